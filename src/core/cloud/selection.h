#pragma once

#include "neighborhoods.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/result.h"
#include "stage_clock.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace spherical_param::internal {

/// The finite points that are used, ascending.
///
/// \param left_out receives the others.
std::vector<Index> usableInputs(const Positions& points, const CloudInfo& info, LeftOut& left_out);

/// The points to mesh: finite points without outliers, in parts; and their neighbours.
class Selection {
public:
  /// \param points    3 x n. All arguments must outlive this.
  /// \param search_of makes the search for neighbours; may be empty.
  /// \param given     options; with PartsMode::AsTopology, all points are one part if all parts are
  ///                  too small.
  /// \param info      of the points.
  /// \param left_out  receives the points that are not meshed.
  /// \param known     the nodes of usableInputs(), if they are known already.
  /// \throw InvalidInput if too few points are left.
  Selection(const Positions& points, const Options& given, const NeighborSearchFactory& search_of,
            const CloudInfo& info, StageClock& clock, LeftOut& left_out,
            std::optional<SearchedNodes> known = {});

  /// The points of each part, the largest part first. Empty if all parts are too small.
  const std::vector<std::vector<Index>>& parts() const { return parts_; }
  /// The points of a part, 3 x m.
  Positions pointsOf(std::size_t part) const;
  /// The info of a part; normals that are not finite are 0.
  CloudInfo infoOf(std::size_t part) const;
  /// The neighbours of the points of a part, valid until the next call.
  Neighborhoods& neighborhoodsOf(std::size_t part);
  /// Frees the neighbours.
  void release() { cloud_.reset(); }
  /// Adds points that were left out to a part if they are in its openings: they sample the surface
  /// there.
  ///
  /// \param nodes    of the part.
  /// \param openings found among these nodes.
  /// \return whether there are such points.
  bool complete(std::size_t part, const OrderedPoints& nodes, const std::vector<Opening>& openings);

private:
  Neighborhoods& findNeighbors(const std::vector<Index>& inputs);
  void leaveOutOutliers();
  void takeApart(bool is_never_empty);

  const Positions& points_;
  Options options_;
  const NeighborSearchFactory& search_of_;
  const CloudInfo& info_;
  StageClock& clock_;
  LeftOut& left_out_;
  std::optional<SearchedNodes> known_;    ///< until the neighbours are found
  std::vector<Index> inputs_;             ///< all finite points without outliers
  std::unique_ptr<Neighborhoods> cloud_;  ///< of the inputs, then of one part after the other
  std::vector<std::vector<Index>> parts_;
};

}  // namespace spherical_param::internal
