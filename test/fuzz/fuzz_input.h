#pragma once

#include "exact.h"
#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

/// What the fuzzers of the core share: points, lists and numbers from bytes, and what is true of
/// them, decided without the code under test.
namespace fuzz {

using spherical_param::Index;
using spherical_param::NeighborLists;
using spherical_param::Positions;
using spherical_param::Triangles;

/// An answer that is not what is guaranteed: ends the program, for libFuzzer to keep the input.
[[noreturn]] inline void finding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

/// What callbacks of the caller throw; it must come out as it is.
struct CallersFault {
  int number = 0;
};

/// Reads bytes from the front; zeros once there are no more.
class Bytes {
public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool empty() const { return at_ >= size_; }
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
  Index index(std::size_t n, bool in_range) {
    const std::uint8_t choice = byte();
    if (in_range || choice < 250)
      return n == 0 ? 0 : static_cast<Index>(choice % n);
    constexpr std::array<Index, 4> odd{-1, std::numeric_limits<Index>::min(),
                                       std::numeric_limits<Index>::max(), 64};
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
    constexpr double inf = std::numeric_limits<double>::infinity();
    constexpr std::array<double, 24> usual{
        0.0,         -0.0,     1.0,    -1.0,   0.5,     2.0,
        3.0,         16.0,     1e100,  -1e100, 1.1e100, 1e-90,
        1e-100,      1e-12,    1e-200, 1e-300, 1e300,   Real::max(),
        Real::min(), 4.9e-324, 1e7,    inf,    -inf,    std::numeric_limits<double>::quiet_NaN()};
    const std::uint8_t choice = byte();
    if (choice < usual.size())
      return usual[choice];
    return choice < 160 ? (choice - 90) / 8.0 : raw<double>();
  }

private:
  using Int = std::numeric_limits<int>;
  using Real = std::numeric_limits<double>;

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

/// Moved by some units in the last place.
inline double stepped(double x, int steps) {
  for (int i = 0; i < std::abs(steps); ++i)
    x = std::nextafter(x, steps > 0 ? std::numeric_limits<double>::infinity()
                                    : -std::numeric_limits<double>::infinity());
  return x;
}

/// Point i of n in one of many encodings; without bytes, on a sphere.
inline Eigen::Vector3d pointFrom(Bytes& bytes, const Positions& points, Eigen::Index i,
                                 Eigen::Index n) {
  const auto earlier = [&]() -> Eigen::Vector3d {
    return points.col(static_cast<Eigen::Index>(bytes.byte()) % i);
  };
  const std::uint8_t kind = bytes.empty() ? 0 : bytes.byte();
  switch (kind % 12) {
  case 1:  // lattice
    return {static_cast<double>(bytes.byte() % 5) - 2.0,
            static_cast<double>(bytes.byte() % 5) - 2.0,
            static_cast<double>(bytes.byte() % 5) - 2.0};
  case 2:
    return {bytes.raw<double>(), bytes.raw<double>(), bytes.raw<double>()};
  case 3:
    return {static_cast<double>(bytes.raw<float>()), static_cast<double>(bytes.raw<float>()),
            static_cast<double>(bytes.raw<float>())};
  case 4:
    if (i > 0)
      return earlier();
    break;
  case 5:  // as good as a copy
    if (i > 0) {
      Eigen::Vector3d point = earlier();
      const std::uint8_t how = bytes.byte();
      for (int axis = 0; axis < 3; ++axis)
        point[axis] = stepped(point[axis], ((how >> (2 * axis)) & 3) - 1);
      return point;
    }
    break;
  case 6:
    if (i > 0) {
      Eigen::Vector3d point = earlier();
      point[static_cast<Eigen::Index>(bytes.below(3))] = bytes.real();
      return point;
    }
    break;
  case 7: {  // lattices of any scale
    const int exponent = bytes.raw<std::int16_t>() % 1075;
    return Eigen::Vector3d(bytes.byte() % 7, bytes.byte() % 7, bytes.byte() % 7)
        .unaryExpr([&](double x) { return std::ldexp(x - 3.0, exponent); });
  }
  case 8:
    return {bytes.real(), bytes.real(), bytes.real()};
  case 9:  // a cluster
    if (i > 0)
      return earlier() +
             std::ldexp(1.0, -static_cast<int>(bytes.byte())) *
                 Eigen::Vector3d(bytes.byte() - 128.0, bytes.byte() - 128.0, bytes.byte() - 128.0);
    break;
  case 10: {  // in a plane, on a line
    const double a = bytes.byte() - 128.0;
    const double b = bytes.byte() % 4;
    return {a, b, a + 2.0 * b};
  }
  default:
    break;
  }
  const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n);
  const double angle = 2.4 * static_cast<double>(i);
  const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Up to 64 points; mostly all in the range that reconstruct() takes.
inline Positions pointsFrom(Bytes& bytes) {
  const std::uint8_t how = bytes.byte();
  const Eigen::Index n = how < 250 ? 4 + how % 61 : how - 250;
  const std::uint8_t range = bytes.byte();
  Positions points(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    points.col(i) = pointFrom(bytes, points, i, n);
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

/// The nearest other points, by brute force; what is no number is far away.
inline NeighborLists nearest(const Positions& points, int k) {
  if (points.allFinite())
    return spherical_param::test::bruteForceNeighbors(points.cwiseMax(-1e150).cwiseMin(1e150), k);
  Positions finite = points.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; });
  return nearest(finite, k);
}

/// Lists of `count` points, in range or not.
inline NeighborLists arbitraryLists(Bytes& bytes, std::size_t count, std::size_t n, bool in_range) {
  NeighborLists lists;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t size = bytes.below(12);
    for (std::size_t k = 0; k < size && n > 0; ++k)
      lists.indices.push_back(bytes.index(n, in_range));
    lists.offsets.push_back(lists.indices.size());
  }
  if (!in_range) {
    const std::uint8_t fault = bytes.byte();
    if (fault % 8 == 1)
      lists.offsets.clear();
    else if (fault % 8 == 2)
      lists.offsets.pop_back();
    else if (fault % 8 == 3)
      lists.offsets.push_back(lists.indices.size());
    else if (fault % 8 == 4)
      lists.offsets[bytes.below(lists.offsets.size())] = bytes.raw<std::size_t>();
    else if (fault % 8 == 5)
      lists.offsets[bytes.below(lists.offsets.size())] = bytes.byte();
    else if (fault % 8 == 6)
      lists.indices.push_back(bytes.index(n, false));
    else if (fault % 8 == 7 && !lists.indices.empty())
      lists.indices.pop_back();
  }
  return lists;
}

/// Whether lists are as types.h says: `count` lists of indices in [0, n).
inline bool areLists(const NeighborLists& lists, std::size_t count, std::size_t n) {
  if (lists.offsets.size() != count + 1 || lists.offsets.front() != 0 ||
      lists.offsets.back() != lists.indices.size())
    return false;
  for (std::size_t i = 0; i < count; ++i)
    if (lists.offsets[i] > lists.offsets[i + 1])
      return false;
  return std::all_of(lists.indices.begin(), lists.indices.end(),
                     [&](Index j) { return j >= 0 && static_cast<std::size_t>(j) < n; });
}

// --- What is true of points ----------------------------------------------------------------------

using stress::countDistinct;
using stress::liesInPlane;
using stress::placeOf;

/// Whether no coordinate has digits below 1e-100 of the largest one: intersections are then exact.
inline bool haveExactProducts(const Positions& points) {
  const double largest = points.size() > 0 ? points.cwiseAbs().maxCoeff() : 0.0;
  const double least = 1e-100 * largest;
  return (points.array() == 0.0 ||
          points.array().abs() * std::numeric_limits<double>::epsilon() / 2.0 >= least)
      .all();
}

inline bool areUnitVectors(const Positions& directions) {
  for (Eigen::Index i = 0; i < directions.cols(); ++i)
    if (!(std::abs(directions.col(i).norm() - 1.0) < 1e-9))
      return false;
  return true;
}

// --- Callbacks -----------------------------------------------------------------------------------

/// What a progress callback does, and has seen.
class Watch {
public:
  enum class Way { Go, Cancel, Throw };

  explicit Watch(Bytes& bytes) {
    const std::uint8_t how = bytes.byte();
    if (how < 128)
      return;
    listens_ = true;
    if (how < 160)
      return;
    way_ = how < 208 ? Way::Cancel : Way::Throw;
    at_ = how % 2 == 0 ? static_cast<std::size_t>(bytes.byte()) : bytes.raw<std::uint16_t>();
  }

  bool listens() const { return listens_; }
  void listen() { listens_ = true; }
  /// Ends work that would take too long.
  void cancelAt(std::size_t call) {
    listens_ = true;
    if (way_ == Way::Go || call < at_) {
      way_ = Way::Cancel;
      at_ = call;
    }
  }
  /// The callback.
  bool operator()(const spherical_param::Progress& progress) {
    if (ended_)
      finding("the progress callback is called again after it ended the work");
    if (std::this_thread::get_id() != caller_)
      finding("the progress callback is called from another thread");
    if (progress.stage == nullptr || *progress.stage == '\0')
      finding("a stage without a name");
    if (!(progress.fraction >= 0.0 && progress.fraction <= 1.0))
      finding("a fraction of " + std::to_string(progress.fraction));
    if (calls_++ < at_ || way_ == Way::Go)
      return true;
    ended_ = true;
    if (way_ == Way::Throw)
      throw CallersFault{static_cast<int>(at_)};
    return false;
  }
  bool ended() const { return ended_; }
  Way way() const { return way_; }
  std::size_t at() const { return at_; }

private:
  bool listens_ = false;
  bool ended_ = false;
  Way way_ = Way::Go;
  std::size_t at_ = 0;
  std::size_t calls_ = 0;
  std::thread::id caller_ = std::this_thread::get_id();
};

/// How a call ended.
struct Ending {
  enum class Kind { Answer, InvalidInput, ComputeError, Cancelled, CallersFault };
  Kind kind = Kind::Answer;
  std::string message;
};

/// Calls, and catches the documented exceptions; any other is a finding.
template <typename Call>
Ending endingOf(const Call& call) {
  try {
    call();
    return {};
  } catch (const spherical_param::InvalidInput& error) {
    return {Ending::Kind::InvalidInput, error.what()};
  } catch (const spherical_param::ComputeError& error) {
    return {Ending::Kind::ComputeError, error.what()};
  } catch (const spherical_param::Cancelled& error) {
    return {Ending::Kind::Cancelled, error.what()};
  } catch (const CallersFault& fault) {
    return {Ending::Kind::CallersFault, std::to_string(fault.number)};
  } catch (const std::exception& error) {
    finding(std::string("not a documented exception: ") + error.what());
  }
}

/// Checks that the work ended as the callback asked. \return whether the callback ended the work
inline bool wasEndedBy(const Watch& watch, const Ending& ending) {
  const bool cancelled = ending.kind == Ending::Kind::Cancelled;
  const bool thrown = ending.kind == Ending::Kind::CallersFault;
  if (!watch.ended()) {
    if (cancelled)
      finding("Cancelled without a request");
    return false;
  }
  if (watch.way() == Watch::Way::Cancel ? !cancelled : !thrown)
    finding("the callback ended the work, but it came to: " + ending.message);
  if (thrown && ending.message != std::to_string(static_cast<int>(watch.at())))
    finding("another exception than the callback's");
  return true;
}

}  // namespace fuzz
