#pragma once

#include "spherical_param/errors.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/map/texture_atlas.h"

#include <array>
#include <string>
#include <utility>

/// The names of the map's enumerators in Python. Those of options and results of reconstruct() are
/// in optionTable() and result_fields.h.
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

}  // namespace spherical_param::python
