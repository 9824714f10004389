#pragma once

#include "cut_graph.h"
#include "openings.h"
#include "spherical_param/execution.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

#include <cstddef>
#include <optional>

namespace spherical_param::internal {

/// A closed mesh of several spheres.
struct GluedMesh {
  Triangles triangles;        ///< a closed, oriented manifold over all nodes, in one piece
  EmbeddingReport embedding;  ///< of the sphere with the most nodes, or of one that collapsed
};

/// Embeds and triangulates each component of a cut graph as a sphere, with virtual nodes in its
/// rims and openings, and glues them along the rims.
///
/// \param nodes    number of nodes before the cut.
/// \param openings of the surface, apart from the rims, that virtual nodes fill.
/// \return nothing if the spheres cannot be glued.
std::optional<GluedMesh> meshGluedSpheres(std::size_t nodes, const CutGraph& cut,
                                          const Openings& openings, const Options& options,
                                          const Execution& execution);

}  // namespace spherical_param::internal
