#include "answers.h"

#include "independent_check.h"
#include "result_bytes.h"
#include "search/kd_tree.h"
#include "spherical_param/errors.h"
#include "spherical_param/reconstruct.h"
#include "truth.h"

#include <pcl/common/point_tests.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <random>
#include <sstream>

namespace torture {
namespace {

using spherical_param::Index;
using spherical_param::NeighborLists;
using spherical_param::NeighborSearch;
using spherical_param::Options;
using spherical_param::Positions;
using spherical_param::Result;

/// A seed's numbers for what is not the set itself.
class Choice {
public:
  explicit Choice(std::uint64_t seed) : engine_(seed ^ 0x5eedULL) {}
  int one(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  bool chance(int percent) { return one(100) < percent; }

private:
  std::mt19937_64 engine_;
};

/// The defaults for half of the sets.
Options someOptions(Choice& choice, std::size_t points) {
  using namespace spherical_param;
  Options options;
  if (choice.chance(50))
    return options;
  const bool is_large = points > 600;
  options.graph = choice.chance(40) ? GraphMethod::NearestNeighbors : GraphMethod::LocalDelaunay;
  options.solver = choice.chance(30) ? EmbeddingMethod::Iterative : EmbeddingMethod::Multilevel;
  options.hull = choice.chance(40) ? TriangulationMethod::Qhull : TriangulationMethod::Incremental;
  options.weights = static_cast<EdgeWeights>(choice.one(3));
  options.optimization = static_cast<OptimizationMethod>(choice.one(3));
  if (choice.chance(40))
    options.k = 3 + choice.one(30);
  if (choice.chance(20) && options.solver == EmbeddingMethod::Multilevel)
    options.exponent = 2.0 + 0.1 * (1 + choice.one(140));
  if (choice.chance(20))
    options.tolerance = choice.chance(20) ? 0.0 : 1e-8;
  if (choice.chance(30))
    options.smoothing_steps = choice.chance(5) ? 1000 : choice.one(30);
  options.max_iterations = is_large ? 50 : choice.chance(10) ? 0 : 300;
  options.stagnation_window = choice.chance(20) ? 0 : 100;
  options.lambda = choice.chance(20) ? 1.0 : 0.5;
  options.starts = 1 + choice.one(3);
  options.attempts = 1 + choice.one(4);
  options.seed = static_cast<std::uint32_t>(choice.one(1000000));
  options.details = choice.chance(20);
  if (choice.chance(10))
    options.history.vertices = 1 + choice.one(500);
  return options;
}

std::string text(const Options& options) {
  std::ostringstream out;
  out << "graph " << static_cast<int>(options.graph) << " solver "
      << static_cast<int>(options.solver) << " hull " << static_cast<int>(options.hull)
      << " weights " << static_cast<int>(options.weights) << " optimization "
      << static_cast<int>(options.optimization) << " k " << options.k.value_or(0) << " exponent "
      << options.exponent << " tolerance " << options.tolerance.value_or(-1.0) << " smoothing "
      << options.smoothing_steps << " iterations " << options.max_iterations << " starts "
      << options.starts << " attempts " << options.attempts << " seed " << options.seed;
  return out.str();
}

using Tree = spherical_param::internal::KdTree<double>;

NeighborSearch searchIn(const Positions& points) {
  const auto tree = std::make_shared<const Tree>(points);
  return [tree](const std::vector<Index>& queries, int count) {
    const std::size_t each = std::min(tree->size(), static_cast<std::size_t>(count) + 1);
    NeighborLists lists;
    lists.indices.resize(each * queries.size());
    tree->find(queries.data(), queries.size(), each, lists.indices.data());
    for (std::size_t i = 1; i <= queries.size(); ++i)
      lists.offsets.push_back(i * each);
    return lists;
  };
}

/// Lists of the nearest by brute force, of all points, repeated ones included.
NeighborLists listsOf(const Positions& points, int k) {
  NeighborLists lists;
  std::vector<std::pair<double, Index>> others;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    others.clear();
    for (Eigen::Index j = 0; j < points.cols(); ++j)
      if (j != i)
        others.emplace_back((points.col(i) - points.col(j)).squaredNorm(), static_cast<Index>(j));
    const auto count = std::min<std::ptrdiff_t>(k, static_cast<std::ptrdiff_t>(others.size()));
    std::partial_sort(others.begin(), others.begin() + count, others.end());
    for (std::ptrdiff_t c = 0; c < count; ++c)
      lists.indices.push_back(others[static_cast<std::size_t>(c)].second);
    lists.offsets.push_back(lists.indices.size());
  }
  return lists;
}

Result reconstructCore(const Positions& points, const Options& options, bool by_lists) {
  if (!by_lists)
    return spherical_param::reconstruct(
        points, [](const Positions& nodes, const std::vector<Index>&) { return searchIn(nodes); },
        options);
  const bool is_finite = points.allFinite();
  const NeighborLists lists =
      is_finite ? listsOf(points, spherical_param::neighborsToSearch(options)) : NeighborLists();
  return spherical_param::reconstruct(points, lists, options);
}

/// What is wrong with the numbers of vertices: each distinct point one, that of its first point.
std::vector<std::string> numberFaults(const Truth& truth, const std::vector<Index>& vertex_of_input,
                                      const std::vector<Index>& input_of_vertex) {
  const std::vector<Index>& first = truth.firstEqual();
  if (vertex_of_input.size() != first.size())
    return {"vertex_of_input has another size"};
  if (input_of_vertex.size() != truth.distinct())
    return {"there are " + std::to_string(input_of_vertex.size()) + " vertices of " +
            std::to_string(truth.distinct()) + " distinct points"};
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Index v = vertex_of_input[i];
    if (v < 0 || static_cast<std::size_t>(v) >= input_of_vertex.size() ||
        input_of_vertex[static_cast<std::size_t>(v)] != first[i])
      return {"vertex_of_input is wrong at point " + std::to_string(i)};
  }
  return {};
}

void append(std::vector<std::string>& to, const std::vector<std::string>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// Adds what is wrong with a result. \return the mesh.
Mesh checkResult(const Positions& points, const Truth& truth, const Options& options,
                 const Result& result, Answer& answer) {
  const auto fault = [&](const std::string& words) { answer.faults.push_back(words); };
  if (truth.firstBad())
    fault("bad points were taken");
  else if (!truth.spansSpace())
    fault("points in a plane were taken");
  const std::size_t v = result.vertexCount();
  Mesh mesh;
  mesh.vertices = v;
  for (Eigen::Index t = 0; t < result.triangles.cols(); ++t)
    mesh.triangles.push_back(
        {result.triangles(0, t), result.triangles(1, t), result.triangles(2, t)});
  append(answer.faults, numberFaults(truth, result.vertex_of_input, result.input_of_vertex));
  answer.lost += unusedVertices(mesh) + (truth.distinct() > v ? truth.distinct() - v : 0);
  if (result.duplicates != static_cast<std::size_t>(points.cols()) - truth.distinct())
    fault("duplicates are miscounted");
  append(answer.faults, topologyFaults(mesh));
  if (!result.topology.isSphere() ||
      !spherical_param::checkTopology(result.triangles, v).isSphere())
    fault("the library's own check finds a fault");
  if (answer.faults.empty()) {
    Positions of_vertices(3, static_cast<Eigen::Index>(v));
    for (std::size_t i = 0; i < v; ++i)
      of_vertices.col(static_cast<Eigen::Index>(i)) = points.col(result.input_of_vertex[i]);
    if (facesInward(of_vertices, mesh))
      fault("the triangles face inward");
  }
  if (result.sphere.cols() != static_cast<Eigen::Index>(v) ||
      !((result.sphere.colwise().norm().array() - 1.0).abs() < 1e-9).all())
    fault("the sphere is none");
  if (!std::isfinite(result.volume) || !std::isfinite(result.area))
    fault("volume or area is not finite");
  if (options.smoothing_steps > 0 &&
      (result.smoothed.cols() != static_cast<Eigen::Index>(v) || !result.smoothed.allFinite()))
    fault("smoothed points are missing or not finite");
  for (const auto& pair : result.self_intersections)
    for (const Index t : pair)
      if (t < 0 || t >= result.triangles.cols())
        fault("a self-intersection of no triangle");
  answer.triangles = mesh.triangles.size();
  return mesh;
}

void checkRefusal(const Truth& truth, const std::string& reason, Answer& answer) {
  answer.refused = true;
  const std::string fault = truth.faultOf(reason);
  if (!fault.empty())
    answer.faults.push_back("InvalidInput: \"" + reason + "\", but " + fault);
}

void tryCore(const Positions& points, Options options, Choice& choice, Answer& answer) {
  const bool by_lists = points.cols() <= 300 && choice.chance(40);
  answer.how += by_lists ? "; lists" : "; search";
  answer.twice = choice.chance(25);
  const int other_threads = 2 + choice.one(3);
  options.threads = 1;
  const Truth truth(points);
  try {
    const Result result = reconstructCore(points, options, by_lists);
    checkResult(points, truth, options, result, answer);
    if (answer.twice) {
      options.threads = other_threads;
      if (bytesOf(result) != bytesOf(reconstructCore(points, options, by_lists)))
        answer.faults.push_back("other bytes with " + std::to_string(other_threads) + " threads");
    }
  } catch (const spherical_param::InvalidInput& error) {
    checkRefusal(truth, error.what(), answer);
  }
}

bool samePolygons(const std::vector<pcl::Vertices>& a, const std::vector<pcl::Vertices>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(),
      [](const pcl::Vertices& p, const pcl::Vertices& q) { return p.vertices == q.vertices; });
}

/// In single precision, with points that are not finite among the others.
void tryPcl(const Positions& points, const Options& options, Choice& choice, Answer& answer) {
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;
  answer.how += "; PCL";
  answer.through_pcl = true;
  answer.twice = choice.chance(25);
  const int other_threads = 2 + choice.one(3);
  const auto cloud = pcl::make_shared<Cloud>();
  const int holes = choice.chance(30) ? 1 + choice.one(20) : 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3f p = points.col(i).cast<float>();  // beyond its range: infinite
    cloud->push_back({p.x(), p.y(), p.z()});
    if (holes > 0 && choice.one(static_cast<int>(points.cols())) < holes)
      cloud->push_back({p.x(), std::numeric_limits<float>::quiet_NaN(), p.z()});
  }
  // The points that count, as the truth is asked for them.
  std::vector<pcl::index_t> used;
  for (std::size_t i = 0; i < cloud->size(); ++i)
    if (pcl::isFinite((*cloud)[i]))
      used.push_back(static_cast<pcl::index_t>(i));
  Positions finite(3, static_cast<Eigen::Index>(used.size()));
  for (std::size_t i = 0; i < used.size(); ++i)
    finite.col(static_cast<Eigen::Index>(i)) =
        (*cloud)[static_cast<std::size_t>(used[i])].getVector3fMap().cast<double>();
  const Truth truth(finite);
  const std::size_t ignored = cloud->size() - used.size();

  pcl::SphericalParamReconstruction<pcl::PointXYZ> mesher;
  mesher.setOptions(options);
  mesher.setNumberOfThreads(1);
  mesher.setInputCloud(cloud);
  std::vector<pcl::Vertices> polygons;
  mesher.reconstruct(polygons);
  if (!mesher.getErrorMessage().empty()) {
    const std::string& reason = mesher.getErrorMessage();
    if (!polygons.empty())
      answer.faults.emplace_back("a mesh in spite of an error");
    if (cloud->empty() && reason.find("the input cloud is empty") != std::string::npos) {
      answer.refused = true;
      return;
    }
    checkRefusal(truth, reason, answer);
    if (ignored > 0 && reason.find("of the cloud's points, " + std::to_string(ignored) +
                                   " are not finite") == std::string::npos)
      answer.faults.emplace_back("points that are not finite are not told");
    return;
  }
  const Result& result = mesher.getResult();
  const Mesh mesh = checkResult(finite, truth, options, result, answer);
  if (mesher.getIgnoredPointCount() != ignored)
    answer.faults.emplace_back("ignored points are miscounted");
  bool is_mapped = polygons.size() == mesh.triangles.size() &&
                   mesher.getVertexIndices().size() == result.vertexCount();
  for (std::size_t t = 0; t < polygons.size() && is_mapped; ++t) {
    is_mapped = polygons[t].vertices.size() == 3;
    for (std::size_t k = 0; k < 3 && is_mapped; ++k) {
      const auto vertex = static_cast<std::size_t>(mesh.triangles[t][k]);
      is_mapped = static_cast<pcl::index_t>(polygons[t].vertices[k]) ==
                  used[static_cast<std::size_t>(result.input_of_vertex[vertex])];
    }
  }
  if (!is_mapped)
    answer.faults.emplace_back("polygons are not those of the result");
  if (answer.twice) {
    mesher.setNumberOfThreads(static_cast<unsigned int>(other_threads));
    const Result before = result;
    std::vector<pcl::Vertices> again;
    mesher.reconstruct(again);
    if (!samePolygons(polygons, again) || bytesOf(before) != bytesOf(mesher.getResult()))
      answer.faults.push_back("other bytes with " + std::to_string(other_threads) + " threads");
  }
}

/// Computing time of the calling thread.
double secondsOfThread() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

Answer tryOut(std::uint64_t seed) {
  const NastySet set = makeNastySet(seed);
  Choice choice(seed);
  Answer answer;
  answer.family = set.family;
  answer.points = static_cast<std::size_t>(set.points.cols());
  answer.how = std::to_string(set.points.cols()) + " points";
  for (const std::string& treatment : set.treatment)
    answer.how += ", " + treatment;
  const bool through_pcl = choice.chance(25);
  const Options options = someOptions(choice, answer.points);
  answer.how += "; " + text(options);
  const double begin = secondsOfThread();
  try {
    if (through_pcl)
      tryPcl(set.points, options, choice, answer);
    else
      tryCore(set.points, options, choice, answer);
  } catch (const std::exception& error) {
    answer.faults.push_back(std::string("an exception: ") + error.what());
  }
  answer.seconds = secondsOfThread() - begin;
  return answer;
}

std::vector<std::string> overlookedNumbers() {
  std::vector<std::string> overlooked;
  Positions points(3, 5);
  points << 0, 1, 0, 0, -0.0,  //
      0, 0, 1, 0, 0,           //
      0, 0, 0, 1, 0;
  const Truth truth(points);
  const std::vector<Index> vertices{0, 1, 2, 3, 0};
  const std::vector<Index> inputs{0, 1, 2, 3};
  if (!numberFaults(truth, vertices, inputs).empty())
    overlooked.emplace_back("sound numbers are taken for faulty ones");
  if (numberFaults(truth, {0, 1, 3, 2, 0}, inputs).empty())
    overlooked.emplace_back("a wrong vertex_of_input");
  if (numberFaults(truth, {0, 1, 2, 3, 1}, inputs).empty())
    overlooked.emplace_back("a wrong vertex_of_input of a repeated point");
  if (numberFaults(truth, {0, 1, 2, 0, 0}, {0, 1, 2}).empty())
    overlooked.emplace_back("a lost point");
  if (numberFaults(truth, {0, 1, 2, 3, 0}, {4, 1, 2, 3}).empty())
    overlooked.emplace_back("an input_of_vertex that is not the first");
  if (truth.faultOf("all points lie in one plane").empty() ||
      truth.faultOf("at least 4 distinct finite points are needed, but there are 3").empty() ||
      truth.faultOf("point 2 is not finite").empty())
    overlooked.emplace_back("a reason that is not true");
  return overlooked;
}

}  // namespace torture
