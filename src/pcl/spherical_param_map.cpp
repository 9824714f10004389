#include <pcl/console/print.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_map.h>

#include <exception>
#include <functional>
#include <new>

namespace pcl {
namespace detail {

bool runCore(const char* function, const std::function<void()>& work) {
  try {
    work();
    return true;
  } catch (const std::bad_alloc&) {
    PCL_ERROR("[pcl::%s] out of memory; use fewer points\n", function);
  } catch (const std::exception& error) {
    PCL_ERROR("[pcl::%s] %s\n", function, withoutFunctionName(error.what()));
  }
  return false;
}

bool mapMesh(const spherical_param::Positions& points, const spherical_param::Result& mesh,
             const spherical_param::SphereMapOptions& options, spherical_param::SphereMap& map) {
  std::exception_ptr callback_error;
  const bool is_done = runCore("computeSphericalParamMap", [&] {
    spherical_param::SphereMapOptions guarded = options;
    if (options.progress)
      guarded.progress = [&options, &callback_error](double share) {
        try {
          return options.progress(share);
        } catch (...) {
          callback_error = std::current_exception();
          return false;
        }
      };
    map = spherical_param::computeSphereMap(points, mesh.triangles, mesh.sphere, guarded);
  });
  if (!is_done)
    map = spherical_param::SphereMap();
  if (callback_error)
    std::rethrow_exception(callback_error);
  return is_done;
}

}  // namespace detail
}  // namespace pcl
