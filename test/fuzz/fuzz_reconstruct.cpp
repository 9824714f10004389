// reconstruct() with everything made of bytes: points, searches, options, callbacks.

#include "guarantees.h"

namespace {

using namespace fuzz;

Options optionsFrom(Bytes& bytes) {
  Options options;
  EmbeddingOptions& embedding = options.embedding;
  PaperOptions& paper = options.paper;
  options.method = bytes.choice<Method>(2);
  paper.weights = bytes.choice<EdgeWeights>(3);
  // Each bit stands for an option that is not the default.
  unsigned which = bytes.raw<std::uint16_t>();
  const auto vary = [&](auto& option, auto(Bytes::*read)()) {
    if (which % 2 != 0)
      option = (bytes.*read)();
    which /= 2;
  };
  vary(paper.k, &Bytes::integer);
  vary(paper.damping, &Bytes::real);
  vary(paper.max_iterations, &Bytes::integer);
  vary(embedding.tolerance, &Bytes::real);
  vary(options.seed, &Bytes::raw<std::uint32_t>);
  vary(options.smoothing, &Bytes::integer);
  vary(options.threads, &Bytes::integer);
  options.details = which % 2 != 0;
  if (which / 2 % 2 != 0)
    options.consolidation = ConsolidationMode::Auto;
  if (which / 4 % 2 != 0) {
    options.outliers = bytes.choice<OutlierMode>(4);
    options.outlier_sigma = bytes.realOr(4.0);
  }
  if (which / 8 % 2 != 0) {
    options.parts = bytes.choice<PartsMode>(4);
    options.min_points = bytes.integerOr(8);
  }
  options.topology = which / 16 % 2 != 0 ? TopologyMode::Scan : TopologyMode::Sphere;
  return withTopology(options);
}

/// Whether all options are in range; each range has a test of its own.
bool areRight(const Options& options) {
  try {
    checkOptions(options);
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

/// Makes a search that answers correctly, or from bytes.
class Search {
public:
  Search(Bytes bytes, const Positions& points)
      : bytes_(bytes), points_(points), tamed_(tamed(points)) {
    const std::uint8_t how = bytes.byte();
    is_right_ = how < 128;
    is_in_range_ = how < 200;
    throws_ = how >= 240;
    wrong_at_ = bytes.byte() % 4U;
  }
  NeighborSearch operator()(const std::vector<Index>& some) {
    require(some_.empty(), "one search is made");
    require(std::is_sorted(some.begin(), some.end()), "points are ascending");
    require(some.size() == firstAtPlaces(finiteOf(points_)).size() &&
                firstAtPlaces(points_(Eigen::all, some)).size() == some.size(),
            "it is made of one point at each position");
    some_ = some;
    return [this, right = test::bruteForceFactory(tamed_)(some)](const std::vector<Index>& queries,
                                                                 int count) {
      require(count >= 3, "a search is for 3 neighbours or more");
      require(areSome({{0, queries.size()}, queries}, 1), "a search is at points it was made of");
      require(!was_bad_ && !has_thrown_, "the search is not asked again after a wrong answer");
      if (is_right_ || calls_++ < wrong_at_)
        return right(queries, count);
      has_thrown_ = throws_;
      if (throws_)
        throw kFaultOfSearch;
      NeighborLists lists = arbitraryLists(
          bytes_, queries.size(),
          is_in_range_ ? some_.size() : static_cast<std::size_t>(points_.cols()), is_in_range_);
      if (is_in_range_)
        for (Index& index : lists.indices)
          index = some_[static_cast<std::size_t>(index)];
      was_bad_ = !areSome(lists, queries.size());
      return lists;
    };
  }
  bool wasBad() const { return was_bad_; }
  bool hasThrown() const { return has_thrown_; }

private:
  bool areSome(const NeighborLists& lists, std::size_t count) const {
    return areLists(lists, count, static_cast<std::size_t>(points_.cols())) &&
           std::all_of(lists.indices.begin(), lists.indices.end(),
                       [&](Index i) { return std::binary_search(some_.begin(), some_.end(), i); });
  }

  Bytes bytes_;
  const Positions& points_;
  Positions tamed_;
  std::vector<Index> some_;
  bool is_right_ = true;
  bool is_in_range_ = true;
  bool throws_ = false;
  std::size_t wrong_at_ = 0;
  std::size_t calls_ = 0;
  bool was_bad_ = false;
  bool has_thrown_ = false;
};

void checkSurface(const Positions& points, const Options& options, const Surface& result) {
  if (!result.consolidation) {
    requireGuarantees(points, options, result);
  } else {
    requireTopology(result);
    require(result.points.allFinite() &&
                result.points.cols() == static_cast<Eigen::Index>(result.vertexCount()),
            "the points are as many finite ones as there are vertices");
    require(result.vertex_of_input.size() == result.inputs.size(), "each point has a vertex");
    for (std::size_t v = 0; v < result.vertexCount(); ++v)
      require(result.vertexOf(result.input_of_vertex[v]) == static_cast<Index>(v),
              "a vertex is that of its first point");
  }
  require(!options.details || result.sphere.cols() == 0 ||
              result.vertex_residuals.size() == result.vertexCount(),
          "there is a residual for each vertex on the sphere");
  for (const auto& pair : result.self_intersections)
    require(0 <= pair[0] && pair[0] < pair[1] && pair[1] < result.triangles.cols(),
            "a pair is of two triangles");
}

void checkResult(const Positions& points, const Options& options, const Result& result) {
  requireLists(points, options, result);
  for (const Surface& surface : result.surfaces) {
    require(options.parts != PartsMode::Each ||
                firstAtPlaces(points(Eigen::all, surface.inputs)).size() >=
                    static_cast<std::size_t>(options.min_points),
            "a part has its minimum number of distinct points");
    checkSurface(points, options, surface);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const std::uint8_t way = bytes.byte();
  Options options = optionsFrom(bytes);
  Watch watch(bytes);
  const Bytes of_search = bytes;
  bytes.raw<std::uint16_t>();
  const Positions points = pointsFrom(bytes);

  // Valid, but too long to wait for.
  if (options.paper.max_iterations > 3000 || options.smoothing > 300)
    watch.cancelAt(2000);
  const std::array<std::string, 13> stages{
      "neighbors", "graph",     "outliers",      "parts",        "consolidation",
      "openings",  "embedding", "triangulation", "optimization", "smoothing",
      "cleaning",  "fill",      "quality"};
  if (watch.listens())
    options.progress = [&](const Progress& progress) {
      const bool goes_on = watch(progress);
      require(std::count(stages.begin(), stages.end(), progress.stage) == 1, "a stage is known");
      require(progress.part < progress.parts, "a part is one of those there are");
      return goes_on;
    };

  Search search(of_search, points);
  NeighborSearchFactory search_of;
  if (way % 2 == 0)
    search_of = std::ref(search);
  Result result;
  std::string message;
  const Ending ending = endingOf(
      watch, [&] { result = reconstruct(points, options, search_of); }, message);
  if (ending == Ending::AsTheWatchAsked)
    return 0;
  require(search.hasThrown() == (ending == Ending::FaultOfSearch),
          "a search's exception comes out");
  if (ending == Ending::FaultOfSearch)
    return 0;
  if (ending == Ending::ComputeError)
    finding("on valid input: " + message);
  const bool is_right = !search.wasBad() && areRight(options);
  if (ending == Ending::InvalidInput && is_right && mustBeMeshed(points, options))
    finding("valid input is rejected: " + message);
  if (ending == Ending::Answer) {
    require(is_right && canBeMeshed(points, options),
            "points, answers and options that are not valid are rejected");
    checkResult(points, options, result);
  }
  return 0;
}
