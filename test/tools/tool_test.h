#pragma once

#include "spherical_param/types.h"
#include "tool_runner.h"

#include <gtest/gtest.h>
#include <nlohmann/json_fwd.hpp>

#include <map>
#include <string>
#include <vector>

/// What the tests of the tools share: clouds to read, a reader of what is written, and a fixture.
namespace tool_test {

using spherical_param::Positions;
using spherical_param::Triangles;

/// What a PLY file of the tools holds; a cloud has no triangles.
struct MeshFile {
  std::map<std::string, std::vector<double>> properties;  ///< of the vertices, by name
  Triangles triangles;
  std::string comment;  ///< the last one

  std::size_t vertexCount() const { return properties.at("x").size(); }
  Positions columns(const std::string& a, const std::string& b, const std::string& c) const;
  Positions points() const { return columns("x", "y", "z"); }
  Positions normals() const { return columns("nx", "ny", "nz"); }
  Positions colors() const { return columns("red", "green", "blue"); }
  /// Whether it is a closed, oriented sphere over all of its vertices.
  bool isSphere() const;
};

/// Reads a PLY file of little-endian bytes without the code of the tools.
MeshFile parsePly(const std::string& bytes);

/// n points of an ellipsoid on a spiral, exact in single precision.
Positions ellipsoid(int n, const Eigen::Vector3d& axes = {1.2, 0.9, 0.7},
                    const Eigen::Vector3d& center = {0.0, 0.0, 0.0});

/// The points as lines of text, exact.
std::string linesOf(const Positions& points);

/// An ASCII PLY file of points, with normals and colours where these are not empty.
std::string plyOf(const Positions& points, const Positions& normals = {},
                  const Positions& colors = {});

/// Whether all points are among the vertices, exactly.
bool containsAll(const Positions& vertices, const Positions& points);

/// Expects these entries of a report, which may have more.
void expectEntries(const nlohmann::json& report, const nlohmann::json& expected);

/// The words of a command line and some more.
std::vector<std::string> with(std::vector<std::string> words, const std::vector<std::string>& more);

/// A directory in which tools are run.
class ToolTest : public testing::Test {
protected:
  RunResult run(const std::string& tool, const std::vector<std::string>& arguments,
                RunOptions options = {}) const;
  /// A run that has to succeed.
  RunResult expectSuccess(const std::string& tool, const std::vector<std::string>& arguments) const;
  /// What -json reports of a run that has to succeed.
  nlohmann::json reportOf(const std::string& tool, const std::vector<std::string>& arguments) const;
  /// The command line fails with a cause and a remedy, one line each, and the files stay as they
  /// are.
  void expectRefused(const std::string& tool, const std::vector<std::string>& arguments,
                     int exit_code, const std::string& cause, RunOptions options = {}) const;
  void write(const std::string& name, const std::string& content) const;
  std::string content(const std::string& name) const;
  bool exists(const std::string& name) const;
  MeshFile mesh(const std::string& name) const { return parsePly(content(name)); }

  const TemporaryDirectory directory;
};

}  // namespace tool_test
