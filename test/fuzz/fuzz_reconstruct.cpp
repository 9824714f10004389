// reconstruct() with everything made of bytes: points, neighbours, options, callbacks.

#include "fuzz_input.h"
#include "spherical_param/reconstruct.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace spherical_param;
using fuzz::Bytes;
using fuzz::Ending;
using fuzz::require;

Options optionsFrom(Bytes& bytes) {
  Options options;
  EmbeddingOptions& embedding = options.embedding;
  options.graph = bytes.choice<GraphMethod>(2);
  embedding.method = bytes.choice<EmbeddingMethod>(2);
  options.triangulation = bytes.choice<TriangulationMethod>(2);
  options.optimization = bytes.choice<OptimizationMethod>(3);
  embedding.weights = bytes.choice<EdgeWeights>(3);
  // Each bit stands for an option that is not the default.
  unsigned which = bytes.raw<std::uint16_t>();
  const auto vary = [&](auto& option, auto(Bytes::*read)()) {
    if (which % 2 != 0)
      option = (bytes.*read)();
    which /= 2;
  };
  vary(options.k, &Bytes::integer);
  vary(embedding.exponent, &Bytes::real);
  vary(embedding.damping, &Bytes::real);
  vary(embedding.tolerance, &Bytes::real);
  vary(embedding.max_iterations, &Bytes::integer);
  vary(embedding.stagnation_window, &Bytes::integer);
  vary(embedding.starts, &Bytes::integer);
  vary(options.seed, &Bytes::raw<std::uint32_t>);
  vary(options.smoothing, &Bytes::integer);
  vary(embedding.history_vertices, &Bytes::integer);
  vary(embedding.history_frames, &Bytes::integer);
  vary(options.threads, &Bytes::integer);
  options.details = which % 2 != 0;
  if (which / 2 % 2 != 0)
    options.consolidation = ConsolidationMode::Auto;
  return options;
}

/// Whether all options are in range, according to the headers.
bool areRight(const Options& o) {
  const EmbeddingOptions& e = o.embedding;
  const auto in = [](auto value, auto low, auto high) {
    return low <= static_cast<decltype(low)>(value) && static_cast<decltype(low)>(value) <= high;
  };
  constexpr int any = std::numeric_limits<int>::max();
  return in(e.method, 0, 1) && in(e.weights, 0, 2) && in(e.exponent, 2.0, 16.0) &&
         e.exponent > 2.0 && (e.method != EmbeddingMethod::Iterative || e.exponent == 3.0) &&
         in(e.damping, 0.0, 1.0) && e.damping > 0.0 &&
         (!e.tolerance || in(*e.tolerance, 0.0, 1.0)) && in(e.max_iterations, 0, any) &&
         in(e.stagnation_window, 0, any) && in(e.starts, 1, 100) &&
         in(e.history.vertices, 0, 1 << 24) && in(e.history.frames, 2, 10000) &&
         in(o.graph, 0, 1) && (!o.k || in(*o.k, 3, any)) &&
         in(o.triangulation.method, 0, 1) && in(o.optimization.method, 0, 2) &&
         in(o.smoothing.steps, 0, 10000) && in(o.threads, 0, 1024);
}

/// A search that answers correctly, or from bytes.
class Search {
public:
  Search(Bytes bytes, const Positions& points)
      : bytes_(bytes), n_(static_cast<std::size_t>(points.cols())), points_(fuzz::tamed(points)) {
    const std::uint8_t how = bytes.byte();
    is_right_ = how < 128;
    is_in_range_ = how < 200;
    throws_ = how >= 240;
    wrong_at_ = bytes.byte() % 4U;
  }
  NeighborLists operator()(const std::vector<Index>& queries, int count) {
    require(count >= 3, "a search is for 3 neighbours or more");
    require(stress::areLists({{0, queries.size()}, queries}, 1, n_), "a search is at points");
    require(!was_bad_ && !has_thrown_, "the search is not asked again after a wrong answer");
    if (is_right_ || calls_++ < wrong_at_)
      return test::bruteForceSearch(points_)(queries, count);
    has_thrown_ = throws_;
    if (throws_)
      throw fuzz::kFaultOfSearch;
    NeighborLists lists = fuzz::arbitraryLists(bytes_, queries.size(), n_, is_in_range_);
    was_bad_ = !stress::areLists(lists, queries.size(), n_);
    return lists;
  }
  bool wasBad() const { return was_bad_; }
  bool hasThrown() const { return has_thrown_; }

private:
  Bytes bytes_;
  std::size_t n_;
  Positions points_;
  bool is_right_ = true;
  bool is_in_range_ = true;
  bool throws_ = false;
  std::size_t wrong_at_ = 0;
  std::size_t calls_ = 0;
  bool was_bad_ = false;
  bool has_thrown_ = false;
};

void checkResult(const Positions& points, const Options& options, const Surface& result) {
  if (options.consolidation == ConsolidationMode::None) {
    const std::string fault = stress::faultOf(points, options, result);
    if (!fault.empty())
      fuzz::finding(fault);
  } else {
    require(result.topology.isSphere(), "the mesh of consolidated points is a sphere");
    require(result.consolidated.allFinite() &&
                result.consolidated.cols() == static_cast<Eigen::Index>(result.vertexCount()),
            "the consolidated points are as many finite ones as there are vertices");
    require(result.vertex_of_input.size() == static_cast<std::size_t>(points.cols()),
            "each point has a vertex");
    for (std::size_t v = 0; v < result.vertexCount(); ++v)
      require(result.vertex_of_input[static_cast<std::size_t>(result.input_of_vertex[v])] ==
                  static_cast<Index>(v),
              "a vertex is that of its first point");
  }
  require(!options.details || result.vertex_residuals.size() == result.vertexCount(),
          "there is a residual for each vertex");
  require(options.embedding.history_vertices > 0 || result.history.frames.empty(),
          "there is no history without a request");
  for (const HistoryFrame& frame : result.history.frames)
    require(frame.sphere.cols() == static_cast<Eigen::Index>(result.history.vertices.size()) &&
                stress::areUnitVectors(frame.sphere),
            "a frame of the history is of unit vectors");
  for (const auto& pair : result.self_intersections)
    require(0 <= pair[0] && pair[0] < pair[1] && pair[1] < result.triangles.cols(),
            "a pair is of two triangles");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const std::uint8_t way = bytes.byte();
  Options options = optionsFrom(bytes);
  fuzz::Watch watch(bytes);
  const Bytes of_search = bytes;
  bytes.raw<std::uint16_t>();
  const Positions points = fuzz::pointsFrom(bytes);
  const auto n = static_cast<std::size_t>(points.cols());

  // Valid, but too long to wait for.
  if (options.embedding.max_iterations > 3000 || options.embedding.starts > 20 ||
      options.smoothing > 300)
    watch.cancelAt(2000);
  const std::array<std::string, 9> stages{"consolidation", "neighbors", "graph",
                                          "openings",      "embedding", "triangulation",
                                          "optimization",  "smoothing", "quality"};
  if (watch.listens())
    options.progress = [&](const Progress& progress) {
      const bool goes_on = watch(progress);
      require(std::count(stages.begin(), stages.end(), progress.stage) == 1, "a stage is known");
      return goes_on;
    };

  Search search(of_search, points);
  NeighborLists lists;
  lists.offsets.assign(n + 1, 0);
  bool has_search = (way & 8) != 0;
  if (way % 8 < 2) {
    lists = fuzz::nearest(points, 3 + way / 8);
    has_search = way % 2 == 0;
  } else if (way % 8 < 4) {
    lists = fuzz::arbitraryLists(bytes, n, n, way % 8 == 2);
  }
  Surface result;
  std::string message;
  const Ending ending = fuzz::endingOf(
      watch,
      [&] {
        result = way % 8 > 4 ? reconstruct(points, options)
                             : reconstruct(points, lists, options,
                                           has_search ? NeighborSearch(std::ref(search)) : nullptr);
      },
      message);
  if (ending == Ending::AsTheWatchAsked)
    return 0;
  require(search.hasThrown() == (ending == Ending::FaultOfSearch),
          "a search's exception comes out");
  if (ending == Ending::FaultOfSearch)
    return 0;
  if (ending == Ending::ComputeError)
    fuzz::finding("on valid input: " + message);
  const bool is_valid = stress::canBeMeshed(points) && stress::areLists(lists, n, n) &&
                        !search.wasBad() && areRight(options);
  if (ending == Ending::InvalidInput && is_valid)
    fuzz::finding("valid input is rejected: " + message);
  if (ending == Ending::Answer) {
    require(is_valid, "points, lists and options that are not valid are rejected");
    checkResult(points, options, result);
  }
  return 0;
}
