#include "spherical_param/sphere_triangulation.h"

#include "incremental_delaunay.h"
#include "progress.h"
#include "spherical_param/errors.h"

#include <cmath>
#include <string>

namespace spherical_param {

Triangles triangulateSphere(const Positions& directions, const Execution& execution) {
  const std::string points =
      "triangulateSphere: " + std::to_string(directions.cols()) + " points; ";
  if (directions.cols() < 4)
    throw InvalidInput(points + "at least 4 are needed");
  constexpr Eigen::Index max_points = Eigen::Index{1} << 29;  // of incrementalDelaunay()
  if (directions.cols() > max_points)
    throw InvalidInput(points + "at most " + std::to_string(max_points) + " can be triangulated");
  constexpr double tolerance = 1e-9;
  for (Eigen::Index i = 0; i < directions.cols(); ++i)
    if (!(std::abs(directions.col(i).squaredNorm() - 1.0) <= tolerance))
      throw InvalidInput("triangulateSphere: point " + std::to_string(i) +
                         " is not of unit length; normalise the points first");
  return internal::incrementalDelaunay(directions, internal::reportOf(execution, "triangulation"))
      .triangles;
}

}  // namespace spherical_param
