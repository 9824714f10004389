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
  /// All that a result says, but for the times.
  void add(const spherical_param::Result& result) {
    add(result.triangles);
    add(result.sphere);
    add(result.vertex_of_input);
    add(result.input_of_vertex);
    add(result.duplicates);
    add(result.self_intersections);
    add(result.smoothed);
    add(result.history.vertices);
    for (const spherical_param::HistoryFrame& frame : result.history.frames) {
      add(frame.level);
      add(frame.iteration);
      add(frame.residual);
      add(frame.sphere);
    }
    add(result.vertex_residuals);
    add(result.diagnosis.kind);
    add(result.diagnosis.genus);
    add(result.diagnosis.summary);
    add(result.diagnosis.triangle_marks);
    for (const spherical_param::Lid& lid : result.diagnosis.lids) {
      add(lid.area);
      add(lid.vertices);
      add(lid.loops);
    }
    for (const spherical_param::CollapsedHandle& handle : result.diagnosis.handles)
      add(handle.vertices);
    add(result.volume);
    add(result.area);
    add(result.edges_outside_graph);
    add(result.graph.edges);
    add(result.graph.components);
    add(result.graph.without_tangent_plane);
    add(result.graph.searched_again);
    add(result.graph.uncertified);
    add(result.graph.weak);
    add(result.embedding.stop_reason);
    add(result.embedding.iterations);
    add(result.embedding.residual);
    add(result.embedding.residuals);
    add(result.embedding.centroid_norm);
    add(result.embedding.energy);
    add(result.triangulation.reinserted);
    add(result.optimization.energy);
    add(result.optimization.rough);
    add(result.optimization.alignment);
    add(result.optimization.unevenness);
    add(result.smoothing.rms_displacement);
    add(result.smoothing.volume_after);
    for (const spherical_param::AttemptReport& attempt : result.attempts) {
      add(attempt.description);
      add(attempt.self_intersections);
      add(attempt.energy);
      add(attempt.chosen);
    }
    add(result.warnings);
  }
  std::string take() { return std::move(bytes_); }

private:
  std::string bytes_;
};

template <typename... Values>
std::string bytesOf(const Values&... values) {
  Bytes bytes;
  (bytes.add(values), ...);
  return bytes.take();
}

}  // namespace torture
