// The extension module of the Python package: NumPy arrays and plain values in, dictionaries of
// them out. Names, defaults, checks of types and documentation are the package's, in Python.

#include "python/arrays.h"
#include "python/listener.h"
#include "python/names.h"
#include "python/neighbor_search.h"
#include "python/reports.h"
#include "spherical_param/errors.h"
#include "spherical_param/outliers.h"
#include "spherical_param/point_set.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/version.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::python {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

/// The end of a stage is told once.
constexpr double kMostBeforeEnd = 0.999;

/// The core's messages begin with the name of a function in C++.
std::string withoutFunctionName(const std::string& message) {
  const auto end = std::find_if(message.begin(), message.end(),
                                [](unsigned char letter) { return std::isalnum(letter) == 0; });
  const auto length = static_cast<std::size_t>(end - message.begin());
  return length > 0 && message.compare(length, 2, ": ") == 0 ? message.substr(length + 2) : message;
}

/// The rows that are finite numbers, and which they are.
struct FinitePoints {
  explicit FinitePoints(const DoubleArray& array) {
    const Positions all = toPositions(array);
    rows.reserve(static_cast<std::size_t>(all.cols()));
    for (Eigen::Index i = 0; i < all.cols(); ++i)
      if (all.col(i).allFinite())
        rows.push_back(static_cast<Index>(i));
    points = rows.size() == static_cast<std::size_t>(all.cols()) ? all
                                                                 : Positions(all(Eigen::all, rows));
    given = static_cast<std::size_t>(all.cols());
  }

  std::size_t ignored() const { return given - rows.size(); }

  Positions points;
  std::vector<Index> rows;  ///< of each point in the array
  std::size_t given = 0;    ///< rows of the array
};

/// Neighbour lists take memory before anything else fails: an absurd k is told first.
void checkMemory(int neighbors, std::size_t points) {
  constexpr std::uint64_t most_entries = std::uint64_t{1} << 31;
  if (std::min(static_cast<std::uint64_t>(neighbors), std::uint64_t{points}) * points >
      most_entries)
    throw InvalidInput("k = " + std::to_string(neighbors) + " neighbours of each of " +
                       std::to_string(points) +
                       " points do not fit into memory; leave k out, its default will do");
}

py::dict reconstructPoints(const DoubleArray& array, const std::string& graph, std::optional<int> k,
                           const std::string& solver, const std::string& weights, double exponent,
                           double lambda, std::optional<double> tolerance, int max_iterations,
                           int stagnation_window, int starts, std::uint32_t seed,
                           const std::string& hull, const std::string& optimization, int attempts,
                           int smoothing_steps, int history, bool details, int threads,
                           const py::object& progress) {
  Options options;
  options.graph = valueOf("graph", graph, kGraphNames);
  options.k = k;
  options.solver = valueOf("solver", solver, kSolverNames);
  options.weights = valueOf("weights", weights, kWeightsNames);
  options.exponent = exponent;
  options.lambda = lambda;
  options.tolerance = tolerance;
  options.max_iterations = max_iterations;
  options.stagnation_window = stagnation_window;
  options.starts = starts;
  options.seed = seed;
  options.hull = valueOf("hull", hull, kHullNames);
  options.optimization = valueOf("optimization", optimization, kOptimizationNames);
  options.attempts = attempts;
  options.smoothing_steps = smoothing_steps;
  options.history.vertices = history;
  options.details = details;
  options.threads = threads;
  checkOptions(options);

  Listener listener(progress);
  options.progress = [&listener](const Progress& state) {
    return listener.tell(state.stage, state.fraction, state.iteration, state.residual);
  };
  const auto report_search = [&listener](double share) {
    // The end of the stage is told by the core.
    if (share < 1.0 &&
        !listener.tell("neighbors", kShareBeforeSearch + (1.0 - kShareBeforeSearch) * share))
      throw Cancelled("cancelled by the progress callback");
  };
  const FinitePoints finite(array);
  checkMemory(neighborsToSearch(options), finite.rows.size());
  try {
    const Result result = listener.run([&] {
      return reconstruct(finite.points, neighborSearch(threads, report_search), options);
    });
    return toDict(result, finite.rows, finite.given);
  } catch (const InvalidInput& error) {
    if (finite.ignored() == 0)
      throw;
    throw InvalidInput(std::string(error.what()) + " (of the points, " +
                       std::to_string(finite.ignored()) + " are not finite)");
  }
}

py::dict findOutlierPoints(const DoubleArray& array, double sigma, int k, int threads,
                           const py::object& progress) {
  /// So many more neighbours than are used step in for outliers.
  constexpr int spare_neighbors = 16;
  constexpr int most_neighbors = 1 << 20;
  if (k < 3 || k > most_neighbors)
    throw InvalidInput("k = " + std::to_string(k) + " is out of range; use 3 and more, mostly 16");
  OutlierOptions options;
  options.sigma = sigma;
  options.k = k;
  options.threads = threads;
  Listener listener(progress);
  const FinitePoints finite(array);
  checkMemory(k + spare_neighbors, finite.rows.size());
  constexpr std::size_t fewest = 4;
  if (finite.rows.size() < fewest)
    throw InvalidInput("there are " + std::to_string(finite.rows.size()) +
                       " finite points; give at least 4");
  std::vector<Index> indices;
  std::vector<double> scores(finite.given, std::nan(""));
  const Outliers found = listener.run([&] {
    const DistinctPoints distinct = findDistinctPoints(finite.points);
    const Positions vertices = finite.points(Eigen::all, distinct.input_of_vertex);
    const NeighborLists lists =
        nearestNeighbors(vertices, k + spare_neighbors, threads,
                         [&](double share) { listener.step("neighbors", share); });
    listener.step("outliers", 0.0);
    Outliers outliers = findOutliers(vertices, lists, options);
    listener.step("outliers", 1.0);
    std::vector<bool> is_outlier(distinct.input_of_vertex.size(), false);
    for (const Index vertex : outliers.indices)
      is_outlier[static_cast<std::size_t>(vertex)] = true;
    for (std::size_t i = 0; i < finite.rows.size(); ++i) {
      const auto vertex = static_cast<std::size_t>(distinct.vertex_of_input[i]);
      scores[static_cast<std::size_t>(finite.rows[i])] = outliers.scores[vertex];
      if (is_outlier[vertex])
        indices.push_back(finite.rows[i]);
    }
    return outliers;
  });
  return py::dict("indices"_a = toArray(indices), "scores"_a = toArray(scores),
                  "threshold"_a = found.threshold, "rounds"_a = found.rounds);
}

py::dict mapToSphere(const DoubleArray& points, const IndexArray& triangles,
                     const DoubleArray& start, double area_weight, int sweeps, int threads,
                     const py::object& progress) {
  Listener listener(progress);
  SphereMapOptions options;
  options.area_weight = area_weight;
  options.sweeps = sweeps;
  options.threads = threads;
  options.progress = [&listener](double share) {
    return listener.tell("map", std::min(share, kMostBeforeEnd));
  };
  const Positions vertices = toPositions(points);
  const Triangles mesh = toTriangles(triangles);
  const Positions directions = toPositions(start);
  return toDict(listener.run([&] {
    SphereMap map = computeSphereMap(vertices, mesh, directions, options);
    listener.step("map", 1.0);
    return map;
  }));
}

py::dict measureDistortion(const DoubleArray& points, const IndexArray& triangles,
                           const DoubleArray& sphere, int threads) {
  Listener listener(py::none{});
  const Positions vertices = toPositions(points);
  const Triangles mesh = toTriangles(triangles);
  const Positions directions = toPositions(sphere);
  return toDict(
      listener.run([&] { return measureMapDistortion(vertices, mesh, directions, threads); }));
}

/// Places in a mesh, as two arrays.
void addLocations(const std::vector<SphereLocation>& locations, py::dict& dict) {
  std::vector<Index> triangles(locations.size());
  Positions weights(3, static_cast<Eigen::Index>(locations.size()));
  for (std::size_t i = 0; i < locations.size(); ++i) {
    triangles[i] = locations[i].triangle;
    weights.col(static_cast<Eigen::Index>(i)) = locations[i].weights;
  }
  dict["source_triangle"] = toArray(triangles);
  dict["source_weights"] = toArray(weights);
}

/// What remeshing gives, before it is taken to Python.
struct Remeshed {
  ResampledMesh mesh;
  std::vector<SphereLocation> locations;
  std::vector<std::array<Index, 2>> self_intersections;
  int frequency = 0;
  UntanglingReport untangling;
  std::size_t flipped_edges = 0;
};

Remeshed remeshOnGrid(const SphereSurface& surface, SphereGrid kind, std::size_t points,
                      int threads, Listener& listener) {
  // The grid itself would take as many as it can have.
  constexpr std::size_t most_points = std::size_t{1} << 28;
  if (points < 4 || points > most_points)
    throw InvalidInput("points = " + std::to_string(points) +
                       " is out of range; use 4 to 2^28 for a grid");
  Remeshed result;
  const GridSphere grid = makeGridSphere(kind, gridFrequency(kind, points));
  result.frequency = grid.frequency;
  result.mesh = resampleSurface(surface, grid);
  listener.step("resample", 1.0);
  listener.step("untangle", 0.0);
  result.untangling = untangle(surface, result.mesh, threads);
  // What sliding leaves, other edges may mend.
  if (result.untangling.after > 0) {
    listener.step("untangle", 0.8);
    result.flipped_edges = removeIntersections(result.mesh, threads).flips;
  }
  listener.step("untangle", 1.0);
  result.locations = surface.evaluate(result.mesh.directions).locations;
  SelfIntersectionOptions options;
  options.threads = threads;
  options.progress = [&listener](double share) {
    return listener.tell("verify", std::min(share, kMostBeforeEnd));
  };
  result.self_intersections =
      findSelfIntersections(result.mesh.points, result.mesh.triangles, options);
  listener.step("verify", 1.0);
  return result;
}

Remeshed spreadEvenly(const SphereSurface& surface, std::size_t points, std::uint32_t seed,
                      Listener& listener) {
  constexpr std::size_t most_points = std::size_t{1} << 24;
  if (points < 1 || points > most_points)
    throw InvalidInput("points = " + std::to_string(points) +
                       " is out of range; use 1 to 2^24 for an even cloud");
  Remeshed result;
  SurfacePoints even = sampleEvenly(surface, points, seed);
  listener.step("resample", 1.0);
  result.mesh.points = std::move(even.points);
  result.mesh.normals = std::move(even.normals);
  result.mesh.triangles.resize(3, 0);
  result.locations = std::move(even.locations);
  result.mesh.directions.resize(3, result.mesh.points.cols());
  for (std::size_t i = 0; i < result.locations.size(); ++i) {
    const SphereLocation& location = result.locations[i];
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    for (Eigen::Index corner = 0; corner < 3; ++corner)
      direction += location.weights[corner] *
                   surface.sphere().col(surface.triangles()(corner, location.triangle));
    result.mesh.directions.col(static_cast<Eigen::Index>(i)) = direction.normalized();
  }
  return result;
}

py::dict remeshSurface(const DoubleArray& points, const IndexArray& triangles,
                       const DoubleArray& sphere, const std::string& grid, std::size_t count,
                       const std::string& fit, std::uint32_t seed, int threads,
                       const py::object& progress) {
  const bool is_even = grid == "even";
  constexpr Names<SphereGrid, 3> grid_names = {{
      {"icosahedral", SphereGrid::Icosahedral},
      {"octahedral", SphereGrid::Octahedral},
      {"even", SphereGrid::Icosahedral},  // not used
  }};
  const SphereGrid kind = valueOf("grid", grid, grid_names);
  const SurfaceFit surface_fit = valueOf("fit", fit, kFitNames);
  Listener listener(progress);
  const Positions vertices = toPositions(points);
  const Triangles mesh = toTriangles(triangles);
  const Positions directions = toPositions(sphere);
  const Remeshed remeshed = listener.run([&] {
    listener.step("surface", 0.0);
    const SphereSurface surface(vertices, mesh, directions, {surface_fit, threads});
    listener.step("surface", 1.0);
    listener.step("resample", 0.0);
    return is_even ? spreadEvenly(surface, count, seed, listener)
                   : remeshOnGrid(surface, kind, count, threads, listener);
  });
  py::dict dict("vertices"_a = toArray(remeshed.mesh.points),
                "triangles"_a = toArray(remeshed.mesh.triangles),
                "normals"_a = toArray(remeshed.mesh.normals),
                "directions"_a = toArray(remeshed.mesh.directions),
                "frequency"_a = is_even ? py::none() : py::cast(remeshed.frequency),
                "self_intersections"_a = toArray(remeshed.self_intersections),
                "self_intersections_before"_a = remeshed.untangling.before,
                "moved"_a = remeshed.untangling.moved, "flipped_edges"_a = remeshed.flipped_edges);
  addLocations(remeshed.locations, dict);
  return dict;
}

py::dict textureAtlas(const IndexArray& triangles, const DoubleArray& sphere,
                      const std::string& chart, double margin) {
  TextureAtlasOptions options;
  options.chart = valueOf("chart", chart, kChartNames);
  options.margin = margin;
  Listener listener(py::none{});
  const Triangles mesh = toTriangles(triangles);
  const Positions directions = toPositions(sphere);
  const TextureAtlas atlas =
      listener.run([&] { return makeTextureAtlas(mesh, directions, options); });
  std::vector<std::array<Index, 3>> corners;
  Positions weights(3, static_cast<Eigen::Index>(atlas.vertices.size()));
  for (std::size_t i = 0; i < atlas.vertices.size(); ++i) {
    corners.push_back(atlas.vertices[i].vertices);
    weights.col(static_cast<Eigen::Index>(i)) = atlas.vertices[i].weights;
  }
  return py::dict("triangles"_a = toArray(atlas.triangles),
                  "coordinates"_a = toArray(atlas.coordinates),
                  "coordinate_triangles"_a = toArray(atlas.coordinate_triangles),
                  "source_triangle"_a = toArray(atlas.source),
                  "source_vertices"_a = toArray(corners), "source_weights"_a = toArray(weights));
}

/// The package's exceptions, in the place of pybind11's choice for their bases in C++.
void registerErrors() {
  // Kept to the end of the process, as the translator is.
  static const py::handle errors = py::module_::import("spherical_param._errors").release();
  py::register_exception_translator([](std::exception_ptr error) {
    const auto raise = [](const char* name, const std::exception& cause) {
      PyErr_SetString(errors.attr(name).ptr(), withoutFunctionName(cause.what()).c_str());
    };
    try {
      if (error)
        std::rethrow_exception(error);
    } catch (const InvalidInput& cause) {
      raise("InvalidInput", cause);
    } catch (const ComputeError& cause) {
      raise("ComputeError", cause);
    } catch (const Cancelled& cause) {
      raise("Cancelled", cause);
    }
  });
}

}  // namespace
}  // namespace spherical_param::python

PYBIND11_MODULE(_core, module) {
  using namespace spherical_param::python;
  namespace py = pybind11;
  using py::literals::operator""_a;

  module.doc() = "What of spherical_param is in C++; use the package's own functions.";
  module.attr("__version__") = SPHERICAL_PARAM_VERSION;
  registerErrors();
  const auto points = py::arg("points").noconvert();
  const auto triangles = py::arg("triangles").noconvert();
  const auto sphere = py::arg("sphere").noconvert();
  module.def("reconstruct", &reconstructPoints, points, py::kw_only(), "graph"_a, "k"_a, "solver"_a,
             "weights"_a, "exponent"_a, "lambda_"_a, "tolerance"_a, "max_iterations"_a,
             "stagnation_window"_a, "starts"_a, "seed"_a, "hull"_a, "optimization"_a, "attempts"_a,
             "smoothing_steps"_a, "history"_a, "details"_a, "threads"_a, "progress"_a);
  module.def("find_outliers", &findOutlierPoints, points, py::kw_only(), "sigma"_a, "k"_a,
             "threads"_a, "progress"_a);
  module.def("sphere_map", &mapToSphere, points, triangles, sphere, py::kw_only(), "area_weight"_a,
             "sweeps"_a, "threads"_a, "progress"_a);
  module.def("measure_map_distortion", &measureDistortion, points, triangles, sphere, py::kw_only(),
             "threads"_a);
  module.def("remesh", &remeshSurface, points, triangles, sphere, py::kw_only(), "grid"_a,
             "count"_a, "fit"_a, "seed"_a, "threads"_a, "progress"_a);
  module.def("texture_coordinates", &textureAtlas, triangles, sphere, py::kw_only(), "chart"_a,
             "margin"_a);
}
