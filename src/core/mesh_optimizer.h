#pragma once

#include "core/sphere_mesh.h"
#include "core/surface_energy.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Moves that lower the energy of a closed genus-0 mesh on fixed points. What does not lower it is
/// taken back, to the last index and bit. The running total of the energy is kept.
class MeshOptimizer {
public:
  /// All but the triangles must outlive this.
  MeshOptimizer(const Positions& points, const Triangles& triangles, const Graph& graph,
                int threads);

  const SphereMesh& mesh() const { return mesh_; }

  /// Begins anew with as many triangles.
  void reset(const Triangles& triangles);

  /// Begins to work with another energy, or with other positions of the points.
  void setEnergy(const SurfaceEnergy& energy);
  void setPoints(const Positions& points);

  double energy() const { return energy_; }  ///< running total
  double recomputedEnergy() const;           ///< the same from the mesh

  /// Flips edges, the one that gains most first, until none gains. Returns the number of flips.
  std::size_t flipAll();

  /// Takes a vertex out and puts it back where it costs least, among the triangles around its
  /// neighbours in mesh and graph; keeps that if the energy falls: returns whether it did.
  bool relocate(Index v);

  /// Takes vertices out and puts them back in random order; keeps that if `accept` says so of the
  /// change of the energy [mean length of the graph's edges].
  bool recreate(const std::vector<Index>& vertices, const std::function<bool(double)>& accept,
                std::uint64_t& random);

  /// Whether a change of the energy is a gain beyond rounding [mean length of the graph's edges].
  static bool isGain(double change);

  /// `count` vertices, or all there are, that spread from the seeds at random, over the edges of
  /// mesh and graph.
  std::vector<Index> spread(const std::vector<Index>& seeds, std::size_t count,
                            std::uint64_t& random);

  /// Edges whose triangles' normals have a cosine below the bound.
  std::vector<std::pair<Index, Index>> edgesBelow(double cosine) const;

  /// Tells whether a vertex has an edge whose triangles' normals have a cosine below the bound, or
  /// is more than two edges away from a near neighbour in the graph.
  bool isRough(Index v, double cosine) const;
  /// All such vertices, ascending.
  std::vector<Index> roughVertices(double cosine) const;

  /// n entries: the median of the angles at a vertex's edges and those opposite to it [rad].
  std::vector<double> medianAngles() const;

  /// Pairs that intersect among the triangles around some vertices.
  std::size_t intersectionsAround(const std::vector<Index>& vertices) const;

private:
  /// A flip that gains. Void if its side has another stamp by now.
  struct Candidate {
    double gain;
    Index triangle;
    std::uint32_t stamp;
    std::uint8_t corner;

    bool operator<(const Candidate& other) const {
      return gain != other.gain
                 ? gain < other.gain
                 : std::pair(triangle, corner) > std::pair(other.triangle, other.corner);
    }
  };

  const Facet& facetOf(Index t) const { return facets_[static_cast<std::size_t>(t)]; }
  Facet facet(Index a, Index b, Index c) const {
    return terms_.facet(points_->col(a), points_->col(b), points_->col(c));
  }
  void setFacet(Index t);
  void recomputeFacets();
  /// The items of [0, count) that meet a condition, ascending.
  template <typename Condition>
  std::vector<Index> filter(std::size_t count, const Condition& meets) const;
  double edge(Index v, Index w, const Facet& f, const Facet& g) const {
    return terms_.edge(v, w, points_->col(v), points_->col(w), f.normal, g.normal);
  }

  double flipGain(Index t, int k) const;
  bool flip(Index t, int k, double gain);
  /// Puts the flips of a triangle's sides in the queue, and declares void what was there of them.
  void queueSides(Index t);
  void queueFlip(Index t, int k);
  /// Flips around some triangles until none gains.
  void flipAround(const std::vector<Index>& triangles);
  std::size_t flipQueued();

  double splitCost(Index t, Index v) const;
  bool remove(Index v);
  bool insert(Index v, const std::vector<Index>& neighbors);
  void appendNeighbors(Index v, std::vector<Index>& neighbors) const;

  void begin();
  void keep();
  void takeBack();
  /// Change of the energy since begin() [mean length of the graph's edges].
  double change() const { return (energy_ - energy_before_) / unit_; }

  const Positions* points_;
  const Graph& graph_;
  const int threads_;
  SphereMesh mesh_;
  SurfaceEnergy terms_;
  double unit_ = 1.0;  ///< mean length of the graph's edges
  double energy_ = 0.0;
  double energy_before_ = 0.0;
  std::vector<Facet> facets_;
  bool is_recording_ = false;
  std::vector<std::pair<Index, Facet>> old_facets_;

  std::vector<Candidate> queue_;       ///< a heap
  std::vector<std::uint32_t> stamps_;  ///< of each side of each triangle
  /// Marks of what a pass has seen: those equal to `pass_`.
  std::vector<std::uint32_t> seen_triangles_;
  std::vector<std::uint32_t> seen_vertices_;
  std::uint32_t pass_ = 0;
  std::vector<Index> around_;  ///< working memory of insert() and relocate()
  std::vector<Index> changed_;
};

}  // namespace spherical_param::internal
