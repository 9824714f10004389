#pragma once

#include "sphere_mesh.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace spherical_param::internal {

struct ViewMesh {
  Positions points;
  Triangles triangles;
  Index behind = -1;
  std::vector<Index> hidden;
};

Positions directionsFrom(const Eigen::Vector3d& place, const Positions& points);

std::optional<ViewMesh> triangulateView(const Positions& points, const Eigen::Vector3d& place, const Execution& execution);

}  // namespace spherical_param::internal
