// Meshes many nasty sets of points, in many ways. VTK and exact arithmetic check each answer.
//
//   stress_shapes [--quick] [--seed N]

#include "exact.h"
#include "helpers.h"
#include "nasty_sets.h"
#include "result_bytes.h"
#include "spherical_param/errors.h"
#include "spherical_param/reconstruct.h"
#include "stress.h"

#include <Eigen/Geometry>

#include <vtkCellArray.h>
#include <vtkFeatureEdges.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataConnectivityFilter.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param;
using Faults = std::vector<std::string>;

vtkIdType featureEdges(vtkPolyData* data, bool boundary) {
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(data);
  edges->SetBoundaryEdges(boundary);
  edges->SetNonManifoldEdges(!boundary);
  edges->FeatureEdgesOff();
  edges->ManifoldEdgesOff();
  edges->Update();
  return edges->GetOutput()->GetNumberOfCells();
}

/// Whether VTK takes the triangles for a closed manifold in one piece, and helpers.h for a sphere.
bool isSphere(const Triangles& triangles, Index vertices) {
  if (!test::isSphereOverAll(triangles, vertices))
    return false;
  // Made-up points, far from each other: VTK's filters must not merge what is near.
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (Index v = 0; v < vertices; ++v)
    points->InsertNextPoint(v, v % 7, v % 11);
  vtkNew<vtkCellArray> cells;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    cells->InsertNextCell({triangles(0, t), triangles(1, t), triangles(2, t)});
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  vtkNew<vtkPolyDataConnectivityFilter> regions;
  regions->SetInputData(data);
  regions->SetExtractionModeToAllRegions();
  regions->Update();
  return featureEdges(data, true) == 0 && featureEdges(data, false) == 0 &&
         regions->GetNumberOfExtractedRegions() == 1;
}

/// Whether the volume, in long double, is negative by more than its rounding.
bool facesInward(const Positions& points, const Triangles& triangles) {
  using Vector = Eigen::Matrix<long double, 3, 1>;
  const Vector origin = points.col(0).cast<long double>();
  long double volume = 0.0L;
  long double size = 0.0L;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Vector a = points.col(triangles(0, t)).cast<long double>() - origin;
    const Vector b = points.col(triangles(1, t)).cast<long double>() - origin;
    const Vector c = points.col(triangles(2, t)).cast<long double>() - origin;
    volume += a.dot(b.cross(c));
    size += a.norm() * b.norm() * c.norm();
  }
  return volume < -1e-12L * size;
}

/// The defaults for half of the sets.
Options someOptions(std::mt19937_64& random, bool is_large) {
  const auto one = [&random](int count) {
    return static_cast<int>(random() % static_cast<std::uint64_t>(count));
  };
  Options options;
  if (one(2) == 0)
    return options;
  options.graph.method = one(5) < 2 ? GraphMethod::NearestNeighbors : GraphMethod::LocalDelaunay;
  EmbeddingOptions& embedding = options.embedding;
  embedding.method = one(3) == 0 ? EmbeddingMethod::Iterative : EmbeddingMethod::Multilevel;
  options.triangulation.method =
      one(5) < 2 ? TriangulationMethod::Qhull : TriangulationMethod::Incremental;
  embedding.weights = static_cast<EdgeWeights>(one(3));
  options.optimization.method = static_cast<OptimizationMethod>(one(3));
  if (one(5) < 2)
    options.graph.k = 3 + one(30);
  if (one(5) == 0 && embedding.method == EmbeddingMethod::Multilevel)
    embedding.exponent = 2.0 + 0.1 * (1 + one(140));
  options.smoothing.steps = one(3) == 0 ? one(30) : 0;
  embedding.max_iterations = is_large ? 50 : one(10) == 0 ? 0 : 300;
  embedding.starts = 1 + one(3);
  options.retries = one(4);
  options.seed = static_cast<std::uint32_t>(one(1000000));
  return options;
}

/// With lists of the caller, or without.
Result reconstructBy(bool by_lists, const Positions& points, const Options& options) {
  if (!by_lists)
    return reconstruct(points, options);
  const NeighborLists lists =
      points.allFinite() ? test::bruteForceNeighbors(points, neighborsToSearch(options.graph))
                         : NeighborLists();
  return reconstruct(points, lists, options);
}

/// Everything that is guaranteed, from the result alone.
Faults faultsOf(const Positions& points, const Options& options, const Result& result) {
  Faults faults;
  const auto n = static_cast<std::size_t>(points.cols());
  const std::size_t v = stress::countDistinct(points);
  if (result.vertexCount() != v || result.duplicates() != n - v ||
      result.vertex_of_input.size() != n || result.input_of_vertex.size() != v)
    return {"not one vertex for each distinct point"};
  std::map<stress::Place, Index> first;
  for (std::size_t i = 0; i < n; ++i) {
    const Index own =
        first.emplace(stress::placeOf(points, static_cast<Eigen::Index>(i)), static_cast<Index>(i))
            .first->second;
    const auto vertex = static_cast<std::size_t>(result.vertex_of_input[i]);
    if (vertex >= v || result.input_of_vertex[vertex] != own)
      return {"the vertex of point " + std::to_string(i) + " is not that of its first equal"};
  }
  if (!isSphere(result.triangles, static_cast<Index>(v)))
    return {"the mesh is not a sphere over all points"};
  Positions vertices(3, static_cast<Eigen::Index>(v));
  for (std::size_t i = 0; i < v; ++i)
    vertices.col(static_cast<Eigen::Index>(i)) = points.col(result.input_of_vertex[i]);
  if (facesInward(vertices, result.triangles))
    faults.emplace_back("the triangles face inward");
  if (!result.topology.isSphere())
    faults.emplace_back("the library's own check finds a fault");
  if (!((result.sphere.colwise().norm().array() - 1.0).abs() < 1e-9).all())
    faults.emplace_back("the embedding is not of unit vectors");
  if (!std::isfinite(result.measures.volume) || !std::isfinite(result.measures.area) ||
      (options.smoothing.steps > 0 &&
       (result.smoothed.cols() != vertices.cols() || !result.smoothed.allFinite())))
    faults.emplace_back("volume, area or smoothed points are missing or not finite");
  return faults;
}

Faults tryOut(std::uint64_t seed, std::string& family) {
  const stress::NastySet set = stress::makeNastySet(seed);
  family = set.family;
  const Positions& points = set.points;
  std::mt19937_64 random(seed ^ 0x5eedULL);
  Options options = someOptions(random, points.cols() > 600);
  const bool by_lists = random() % 5 < 2;
  options.threads = 1;
  const bool can_be_meshed = points.allFinite() && (points.array().abs() <= 1e100).all() &&
                             stress::countDistinct(points) >= 4 && !stress::liesInPlane(points);
  try {
    const Result result = reconstructBy(by_lists, points, options);
    if (!can_be_meshed)
      return {"points that cannot be meshed are accepted"};
    Faults faults = faultsOf(points, options, result);
    if (random() % 4 == 0) {
      options.threads = 3;
      if (stress::bytesOf(result) != stress::bytesOf(reconstructBy(by_lists, points, options)))
        faults.emplace_back("other bytes with 3 threads");
    }
    return faults;
  } catch (const InvalidInput& error) {
    if (can_be_meshed)
      return {std::string("rejected: ") + error.what()};
  } catch (const std::exception& error) {
    return {std::string("not a documented exception: ") + error.what()};
  }
  return {};
}

/// Whether faults that are planted in a sound mesh are found.
bool findsPlantedFaults() {
  Positions points(3, 6);
  points << 1, -1, 0, 0, 0, 0,  //
      0, 0, 1, -1, 0, 0,        //
      0, 0, 0, 0, 1, -1;
  Triangles sound(3, 8);
  sound << 0, 2, 1, 3, 2, 1, 3, 0,  //
      2, 1, 3, 0, 0, 2, 1, 3,       //
      4, 4, 4, 4, 5, 5, 5, 5;
  Triangles flipped = sound;
  std::swap(flipped(0, 3), flipped(1, 3));
  Triangles inside_out = sound;
  inside_out.row(0).swap(inside_out.row(1));
  return isSphere(sound, 6) && !facesInward(points, sound) && facesInward(points, inside_out) &&
         !isSphere(flipped, 6) && !isSphere(sound, 7) && !isSphere(sound.leftCols(7), 6);
}

}  // namespace

int main(int argc, char** argv) {
  const stress::Arguments arguments = stress::parse(argc, argv);
  if (!findsPlantedFaults()) {
    std::printf("the checks overlook planted faults\n");
    return 2;
  }
  const std::size_t sets = arguments.quick ? 300 : 10000;
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> found{0};
  std::vector<std::thread> threads;
  for (unsigned t = std::max(1U, std::thread::hardware_concurrency()); t > 0; --t)
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < sets; i = next++) {
        std::string family;
        for (const std::string& fault : tryOut(arguments.seed + i, family)) {
          ++found;
          std::printf("seed %llu (%s): %s\n", arguments.seed + i, family.c_str(), fault.c_str());
        }
      }
    });
  for (std::thread& thread : threads)
    thread.join();
  return stress::finish("nasty sets of points", sets, found);
}
