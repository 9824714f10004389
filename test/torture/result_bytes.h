#pragma once

#include "spherical_param/reconstruct.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace torture {

/// Values one after the other, bit by bit.
class Bytes {
public:
  template <typename Value>
  void add(const Value& value) {
    static_assert(std::is_arithmetic_v<Value> || std::is_enum_v<Value>, "might have padding");
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  void add(const std::string& text) {
    add(text.size());
    bytes_ += text;
  }
  template <typename Value>
  void add(const std::vector<Value>& values) {
    add(values.size());
    for (const Value& value : values)
      add(value);
  }
  void add(const std::vector<bool>& values) {
    add(values.size());
    for (const bool value : values)
      add(value);
  }
  template <typename Value, std::size_t count>
  void add(const std::array<Value, count>& values) {
    for (const Value& value : values)
      add(value);
  }
  template <typename Scalar, int rows, int columns>
  void add(const Eigen::Matrix<Scalar, rows, columns>& matrix) {
    add(matrix.cols());
    for (Eigen::Index i = 0; i < matrix.size(); ++i)
      add(matrix.data()[i]);
  }
  template <typename Value>
  void add(const std::optional<Value>& value) {
    add(value.has_value());
    if (value)
      add(*value);
  }
  std::string take() { return std::move(bytes_); }

private:
  std::string bytes_;
};

/// All that a result says, but for the times.
inline void addResult(const spherical_param::Result& result, Bytes& bytes) {
  bytes.add(result.triangles);
  bytes.add(result.sphere);
  bytes.add(result.vertex_of_input);
  bytes.add(result.input_of_vertex);
  bytes.add(result.duplicates);
  bytes.add(result.self_intersections);
  bytes.add(result.smoothed);
  bytes.add(result.history.vertices);
  for (const spherical_param::HistoryFrame& frame : result.history.frames) {
    bytes.add(frame.level);
    bytes.add(frame.iteration);
    bytes.add(frame.residual);
    bytes.add(frame.sphere);
  }
  bytes.add(result.vertex_residuals);
  bytes.add(result.diagnosis.kind);
  bytes.add(result.diagnosis.genus);
  bytes.add(result.diagnosis.summary);
  bytes.add(result.diagnosis.triangle_marks);
  for (const spherical_param::Lid& lid : result.diagnosis.lids) {
    bytes.add(lid.area);
    bytes.add(lid.vertices);
    bytes.add(lid.loops);
  }
  for (const spherical_param::CollapsedHandle& handle : result.diagnosis.handles)
    bytes.add(handle.vertices);
  bytes.add(result.volume);
  bytes.add(result.area);
  bytes.add(result.edges_outside_graph);
  bytes.add(result.graph.edges);
  bytes.add(result.graph.components);
  bytes.add(result.graph.without_tangent_plane);
  bytes.add(result.graph.searched_again);
  bytes.add(result.graph.uncertified);
  bytes.add(result.graph.weak);
  bytes.add(result.embedding.stop_reason);
  bytes.add(result.embedding.iterations);
  bytes.add(result.embedding.residual);
  bytes.add(result.embedding.residuals);
  bytes.add(result.embedding.centroid_norm);
  bytes.add(result.embedding.energy);
  bytes.add(result.triangulation.reinserted);
  bytes.add(result.optimization.energy);
  bytes.add(result.optimization.rough);
  bytes.add(result.optimization.alignment);
  bytes.add(result.optimization.unevenness);
  bytes.add(result.smoothing.rms_displacement);
  bytes.add(result.smoothing.volume_after);
  for (const spherical_param::AttemptReport& attempt : result.attempts) {
    bytes.add(attempt.description);
    bytes.add(attempt.self_intersections);
    bytes.add(attempt.energy);
    bytes.add(attempt.chosen);
  }
  bytes.add(result.warnings);
}

inline std::string bytesOf(const spherical_param::Result& result) {
  Bytes bytes;
  addResult(result, bytes);
  return bytes.take();
}

}  // namespace torture
