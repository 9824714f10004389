#pragma once

#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "common/point_data.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// A mesh with a texture in single precision, as it is written.
struct TexturedMesh {
  std::vector<FloatTriple> points;                ///< each vertex once, also on cuts
  std::vector<FloatTriple> normals;               ///< one per vertex
  std::vector<std::array<float, 2>> coordinates;  ///< u to the right and v up
  std::vector<Index> vertex_of_coordinate;        ///< each coordinate belongs to one vertex
  std::vector<std::array<Index, 3>> triangles;    ///< of vertices
  std::vector<std::array<Index, 3>> coordinate_triangles;  ///< of coordinates
  bool repeats_u = false;  ///< the left side of the image continues its right side
};

/// \param points    3 x v, vertices of the mesh that the atlas was made of.
/// \param triangles of that mesh, which give the normals.
TexturedMesh makeTexturedMesh(const TextureAtlas& atlas, const Positions& points,
                              const Triangles& triangles);

/// The image as the content of a PNG file. \throw Failure if it does not fit into memory.
std::string encodePng(const TextureImage& image);

/// Writes glTF 2.0 in one binary file, with the image in it. Vertices are repeated on cuts, as
/// they have one coordinate each there.
///
/// \param png content of a PNG file. \throw Failure
void writeGlb(OutputFile& file, const TexturedMesh& mesh, const std::string& png);

/// Writes PLY with s and t of each vertex, which are repeated on cuts. The name of the image is in
/// a comment, where MeshLab looks for it. \throw Failure
void writeTexturedPly(OutputFile& file, const TexturedMesh& mesh, const std::string& image_name,
                      Encoding encoding);

/// Writes OBJ, with indices of their own for coordinates: it is closed as it is. \throw Failure
///
/// pcl::io::saveOBJFile() is not used for the reasons given at writeMesh().
void writeTexturedObj(OutputFile& file, const TexturedMesh& mesh, const std::string& material_name);

/// Writes the material of an OBJ file. \throw Failure
void writeMaterial(OutputFile& file, const std::string& image_name);

}  // namespace spherical_param::tools
