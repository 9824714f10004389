#include "charts.h"
#include "spherical_param/map/texture_atlas.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::doubledArea;
using test::Mapped;
using test::placesOf;
using TextureOfChart = test::EachChart;
using Colors = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using Color = std::array<int, 3>;

INSTANTIATE_TEST_SUITE_P(EachChart, TextureOfChart, test::kEachChart, test::chartName);

Colors colorsOf(const Mapped& mesh) {
  return 127.5 * (mesh.sphere.array() + 1.0).matrix();
}

std::size_t pixelOf(const TextureImage& image, int x, int y) {
  return static_cast<std::size_t>(y * image.width + x);
}

Color colorAt(const TextureImage& image, std::size_t i) {
  return {image.pixels[3 * i], image.pixels[3 * i + 1], image.pixels[3 * i + 2]};
}

Vector2d centerOf(const TextureImage& image, int x, int y) {
  return {(x + 0.5) / image.width, 1.0 - (y + 0.5) / image.height};
}

TEST_P(TextureOfChart, EveryPixelInATriangleHasItsColor) {
  // Brute force: for all pixels, all triangles.
  for (const Mapped& mesh : {test::octasphere(1), test::mapped(test::randomSphere(200, 4)),
                             test::mapped(test::someRotation() * test::regularTetrahedron()),
                             test::rim(60, 1e-3, test::someRotation())}) {
    SCOPED_TRACE(mesh.sphere.cols());
    const TextureAtlas atlas = atlasOf(mesh);
    const Eigen::MatrixXd of_vertices = atCutVertices(atlas, colorsOf(mesh));
    const TextureImage image = bakeColors(atlas, colorsOf(mesh), {33, 0, 1});
    ASSERT_EQ(image.height, 33);
    ASSERT_EQ(image.width, isEquirectangular() ? 66 : isCubeMap() ? 50 : 33);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Vector2d center = centerOf(image, x, y);
        const Color color = colorAt(image, pixelOf(image, x, y));
        double nearest = std::numeric_limits<double>::infinity();  // without a triangle
        for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
          const std::array<Vector2d, 3> p = placesOf(atlas, t);
          bool is_inside = internal::orientation2d(p[0], p[1], p[2]) > 0;
          Vector3d expected = Vector3d::Zero();
          for (std::size_t k = 0; k < 3 && is_inside; ++k) {
            is_inside = internal::orientation2d(p[(k + 1) % 3], p[(k + 2) % 3], center) >= 0;
            expected += doubledArea({center, p[(k + 1) % 3], p[(k + 2) % 3]}) / doubledArea(p) *
                        of_vertices.col(atlas.triangles(static_cast<Eigen::Index>(k), t));
          }
          if (is_inside)
            nearest = std::min(
                nearest, (expected - Vector3d(color[0], color[1], color[2])).cwiseAbs().maxCoeff());
        }
        ASSERT_EQ(image.covered[pixelOf(image, x, y)], std::isfinite(nearest) ? 1 : 0);
        // Rounding, and a little for thin triangles.
        EXPECT_TRUE(nearest <= 0.51 || !std::isfinite(nearest)) << x << " " << y;
        EXPECT_TRUE(std::isfinite(nearest) || GetParam() != SphereChart::Octahedral);
      }
  }
}

TEST_P(TextureOfChart, TheGutterHasTheColorOfTheNearestPixel) {
  const Mapped mesh = test::mapped(test::randomSphere(40, 6));
  const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, {GetParam(), 0.2});
  const TextureImage plain = bakeColors(atlas, colorsOf(mesh), {30, 0, 1});
  const int gutter = 3;
  const TextureImage image = bakeColors(atlas, colorsOf(mesh), {30, gutter, 1});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      int best = std::numeric_limits<int>::max();
      std::set<Color> candidates;
      for (int v = 0; v < image.height; ++v)
        for (int u = 0; u < image.width; ++u) {
          if (plain.covered[pixelOf(plain, u, v)] == 0)
            continue;
          int across = std::abs(u - x);
          if (isEquirectangular())
            across = std::min(across, image.width - across);
          const int squared = across * across + (v - y) * (v - y);
          if (squared < best)
            candidates.clear();
          best = std::min(best, squared);
          if (squared == best)
            candidates.insert(colorAt(plain, pixelOf(plain, u, v)));
        }
      const int covered = image.covered[pixelOf(image, x, y)];
      ASSERT_EQ(covered, best == 0 ? 1 : best <= gutter * gutter ? 2 : 0);
      EXPECT_EQ(candidates.count(colorAt(image, pixelOf(image, x, y))), covered != 0 ? 1U : 0U)
          << x << " " << y;
    }
}

TEST_P(TextureOfChart, ACheckerboardShowsTheSquareOfItsDirection) {
  const Mapped mesh = test::octasphere(32);
  const int cells = 4;
  const TextureImage image = bakeCheckerboard(atlasOf(mesh), mesh.sphere, cells, {96, 0, 1});
  // By octant, and whether the square is an even one.
  std::map<std::pair<int, int>, std::set<Color>> seen;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (image.covered[pixelOf(image, x, y)] != 1)
        continue;
      const Vector3d d = test::directionAt(options(), centerOf(image, x, y));
      Eigen::Index axis = 0;
      const double depth = d.cwiseAbs().maxCoeff(&axis);
      const auto place = [&](Eigen::Index other) {
        return (4.0 * std::atan(d[other % 3] / depth) / test::kPi + 1.0) / 2.0 * cells;
      };
      const double column = place(axis + 1);
      const double row = place(axis + 2);
      // Triangles are flat in the image: not too close to a border.
      if (std::abs(column - std::round(column)) < 0.03 || std::abs(row - std::round(row)) < 0.03)
        continue;
      const int octant = (d.x() > 0 ? 1 : 0) + (d.y() > 0 ? 2 : 0) + (d.z() > 0 ? 4 : 0);
      seen[{octant, (static_cast<int>(column) + static_cast<int>(row)) % 2}].insert(
          colorAt(image, pixelOf(image, x, y)));
    }
  EXPECT_EQ(seen.size(), 16U);
  std::set<Color> all;
  for (const auto& [squares, colors] : seen) {
    EXPECT_EQ(colors.size(), 1U);
    all.insert(colors.begin(), colors.end());
  }
  EXPECT_EQ(all.size(), 16U);
}

}  // namespace
}  // namespace spherical_param
