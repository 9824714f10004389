#pragma once

#include "spherical_param/map/resampling.h"
#include "spherical_param/map/texture_atlas.h"

#include <Eigen/Geometry>

#include <string>

namespace spherical_param::tools {

/// \throw UsageError if the name that option -image gives does not end in .png.
void requirePngName(const std::string& path);

/// The image of a texture as the content of a PNG file, 8 bits a channel.
/// \throw Failure if it does not fit into memory.
std::string encodePng(const TextureImage& image);

/// The box around the positions of a geometry image [unit of the input].
Eigen::AlignedBox3d boxOf(const GeometryImage& image);

/// A geometry image as the content of a PNG file, 16 bits a channel: red, green and blue are x, y
/// and z, from 0 at the low to 65535 at the high side of its box.
/// \throw Failure if it does not fit into memory.
std::string encodePng(const GeometryImage& image);

}  // namespace spherical_param::tools
