#pragma once

#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace torture {

/// A mesh as somebody else gets it.
struct Mesh {
  std::vector<std::array<spherical_param::Index, 3>> triangles;
  std::size_t vertices = 0;  ///< that there should be: numbers are [0, vertices)
};

/// What VTK finds wrong with a mesh that should be a closed, consistently oriented manifold of
/// genus 0 in one piece over all of its vertices; by numbers alone. Nothing of the library is used.
///
/// \param mesh any.
/// \return a few words for each kind of fault; none if it is what it should be.
std::vector<std::string> topologyFaults(const Mesh& mesh);

/// Vertices that no triangle has.
///
/// \param mesh any.
/// \return their number.
std::size_t unusedVertices(const Mesh& mesh);

/// Whether the triangles face inward: the volume, in long double, is of less than nothing by more
/// than its rounding.
///
/// \param points   3 x v, finite.
/// \param mesh     its numbers are columns of points.
/// \return false as well if the volume cannot be told from 0.
bool facesInward(const spherical_param::Positions& points, const Mesh& mesh);

/// Shows that the checks find faults that are planted.
///
/// \return what was not found; nothing if all was.
std::vector<std::string> overlookedFaults();

/// Kinds of faults that overlookedFaults() plants.
std::size_t plantedFaults();

}  // namespace torture
