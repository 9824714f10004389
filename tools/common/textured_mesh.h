#pragma once

#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "common/point_data.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/types.h"

#include <string>

namespace spherical_param::tools {

/// The vertices of an atlas, with normals.
///
/// \param points    3 x v, vertices of the mesh that the atlas was made of.
/// \param triangles of that mesh, which give the normals.
PointData verticesOf(const TextureAtlas& atlas, const Positions& points,
                     const Triangles& triangles);

/// The mesh whose vertices are repeated on cuts, as they have one texture coordinate each there:
/// the scalars s and t.
TriangleMesh repeatedOnCuts(const TextureAtlas& atlas, const PointData& vertices);

/// Writes OBJ, with indices of their own for coordinates: it is closed as it is. \throw Failure
///
/// pcl::io::saveOBJFile() is not used for the reasons given at writeMesh().
void writeTexturedObj(OutputFile& file, const TextureAtlas& atlas, const PointData& vertices,
                      const std::string& material_name);

/// Writes the material of an OBJ file. \throw Failure
void writeMaterial(OutputFile& file, const std::string& image_name);

}  // namespace spherical_param::tools
