#pragma once

#include "embedding.h"
#include "sphere_mesh.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/result.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// How far normals and triangles have the same side: 1 on the whole area of the surface, -1:
/// nowhere.
///
/// \param normals of the points, of any length.
double agreementWith(const Positions& normals, const Positions& points, const Triangles& surface);

/// Turns an embedding into its mirror image.
void mirror(Embedding& embedding);

/// Turns sphere and triangles inside out if the embedding is a mirror image, so that the triangles
/// of a closed mesh face outward.
void orientOutward(const Positions& points, SphereMesh& mesh, Embedding& embedding);

/// Turns sphere and triangles so that the surface faces the first of these that applies: the side
/// of the normals, if they agree on most of the area; of an open surface the viewpoint that looks
/// at it, up if it is low, or the viewpoint that hardly sees it; outward.
///
/// \param points    3 x n.
/// \param info      with normals of these points, and a viewpoint in their unit.
/// \param mesh      closed, with its openings.
/// \return what decided.
FacedBy orient(const Positions& points, const CloudInfo& info, SphereMesh& mesh,
               Embedding& embedding);

}  // namespace spherical_param::internal
