#pragma once

#include "graph.h"
#include "local_intersections.h"
#include "progress.h"
#include "sphere_mesh.h"
#include "spherical_param/types.h"
#include "surface_energy.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Moves that lower the energy of a closed genus-0 mesh on fixed points. Other moves are rolled
/// back bit by bit. Keeps a running total of the energy.
class MeshOptimizer {
public:
  using Pairs = std::vector<std::array<Index, 2>>;

  /// Call setEnergy() first. All arguments but the triangles must outlive this.
  ///
  /// \param report   receives the fraction done; used only here.
  /// \param openings of the surface; nullptr: it is closed.
  MeshOptimizer(const Positions& points, const Triangles& triangles, const Graph& graph,
                int threads, const FractionReport& report = {},
                const OpenPlaces* openings = nullptr);

  const SphereMesh& mesh() const { return mesh_; }

  /// Begins anew with as many triangles.
  void reset(const Triangles& triangles);

  /// Changes the energy.
  ///
  /// \param energy its typical angles must not change; \see setExcessEnergy.
  void setEnergy(const SurfaceEnergy& energy);
  /// The same for Bend::Excess, with the typical angles of the current mesh: `factor` times the
  /// median of medianAngles(), at least `least` [rad]. Later calls process only changes.
  void setExcessEnergy(double mu, double factor, double least);
  const SurfaceEnergy& terms() const { return terms_; }
  void setPoints(const Positions& points);

  double energy() const { return energy_; }  ///< running total
  double recomputedEnergy() const;           ///< the same from the mesh

  /// Flips edges, the largest gain first, until none gains. Returns the number of flips. Later
  /// calls with the same energy process only changes.
  ///
  /// \param report receives an estimate of the fraction done. If it throws, mesh and energy stay
  ///               consistent.
  std::size_t flipAll(const FractionReport& report = {});

  /// Takes a vertex out and puts it back where it costs least, among the triangles around its
  /// neighbours in mesh and graph. Commits if the energy falls; returns whether it did.
  bool relocate(Index v);

  /// Ruin and recreate: takes vertices out and puts them back in random order. Commits if `accept`
  /// returns true for the change of the energy [mean length of the graph's edges].
  bool recreate(const std::vector<Index>& vertices, const std::function<bool(double)>& accept,
                std::uint64_t& random);

  /// Work of recreate(), flipApart() and flipChangedApart() so far [vertices taken out and put
  /// back], about proportional to the time.
  std::size_t work() const { return work_; }

  /// Whether a change of the energy is a gain beyond rounding [mean length of the graph's edges].
  static bool isGain(double change);

  /// `count` vertices, or all, that spread randomly from the seeds over the edges of mesh and
  /// graph.
  std::vector<Index> spread(const std::vector<Index>& seeds, std::size_t count,
                            std::uint64_t& random);

  /// Edges whose triangles' normals have a cosine below the bound.
  std::vector<std::pair<Index, Index>> edgesBelow(double cosine) const;

  /// Whether a vertex has an edge whose triangles' normals have a cosine below the bound, or is
  /// more than two edges away from a near neighbour in the graph.
  bool isRough(Index v, double cosine) const;
  /// All such vertices, ascending.
  std::vector<Index> roughVertices(double cosine, const FractionReport& report = {}) const;

  /// n entries: the median of the angles at a vertex's edges and those opposite to it [rad].
  std::vector<double> medianAngles() const;

  /// All pairs of triangles that intersect, by their slots in the mesh, without free slots. Open
  /// triangles do not count. After few changes, only new triangles are tested.
  Pairs intersections(const FractionReport& report = {});
  /// For each vertex, 1 if its triangles evidently do not intersect each other: seen along an axis,
  /// they go around it once.
  std::vector<std::uint8_t> plainFans(const FractionReport& report = {}) const;
  /// Watches the triangles around some vertices, except open ones.
  void watch(const std::vector<Index>& vertices);
  /// Flips one or two edges of watched triangles at a time so that fewer triangles intersect; ties
  /// by the least cost. Returns by how many pairs the number falls.
  std::size_t flipApart();
  /// The same for triangles changed since watch(), for `accept` of recreate(). Returns by how many
  /// pairs the number has risen; pairs of unwatched triangles count as new.
  int flipChangedApart();

private:
  /// A flip that gains. Void if the stamp of its side has changed.
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
  RawFacet rawFacet(Index a, Index b, Index c) const {
    RawFacet facet(points_->col(a), points_->col(b), points_->col(c));
    if (openings_ != nullptr && openings_->isOpen(a, b, c))
      facet.open();
    return facet;
  }
  Facet facet(Index a, Index b, Index c) const { return rawFacet(a, b, c).facet(); }
  double cost(const Facet& facet) const { return terms_.cost(facet.radius); }
  void setFacet(Index t);
  /// Whether a triangle or one of its neighbours has a mark in changes_.
  bool isNearChange(Index t, std::uint8_t change) const;
  void unmark(std::uint8_t change);
  bool isPlainFan(Index v) const;
  Pairs allIntersections(const Triangles& triangles, const FractionReport& report) const;
  Triangles trianglesAt(const std::vector<Index>& places) const;
  /// Cosines of the angles of medianAngles().
  void gatherCosines(Index v, std::vector<double>& cosines) const;
  void updateUsualAngles(double factor, double least);
  void recomputeFacets(const FractionReport& report = {});
  /// The items of [0, count) that meet a condition, ascending.
  template <typename Condition>
  std::vector<Index> filter(std::size_t count, const Condition& meets,
                            const FractionReport& report = {}) const;
  double edge(Index v, Index w, const Facet& f, const Facet& g) const {
    return terms_.edge(v, w, points_->col(v), points_->col(w), f, g);
  }

  /// Gain of a flip, or any value up to `floor` if the gain is at most that.
  double flipGain(Index t, int k, double floor) const;
  bool flip(Index t, int k, double gain);
  std::size_t flipApart(std::vector<Index> bad);
  /// A flip and its effect: change of intersections among local_, and of the energy.
  struct Repair {
    int intersections;
    double cost;
    Index triangle;
    int corner;

    bool isBetterThan(const Repair& other) const {
      return intersections != other.intersections ? intersections < other.intersections
                                                  : cost < other.cost;
    }
  };
  Face face(Index t, Index a, Index b, Index c) const;
  Face face(Index t) const {
    return face(t, mesh_.vertex(t, 0), mesh_.vertex(t, 1), mesh_.vertex(t, 2));
  }
  /// Fills near_ with those of local_ that two flips near a triangle may affect.
  void gatherNear(Index t);
  bool intersects(Index t) const { return local_.contains(t) && local_.intersects(face(t)); }
  /// The effect of a flip, without its cost. \return false if the flip is impossible, or if it adds
  /// more than `most` intersections
  bool findRepair(Index t, int k, int most, Repair& repair);
  double costOf(const Repair& repair) const;
  void flipLocally(const Repair& repair);
  void updateLocally(Index t, Index o);
  /// The best one or two flips of a triangle that intersects others. Returns their number.
  int findRepairs(Index t, std::array<Repair, 2>& repairs);
  /// Queues the flips of a triangle's sides and voids older entries.
  void queueSides(Index t);
  void queueFlip(Index t, int k);
  /// Flips around some triangles until none gains.
  void flipAround(const std::vector<Index>& triangles);
  std::size_t flipQueued(const FractionReport& report = {});

  /// Cost of a split, or any value from `ceiling` on if the cost is at least that.
  double splitCost(Index t, Index v, double ceiling) const;
  bool remove(Index v);
  bool insert(Index v, const std::vector<Index>& neighbors);
  void appendNeighbors(Index v, std::vector<Index>& neighbors) const;

  void begin();
  void commit();
  void rollBack();
  /// Change of the energy since begin() [mean length of the graph's edges].
  double change() const { return (energy_ - open_.back().energy) / unit_; }

  const Positions* points_;
  const Graph& graph_;
  const OpenPlaces* openings_;
  const int threads_;
  SphereMesh mesh_;
  SurfaceEnergy terms_;
  double unit_ = 1.0;   ///< mean length of the graph's edges
  double scale_ = 1.0;  ///< brings the coordinates to at most 1
  double energy_ = 0.0;
  std::vector<Facet> facets_;
  /// The mesh and the result of the last intersections().
  struct Checked {
    Triangles triangles;
    Pairs pairs;
  };
  Checked checked_;
  /// The state before each open begin().
  struct Before {
    std::size_t changes;
    std::size_t facets;
    double energy;
  };
  std::vector<Before> open_;
  std::vector<std::pair<Index, Facet>> old_facets_;

  static constexpr std::uint8_t kChangedSinceFlips = 1;
  static constexpr std::uint8_t kChangedSinceAngles = 2;
  /// Marks of triangles that may have changed since flipAll() with settled_terms_, and since
  /// typical_angles_ were computed.
  std::vector<std::uint8_t> changes_;
  bool are_flips_settled_ = false;
  SurfaceEnergy settled_terms_;
  bool has_typical_angles_ = false;
  double typical_factor_ = 0.0;
  double min_typical_ = 0.0;
  std::vector<double> typical_angles_;

  std::vector<Candidate> queue_;       ///< a heap
  std::vector<Index> refused_;         ///< triangles of flips whose new edge existed
  std::vector<std::uint32_t> stamps_;  ///< of each side of each triangle
  /// A pass has seen the entries equal to `pass_`.
  std::vector<std::uint32_t> seen_triangles_;
  std::vector<std::uint32_t> seen_vertices_;
  std::uint32_t pass_ = 0;
  std::size_t work_ = 0;
  LocalIntersections local_;   ///< of the last watch()
  LocalIntersections near_;    ///< a part of local_
  std::vector<Index> around_;  ///< working memory of insert() and relocate()
  std::vector<Index> changed_;
};

}  // namespace spherical_param::internal
