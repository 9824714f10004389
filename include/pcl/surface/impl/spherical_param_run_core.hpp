#pragma once

#include <pcl/pcl_exports.h>
#include <pcl/point_cloud.h>
#include <pcl/types.h>

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <exception>
#include <functional>
#include <string>

namespace pcl {
namespace detail {

/** \brief The positions of some points of a cloud.
 * \return 3 x the number of indices */
template <typename PointT>
spherical_param::Positions positionsOf(const pcl::PointCloud<PointT>& cloud,
                                       const pcl::Indices& indices) {
  spherical_param::Positions positions(3, static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const PointT& point = cloud[static_cast<std::size_t>(indices[i])];
    positions.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3d(
        static_cast<double>(point.x), static_cast<double>(point.y), static_cast<double>(point.z));
  }
  return positions;
}

/** \brief A progress callback for the core that passes exceptions of the user's callback on to the
 * user, instead of turning them into error messages. Needs failureOf() around the core. */
PCL_EXPORTS std::function<bool(const spherical_param::Progress&)>
guardProgress(const std::function<bool(const spherical_param::Progress&)>& progress);

/** \brief Calls work that may throw anything.
 * \param[out] callback_error exception of a progress callback of guardProgress(), if any
 * \return why the work failed, with a remedy; empty after a success */
PCL_EXPORTS std::string failureOf(const std::function<void()>& work,
                                  std::exception_ptr& callback_error);

/** \brief Calls work with the execution for the core, whose threads are those of the user, or
 * `threads`, and reports a failure by PCL_ERROR: "[pcl::function] ...". Throws only exceptions of
 * the user's progress callback. \return false after a failure */
PCL_EXPORTS bool runCore(const char* function, const spherical_param::Execution& execution,
                         unsigned int threads,
                         const std::function<void(const spherical_param::Execution&)>& work);
template <typename Work>
bool runCore(const char* function, const spherical_param::Execution& execution,
             unsigned int threads, const Work& work) {
  return runCore(function, execution, threads,
                 std::function<void(const spherical_param::Execution&)>(std::cref(work)));
}

}  // namespace detail
}  // namespace pcl
