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

/// Moves that lower the energy of a closed genus-0 mesh on fixed points. Other moves are
/// rolled back, to the last index and bit. The running total of the energy is kept.
class MeshOptimizer {
public:
  using Pairs = std::vector<std::array<Index, 2>>;

  /// \param openings of the surface; nullptr: it is closed.
  ///
  /// All but the triangles and the report, which is called with the fraction that is done, must
  /// outlive this. setEnergy() must come first.
  MeshOptimizer(const Positions& points, const Triangles& triangles, const Graph& graph,
                int threads, const FractionReport& report = {},
                const OpenPlaces* openings = nullptr);

  const SphereMesh& mesh() const { return mesh_; }

  /// Begins anew with as many triangles.
  void reset(const Triangles& triangles);

  /// Begins to work with another energy, or with other positions of the points.
  ///
  /// \param energy its typical angles must not change; \see setExcessEnergy.
  void setEnergy(const SurfaceEnergy& energy);
  /// The same for Bend::Excess, with angles that are typical of the mesh as it is now: `factor`
  /// times the median of medianAngles(), or `least` [rad] if that is more. Asked again, it looks
  /// only at what has changed.
  void setExcessEnergy(double mu, double factor, double least);
  const SurfaceEnergy& terms() const { return terms_; }
  void setPoints(const Positions& points);

  double energy() const { return energy_; }  ///< running total
  double recomputedEnergy() const;           ///< the same from the mesh

  /// Flips edges, the one that gains most first, until none gains. Returns the number of flips.
  /// Asked again with the same energy, it looks only at what has changed.
  ///
  /// \param report called with the fraction that is done: an estimate, for a flip may make others
  /// gain. What it throws leaves a sound mesh of which the energy is as it should be.
  std::size_t flipAll(const FractionReport& report = {});

  /// Takes a vertex out and puts it back where it costs least, among the triangles around its
  /// neighbours in mesh and graph; keeps that if the energy falls: returns whether it did.
  bool relocate(Index v);

  /// Takes vertices out and puts them back in random order; keeps that if `accept` says so of the
  /// change of the energy [mean length of the graph's edges].
  bool recreate(const std::vector<Index>& vertices, const std::function<bool(double)>& accept,
                std::uint64_t& random);

  /// Work of recreate(), flipApart() and flipChangedApart() so far [vertices that are taken out and
  /// put back]: what time it takes is about proportional to that.
  std::size_t work() const { return work_; }

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
  std::vector<Index> roughVertices(double cosine, const FractionReport& report = {}) const;

  /// n entries: the median of the angles at a vertex's edges and those opposite to it [rad].
  std::vector<double> medianAngles() const;

  /// All pairs of triangles that intersect, by their places in the mesh; none may be free. Open
  /// triangles do not count.
  ///
  /// Of a mesh that has changed little since it was asked last, only triangles that are new are
  /// looked at.
  Pairs intersections(const FractionReport& report = {});
  /// For each vertex, 1 if the triangles around it are evidently such that no two of them
  /// intersect: seen along an axis, they go around it once.
  std::vector<std::uint8_t> plainFans(const FractionReport& report = {}) const;
  /// Watches the triangles around some vertices, other than open ones.
  void watch(const std::vector<Index>& vertices);
  /// Flips edges of the triangles that are watched so that fewer of them intersect: one edge or two
  /// at a time, and of equally good flips those that cost least. Returns how many pairs fewer there
  /// are.
  std::size_t flipApart();
  /// For `accept` of recreate(): the same where triangles intersect that it has changed since
  /// watch(). Returns how many pairs more there are than before that. Of triangles that were not
  /// watched, no pairs were known before.
  int flipChangedApart();

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
  /// Of the angles of medianAngles().
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

  /// What the energy falls by if a side is flipped, or no more than `floor` if that is so.
  double flipGain(Index t, int k, double floor) const;
  bool flip(Index t, int k, double gain);
  std::size_t flipApart(std::vector<Index> bad);
  /// A flip by what it changes: intersections among local_, and the energy.
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
  /// Those of local_ that two flips near a triangle may make or end intersections with, to near_.
  void gatherNear(Index t);
  bool intersects(Index t) const { return local_.contains(t) && local_.intersects(face(t)); }
  /// What a flip changes, without its cost. \return false if the side may not be flipped, or if
  /// more than `most` intersections come.
  bool findRepair(Index t, int k, int most, Repair& repair);
  double costOf(const Repair& repair) const;
  void flipLocally(const Repair& repair);
  void updateLocally(Index t, Index o);
  /// The best flip of a triangle that intersects others, or the best two. Returns their number.
  int findRepairs(Index t, std::array<Repair, 2>& repairs);
  /// Puts the flips of a triangle's sides in the queue, and declares void what was there of them.
  void queueSides(Index t);
  void queueFlip(Index t, int k);
  /// Flips around some triangles until none gains.
  void flipAround(const std::vector<Index>& triangles);
  std::size_t flipQueued(const FractionReport& report = {});

  /// What the energy rises by if a triangle is split, or no less than `ceiling` if that is so.
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
  /// The mesh when intersections() was asked last, and what it answered.
  struct Checked {
    Triangles triangles;
    Pairs pairs;
  };
  Checked checked_;
  /// What was before each begin() that neither commit() nor rollBack() has ended yet.
  struct Before {
    std::size_t changes;
    std::size_t facets;
    double energy;
  };
  std::vector<Before> open_;
  std::vector<std::pair<Index, Facet>> old_facets_;

  static constexpr std::uint8_t kChangedSinceFlips = 1;
  static constexpr std::uint8_t kChangedSinceAngles = 2;
  /// Marks of triangles that may have changed since flipAll(), in settled_terms_, left no flip that
  /// gains, and since typical_angles_ were found.
  std::vector<std::uint8_t> changes_;
  bool are_flips_settled_ = false;
  SurfaceEnergy settled_terms_;
  bool has_typical_angles_ = false;
  double typical_factor_ = 0.0;
  double min_typical_ = 0.0;
  std::vector<double> typical_angles_;

  std::vector<Candidate> queue_;       ///< a heap
  std::vector<Index> refused_;         ///< triangles of flips that would have joined twice
  std::vector<std::uint32_t> stamps_;  ///< of each side of each triangle
  /// Marks of what a pass has seen: those equal to `pass_`.
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
