// Geometry images, which pcl_spherical_param_remesh reads: TIFF files of any content.

#include "common/errors.h"
#include "common/geometry_image_file.h"
#include "fuzz_file.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace spherical_param;
  static stress::FuzzFile file(".tiff");
  file.fill(bytes, size);
  try {
    const GeometryImage image = tools::readGeometryImage(file.path());
    stress::require(image.side >= 3 && image.side % 2 == 1, "the side is odd");
    stress::require(image.positions.cols() == static_cast<Eigen::Index>(image.side) * image.side,
                    "a position for each pixel");
    stress::require(image.positions.allFinite(), "positions are finite");
  } catch (const tools::ToolError& error) {
    stress::require(!error.remedy().empty(), "a refusal has its remedy");
  }
  return 0;
}
