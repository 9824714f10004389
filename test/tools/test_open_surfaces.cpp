// What the tools that use the map make of a surface with openings.

#include "tool_test.h"

#include "open_shapes.h"
#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::checkTopology;
using spherical_param::Positions;
using tool_test::MeshFile;
using tool_test::RunResult;
using Words = std::vector<std::string>;

/// open.xyz is half of a sphere, closed.xyz a whole one.
class OpenSurfaces : public tool_test::ToolTest {
protected:
  void SetUp() override {
    write("open.xyz", tool_test::linesOf(spherical_param::test::hemisphere(1000)));
    write("closed.xyz", tool_test::linesOf(tool_test::ellipsoid(800, {1.0, 1.0, 1.0})));
  }

  void expectHalfASphere(const std::string& name) const {
    const MeshFile file = mesh(name);
    const auto topology = checkTopology(file.triangles, file.vertexCount());
    EXPECT_TRUE(topology.isOpenSurface()) << name;
    EXPECT_EQ(topology.euler_characteristic, 1) << name;
    const Positions points = file.points();
    EXPECT_LT(points.row(2).maxCoeff(), 0.05) << name;
    EXPECT_GT(points.colwise().norm().minCoeff(), 0.95) << name;
    // That of a ring of missing triangles is less than one part in ten.
    EXPECT_NEAR(spherical_param::surfaceArea(points, file.triangles),
                2.0 * spherical_param::test::kPi, 0.6)
        << name;
  }
};

TEST_F(OpenSurfaces, StayOpenInTextureRemeshingAndMorph) {
  const Words open = {"-surface", "open"};
  const auto ran = [&](const std::string& tool, Words words) {
    words.insert(words.end(), open.begin(), open.end());
    const RunResult result = run(tool, words);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
  };
  ran(TEXTURE_TOOL, {"open.xyz", "texture.ply", "-checker", "8"});
  // Vertices on the cuts of the chart are there once for each side.
  EXPECT_LT(mesh("texture.ply").points().row(2).maxCoeff(), 0.05);
  for (const std::string sampling : {"icosahedral", "octahedral"}) {
    ran(REMESH_TOOL, {"open.xyz", sampling + ".ply", "-grid", sampling, "-points", "2000"});
    expectHalfASphere(sampling + ".ply");
  }
  ran(REMESH_TOOL, {"open.xyz", "even.ply", "-grid", "even", "-points", "500"});
  EXPECT_LT(mesh("even.ply").points().row(2).maxCoeff(), 0.05);
  ran(MORPH_TOOL, {"open.xyz", "closed.xyz", "between.ply", "-frames", "2"});
  expectHalfASphere("between_000.ply");
}

TEST_F(OpenSurfaces, AreNoGeometryImage) {
  expectRefused(REMESH_TOOL, {"open.xyz", "out.tif", "-surface", "open"}, 1,
                "a geometry image has no openings");
}

}  // namespace
