#pragma once

#include "graph.h"
#include "indexed.h"
#include "intersecting_pairs.h"
#include "progress.h"
#include "sphere_mesh.h"
#include "spherical_param/types.h"
#include "surface_energy.h"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// A closed mesh on fixed points, with the energy of its changes. Changes can be rolled
/// back bit by bit.
class EnergyMesh {
public:
  /// The points, the graph and the openings must outlive this.
  ///
  /// \param graph    of the neighbours of each point.
  /// \param openings of the surface; nullptr: it is closed.
  EnergyMesh(const Positions& points, SphereMesh mesh, const Graph& graph, int threads,
             const OpenPlaces* openings = nullptr, const FractionReport& report = {});

  const SphereMesh& mesh() const { return mesh_; }
  const Positions& points() const { return *points_; }
  const Graph& graph() const { return graph_; }
  int threads() const { return threads_; }
  /// Mean length of the graph's edges, the unit of change().
  double unit() const { return unit_; }
  const Facet& facet(Index t) const { return facets_[t]; }
  RawFacet facetOf(Index a, Index b, Index c) const;

  void setEnergy(SurfaceEnergy::Bend bend = SurfaceEnergy::Bend::Angle,
                 double mu = optimization_constants::kMu) {
    energy_.bend = bend;
    energy_.mu = mu;
  }
  /// The energy of the whole mesh [unit()].
  double energy() const;
  /// Which flips are allowed; all of them at first.
  using FlipRule = std::function<bool(const SphereMesh::Diamond&)>;
  void setFlipRule(FlipRule rule) { may_flip_ = std::move(rule); }
  /// Other points, or other places of the openings.
  void setPoints(const Positions& points);
  /// Another mesh with as many triangles.
  void reset(SphereMesh mesh);

  /// Gain of the flip of the side opposite to a corner, or `floor` if the gain is at most that.
  double flipGain(Index t, int corner, double floor) const;
  /// \param gain from flipGain(). Returns whether the flip was possible.
  bool flip(Index t, int corner, double gain);
  /// Cost of a split by a vertex that is not in the mesh, or `ceiling` if the cost is at least
  /// that.
  double splitCost(Index t, Index v, double ceiling) const;
  /// \param cost from splitCost(). Returns the three parts.
  std::array<Index, 3> split(Index t, Index v, double cost);
  /// Removes a vertex of degree 3. Returns whether that was possible.
  bool merge(Index v);

  /// Begins a change; may be nested.
  void begin();
  void commit();
  void rollBack();
  /// Change of the energy since begin() [unit()].
  double change() const { return (change_ - open_.back().change) / unit_; }
  /// Triangles that have changed since begin(), ascending.
  std::vector<Index> changed() const;
  /// Triangles that may have changed since the last call, ascending; all at first.
  std::vector<Index> takeTouched();

private:
  double edge(Index v, Index w, const Facet& f, const Facet& g) const {
    return energy_.edge(v, w, points_->col(v), points_->col(w), f, g);
  }
  void save(Index t);
  void update(Index t);
  void updateAll(const FractionReport& report = {});

  /// The state at a begin().
  struct Before {
    std::size_t moves;
    std::size_t facets;
    double change;
  };

  const Positions* points_;
  const Graph& graph_;
  int threads_;
  SphereMesh mesh_;
  SurfaceEnergy energy_;
  double unit_ = 1.0;
  double change_ = 0.0;  ///< of the energy since the first begin()
  Indexed<Facet> facets_;
  Indexed<char> is_touched_;  ///< since takeTouched()
  FlipRule may_flip_;
  std::vector<Before> open_;
  std::vector<std::pair<Index, Facet>> old_facets_;
};

/// Appends the neighbours of a vertex in mesh and graph.
void appendNeighbors(const EnergyMesh& of, Index v, std::vector<Index>& neighbors);

/// Pairs of triangles that intersect, by their slots in the mesh, none of which is free: a sample
/// if more than `most` triangles intersect. Open triangles do not count.
IntersectingPairs findIntersections(const EnergyMesh& mesh, std::size_t most,
                                    const FractionReport& report);

/// Finds the pairs of triangles that intersect among which some may be new.
///
/// \param touched the triangles that may have changed, ascending.
/// \param found   all pairs before; receives those of now.
void updateIntersections(const EnergyMesh& mesh, const std::vector<Index>& touched,
                         IntersectingPairs& found);

/// Whether a change of the energy is a gain beyond rounding [EnergyMesh::unit()].
bool isGain(double change);

}  // namespace spherical_param::internal
