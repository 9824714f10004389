// reconstruct() on whatever bytes say: points, neighbour lists or a search, options, callbacks.

#include "fuzz_input.h"
#include "spherical_param/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace {

using namespace spherical_param;
using fuzz::Bytes;
using fuzz::Ending;
using fuzz::finding;
using fuzz::Watch;

/// Work that nobody would wait for is cancelled after so many calls of the callback.
constexpr std::size_t kPatience = 2000;
constexpr int kManyIterations = 3000;

template <typename Enum>
Enum enumFrom(Bytes& bytes, int count) {
  const std::uint8_t choice = bytes.byte();
  return static_cast<Enum>(choice < 250 ? choice % count : bytes.integer());
}

Options optionsFrom(Bytes& bytes) {
  Options options;
  options.graph = enumFrom<GraphMethod>(bytes, 2);
  options.solver = enumFrom<EmbeddingMethod>(bytes, 2);
  options.hull = enumFrom<TriangulationMethod>(bytes, 2);
  options.optimization = enumFrom<OptimizationMethod>(bytes, 3);
  options.weights = enumFrom<EdgeWeights>(bytes, 3);
  if (options.solver != EmbeddingMethod::Multilevel)
    options.weights = static_cast<EdgeWeights>(2 - static_cast<int>(options.weights) % 3);
  // One byte says which options are not the default, one bit each.
  const auto which = bytes.raw<std::uint16_t>();
  const auto is_changed = [&](unsigned bit) { return ((which >> bit) & 1U) != 0; };
  if (is_changed(0))
    options.k = bytes.integer();
  if (is_changed(1))
    options.exponent = bytes.real();
  if (is_changed(2))
    options.lambda = bytes.real();
  if (is_changed(3))
    options.tolerance = bytes.real();
  if (is_changed(4))
    options.max_iterations = bytes.integer();
  if (is_changed(5))
    options.stagnation_window = bytes.integer();
  if (is_changed(6))
    options.starts = bytes.integer();
  if (is_changed(7))
    options.seed = bytes.raw<std::uint32_t>();
  if (is_changed(8))
    options.attempts = bytes.integer();
  if (is_changed(9))
    options.smoothing_steps = bytes.integer();
  if (is_changed(10))
    options.history.vertices = bytes.integer();
  if (is_changed(11))
    options.history.frames = bytes.integer();
  if (is_changed(12))
    options.threads = bytes.integer();
  options.details = is_changed(13);
  return options;
}

template <typename Enum>
bool isOneOf(Enum value, int count) {
  return static_cast<int>(value) >= 0 && static_cast<int>(value) < count;
}

/// Whether an option is out of range, as reconstruct.h says it.
bool areWrong(const Options& o) {
  const bool is_paper = o.solver == EmbeddingMethod::Iterative;
  return !(isOneOf(o.graph, 2) && isOneOf(o.solver, 2) && isOneOf(o.hull, 2) &&
           isOneOf(o.optimization, 3) && isOneOf(o.weights, 3) && (!o.k || *o.k >= 3) &&
           o.exponent > 2.0 && o.exponent <= 16.0 && (!is_paper || o.exponent == 3.0) &&
           o.lambda > 0.0 && o.lambda <= 1.0 && (!o.tolerance || *o.tolerance >= 0.0) &&
           o.max_iterations >= 0 && (o.stagnation_window == 0 || o.stagnation_window >= 2) &&
           o.starts >= 1 && o.starts <= 100 && o.attempts >= 1 && o.attempts <= 100 &&
           o.smoothing_steps >= 0 && o.smoothing_steps <= 10000 && o.history.vertices >= 0 &&
           o.history.vertices <= (1 << 24) && o.history.frames >= 2 && o.history.frames <= 10000 &&
           o.threads >= 0 && o.threads <= 1024);
}

/// A search that answers rightly, or as bytes say.
class Search {
public:
  enum class Way { Right, InRange, Any, Throw };

  Search(Bytes& bytes, const Positions& points) : bytes_(bytes), points_(&points) {
    const std::uint8_t how = bytes.byte();
    way_ = how < 128 ? Way::Right : how < 200 ? Way::InRange : how < 240 ? Way::Any : Way::Throw;
    wrong_at_ = bytes.byte() % 4U;
  }
  /// \param seen what came of it so far, where all copies of a search write it
  struct Seen {
    std::size_t calls = 0;
    bool bad = false;
    bool threw = false;
  };
  NeighborLists operator()(const std::vector<Index>& queries, int count) {
    if (count < 3)
      finding("a search for " + std::to_string(count) + " neighbours");
    const auto n = static_cast<std::size_t>(points_->cols());
    for (const Index query : queries)
      if (query < 0 || static_cast<std::size_t>(query) >= n)
        finding("a search at point " + std::to_string(query));
    if (seen_->bad || seen_->threw)
      finding("the search is asked again after a wrong answer");
    const bool is_wrong = way_ != Way::Right && seen_->calls++ >= wrong_at_;
    if (is_wrong && way_ == Way::Throw) {
      seen_->threw = true;
      throw fuzz::CallersFault{-1};
    }
    if (is_wrong) {
      NeighborLists lists = fuzz::arbitraryLists(bytes_, queries.size(), n, way_ == Way::InRange);
      seen_->bad = !fuzz::areLists(lists, queries.size(), n);
      return lists;
    }
    const NeighborLists all = fuzz::nearest(*points_, count);
    NeighborLists lists;
    for (const Index query : queries) {
      const auto i = static_cast<std::size_t>(query);
      for (std::size_t e = all.offsets[i]; e < all.offsets[i + 1]; ++e)
        lists.indices.push_back(all.indices[e]);
      lists.offsets.push_back(lists.indices.size());
    }
    return lists;
  }
  void tell(Seen& seen) { seen_ = &seen; }
  void searchIn(const Positions& points) { points_ = &points; }

private:
  Bytes bytes_;
  const Positions* points_;
  Way way_ = Way::Right;
  std::size_t wrong_at_ = 0;
  Seen* seen_ = nullptr;
};

/// Everything that is guaranteed, from the result alone.
void checkResult(const Positions& points, const Options& options, const Result& result) {
  const std::size_t count = fuzz::countDistinct(points);
  const auto n = static_cast<std::size_t>(points.cols());
  if (result.vertexCount() != count || result.duplicates != n - count ||
      result.vertex_of_input.size() != n)
    finding("not one vertex for each distinct point");
  for (std::size_t i = 0; i < n; ++i) {
    const auto v = static_cast<std::size_t>(result.vertex_of_input[i]);
    if (v >= count || static_cast<std::size_t>(result.input_of_vertex[v]) > i ||
        fuzz::placeOf(points, result.input_of_vertex[v]) !=
            fuzz::placeOf(points, static_cast<Eigen::Index>(i)))
      finding("an input point has another place than its vertex");
  }
  if (!test::isSphereOverAll(result.triangles, static_cast<Index>(count)))
    finding("the mesh is no sphere over all points");
  if (!result.topology.isSphere())
    finding("the result's own check says it is no sphere");
  if (static_cast<std::size_t>(result.sphere.cols()) != count ||
      !fuzz::areUnitVectors(result.sphere))
    finding("the embedding is not of unit vectors");
  if (options.smoothing_steps > 0 &&
      (static_cast<std::size_t>(result.smoothed.cols()) != count || !result.smoothed.allFinite()))
    finding("the smoothed points are not as many finite ones");
  if (options.details && result.vertex_residuals.size() != count)
    finding("no residual for each vertex");
  if (options.history.vertices == 0 && !result.history.frames.empty())
    finding("a history that was not asked for");
  for (const HistoryFrame& frame : result.history.frames)
    if (frame.sphere.cols() != static_cast<Eigen::Index>(result.history.vertices.size()) ||
        !fuzz::areUnitVectors(frame.sphere))
      finding("a frame of the history is not of unit vectors");
  for (const auto& pair : result.self_intersections)
    if (pair[0] < 0 || pair[0] >= pair[1] || pair[1] >= result.triangles.cols())
      finding("a pair of no two triangles");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const std::uint8_t way = bytes.byte();
  Options options = optionsFrom(bytes);
  Watch watch(bytes);
  Bytes of_search = bytes;
  for (int skipped = 0; skipped < 2; ++skipped)
    bytes.byte();
  const Positions points = fuzz::pointsFrom(bytes);
  const auto n = static_cast<std::size_t>(points.cols());

  // Valid, but nobody would wait for it.
  if (options.max_iterations > kManyIterations || options.attempts > 6 || options.starts > 20 ||
      options.smoothing_steps > 300)
    watch.cancelAt(kPatience);
  std::map<std::string, double> shares;
  std::string stage;
  if (watch.listens())
    options.progress = [&](const Progress& progress) {
      // Stages begin anew in further attempts.
      if (progress.stage != stage)
        shares[progress.stage] = 0.0;
      stage = progress.stage;
      if (progress.fraction < shares[stage] && progress.fraction > 0.0)
        finding("the share of \"" + stage + "\" falls");
      shares[stage] = progress.fraction;
      return watch(progress.fraction);
    };

  Search::Seen seen;
  Search search(of_search, points);
  search.tell(seen);
  bool are_lists_bad = false;
  Result result;
  const auto by_lists = [&](const NeighborLists& lists, bool with_search) {
    are_lists_bad = !fuzz::areLists(lists, n, n);
    return fuzz::endingOf([&] {
      result = reconstruct(points, lists, options,
                           with_search ? NeighborSearch(std::ref(search)) : NeighborSearch());
    });
  };
  Ending ending;
  switch (way % 8) {
  case 0:
  case 1:
    ending = by_lists(fuzz::nearest(points, 3 + way / 8), way % 2 == 0);
    break;
  case 2:
    ending = by_lists(fuzz::arbitraryLists(bytes, n, n, true), (way & 8) != 0);
    break;
  case 3:
    ending = by_lists(fuzz::arbitraryLists(bytes, n, n, false), (way & 8) != 0);
    break;
  case 4: {
    NeighborLists empty;
    empty.offsets.assign(n + 1, 0);
    ending = by_lists(empty, (way & 8) != 0);
    break;
  }
  default: {
    const bool is_empty = way % 8 == 7 && way > 200;
    are_lists_bad = is_empty;
    const NeighborSearchFactory factory = [&](const Positions& nodes,
                                              const std::vector<Index>&) -> NeighborSearch {
      if (is_empty)
        return {};
      search.searchIn(nodes);
      return std::ref(search);
    };
    ending = fuzz::endingOf([&] { result = reconstruct(points, factory, options); });
  }
  }
  if (fuzz::wasEndedBy(watch, ending))
    return 0;
  if (seen.threw) {
    if (ending.kind != Ending::Kind::CallersFault || ending.message != "-1")
      finding("the search threw, but it came to: " + ending.message);
    return 0;
  }
  if (ending.kind == Ending::Kind::CallersFault)
    finding("an exception that nobody threw");
  if (ending.kind == Ending::Kind::ComputeError)
    finding("on valid input: " + ending.message);
  const bool is_bad_cloud = !points.allFinite() || (points.array().abs() > 1e100).any() ||
                            fuzz::countDistinct(points) < 4 || fuzz::liesInPlane(points);
  const bool is_any_wrong = areWrong(options);
  if (ending.kind == Ending::Kind::InvalidInput) {
    if (!is_bad_cloud && !are_lists_bad && !seen.bad && !is_any_wrong)
      finding("valid input is refused: " + ending.message);
    return 0;
  }
  if (is_bad_cloud)
    finding("an answer to points that have none");
  if (are_lists_bad || seen.bad)
    finding("an answer to lists that are none");
  if (is_any_wrong)
    finding("an answer with an option out of range");
  checkResult(points, options, result);
  return 0;
}
