#pragma once

#include "indexed.h"
#include "progress.h"
#include "spherical_param/types.h"

#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// A mesh of the hierarchy, of the vertices [0, vertex_count) of its numbering.
struct MapMesh {
  Index vertex_count = 0;
  Triangles triangles;
  /// Area in space that each triangle stands for [unit of the input squared].
  Indexed<float> masses;
};

/// A closed mesh of genus 0 and ever coarser ones, down to a tetrahedron, which stand for the same
/// surface: where a vertex was taken out, the triangles that fill the hole have the masses of those
/// that were there. So the tip of a limb keeps its fraction of the sphere when a single triangle is
/// left of it.
struct MapHierarchy {
  /// The vertices of the input in the numbering of the hierarchy: the coarser meshes first.
  Indexed<Index> order;
  /// 3 x v, the vertices in that order.
  Positions points;
  /// Some of the meshes, finest first; the last is a tetrahedron.
  std::vector<MapMesh> meshes;
  /// Ascending, the first 4: the vertices from one number to the next were taken out together, no
  /// two of them neighbours of each other.
  std::vector<Index> batches;
  /// Ring of vertex v, v >= 4, when it was taken out: [ring_begin[v - 4], ring_begin[v - 3]) of
  /// `ring`, counter-clockwise; all triangles that fill the hole have its first entry as a corner.
  /// ring_masses has the masses of the triangles of v, an entry and the next one.
  std::vector<std::uint32_t> ring_begin;
  std::vector<Index> ring;
  std::vector<float> ring_masses;
};

/// Takes out vertices by half-edge collapses, level by level.
///
/// \param triangles a closed, manifold, consistently oriented mesh of genus 0 in one piece.
MapHierarchy buildMapHierarchy(const Positions& points, const Triangles& triangles, int threads,
                               const FractionReport& report = {});

}  // namespace spherical_param::internal
