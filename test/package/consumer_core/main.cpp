#include <spherical_param/map/sphere_map.h>
#include <spherical_param/reconstruct.h>
#include <spherical_param/version.h>

#include <cmath>
#include <iostream>

int main() {
  spherical_param::Positions points(3, 400);
  for (int i = 0; i < 400; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 400.0;
    const double r = std::sqrt(1.0 - z * z);
    points.col(i) << 3.0 * r * std::cos(2.4 * i), 2.0 * r * std::sin(2.4 * i), z;
  }
  const spherical_param::Surface result = spherical_param::reconstruct(points).surface();
  const spherical_param::SphereMap map =
      spherical_param::computeSphereMap(points, result.triangles, result.sphere);
  std::cout << "spherical_param " << SPHERICAL_PARAM_VERSION << ": " << result.triangles.cols()
            << " triangles\n";
  return result.triangles.cols() == 796 && map.distortion.flipped_triangles == 0 ? 0 : 1;
}
