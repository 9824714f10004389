#pragma once

#include "spherical_param/errors.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/reconstruct.h"

#include <array>
#include <string>
#include <utility>

/// The names of enumerators in Python. Those of reconstruct()'s options are in optionTable().
namespace spherical_param::python {

template <typename Enum, std::size_t Size>
using Names = std::array<std::pair<const char*, Enum>, Size>;

inline constexpr Names<SurfaceFit, 2> kFitNames = {{
    {"smooth", SurfaceFit::Smooth},
    {"linear", SurfaceFit::Linear},
}};
inline constexpr Names<SphereChart, 3> kChartNames = {{
    {"octahedral", SphereChart::Octahedral},
    {"equirectangular", SphereChart::Equirectangular},
    {"cube", SphereChart::CubeMap},
}};
inline constexpr Names<MorphConnectivity, 2> kConnectivityNames = {{
    {"all", MorphConnectivity::AllVertices},
    {"resampled", MorphConnectivity::Resampled},
}};
inline constexpr Names<SurfaceKind, 5> kKindNames = {{
    {"closed_genus0", SurfaceKind::ClosedGenus0},
    {"open", SurfaceKind::Open},
    {"handles", SurfaceKind::Handles},
    {"several_parts", SurfaceKind::SeveralParts},
    {"unclear", SurfaceKind::Unclear},
}};
inline constexpr Names<StopReason, 5> kStopReasonNames = {{
    {"converged", StopReason::Converged},
    {"iteration_limit", StopReason::IterationLimit},
    {"stagnated", StopReason::Stagnated},
    {"collapsed", StopReason::Collapsed},
    {"unfinished", StopReason::Unfinished},
}};

inline constexpr Names<EmbeddingStep, 5> kStepNames = {{
    {"start", EmbeddingStep::Start},
    {"sweeps", EmbeddingStep::Sweeps},
    {"newton", EmbeddingStep::Newton},
    {"iteration", EmbeddingStep::Iteration},
    {"end", EmbeddingStep::End},
}};

/// \throw InvalidInput with the names that there are.
template <typename Enum, std::size_t Size>
Enum valueOf(const char* option, const std::string& name, const Names<Enum, Size>& names) {
  std::string known;
  for (const auto& [candidate, value] : names) {
    if (name == candidate)
      return value;
    known += (known.empty() ? "'" : ", '") + std::string(candidate) + "'";
  }
  throw InvalidInput(std::string(option) + " = '" + name + "' is not known; use one of " + known);
}

template <typename Enum, std::size_t Size>
const char* nameOf(Enum value, const Names<Enum, Size>& names) {
  for (const auto& [name, candidate] : names)
    if (candidate == value)
      return name;
  return "";
}

inline const char* nameOf(SurfaceKind kind) {
  return nameOf(kind, kKindNames);
}

inline const char* nameOf(EmbeddingStep step) {
  return nameOf(step, kStepNames);
}

inline const char* nameOf(StopReason reason) {
  return nameOf(reason, kStopReasonNames);
}

}  // namespace spherical_param::python
