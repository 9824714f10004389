#include <pcl/console/print.h>
#include <pcl/impl/instantiate.hpp>
#include <pcl/point_types.h>
#include <pcl/surface/impl/spherical_param_map.hpp>

#include <exception>
#include <new>
#include <string>

namespace pcl {
namespace detail {

bool runCore(const std::string& function, const std::function<void()>& work) {
  std::string failure;
  try {
    work();
    return true;
  } catch (const std::bad_alloc&) {
    failure = "out of memory; use fewer points";
  } catch (const std::exception& error) {
    failure = withoutFunctionName(error.what());
  }
  PCL_ERROR("[pcl::%s] %s\n", function.c_str(), failure.c_str());
  return false;
}

bool mapMesh(const spherical_param::Positions& points, const spherical_param::Result& mesh,
             const spherical_param::SphereMapOptions& options, spherical_param::SphereMap& map) {
  spherical_param::SphereMapOptions guarded = options;
  std::exception_ptr callback_error;
  if (options.progress)
    guarded.progress = [&options, &callback_error](double share) {
      try {
        return options.progress(share);
      } catch (...) {
        callback_error = std::current_exception();
        return false;
      }
    };
  const bool is_done = runCore("computeSphericalParamMap", [&] {
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

PCL_INSTANTIATE(computeSphericalParamMap, PCL_XYZ_POINT_TYPES)
