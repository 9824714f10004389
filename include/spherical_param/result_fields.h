#pragma once

#include "spherical_param/result.h"

#include <array>
#include <cstddef>
#include <functional>
#include <type_traits>
#include <vector>

/// \file
/// The fields of a result's structs. Units, JSON, Python classes and tables are made from these
/// lists. A new figure is one more line.

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// What the values of a field mean.
enum class FieldKind {
  Figure,        ///< a number, flag, choice or text, or structs of them
  OfSolid,       ///< a figure that needs Surface::hasVolume()
  Vertices,      ///< vertices of the mesh, ascending
  VertexList,    ///< vertices in any order
  Loops,         ///< one or more loops of vertices, each from its lowest vertex on
  TriangleList,  ///< triangles of the mesh, or pairs of them
  Inputs,        ///< input points
  PerVertex,     ///< an entry for each vertex
  PerTriangle,   ///< an entry for each triangle
  PerInput,      ///< an entry for each of Surface::inputs
  CppOnly,       ///< for callers in C++ only
};

/// One field of a struct, or a struct.
struct ResultField {
  const char* name;                    ///< the same in C++, JSON and Python
  const char* help;                    ///< one line, without the unit
  int power = 0;                       ///< of the unit of the input
  FieldKind kind = FieldKind::Figure;  ///< what its values are
};

/// Names of an enumeration's values, in their order. \return them
constexpr std::array<const char*, 4> namesOf(FacedBy) {
  return {"normals", "viewpoint", "up", "outward"};
}
/// \copydoc namesOf(FacedBy)
constexpr std::array<const char*, 4> namesOf(ViewSource) {
  return {"given", "origin", "above", "rays"};
}
/// \copydoc namesOf(FacedBy)
constexpr std::array<const char*, 5> namesOf(StopReason) {
  return {"converged", "iteration_limit", "stagnated", "collapsed", "unfinished"};
}
/// \copydoc namesOf(FacedBy)
constexpr std::array<const char*, 3> namesOf(EmbeddingBarrier) {
  return {"none", "coarse_levels", "everywhere"};
}

/// The name of one value.
///
/// \param value of an enumeration of results.
/// \return its name.
template <typename Enum>
constexpr const char* nameOf(Enum value) {
  return namesOf(value).at(static_cast<std::size_t>(value));
}

/// Access to a field that may be empty.
///
/// \param member pointer to an array or list of a struct.
/// \return a function that returns a pointer to it, null if it is empty.
template <typename Member>
constexpr auto unlessEmpty(Member member) {
  return [member](auto& self) { return (self.*member).size() == 0 ? nullptr : &(self.*member); };
}

/// Calls visit(field, access) for all fields of a struct, selected by the pointer's type.
/// std::invoke(access, struct) is a reference to the stored value, a pointer to it (null if it has
/// no meaning), or a derived value.
///
/// \param visit function that takes a ResultField and the access to its value.
/// \return name and help of the struct.
template <typename Visit>
constexpr ResultField visitFields(const MeshTopology*, const Visit& visit) {
  using Of = MeshTopology;
  visit({"vertices", "used by triangles"}, &Of::vertices);
  visit({"edges", "undirected"}, &Of::edges);
  visit({"triangles", "their number"}, &Of::triangles);
  visit({"closed", "no edge has just one triangle"}, &Of::closed);
  visit({"manifold", "manifold at edges and vertices"}, &Of::manifold);
  visit({"edge_manifold", "no edge has more than two triangles"}, &Of::edge_manifold);
  visit({"vertex_manifold", "the triangles around each vertex are one fan"}, &Of::vertex_manifold);
  visit({"oriented", "the triangles of each edge traverse it in opposite directions"},
        &Of::oriented);
  visit({"components", "connected components of triangles"}, &Of::components);
  visit({"boundary_loops", "of edges with one triangle"}, &Of::boundary_loops);
  visit({"euler_characteristic", "V - E + F = 2 components - 2 genus - boundary_loops"},
        &Of::euler_characteristic);
  visit({"genus", "sum over the components; none unless manifold and oriented"}, &Of::genus);
  visit({"nonmanifold_vertices", "their triangles are not one fan", 0, FieldKind::CppOnly},
        &Of::nonmanifold_vertices);
  visit({"unused_vertices", "they have no triangles", 0, FieldKind::CppOnly}, &Of::unused_vertices);
  return {"Topology", "Combinatorial properties of the mesh, counted on its triangles."};
}

/// \cond  the same for all other structs
template <typename Visit>
constexpr ResultField visitFields(const MeshMeasures*, const Visit& visit) {
  using Of = MeshMeasures;
  visit({"volume", "of the solid, positive if the mesh faces outward", 3, FieldKind::OfSolid},
        &Of::volume);
  visit({"area", "of the mesh", 2}, &Of::area);
  visit({"mean_edge_length", "of the mesh", 1}, &Of::mean_edge_length);
  visit({"box_min", "lower corner of the box along the axes", 1}, &Of::box_min);
  visit({"box_max", "upper corner of that box", 1}, &Of::box_max);
  visit({"centroid", "centre of mass of the solid", 1, FieldKind::OfSolid}, &Of::centroid);
  visit({"inertia", "of the solid at unit density about the centroid", 5, FieldKind::OfSolid},
        &Of::inertia);
  return {"Measures",
          "Size, place and mass properties of the mesh and the solid that it encloses. Volume, "
          "centroid and inertia are none if the mesh is open or folded, or more than 1 % of its "
          "triangles intersect."};
}

template <typename Visit>
constexpr ResultField visitFields(const StageTime*, const Visit& visit) {
  visit({"name", "of the stage"}, &StageTime::name);
  visit({"seconds", "wall time [s]"}, &StageTime::seconds);
  return {"StageTime", "Time of one stage."};
}

template <typename Visit>
constexpr ResultField visitFields(const Finding*, const Visit& visit) {
  visit({"text", "a clause, e.g. '2 separate parts (395 and 5,633 points)'"}, &Finding::text);
  visit({"option", "name of the option that helps; empty if none does"}, &Finding::option);
  visit({"value", "of that option"}, &Finding::value);
  visit({"is_fault", "a self-intersection, fold, filled opening, cut handle or joined part"},
        &Finding::is_fault);
  visit({"is_consequence", "the option of another finding deals with this fault, too"},
        &Finding::is_consequence);
  visit({"kind", "the same for all findings of a kind, e.g. 'openings'"}, &Finding::kind);
  visit({"size", "of what was found, e.g. its points; 0: it has none"}, &Finding::size);
  visit({"parts", "of several surfaces: those that have it, numbered from 1"}, &Finding::parts);
  return {"Finding", "A remark on a mesh, and the option that helps."};
}

template <typename Visit>
constexpr ResultField visitFields(const Opening*, const Visit& visit) {
  visit({"is_filled", "the mesh has triangles over it"}, &Opening::is_filled);
  visit({"certainty",
         "from 0 at 3 spacings of width to 1 at 9, or 1 for the boundary of a low sheet"},
        &Opening::certainty);
  visit({"is_certain", "certainty is 1 and it is not flat"}, &Opening::isCertain);
  visit({"is_flat", "the loop lies in a plane and does not bound a sheet: perhaps a flat face"},
        &Opening::is_flat);
  visit({"is_base", "the longest opening, with all of the surface on one side of it"},
        &Opening::is_base);
  visit({"center", "mean of the loop", 1}, &Opening::center);
  visit({"width", "min(4 area / boundary_length, boundary_length / pi)", 1}, &Opening::width);
  visit({"spacing", "mean point spacing at the loop", 1}, &Opening::spacing);
  visit({"area", "length of the vector area of the loop; if it curls, least area over it", 2},
        &Opening::area);
  visit({"boundary_length", "of the loop", 1}, &Opening::boundary_length);
  visit({"loop", "vertices around it, in order; may list a vertex twice", 0, FieldKind::Loops},
        &Opening::loop);
  visit({"triangles", "of the mesh over it if it is filled", 0, FieldKind::TriangleList},
        &Opening::triangles);
  return {"Opening", "An opening of the sampled surface: a wide face of its neighbour graph."};
}

template <typename Visit>
constexpr ResultField visitFields(const PartBridge*, const Visit& visit) {
  using Of = PartBridge;
  visit({"points", "of the smaller part"}, &Of::points);
  visit({"other_points", "of the larger part"}, &Of::other_points);
  visit({"gap", "length of the shortest bridge", 1}, &Of::gap);
  visit({"spacing", "point spacing at its ends", 1}, &Of::spacing);
  visit({"center", "mean of the ends of all its bridges", 1}, &Of::center);
  visit({"vertices", "the ends, ascending, at most 64", 0, FieldKind::Vertices}, &Of::vertices);
  return {"PartBridge", "Two parts of the cloud with a gap between them."};
}

template <typename Visit>
constexpr ResultField visitFields(const SurfaceDiagnosis*, const Visit& visit) {
  using Of = SurfaceDiagnosis;
  visit({"cut_handles", "that the cloud certainly has, and the mesh has not"}, &Of::cut_handles);
  visit({"possible_handles", "that the cloud may have, and the mesh has not"},
        &Of::possible_handles);
  visit({"is_one_sided", "like a Moebius strip or a Klein bottle"}, &Of::is_one_sided);
  visit({"is_on_lines", "the points lie along lines"}, &Of::is_on_lines);
  visit({"fills_volume", "the points fill a volume"}, &Of::fills_volume);
  visit({"is_layered", "the points are voxels, three or more across the surface"}, &Of::is_layered);
  visit({"is_on_curves", "the points lie along curves without a surface"}, &Of::is_on_curves);
  visit({"is_scattered", "a few points, which show no surface"}, &Of::is_scattered);
  visit({"coarse_steps", "of the coordinates where single precision lost digits; 0: none", 1},
        &Of::coarse_steps);
  visit({"edges_outside_graph",
         "fraction of edges between points more than two steps apart in the graph"},
        &Of::edges_outside_graph);
  visit({"bridges", "in descending number of points"}, &Of::bridges);
  visit({"joined_parts", "number of parts that the bridges join"}, &Of::joined_parts);
  visit({"triangle_marks", "sum of the TriangleMark of all findings", 0, FieldKind::PerTriangle},
        unlessEmpty(&Of::triangle_marks));
  return {"Diagnosis", "Evidence against a closed surface without handles, and its place."};
}

template <typename Visit>
constexpr ResultField visitFields(const ConsolidationReport*, const Visit& visit) {
  using Of = ConsolidationReport;
  visit({"noise", "median distance of the points from the surface", 1}, &Of::noise);
  visit({"merged", "points merged into others, exact duplicates not counted"}, &Of::merged);
  visit({"distance_95", "of 95 % of the points from the mesh, at most", 1}, &Of::distance_95);
  return {"Consolidation", "What consolidation found and did."};
}

template <typename Visit>
constexpr ResultField visitFields(const LevelReport*, const Visit& visit) {
  using Of = LevelReport;
  visit({"nodes", "of the level's graph"}, &Of::nodes);
  visit({"edges", "undirected"}, &Of::edges);
  visit({"sweeps", "of smoothing"}, &Of::sweeps);
  visit({"newton_iterations", "steps of Newton's method"}, &Of::newton_iterations);
  visit({"linear_iterations", "conjugate gradient steps within these"}, &Of::linear_iterations);
  visit({"residual", "mean length of the tangential Laplacian at the end [radius]"}, &Of::residual);
  return {"EmbeddingLevel", "Work on one level of the embedding."};
}

template <typename Visit>
constexpr ResultField visitFields(const EmbeddingReport*, const Visit& visit) {
  using Of = EmbeddingReport;
  visit({"stop_reason", "why the work on it ended"}, &Of::stop_reason);
  visit({"converged", "the residual reached the tolerance"}, &Of::converged);
  visit({"iterations", "steps of Newton's method, or of the paper's iteration"}, &Of::iterations);
  visit({"residual", "mean length of the tangential Laplacian [radius]"}, &Of::residual);
  visit({"residuals", "the same before each step and at the end [radius]"}, &Of::residuals);
  visit({"centroid_norm", "length of the mean direction, in [0, 1]; 1: collapsed"},
        &Of::centroid_norm);
  visit({"fallback_start", "it collapsed and was replaced by the directions from the centroid"},
        &Of::fallback_start);
  visit({"start_level", "level on which it started; 0 is the graph itself"}, &Of::start_level);
  visit({"barrier", "where a barrier keeps it from collapsing"}, &Of::barrier);
  visit({"levels", "the finest first"}, &Of::levels);
  return {"Embedding", "How the embedding on the sphere was reached."};
}

template <typename Visit>
constexpr ResultField visitFields(const SmoothingReport*, const Visit& visit) {
  using Of = SmoothingReport;
  visit({"max_displacement", "of a point", 1}, &Of::max_displacement);
  visit({"mean_displacement", "over the points of triangles", 1}, &Of::mean_displacement);
  visit({"rms_displacement", "over the points of triangles", 1}, &Of::rms_displacement);
  visit({"volume_before", "signed volume enclosed", 3}, &Of::volume_before);
  visit({"volume_after", "signed volume enclosed", 3}, &Of::volume_after);
  return {"Smoothing", "Distance of the smoothed surface from the given one."};
}

template <typename Visit>
constexpr ResultField visitFields(const Surface*, const Visit& visit) {
  using Of = Surface;
  visit({"verdict", "a headline, e.g. 'A sound mesh with 2 openings.'"}, &Of::verdict);
  visit({"findings", "remarks and remedies; empty if all is well"}, &Of::findings);
  visit({"usable", "at most 1 % of the triangles intersect"}, &Of::isUsable);
  visit({"is_noisy", "the points look noisy"}, &Of::is_noisy);
  visit({"is_out_of_time", "the time limit ended optimisation or filling early"},
        &Of::is_out_of_time);
  visit({"duplicates", "points that repeat an earlier one"}, &Of::duplicates);
  visit({"added_vertices", "number of vertices added in filled openings"}, &Of::added_vertices);
  visit({"smoothly_filled", "number of openings that have them"}, &Of::smoothly_filled);
  visit({"topology", "checked on the triangles"}, &Of::topology);
  visit({"intersecting_triangles", "number of triangles that intersect others"},
        &Of::intersecting_triangles);
  visit({"intersections_are_sampled",
         "more than 1 % of the triangles intersect, and the search ended: there may be more"},
        &Of::intersections_are_sampled);
  visit({"left_out_triangles", "triangles that were left out because they would intersect others"},
        &Of::left_out_triangles);
  visit({"has_certain_triangles_only",
         "a mesh of all points is a tangle: only small faces of the graph are in this one"},
        &Of::has_certain_triangles_only);
  visit({"self_intersections",
         "pairs of triangles that intersect (exact), ascending: all, or a sample", 0,
         FieldKind::TriangleList},
        &Of::self_intersections);
  visit({"measures", "of the mesh"}, &Of::measures);
  visit({"diagnosis", "whether the cloud looks like a closed surface without handles"},
        &Of::diagnosis);
  visit({"outliers", "stray points that the mesh contains, ascending", 0, FieldKind::Inputs},
        &Of::outliers);
  visit({"openings", "of the surface, open or filled"}, &Of::openings);
  visit({"boundary", "boundary loops, the surface on the left; empty for a closed mesh", 0,
         FieldKind::Loops},
        &Of::boundary);
  visit({"faced_by", "what decided which side of the surface is outside"}, &Of::faced_by);
  visit({"embedding", "how it was reached"}, &Of::embedding);
  visit({"consolidation", "its report; none without consolidation"},
        [](auto& s) { return s.consolidation ? &*s.consolidation : nullptr; });
  visit({"smoothing", "its report; none without smoothing"},
        [](auto& s) { return s.smoothing ? &*s.smoothing : nullptr; });
  visit({"vertices", "input, consolidated or smoothed points, then added vertices, as written", 1,
         FieldKind::PerVertex},
        &Of::points);
  visit({"triangles", "vertices of each, counter-clockwise seen from outside", 0,
         FieldKind::PerTriangle},
        &Of::triangles);
  visit({"sphere",
         "unit vectors: the embedding, if a view, a tolerance, details or topology sphere ask for "
         "it; none of a mesh with handles",
         0, FieldKind::PerVertex},
        unlessEmpty(&Of::sphere));
  visit({"vertex_residuals", "length of the tangential Laplacian of the sphere [radius]", 0,
         FieldKind::PerVertex},
        unlessEmpty(&Of::vertex_residuals));
  visit({"inputs", "the input points of the surface, ascending", 0, FieldKind::PerInput},
        &Of::inputs);
  visit({"vertex_of_input", "vertex of each of them", 0, FieldKind::PerInput},
        &Of::vertex_of_input);
  visit({"input_of_vertex", "first input point at that position", 0, FieldKind::PerVertex},
        &Of::input_of_vertex);
  return {"Surface", "A mesh through all points, its map to the sphere, and their quality."};
}

template <typename Visit>
constexpr ResultField visitFields(const LeftOut*, const Visit& visit) {
  using Of = LeftOut;
  visit({"not_finite", "with a coordinate that is not finite", 0, FieldKind::Inputs},
        &Of::not_finite);
  visit({"unused", "of a file with faces, in none of these", 0, FieldKind::Inputs}, &Of::unused);
  visit({"outliers", "found by the option outliers", 0, FieldKind::Inputs}, &Of::outliers);
  visit({"other_parts", "of parts that were not meshed, or of no part", 0, FieldKind::Inputs},
        &Of::other_parts);
  visit(
      {"unmeshed", "of meshed parts: triangles through them would intersect", 0, FieldKind::Inputs},
      &Of::unmeshed);
  return {"LeftOut", "Input points that are in no surface, by reason."};
}

template <typename Visit>
constexpr ResultField visitFields(const View*, const Visit& visit) {
  visit({"place", "of the sensor", 1}, &View::place);
  visit({"source", "how it was found"}, &View::source);
  return {"View", "The place from which a cloud is seen as one layer."};
}

template <typename Visit>
constexpr ResultField visitFields(const Result*, const Visit& visit) {
  visit({"view", "the place from which the cloud is seen as one layer; none if there is none"},
        [](auto& r) { return r.view ? &*r.view : nullptr; });
  visit({"verdict", "a headline, e.g. '3 meshes, all sound.'"}, &Result::verdict);
  visit({"findings", "of all surfaces; with several, each names its parts"}, &Result::findings);
  visit({"usable", "all surfaces are usable"}, &Result::isUsable);
  visit({"failures", "why parts could not be meshed"}, &Result::failures);
  visit({"left_out", "points in no surface"}, &Result::left_out);
  visit({"surfaces", "one for each meshed part, the largest first"}, &Result::surfaces);
  visit({"stages", "in the order of the work, of all surfaces together"}, &Result::stages);
  return {"Result", "The result of reconstruct()."};
}

/// \endcond

/// A visit of fields that does nothing.
struct NoVisit {
  /// Takes a field and the access to its value.
  template <typename Access>
  constexpr void operator()(const ResultField&, const Access&) const {}
};

/// Name and help of a struct, selected by the pointer's type.
///
/// \param self pointer to the struct; may be null.
/// \return both.
template <typename Struct>
constexpr auto describe(const Struct* self) -> decltype(visitFields(self, NoVisit())) {
  return visitFields(self, NoVisit());
}

/// Whether visitFields() exists for a struct, selected by the pointer's type.
///
/// \param self pointer to the struct; may be null.
/// \return true if they do.
template <typename Struct>
constexpr auto isDescribed(const Struct* self) -> decltype(describe(self), true) {
  return true;
}
/// No other type is described. \return false
constexpr bool isDescribed(const void*) {
  return false;
}

/// The same for a list of structs.
///
/// \return true if they do.
template <typename Struct>
constexpr bool isDescribedList(const std::vector<Struct>*) {
  return isDescribed(static_cast<const Struct*>(nullptr));
}
/// No other type is a list of structs. \return false
constexpr bool isDescribedList(const void*) {
  return false;
}

/// Calls visit(field, value) for all stored values of a struct, also of structs and lists of
/// structs within it.
///
/// \param field of the value; \param value the struct, or the value of one of its fields.
/// \param visit takes a ResultField and a reference.
template <typename Value, typename Visit>
void visitValues(const ResultField& field, Value& value, const Visit& visit) {
  constexpr const std::remove_const_t<Value>* type = nullptr;
  if constexpr (isDescribed(type)) {
    visitFields(type, [&](const ResultField& inner, auto access) {
      using Got = std::invoke_result_t<decltype(access), Value&>;
      if constexpr (std::is_pointer_v<Got>) {
        if (auto* part = std::invoke(access, value))
          visitValues(inner, *part, visit);
      } else if constexpr (std::is_lvalue_reference_v<Got>) {
        visitValues(inner, std::invoke(access, value), visit);
      }
    });
  } else if constexpr (isDescribedList(type)) {
    for (auto& item : value)
      visitValues(field, item, visit);
  } else {
    visit(field, value);
  }
}

/// The same for a whole result.
///
/// \param value described struct.
/// \param visit takes a ResultField and a reference.
template <typename Struct, typename Visit>
void visitValues(Struct& value, const Visit& visit) {
  visitValues(describe(&value), value, visit);
}

/// @}

}  // namespace spherical_param
