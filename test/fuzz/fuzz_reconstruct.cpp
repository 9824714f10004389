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
  paper.max_iterations = atMost(3000, paper.max_iterations, std::numeric_limits<int>::max());
  options.smoothing = atMost(300, options.smoothing, 10000);
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

/// Makes a search that answers correctly, or by any lists; sometimes with a point that there is
/// not.
class Search {
public:
  Search(Bytes bytes, const Positions& points)
      : bytes_(bytes), points_(points), tamed_(tamed(points)) {
    const std::uint8_t how = bytes.byte();
    is_right_ = how < 128;
    is_in_range_ = how < 200;
  }
  NeighborSearch operator()(const std::vector<Index>& some) {
    require(std::is_sorted(some.begin(), some.end()), "points are ascending");
    require(some.size() == firstAtPlaces(finiteOf(points_)).size() &&
                firstAtPlaces(points_(Eigen::all, some)).size() == some.size(),
            "it is made of one point at each position");
    return [this, some, right = test::bruteForceFactory(tamed_)(some)](
               const std::vector<Index>& queries, int count) {
      for (const Index query : queries)
        require(std::binary_search(some.begin(), some.end(), query),
                "a search is at points it was made of");
      require(!was_bad_, "the search is not asked again after a wrong answer");
      return is_right_ ? right(queries, count) : anyLists(queries.size(), some);
    };
  }
  bool wasBad() const { return was_bad_; }

private:
  NeighborLists anyLists(std::size_t count, const std::vector<Index>& some) {
    NeighborLists lists;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = bytes_.below(12); k > 0; --k)
        lists.indices.push_back(some[bytes_.byte() % some.size()]);
      lists.offsets.push_back(lists.indices.size());
    }
    if (!is_in_range_ && !lists.indices.empty()) {
      Index& index = lists.indices[bytes_.byte() % lists.indices.size()];
      index = bytes_.raw<Index>();
      was_bad_ = !std::binary_search(some.begin(), some.end(), index);
    }
    return lists;
  }

  Bytes bytes_;
  const Positions& points_;
  Positions tamed_;
  bool is_right_ = true;
  bool is_in_range_ = true;
  bool was_bad_ = false;
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
  }
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

  if (watch.listens())
    options.progress = [&](const Progress& progress) {
      require(progress.part < progress.parts, "a part is one of those there are");
      return watch(progress);
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
