// The extension module of the Python package: NumPy arrays and plain values in, dictionaries of
// them out. The options of reconstruct() are those of optionTable(); all other names, defaults,
// checks of types and documentation are the package's, in Python.

#include "common/errors.h"
#include "python/arrays.h"
#include "python/conversions.h"
#include "python/files.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/version.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cctype>
#include <initializer_list>
#include <string>
#include <tuple>

namespace spherical_param::python {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

/// The names of the map's enumerators in Python. Those of options and results of reconstruct() are
/// in optionTable() and result_fields.h.
template <typename Enum>
using Names = std::initializer_list<std::pair<const char*, Enum>>;

/// The package in Python has checked that it is one of the names.
template <typename Enum>
Enum valueOf(const std::string& name, Names<Enum> names) {
  for (const auto& [candidate, value] : names)
    if (name == candidate)
      return value;
  throw InvalidInput("'" + name + "' is not known");
}

SurfaceFit fitOf(const std::string& name) {
  return valueOf<SurfaceFit>(name,
                             {{"smooth", SurfaceFit::Smooth}, {"linear", SurfaceFit::Linear}});
}

/// The core's messages begin with the name of a function in C++.
std::string withoutFunctionName(const std::string& message) {
  const auto end = std::find_if(message.begin(), message.end(),
                                [](unsigned char letter) { return std::isalnum(letter) == 0; });
  const auto length = static_cast<std::size_t>(end - message.begin());
  return length > 0 && message.compare(length, 2, ": ") == 0 ? message.substr(length + 2) : message;
}

py::dict reconstructPoints(const Positions& points, const py::dict& values, const py::dict& info,
                           bool details, const py::object& progress) {
  Listener listener(progress);
  Options options = toOptions(values, listener);
  options.details = details;
  const CloudInfo cloud_info = toCloudInfo(info);
  return toDict(listener.run([&] { return reconstruct(points, options, {}, cloud_info); }));
}

py::object findOutlierPoints(const Positions& points, const py::dict& values,
                             const py::object& progress) {
  Listener listener(progress);
  const Options options = toOptions(values, listener);
  return toArray(listener.run([&] { return findOutliers(points, options); }));
}

py::tuple findPartsOfPoints(const Positions& points, const py::dict& values,
                            const py::object& progress) {
  Listener listener(progress);
  const Options options = toOptions(values, listener);
  py::list parts;
  for (const std::vector<Index>& part : listener.run([&] { return findParts(points, options); }))
    parts.append(toArray(part));
  return py::tuple(parts);
}

py::dict mapToSphere(const Positions& points, const Triangles& triangles, const Positions& start,
                     double area_weight, int sweeps, int threads, const py::object& progress) {
  Listener listener(progress);
  SphereMapOptions options;
  static_cast<Execution&>(options) = listener.execution(threads);
  options.area_weight = area_weight;
  options.sweeps = sweeps;
  return toDict(listener.run([&] { return computeSphereMap(points, triangles, start, options); }));
}

py::dict measureDistortion(const Positions& points, const Triangles& triangles,
                           const Positions& sphere, int threads) {
  Listener listener(py::none{});
  return toDict(
      listener.run([&] { return measureMapDistortion(points, triangles, sphere, threads); }));
}

/// Points, triangles, directions and caps of a mesh with its map to the sphere.
using MappedMesh = std::tuple<Positions, Triangles, Positions, Positions>;

SphereSurface surfaceOf(const MappedMesh& mesh, SurfaceFit fit, int threads) {
  const auto& [points, triangles, directions, caps] = mesh;
  return {points, triangles, directions, {fit, threads, caps}};
}

/// Places in a mesh, as two arrays.
void addLocations(const std::vector<SphereLocation>& locations, const char* of, py::dict& dict) {
  std::vector<Index> triangles(locations.size());
  Positions weights(3, static_cast<Eigen::Index>(locations.size()));
  for (std::size_t i = 0; i < locations.size(); ++i) {
    triangles[i] = locations[i].triangle;
    weights.col(static_cast<Eigen::Index>(i)) = locations[i].weights;
  }
  dict[py::str(of + std::string("_triangle"))] = toArray(triangles);
  dict[py::str(of + std::string("_weights"))] = toArray(weights);
}

py::dict remeshSurface(const MappedMesh& mapped, const std::string& grid, std::size_t count,
                       const std::string& fit, int threads, const py::object& progress) {
  const SphereGrid kind = valueOf<SphereGrid>(
      grid, {{"icosahedral", SphereGrid::Icosahedral}, {"octahedral", SphereGrid::Octahedral}});
  const SurfaceFit surface_fit = fitOf(fit);
  ResampledMesh mesh;
  int frequency = 0;
  UntanglingReport untangling;
  std::vector<SphereLocation> locations;
  std::vector<std::array<Index, 2>> self_intersections;
  Listener listener(progress);
  listener.run([&] {
    listener.step("surface", 0.0);
    const SphereSurface surface = surfaceOf(mapped, surface_fit, threads);
    listener.step("surface", 1.0);
    listener.step("resample", 0.0);
    frequency = gridFrequency(kind, count, surface);
    mesh = resampleSurface(surface, makeGridSphere(kind, frequency));
    listener.step("resample", 1.0);
    listener.step("untangle", 0.0);
    untangling = untangle(surface, mesh, threads);
    listener.step("untangle", 1.0);
    locations = surface.evaluate(mesh.directions).locations;
    self_intersections =
        findSelfIntersections(mesh.points, mesh.triangles, listener.execution(threads));
  });
  py::dict dict("vertices"_a = toArray(mesh.points), "triangles"_a = toArray(mesh.triangles),
                "normals"_a = toArray(mesh.normals), "directions"_a = toArray(mesh.directions),
                "frequency"_a = frequency, "self_intersections"_a = toArray(self_intersections),
                "self_intersections_before"_a = untangling.before, "moved"_a = untangling.moved,
                "flipped_edges"_a = untangling.flips);
  addLocations(locations, "source", dict);
  return dict;
}

py::dict textureAtlas(const Triangles& triangles, const Positions& sphere, const std::string& chart,
                      double margin) {
  TextureAtlasOptions options;
  options.chart = valueOf<SphereChart>(chart, {{"octahedral", SphereChart::Octahedral},
                                               {"equirectangular", SphereChart::Equirectangular},
                                               {"cube", SphereChart::CubeMap}});
  options.margin = margin;
  Listener listener(py::none{});
  const TextureAtlas atlas =
      listener.run([&] { return makeTextureAtlas(triangles, sphere, options); });
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

py::dict morphMeshes(const MappedMesh& first, const MappedMesh& second, const Array<Index>& pairs,
                     bool align, const std::string& connectivity, std::size_t samples,
                     const std::string& fit, int threads, const py::object& progress) {
  Listener listener(progress);
  MorphOptions options;
  static_cast<Execution&>(options) = listener.execution(threads);
  options.align = align;
  options.connectivity =
      valueOf<MorphConnectivity>(connectivity, {{"all", MorphConnectivity::AllVertices},
                                                {"resampled", MorphConnectivity::Resampled}});
  options.samples = samples;
  const auto rows = pairs.unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i)
    options.pairs.push_back({rows(i, 0), rows(i, 1)});
  const SurfaceFit surface_fit = fitOf(fit);
  const MorphResult morph = listener.run([&] {
    return morphSurfaces(surfaceOf(first, surface_fit, threads),
                         surfaceOf(second, surface_fit, threads), options);
  });
  py::list impossible;
  for (const ImpossiblePair& pair : morph.impossible)
    impossible.append(py::dict("pair"_a = pair.pair, "reason"_a = pair.reason));
  py::dict dict("triangles"_a = toArray(morph.triangles), "first"_a = toArray(morph.first),
                "second"_a = toArray(morph.second), "directions"_a = toArray(morph.sphere),
                "rotation"_a = toArray(morph.rotation), "alignment_error"_a = morph.alignment_error,
                "impossible"_a = impossible, "worst_pair"_a = morph.worst_pair);
  addLocations(morph.first_places, "first", dict);
  addLocations(morph.second_places, "second", dict);
  return dict;
}

/// Translates the exceptions of the core and the tools to those of the package.
void registerErrors() {
  py::register_exception_translator([](std::exception_ptr error) {
    const auto raise = [](const char* name, const std::exception& cause) {
      const py::module_ errors = py::module_::import("spherical_param._errors");
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
    } catch (const tools::ToolError& cause) {
      const std::string message = std::string(cause.what()) + "; " + cause.remedy();
      if (cause.exitCode() == tools::ExitCode::Usage)
        raise("InvalidInput", InvalidInput(message));
      else
        PyErr_SetString(PyExc_OSError, message.c_str());
    }
  });
}

}  // namespace
}  // namespace spherical_param::python

PYBIND11_MODULE(_core, module) {
  using namespace spherical_param::python;
  namespace py = pybind11;
  using py::literals::operator""_a;

  module.doc() = "The part of spherical_param that is in C++; use the package's own functions.";
  module.attr("__version__") = SPHERICAL_PARAM_VERSION;
  registerErrors();
  module.def("option_table", &optionRows);
  module.def("result_table", &resultTable);
  addFiles(module);
  module.def("reconstruct", &reconstructPoints, "points"_a, "options"_a, py::kw_only(), "info"_a,
             "details"_a, "progress"_a);
  module.def("morph", &morphMeshes, "first"_a, "second"_a, py::kw_only(), "pairs"_a, "align"_a,
             "connectivity"_a, "samples"_a, "fit"_a, "threads"_a, "progress"_a);
  module.def("find_outliers", &findOutlierPoints, "points"_a, "options"_a, py::kw_only(),
             "progress"_a);
  module.def("find_parts", &findPartsOfPoints, "points"_a, "options"_a, py::kw_only(),
             "progress"_a);
  module.def("sphere_map", &mapToSphere, "points"_a, "triangles"_a, "sphere"_a, py::kw_only(),
             "area_weight"_a, "sweeps"_a, "threads"_a, "progress"_a);
  module.def("measure_map_distortion", &measureDistortion, "points"_a, "triangles"_a, "sphere"_a,
             py::kw_only(), "threads"_a);
  module.def("remesh", &remeshSurface, "mesh"_a, py::kw_only(), "grid"_a, "count"_a, "fit"_a,
             "threads"_a, "progress"_a);
  module.def("texture_coordinates", &textureAtlas, "triangles"_a, "sphere"_a, py::kw_only(),
             "chart"_a, "margin"_a);
}
