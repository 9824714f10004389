#pragma once

#include "spherical_param/reconstruct.h"

#include <cstddef>
#include <string>
#include <vector>

namespace stress {

/// The arrays and numbers of a result bit by bit, to compare results.
inline std::string bytesOf(const spherical_param::Result& result) {
  std::string bytes;
  const auto add = [&bytes](const auto* values, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof *values);
  };
  const auto add_matrix = [&add](const auto& matrix) {
    add(matrix.data(), static_cast<std::size_t>(matrix.size()));
  };
  add_matrix(result.triangles);
  add_matrix(result.sphere);
  add_matrix(result.smoothed);
  add(result.vertex_of_input.data(), result.vertex_of_input.size());
  add(result.input_of_vertex.data(), result.input_of_vertex.size());
  add(result.vertex_residuals.data(), result.vertex_residuals.size());
  add(result.self_intersections.data(), result.self_intersections.size());
  add(result.embedding.residuals.data(), result.embedding.residuals.size());
  const std::vector<double> numbers{result.measures.volume, result.measures.area,
                                    result.embedding.energy, result.optimization.energy,
                                    result.smoothing.volume_after};
  add(numbers.data(), numbers.size());
  for (const std::string& warning : result.warnings)
    add(warning.data(), warning.size());
  return bytes;
}

}  // namespace stress
