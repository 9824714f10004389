#include "open_surface.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Whether the mesh fills an opening.
bool isFilled(const Opening& opening, bool is_cloud_flat, const Options& options) {
  if (is_cloud_flat)
    return false;
  return options.surface == SurfaceMode::Closed ||
         (options.surface == SurfaceMode::Auto && !opening.isCertain()) ||
         opening.loop.size() <= static_cast<std::size_t>(options.fill_holes);
}

}  // namespace

OpenSurface::OpenSurface(const Positions& points, const Graph& graph, Openings found, bool is_flat,
                         double unit, const Options& options)
    : unit_(unit) {
  Openings open;
  open.spacing = found.spacing;
  for (Opening& opening : found.openings) {
    opening.is_filled = isFilled(opening, is_flat, options);
    if (!opening.is_filled)
      open.openings.push_back(opening);
  }
  if (!open.openings.empty())
    places_.emplace(points, graph, open);
  embedded_ = std::move(found);
}

bool OpenSurface::fillsPossible() const {
  return std::any_of(embedded_.openings.begin(), embedded_.openings.end(),
                     [](const Opening& opening) { return opening.is_filled; });
}

std::vector<Opening> OpenSurface::found(const Positions& points, const Graph& graph,
                                        const Triangles& triangles) const {
  std::vector<Opening> all = embedded_.openings;
  Openings filled;
  filled.spacing = embedded_.spacing;
  std::vector<std::size_t> number;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].is_filled) {
      filled.openings.push_back(all[i]);
      number.push_back(i);
    }
  if (number.empty())
    return all;
  const OpenPlaces places(points, graph, filled);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    if (const auto over = places.openingOver(triangles(0, t), triangles(1, t), triangles(2, t)))
      all[number[*over]].triangles.push_back(static_cast<Index>(t));
  return all;
}

}  // namespace spherical_param::internal
