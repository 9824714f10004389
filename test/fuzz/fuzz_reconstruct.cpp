// reconstruct() with everything made of bytes: points, neighbours, options, callbacks.

#include "fuzz_input.h"
#include "spherical_param/reconstruct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace {

using namespace spherical_param;
using fuzz::Bytes;
using fuzz::Ending;
using fuzz::finding;
using fuzz::Watch;

/// Calls of the callback after which work that takes too long is cancelled.
constexpr std::size_t kPatience = 2000;
constexpr int kManyIterations = 3000;

template <typename Enum>
Enum enumFrom(Bytes& bytes, int count) {
  const std::uint8_t choice = bytes.byte();
  return static_cast<Enum>(choice < 250 ? choice % count : bytes.integer());
}

Options optionsFrom(Bytes& bytes) {
  Options options;
  options.graph.method = enumFrom<GraphMethod>(bytes, 2);
  options.embedding.method = enumFrom<EmbeddingMethod>(bytes, 2);
  options.triangulation.method = enumFrom<TriangulationMethod>(bytes, 2);
  options.optimization.method = enumFrom<OptimizationMethod>(bytes, 3);
  options.embedding.weights = enumFrom<EdgeWeights>(bytes, 3);
  // Each bit stands for an option that is not the default.
  const auto which = bytes.raw<std::uint16_t>();
  const auto is_changed = [&](unsigned bit) { return ((which >> bit) & 1U) != 0; };
  if (is_changed(0))
    options.graph.k = bytes.integer();
  EmbeddingOptions& embedding = options.embedding;
  if (is_changed(1))
    embedding.exponent = bytes.real();
  if (is_changed(2))
    embedding.damping = bytes.real();
  if (is_changed(3))
    embedding.tolerance = bytes.real();
  if (is_changed(4))
    embedding.max_iterations = bytes.integer();
  if (is_changed(5))
    embedding.stagnation_window = bytes.integer();
  if (is_changed(6))
    embedding.starts = bytes.integer();
  if (is_changed(7))
    options.seed = bytes.raw<std::uint32_t>();
  if (is_changed(8))
    options.retries = bytes.integer();
  if (is_changed(9))
    options.smoothing.steps = bytes.integer();
  if (is_changed(10))
    embedding.history.vertices = bytes.integer();
  if (is_changed(11))
    embedding.history.frames = bytes.integer();
  if (is_changed(12))
    options.threads = bytes.integer();
  options.details = is_changed(13);
  return options;
}

template <typename Enum>
bool isOneOf(Enum value, int count) {
  return static_cast<int>(value) >= 0 && static_cast<int>(value) < count;
}

/// Whether an option is out of range, according to the headers.
bool areWrong(const Options& o) {
  const EmbeddingOptions& e = o.embedding;
  const bool is_paper = e.method == EmbeddingMethod::Iterative;
  const bool is_embedding_right =
      isOneOf(e.method, 2) && isOneOf(e.weights, 3) && e.exponent > 2.0 && e.exponent <= 16.0 &&
      (!is_paper || e.exponent == 3.0) && e.damping > 0.0 && e.damping <= 1.0 &&
      (!e.tolerance || (*e.tolerance >= 0.0 && *e.tolerance <= 1.0)) && e.max_iterations >= 0 &&
      e.stagnation_window >= 0 && e.starts >= 1 && e.starts <= 100 && e.history.vertices >= 0 &&
      e.history.vertices <= (1 << 24) && e.history.frames >= 2 && e.history.frames <= 10000;
  return !(is_embedding_right && isOneOf(o.graph.method, 2) && (!o.graph.k || *o.graph.k >= 3) &&
           isOneOf(o.triangulation.method, 2) && isOneOf(o.optimization.method, 3) &&
           o.retries >= 0 && o.retries <= 99 && o.smoothing.steps >= 0 &&
           o.smoothing.steps <= 10000 && o.threads >= 0 && o.threads <= 1024);
}

bool isStage(const std::string& name) {
  const std::array<std::string, 7> names{"neighbors",    "graph",     "embedding", "triangulation",
                                         "optimization", "smoothing", "quality"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// A search that answers correctly, or from bytes.
class Search {
public:
  enum class Way { Right, InRange, Any, Throw };

  Search(Bytes& bytes, const Positions& points) : bytes_(bytes), points_(&points) {
    const std::uint8_t how = bytes.byte();
    way_ = how < 128 ? Way::Right : how < 200 ? Way::InRange : how < 240 ? Way::Any : Way::Throw;
    wrong_at_ = bytes.byte() % 4U;
  }
  /// What came of it so far, shared by all copies of a search.
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
  if (result.vertexCount() != count || result.duplicates() != n - count ||
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
    finding("the mesh is not a sphere over all points");
  if (!result.topology.isSphere())
    finding("the result's own check says that the mesh is not a sphere");
  if (static_cast<std::size_t>(result.sphere.cols()) != count ||
      !fuzz::areUnitVectors(result.sphere))
    finding("the embedding is not of unit vectors");
  if (options.smoothing.steps > 0 &&
      (static_cast<std::size_t>(result.smoothed.cols()) != count || !result.smoothed.allFinite()))
    finding("the smoothed points are not as many finite ones");
  if (options.details && result.vertex_residuals.size() != count)
    finding("no residual for each vertex");
  if (options.embedding.history.vertices == 0 && !result.history.frames.empty())
    finding("a history without a request");
  for (const HistoryFrame& frame : result.history.frames)
    if (frame.sphere.cols() != static_cast<Eigen::Index>(result.history.vertices.size()) ||
        !fuzz::areUnitVectors(frame.sphere))
      finding("a frame of the history is not of unit vectors");
  for (const auto& pair : result.self_intersections)
    if (pair[0] < 0 || pair[0] >= pair[1] || pair[1] >= result.triangles.cols())
      finding("a pair is not of two triangles");
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

  // Valid, but too long to wait for.
  if (options.embedding.max_iterations > kManyIterations || options.retries > 5 ||
      options.embedding.starts > 20 || options.smoothing.steps > 300)
    watch.cancelAt(kPatience);
  if (watch.listens())
    options.progress = [&](const Progress& progress) {
      if (!isStage(progress.stage))
        finding(std::string("there is no stage \"") + progress.stage + "\"");
      return watch(progress);
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
  default:
    ending = fuzz::endingOf([&] { result = reconstruct(points, options); });
  }
  if (fuzz::wasEndedBy(watch, ending))
    return 0;
  if (seen.threw) {
    if (ending.kind != Ending::Kind::CallersFault || ending.message != "-1")
      finding("the search threw, but it came to: " + ending.message);
    return 0;
  }
  if (ending.kind == Ending::Kind::CallersFault)
    finding("an exception that no callback threw");
  if (ending.kind == Ending::Kind::ComputeError)
    finding("on valid input: " + ending.message);
  const bool is_bad_cloud = !points.allFinite() || (points.array().abs() > 1e100).any() ||
                            fuzz::countDistinct(points) < 4 || fuzz::liesInPlane(points);
  const bool is_any_wrong = areWrong(options);
  if (ending.kind == Ending::Kind::InvalidInput) {
    if (!is_bad_cloud && !are_lists_bad && !seen.bad && !is_any_wrong)
      finding("valid input is rejected: " + ending.message);
    return 0;
  }
  if (is_bad_cloud)
    finding("points that cannot be meshed are accepted");
  if (are_lists_bad || seen.bad)
    finding("bad lists are accepted");
  if (is_any_wrong)
    finding("an option out of range is accepted");
  checkResult(points, options, result);
  return 0;
}
