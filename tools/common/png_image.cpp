#include "common/png_image.h"

#include "common/errors.h"
#include "common/file_formats.h"
#include "common/text.h"

#include <png.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace spherical_param::tools {
namespace {

/// \param format PNG_FORMAT_... of the pixels, which follow each other row by row.
std::string encode(int width, int height, png_uint_32 format, const void* pixels,
                   const char* remedy) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(width);
  header.height = static_cast<png_uint_32>(height);
  header.format = format;
  constexpr int converted = 0;   // the pixels keep their number of bits
  constexpr int row_stride = 0;  // rows follow each other
  std::string png(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
  png_alloc_size_t size = png.size();
  if (png_image_write_to_memory(&header, png.data(), &size, converted, pixels, row_stride,
                                nullptr) == 0) {
    throw Failure("the image cannot be encoded as PNG", remedy);
  }
  png.resize(size);
  return png;
}

}  // namespace

void requirePngName(const std::string& path) {
  if (extensionOf(path) != ".png") {
    throw UsageError("option -image: " + inQuotes(path) + " does not end in .png",
                     "give a name that does");
  }
}

std::string encodePng(const TextureImage& image) {
  return encode(image.width, image.height, PNG_FORMAT_RGB, image.pixels.data(),
                "give -size a smaller number");
}

Eigen::AlignedBox3d boxOf(const GeometryImage& image) {
  return {image.positions.rowwise().minCoeff(), image.positions.rowwise().maxCoeff()};
}

std::string encodePng(const GeometryImage& image) {
  const Eigen::AlignedBox3d box = boxOf(image);
  const Eigen::Vector3d sizes = box.sizes();
  std::vector<std::uint16_t> pixels;
  pixels.reserve(static_cast<std::size_t>(image.positions.size()));
  for (Eigen::Index i = 0; i < image.positions.cols(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const double fraction =
          sizes[axis] > 0.0 ? (image.positions(axis, i) - box.min()[axis]) / sizes[axis] : 0.0;
      pixels.push_back(static_cast<std::uint16_t>(std::lround(65535.0 * fraction)));
    }
  return encode(image.side, image.side, PNG_FORMAT_LINEAR_RGB, pixels.data(),
                "give -points a smaller number");
}

}  // namespace spherical_param::tools
