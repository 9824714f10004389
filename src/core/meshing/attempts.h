#pragma once

#include "graph.h"
#include "part_mesh.h"
#include "spherical_param/options.h"
#include "stage_clock.h"
#include "surface_plan.h"

#include <optional>

namespace spherical_param::internal {

/// Optimises a closed mesh, smooths it if that is wanted, and opens and cleans it.
///
/// \param part    with a closed mesh, the openings and the embedding; receives the rest.
/// \param is_even \see isEvenlySampled; unset: it is found.
void finishMesh(const Positions& points, const Graph& graph, const Options& options,
                StageClock& clock, PartMesh& part, std::optional<bool> is_even = {});

/// Whether a mesh keeps only the triangles that are certain if the points sample no surface.
bool keepsCertainOnly(const Options& options);

/// Meshes a graph by Method::Default: tries one way after the other, the cheap ones first, as long
/// as the next one may be better, and takes the best mesh.
///
/// \param points nodes; \param graph of them.
PartMesh meshByAttempts(const Positions& points, const Graph& graph, SurfacePlan plan,
                        const Options& options, StageClock& clock);

}  // namespace spherical_param::internal
