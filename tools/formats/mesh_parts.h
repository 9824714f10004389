#pragma once

#include "common/mesh_view.h"
#include "common/record_writer.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

namespace spherical_param::tools {

inline std::size_t channelCount(const MeshView& mesh) {
  return mesh.hasAlpha() ? 4 : 3;
}

/// A line with the number of corners and their indices.
inline void writeTextTriangle(RecordWriter& writer, const Triangle& triangle) {
  writer.text("3");
  for (const std::int32_t corner : triangle) {
    writer.text(" ");
    writer.number(std::int64_t{corner});
  }
  writer.endLine();
}

}  // namespace spherical_param::tools
