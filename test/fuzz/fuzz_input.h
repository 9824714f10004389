#pragma once

#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/execution.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

/// What the fuzzers of the core share: points, lists and numbers from bytes, and how calls end.
namespace fuzz {

using namespace spherical_param;

/// A broken promise: ends the program, for libFuzzer to keep the input.
[[noreturn]] inline void finding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

inline void require(bool holds, const char* what) {
  if (!holds)
    finding(std::string("not so: ") + what);
}

inline bool areUnitVectors(const Positions& directions) {
  return ((directions.colwise().norm().array() - 1.0).abs() < 1e-9).all();
}

/// Reads bytes from the front; zeros once there are no more.
class Bytes {
public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  std::uint8_t byte() { return at_ < size_ ? data_[at_++] : std::uint8_t{0}; }
  template <typename Number>
  Number raw() {
    std::array<std::uint8_t, sizeof(Number)> bytes{};
    for (std::uint8_t& b : bytes)
      b = byte();
    Number number{};
    std::memcpy(&number, bytes.data(), sizeof number);
    return number;
  }
  /// In [0, count).
  std::size_t below(std::size_t count) { return byte() % count; }
  bool oneIn(std::size_t count) { return byte() % count == count - 1; }
  /// An index, mostly in [0, n).
  Index index(std::size_t n, bool in_range = false) {
    const std::uint8_t choice = byte();
    if (in_range || choice < 250)
      return n == 0 ? 0 : static_cast<Index>(choice % n);
    constexpr std::array<Index, 4> odd{-1, Int::min(), Int::max(), 64};
    return choice < 254 ? odd[choice - 250U] : raw<Index>();
  }
  int integer() {
    constexpr std::array<int, 15> usual{
        0, 1, 2, 3, 4, 10, 12, 100, 1000, 1024, 10000, 10001, 1 << 24, Int::max(), Int::min()};
    const std::uint8_t choice = byte();
    if (choice < usual.size())
      return usual[choice];
    return choice < 128 ? choice - 64 : raw<int>();
  }
  double real() {
    constexpr double inf = Real::infinity();
    constexpr std::array<double, 24> usual{
        0.0,   -0.0,        1.0,         -1.0,     0.5,    2.0,   3.0,    16.0,
        1e100, -1e100,      1.1e100,     1e-90,    1e-100, 1e-12, 1e-200, 1e-300,
        1e300, Real::max(), Real::min(), 4.9e-324, 1e7,    inf,   -inf,   Real::quiet_NaN()};
    const std::uint8_t choice = byte();
    if (choice < usual.size())
      return usual[choice];
    return choice < 160 ? (choice - 90) / 8.0 : raw<double>();
  }
  /// One of `count` values of an enumeration, seldom another.
  template <typename Enum>
  Enum choice(int count) {
    const std::uint8_t choice = byte();
    return static_cast<Enum>(choice < 250 ? choice % count : integer());
  }
  /// A default, mostly, or any number.
  int integerOr(int usual) { return oneIn(4) ? integer() : usual; }
  double realOr(double usual) { return oneIn(4) ? real() : usual; }

private:
  using Int = std::numeric_limits<int>;
  using Real = std::numeric_limits<double>;

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

/// Point i of n of one of five shapes that are hard to mesh.
inline Eigen::Vector3d onShape(int shape, int i, double n) {
  using test::kPi;
  using test::onCircle;
  const double t = i / n;
  const double z = 1.0 - (2.0 * i + 1.0) / n;
  const Eigen::Vector3d on_sphere = onCircle(2.4 * i, std::sqrt(std::max(0.0, 1.0 - z * z)), z);
  switch (shape) {
  case 2:  // a knot on a torus
    return onCircle(6.0 * kPi * t, 1.0 + 0.4 * std::cos(10.0 * kPi * t),
                    0.4 * std::sin(10.0 * kPi * t));
  case 1:  // a long thin limb on a sphere
    return i % 2 == 0 ? on_sphere : onCircle(2.4 * i, 0.05, 1.0 + 4.0 * t);
  case 3:  // a lattice
    return {i % 4 + 0.0, i / 4 % 4 + 0.0, i / 16 + 0.0};
  case 4:  // two spheres far apart
    return on_sphere + 1e6 * (i % 2) * Eigen::Vector3d::UnitX();
  default:
    return on_sphere;
  }
}

/// Point i of n in one of many encodings; without bytes, on a shape.
inline Eigen::Vector3d pointFrom(Bytes& bytes, const Positions& points, int shape, Eigen::Index i,
                                 Eigen::Index n) {
  const std::uint8_t kind = bytes.byte() % 10;
  const bool is_of_earlier = (kind >= 3 && kind <= 5) || kind == 7;
  Eigen::Vector3d earlier = Eigen::Vector3d::Zero();
  if (is_of_earlier && i > 0)
    earlier = points.col(bytes.byte() % i);
  switch (is_of_earlier && i == 0 ? 0 : kind) {
  case 1:  // lattice
    return {bytes.byte() % 5 - 2.0, bytes.byte() % 5 - 2.0, bytes.byte() % 5 - 2.0};
  case 2:
    return {bytes.raw<double>(), bytes.raw<double>(), bytes.raw<double>()};
  case 3:
    return earlier;
  case 4: {  // a unit in the last place beside it
    const std::uint8_t how = bytes.byte();
    for (int axis = 0; axis < 3; ++axis) {
      const int steps = ((how >> (2 * axis)) & 3) - 1;
      for (int step = 0; step < std::abs(steps); ++step)
        earlier[axis] =
            std::nextafter(earlier[axis], steps * std::numeric_limits<double>::infinity());
    }
    return earlier;
  }
  case 5:
    earlier[static_cast<Eigen::Index>(bytes.below(3))] = bytes.real();
    return earlier;
  case 6:
    return {bytes.real(), bytes.real(), bytes.real()};
  case 7: {  // a cluster
    const double scale = std::ldexp(1.0, -static_cast<int>(bytes.byte()));
    return earlier + scale * Eigen::Vector3d(bytes.byte() - 128.0, bytes.byte() - 128.0,
                                             bytes.byte() - 128.0);
  }
  case 8: {  // in a plane, on a line
    const double a = bytes.byte() - 128.0;
    const double b = bytes.byte() % 4;
    return {a, b, a + 2.0 * b};
  }
  default:
    return onShape(shape, static_cast<int>(i), static_cast<double>(n));
  }
}

/// Up to 64 points; mostly all in the range that reconstruct() takes.
inline Positions pointsFrom(Bytes& bytes) {
  const std::uint8_t how = bytes.byte();
  const Eigen::Index n = how < 250 ? 4 + how % 61 : how - 250;
  const std::uint8_t range = bytes.byte();
  Positions points(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    points.col(i) = pointFrom(bytes, points, range / 8 % 5, i, n);
    if (range < 200)
      points.col(i) = points.col(i).unaryExpr(
          [](double x) { return std::isfinite(x) && std::abs(x) <= 1e100 ? x : 0.0; });
  }
  if (range % 8 == 1)  // as a survey's coordinates
    points.row(0).array() += 1e7;
  if (range % 8 == 2 || range % 8 == 3)
    points *= range % 8 == 2 ? 1e-30 : 1e30;
  return points;
}

/// Points whose squared distances are finite.
inline Positions tamed(const Positions& points) {
  return points.unaryExpr(
      [](double x) { return std::isfinite(x) ? std::clamp(x, -1e150, 1e150) : 0.0; });
}

/// Limits the time of the work; a value that is out of range is kept.
inline int atMost(int most, int value, int range) {
  return value > most && value <= range ? most : value;
}

/// What callbacks of the caller throw; it must come out as it is.
struct CallersFault {};

/// A progress callback that may end the work, and has seen what it may see.
class Watch {
public:
  explicit Watch(Bytes& bytes) {
    const std::uint8_t how = bytes.byte();
    listens_ = how >= 128;
    if (how < 160)
      return;
    throws_ = how >= 208;
    at_ = how % 2 == 0 ? static_cast<std::size_t>(bytes.byte()) : bytes.raw<std::uint16_t>();
  }

  bool listens() const { return listens_; }
  bool hasEnded() const { return calls_ > at_; }
  bool throws() const { return throws_; }
  bool operator()(const Progress& progress) {
    require(!hasEnded(), "the callback is not called again after it ended the work");
    require(std::this_thread::get_id() == caller_, "it is called from the caller's thread");
    require(progress.stage != nullptr && *progress.stage != '\0', "a stage has a name");
    require(progress.fraction >= 0.0 && progress.fraction <= 1.0, "fractions are in [0, 1]");
    ++calls_;
    if (hasEnded() && throws_)
      throw CallersFault();
    return !hasEnded();
  }

private:
  bool listens_ = false;
  bool throws_ = false;
  std::size_t at_ = std::numeric_limits<std::size_t>::max();  ///< the call that ends the work
  std::size_t calls_ = 0;
  std::thread::id caller_ = std::this_thread::get_id();
};

enum class Ending { Answer, InvalidInput, ComputeError, AsTheWatchAsked };

/// Calls. Any exception that is not documented is a finding, and so is work that the callback ended
/// but that goes on. \param message receives that of the exception.
template <typename Call>
Ending endingOf(const Watch& watch, const Call& call, std::string& message) {
  Ending ending = Ending::Answer;
  try {
    call();
  } catch (const Cancelled&) {
    require(watch.hasEnded() && !watch.throws(), "Cancelled comes out if it was asked for");
    return Ending::AsTheWatchAsked;
  } catch (const CallersFault&) {
    require(watch.hasEnded() && watch.throws(), "the exception of the callback comes out");
    return Ending::AsTheWatchAsked;
  } catch (const InvalidInput& error) {
    ending = Ending::InvalidInput;
    message = error.what();
  } catch (const ComputeError& error) {
    ending = Ending::ComputeError;
    message = error.what();
  } catch (const std::exception& error) {
    finding(std::string("not a documented exception: ") + error.what());
  }
  if (watch.hasEnded())
    finding("the callback ended the work, but it came to: " + message);
  return ending;
}

}  // namespace fuzz
