#include "sphere_mesh.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

bool isInMesh(const SphereMesh& mesh, Index v) {
  return mesh.triangleAt(v) >= 0;
}

/// A closed genus-0 manifold over the vertices that it says it has, with true neighbours, degrees
/// and places.
void expectSound(const SphereMesh& mesh, Index vertex_count) {
  Indexed<Index> number(static_cast<std::size_t>(vertex_count), -1);
  Index present = 0;
  for (Index v = 0; v < vertex_count; ++v)
    if (isInMesh(mesh, v))
      number[v] = present++;
  ASSERT_TRUE(
      isSphereOverAll(mesh.triangles().unaryExpr([&](Index v) { return number[v]; }), present));
  Indexed<Index> degree(static_cast<std::size_t>(vertex_count), 0);
  Index count = 0;
  for (Index t = 0; t < mesh.size(); ++t) {
    if (mesh.vertex(t, 0) < 0)
      continue;
    ++count;
    for (int k = 0; k < 3; ++k) {
      ++degree[mesh.vertex(t, k)];
      ASSERT_EQ(mesh.cornerOf(t, mesh.vertex(t, k)), k);
      const Index o = mesh.neighbor(t, k);
      ASSERT_TRUE(o >= 0 && o < mesh.size() && mesh.vertex(o, 0) >= 0);
      const int l = mesh.oppositeCorner(t, k);
      ASSERT_EQ(mesh.neighbor(o, l), t);
      ASSERT_EQ(mesh.vertex(o, (l + 1) % 3), mesh.vertex(t, (k + 2) % 3));
      ASSERT_EQ(mesh.vertex(o, (l + 2) % 3), mesh.vertex(t, (k + 1) % 3));
    }
  }
  ASSERT_EQ(count, mesh.triangles().cols());
  for (Index v = 0; v < vertex_count; ++v) {
    ASSERT_EQ(mesh.degree(v), degree[v]);
    if (!isInMesh(mesh, v))
      continue;
    const Index t = mesh.triangleAt(v);
    ASSERT_EQ(mesh.vertex(t, mesh.cornerOf(t, v)), v);
    Index around = 0;
    Index last = -1;
    bool counter_clockwise = true;
    mesh.forEachAround(v, [&](Index u, int corner) {
      ++around;
      counter_clockwise = counter_clockwise && mesh.vertex(u, corner) == v &&
                          (last < 0 || mesh.vertex(u, (corner + 1) % 3) == last);
      last = mesh.vertex(u, (corner + 2) % 3);
    });
    ASSERT_EQ(around, mesh.degree(v));
    ASSERT_TRUE(counter_clockwise);
  }
}

/// Everything that can be read from a mesh, including free slots.
std::vector<Index> stateOf(const SphereMesh& mesh, Index vertex_count) {
  std::vector<Index> state;
  for (Index t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k)
      state.insert(state.end(), {mesh.vertex(t, k), mesh.neighbor(t, k)});
  for (Index v = 0; v < vertex_count; ++v)
    state.insert(state.end(), {mesh.triangleAt(v), mesh.degree(v)});
  const Triangles triangles = mesh.triangles();
  state.insert(state.end(), triangles.data(), triangles.data() + triangles.size());
  return state;
}

/// Random moves, and what each of them must answer.
struct Moves {
  SphereMesh& mesh;
  Index vertex_count;
  std::mt19937_64 random;

  bool split() {
    const Index v = below(vertex_count);
    if (isInMesh(mesh, v))
      return false;
    for (const Index part : mesh.split(triangle(), v))
      EXPECT_EQ(mesh.vertex(part, 0), v);
    return true;
  }

  bool merge() {
    const Index v = below(vertex_count);
    if (!isInMesh(mesh, v))
      return false;
    const bool may = mesh.degree(v) == 3 && mesh.triangles().cols() > 4;
    const Fan around = trianglesAround(mesh, v);
    const Index t = mesh.merge(v);
    EXPECT_EQ(std::count(around.begin(), around.end(), t), may ? 1 : 0);
    EXPECT_EQ(isInMesh(mesh, v), !may);
    return may;
  }

  bool flip() {
    const Index t = triangle();
    const int k = static_cast<int>(below(3));
    const auto [a, b, c, d] = mesh.diamond(t, k);
    const Index other = mesh.neighbor(t, k);
    bool joined = false;
    mesh.forEachAround(c, [&, d = d](Index u, int corner) {
      joined = joined || mesh.vertex(u, (corner + 1) % 3) == d;
    });
    EXPECT_EQ(mesh.areJoined(c, d), joined);
    EXPECT_EQ(mesh.areJoined(d, c), joined);
    EXPECT_EQ(mesh.flip(t, k), !joined);
    if (!joined) {
      EXPECT_EQ(mesh.vertex(t, 0), c);
      EXPECT_EQ(mesh.vertex(other, 0), c);
      EXPECT_TRUE(mesh.areJoined(c, d));
      EXPECT_FALSE(mesh.areJoined(a, b));
    }
    return !joined;
  }

  bool any() {
    const Index kind = below(4);
    return kind == 0 ? split() : kind == 1 ? merge() : flip();
  }

  Index below(Index bound) {
    return static_cast<Index>(random() % static_cast<std::uint64_t>(bound));
  }
  Index triangle() {
    Index t = below(mesh.size());
    while (mesh.vertex(t, 0) < 0)
      t = below(mesh.size());
    return t;
  }
};

TEST(SphereMesh, ThousandsOfRandomMovesKeepItASphereAndAreRolledBackToTheLastIndex) {
  std::mt19937_64 random(5);
  for (const Index n : {5, 80}) {  // the fewest are often the smallest mesh, which refuses all else
    SphereMesh mesh(tetrahedron(), static_cast<std::size_t>(n));
    for (Index v = 4; v < n; ++v)
      mesh.split(0, v);
    Moves moves{mesh, n, std::mt19937_64(6)};
    int all_made = 0;
    for (int round = 0; round < 300; ++round) {
      const std::vector<Index> before = stateOf(mesh, n);
      mesh.journal().record();
      // Splits are of vertices that merges took out, so there is room for them.
      const auto length = static_cast<int>(random() % 60);
      int made = 0;
      for (int i = 0; i < length; ++i)
        made += moves.any() ? 1 : 0;
      all_made += made;
      if (round % 2 == 0) {
        mesh.journal().rollBack();
        ASSERT_EQ(stateOf(mesh, n), before);
      } else {
        // Committed changes are not rolled back, and nothing is recorded any more.
        const std::vector<Index> after = stateOf(mesh, n);
        mesh.journal().commit();
        mesh.journal().rollBack();
        ASSERT_EQ(stateOf(mesh, n), after);
      }
      expectSound(mesh, n);
      ASSERT_FALSE(HasFailure());
    }
    EXPECT_GT(all_made, 1000);
    EXPECT_LE(mesh.size(), 2 * n - 4);  // slots are used again
  }
}

}  // namespace
}  // namespace spherical_param::test
