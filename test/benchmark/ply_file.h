#pragma once

#include "spherical_param/types.h"

#include <string>

namespace spherical_param::benchmark {

/// Any set of triangles: it need not be closed, manifold or oriented. A cloud has none.
struct Mesh {
  Positions points;
  Triangles triangles;
};

/// Reads the positions and the polygons of a PLY file; polygons are cut into fans of triangles.
///
/// The referee and the peers have a reader and a writer of their own, so that they do not depend
/// on the code that they are compared with.
///
/// \throw std::runtime_error if the file is broken.
Mesh readPly(const std::string& path);

/// Writes a binary PLY file in single precision. \throw std::runtime_error if that fails.
void writePly(const std::string& path, const Mesh& mesh);

}  // namespace spherical_param::benchmark
