#include "spherical_param/map/texture_atlas.h"

#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/sphere_triangulation.h"

#include "exact_predicates.h"

#include "helpers.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

using namespace spherical_param;
using namespace spherical_param::test;

namespace {

using Colors = Eigen::Matrix<double, 3, Eigen::Dynamic>;

constexpr std::array<SphereChart, 3> charts = {SphereChart::Equirectangular,
                                               SphereChart::Octahedral, SphereChart::CubeMap};

struct Mesh {
  std::string name;
  Positions sphere;
  Triangles triangles;
};

Mesh tetrahedron(const Eigen::Matrix3d& rotation) {
  Mesh mesh{"tetrahedron", Positions(3, 4), Triangles(3, 4)};
  mesh.sphere << 1, -1, -1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  mesh.sphere = rotation * mesh.sphere / std::sqrt(3.0);
  mesh.triangles << 0, 0, 0, 1, 1, 2, 3, 3, 2, 3, 1, 2;
  if (internal::orientation3d(Eigen::Vector3d::Zero(), mesh.sphere.col(0), mesh.sphere.col(1),
                              mesh.sphere.col(2)) < 0)
    flipOrientation(mesh.triangles);
  return mesh;
}

/// All vertices on the axes, all edges on cut planes.
Mesh octahedron() {
  Mesh mesh{"octahedron", Positions(3, 6), Triangles(3, 8)};
  mesh.sphere << 1, -1, 0, 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 1, -1;
  Eigen::Index t = 0;
  for (const Index z : {4, 5})
    for (const Index y : {2, 3})
      for (const Index x : {0, 1}) {
        const bool is_even = ((z - 4) + (y - 2) + x) % 2 == 0;
        mesh.triangles.col(t++) << x, is_even ? y : z, is_even ? z : y;
      }
  return mesh;
}

Mesh divided(const Mesh& mesh) {
  Mesh fine{mesh.name + "'", mesh.sphere, Triangles(3, 4 * mesh.triangles.cols())};
  std::vector<Eigen::Vector3d> points;
  for (Eigen::Index v = 0; v < mesh.sphere.cols(); ++v)
    points.emplace_back(mesh.sphere.col(v));
  std::map<std::pair<Index, Index>, Index> middles;
  const auto middle = [&](Index a, Index b) {
    const auto [entry, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<Index>(points.size()));
    if (is_new)
      points.emplace_back((mesh.sphere.col(a) + mesh.sphere.col(b)).normalized());
    return entry->second;
  };
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Index a = mesh.triangles(0, t);
    const Index b = mesh.triangles(1, t);
    const Index c = mesh.triangles(2, t);
    const Index ab = middle(a, b);
    const Index bc = middle(b, c);
    const Index ca = middle(c, a);
    fine.triangles.col(4 * t) << a, ab, ca;
    fine.triangles.col(4 * t + 1) << ab, b, bc;
    fine.triangles.col(4 * t + 2) << ca, bc, c;
    fine.triangles.col(4 * t + 3) << ab, bc, ca;
  }
  fine.sphere.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    fine.sphere.col(static_cast<Eigen::Index>(i)) = points[i];
  return fine;
}

Mesh delaunay(const std::string& name, const Positions& points) {
  return {name, points, triangulateSphere(points).triangles};
}

/// A linear map keeps the orientation of all triangles of directions.
Mesh transformed(const std::string& name, Mesh mesh, const Eigen::Matrix3d& matrix) {
  mesh.name += name;
  mesh.sphere = (matrix * mesh.sphere).colwise().normalized();
  return mesh;
}

/// Vertices but for a few on a great circle, so that its triangles are long and thin.
Mesh rim(Index n, double height, const Eigen::Matrix3d& rotation) {
  Positions points(3, n + 2);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (Index i = 0; i < n; ++i) {
    const double angle = kPi * uniform(random);
    points.col(i) = Eigen::Vector3d(std::cos(angle), std::sin(angle), height * uniform(random));
  }
  points.col(n) << 0.1, 0.2, 0.9;
  points.col(n + 1) << -0.2, 0.1, -0.9;
  points = (rotation * points).colwise().normalized().eval();
  return delaunay("rim", points);
}

Eigen::Matrix3d someRotation() {
  return Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -0.7).normalized()).toRotationMatrix();
}

std::vector<Mesh> meshes() {
  std::vector<Mesh> all = {tetrahedron(Eigen::Matrix3d::Identity()), tetrahedron(someRotation()),
                           octahedron()};
  // A face over a pole, a vertex in the pole, an edge through it.
  all.push_back(tetrahedron(Eigen::Quaterniond::FromTwoVectors(
                                Eigen::Vector3d(-1, -1, -1).normalized(), Eigen::Vector3d::UnitZ())
                                .toRotationMatrix()));
  all.push_back(divided(octahedron()));
  all.push_back(divided(divided(all.back())));
  all.push_back(transformed(" turned", all.back(), someRotation()));
  all.push_back(divided(tetrahedron(Eigen::Matrix3d::Identity())));
  all.push_back(divided(divided(divided(tetrahedron(someRotation())))));
  all.push_back(delaunay("cube", (cubeGrid(7).array() - 0.5).matrix().colwise().normalized()));
  for (const Index n : {4, 5, 7, 12, 50, 800})
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const Positions points = randomSphere(n, seed);
      if (n < 50) {
        // The centre has to be inside, or one triangle covers more than half of the sphere.
        Positions with_axes(3, n + 4);
        with_axes << points, tetrahedron(someRotation()).sphere;
        all.push_back(delaunay("random", with_axes));
      } else {
        all.push_back(delaunay("random", points));
      }
    }
  const Eigen::Matrix3d stretched = Eigen::Vector3d(1.0, 1.0, 300.0).asDiagonal();
  const Mesh random = all.back();
  all.push_back(transformed(" squeezed", random, stretched));
  all.push_back(transformed(" squeezed", random, someRotation() * stretched));
  all.push_back(
      transformed(" squeezed", random,
                  someRotation() * Eigen::Vector3d(1.0, 0.003, 1.0).asDiagonal().toDenseMatrix()));
  for (const double height : {1e-2, 1e-5, 1e-9})
    all.push_back(rim(300, height, someRotation()));
  all.push_back(rim(300, 1e-6, Eigen::Matrix3d::Identity()));
  return all;
}

Eigen::Vector3d pointOf(const CutVertex& vertex, const Positions& values) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    sum += vertex.weights[static_cast<Eigen::Index>(k)] * values.col(vertex.vertices[k]);
  return sum;
}

std::array<Eigen::Vector2d, 3> placesOf(const TextureAtlas& atlas, Eigen::Index t) {
  std::array<Eigen::Vector2d, 3> places;
  for (std::size_t k = 0; k < 3; ++k)
    places[k] = atlas.coordinates.col(atlas.coordinate_triangles(static_cast<Eigen::Index>(k), t));
  return places;
}

double doubledArea(const std::array<Eigen::Vector2d, 3>& p) {
  const Eigen::Vector2d b = p[1] - p[0];
  const Eigen::Vector2d c = p[2] - p[0];
  return b.x() * c.y() - b.y() * c.x();
}

/// The inverse of the charts, written down anew.
Eigen::Vector3d directionAt(const TextureAtlasOptions& options, const Eigen::Vector2d& place) {
  switch (options.chart) {
  case SphereChart::Equirectangular: {
    const double longitude = (2.0 * place.x() - 1.0) * kPi;
    const double latitude = (place.y() - 0.5) * kPi;
    return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
            std::sin(latitude)};
  }
  case SphereChart::Octahedral: {
    Eigen::Vector3d d(2.0 * place.x() - 1.0, 2.0 * place.y() - 1.0, 0.0);
    d.z() = 1.0 - std::abs(d.x()) - std::abs(d.y());
    if (d.z() < 0.0)
      d.head<2>() = Eigen::Vector2d(std::copysign(1.0 - std::abs(d.y()), d.x()),
                                    std::copysign(1.0 - std::abs(d.x()), d.y()));
    return d.normalized();
  }
  case SphereChart::CubeMap: {
    const int column = std::min(2, static_cast<int>(3.0 * place.x()));
    const bool is_upper = place.y() > 0.5;
    const auto spread = [&](double value) {
      return 2.0 * (value - options.margin) / (1.0 - 2.0 * options.margin) - 1.0;
    };
    const double s = spread(3.0 * place.x() - column);
    const double t = spread(2.0 * place.y() - (is_upper ? 1.0 : 0.0));
    const std::array<Eigen::Vector3d, 6> faces = {
        Eigen::Vector3d(1, s, t),  Eigen::Vector3d(-1, -s, t), Eigen::Vector3d(-s, 1, t),
        Eigen::Vector3d(s, -1, t), Eigen::Vector3d(-t, s, 1),  Eigen::Vector3d(t, s, -1)};
    return faces[static_cast<std::size_t>(column + (is_upper ? 0 : 3))].normalized();
  }
  }
  return Eigen::Vector3d::Zero();
}

class EachChart : public testing::TestWithParam<SphereChart> {
protected:
  TextureAtlasOptions options() const { return {GetParam()}; }
};

std::string nameOf(const testing::TestParamInfo<SphereChart>& info) {
  const std::array<const char*, 3> names = {"Equirectangular", "Octahedral", "CubeMap"};
  return names[static_cast<std::size_t>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(TextureAtlas, EachChart, testing::ValuesIn(charts), nameOf);

TEST_P(EachChart, TheCutMeshIsAClosedSphereOfTheSameAreaAndKeepsItsVertices) {
  for (const Mesh& mesh : meshes()) {
    const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options());
    const Index n = static_cast<Index>(mesh.sphere.cols());
    const std::string where = mesh.name + " " + std::to_string(n);
    EXPECT_TRUE(isSphereOverAll(atlas.triangles, static_cast<Index>(atlas.vertices.size())))
        << where;
    ASSERT_EQ(atlas.source.size(), static_cast<std::size_t>(atlas.triangles.cols()));
    Positions points(3, static_cast<Eigen::Index>(atlas.vertices.size()));
    for (std::size_t v = 0; v < atlas.vertices.size(); ++v) {
      const CutVertex& vertex = atlas.vertices[v];
      EXPECT_NEAR(vertex.weights.sum(), 1.0, 1e-14);
      EXPECT_GE(vertex.weights.minCoeff(), 0.0);
      points.col(static_cast<Eigen::Index>(v)) = pointOf(vertex, mesh.sphere);
      if (v < static_cast<std::size_t>(n)) {
        EXPECT_EQ(points.col(static_cast<Eigen::Index>(v)),
                  mesh.sphere.col(static_cast<Eigen::Index>(v)));
      }
    }
    EXPECT_NEAR(surfaceArea(points, atlas.triangles), surfaceArea(mesh.sphere, mesh.triangles),
                1e-11);
    EXPECT_NEAR(signedVolume(points, atlas.triangles), signedVolume(mesh.sphere, mesh.triangles),
                1e-11);
    // Each part lies in its triangle.
    for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
      const auto whole = mesh.triangles.col(atlas.source[static_cast<std::size_t>(t)]);
      for (Eigen::Index k = 0; k < 3; ++k) {
        const CutVertex& vertex = atlas.vertices[static_cast<std::size_t>(atlas.triangles(k, t))];
        for (std::size_t c = 0; c < 3; ++c)
          if (vertex.weights[static_cast<Eigen::Index>(c)] > 0.0) {
            EXPECT_TRUE((whole.array() == vertex.vertices[c]).any()) << where;
          }
      }
    }
    EXPECT_EQ(atCutVertices(atlas, mesh.sphere), points);
  }
}

TEST_P(EachChart, NoTriangleWrapsRoundOrIsTurnedOver) {
  for (const Mesh& mesh : meshes()) {
    const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options());
    const std::string where = mesh.name + " " + std::to_string(mesh.sphere.cols());
    EXPECT_GE(atlas.coordinates.minCoeff(), 0.0);
    EXPECT_LE(atlas.coordinates.maxCoeff(), 1.0);
    double sum = 0.0;
    for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
      const std::array<Eigen::Vector2d, 3> p = placesOf(atlas, t);
      // Coordinates are rounded to 1.1e-16, and a side is no longer than the image.
      EXPECT_GE(doubledArea(p), -4e-16) << where << ", triangle " << t;
      sum += doubledArea(p) / 2.0;
      // The extent of a quarter in longitude, an octant, a face.
      const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
      const auto [low, high] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
      const bool is_cube = GetParam() == SphereChart::CubeMap;
      EXPECT_LE(right - left, (GetParam() == SphereChart::Equirectangular ? 0.25
                               : is_cube                                  ? 1.0 / 3.0
                                                                          : 0.5) +
                                  1e-15)
          << where;
      EXPECT_LE(high - low, GetParam() == SphereChart::Equirectangular ? 1.0 : 0.5 + 1e-15);
    }
    const double inner = 1.0 - 2.0 * options().margin;
    if (GetParam() == SphereChart::Octahedral) {
      EXPECT_NEAR(sum, 1.0, 1e-12) << where;
    } else if (GetParam() == SphereChart::CubeMap) {
      EXPECT_NEAR(sum, inner * inner, 1e-12) << where;
    } else {
      EXPECT_LT(sum, 1.0) << where;  // at the poles there is nothing beside the triangles
    }
  }
}

TEST_P(EachChart, CoordinatesAreThoseOfTheDirections) {
  for (const Mesh& mesh : meshes()) {
    const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options());
    for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t)
      for (Eigen::Index k = 0; k < 3; ++k) {
        const auto vertex = static_cast<std::size_t>(atlas.triangles(k, t));
        const Eigen::Vector3d direction = pointOf(atlas.vertices[vertex], mesh.sphere).normalized();
        const Eigen::Vector2d place = atlas.coordinates.col(atlas.coordinate_triangles(k, t));
        // Weights are rounded, and so is the length of a point in a large triangle.
        EXPECT_LT((directionAt(options(), place) - direction).norm(), 1e-12) << mesh.name;
      }
  }
}

TEST_P(EachChart, MostMeshesAreHardlyCut) {
  Mesh mesh = octahedron();
  for (int i = 0; i < 6; ++i)
    mesh = divided(mesh);
  mesh = transformed("", mesh, someRotation());
  const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options());
  // 16386 vertices: some 256 along each half of a great circle; each edge that is crossed adds one.
  EXPECT_LT(atlas.vertices.size(), 1.25 * static_cast<double>(mesh.sphere.cols()));
  EXPECT_LT(atlas.coordinates.cols(), 1.1 * static_cast<double>(atlas.vertices.size()));
}

TEST_P(EachChart, PlacesAndDirectionsAreInverse) {
  const Positions directions = randomSphere(2000, 5);
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const Eigen::Vector2d place = chartCoordinates(options(), directions.col(i));
    EXPECT_LT((directionAt(options(), place) - directions.col(i)).norm(), 1e-14);
    EXPECT_LT((chartCoordinates(options(), 7.0 * directions.col(i)) - place).norm(), 1e-15);
  }
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) {
          const Eigen::Vector3d direction = Eigen::Vector3d(x, y, z).normalized();
          const Eigen::Vector2d place = chartCoordinates(options(), direction);
          EXPECT_LT((directionAt(options(), place) - direction).norm(), 1e-14);
        }
}

TEST_P(EachChart, OrderOfTriangles_DoesNotMatter) {
  const Mesh mesh = delaunay("", randomSphere(400, 9));
  const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options());
  const TextureAtlas reversed =
      makeTextureAtlas(mesh.triangles.rowwise().reverse(), mesh.sphere, options());
  const auto places = [](const TextureAtlas& a) {
    std::multiset<std::array<double, 6>> all;
    for (Eigen::Index t = 0; t < a.triangles.cols(); ++t) {
      const std::array<Eigen::Vector2d, 3> p = placesOf(a, t);
      all.insert({p[0].x(), p[0].y(), p[1].x(), p[1].y(), p[2].x(), p[2].y()});
    }
    return all;
  };
  EXPECT_EQ(places(atlas), places(reversed));
}

TEST_P(EachChart, EveryPixelInATriangleHasItsColor) {
  // Brute force: for all pixels, all triangles.
  for (const Mesh& mesh : {octahedron(), delaunay("random", randomSphere(300, 4)),
                           tetrahedron(someRotation()), rim(60, 1e-3, someRotation())}) {
    const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options());
    const Colors colors = 127.5 * (mesh.sphere.array() + 1.0).matrix();
    const Eigen::MatrixXd of_vertices = atCutVertices(atlas, colors);
    const TextureImage image = bakeColors(atlas, colors, {32, 0, 1});
    ASSERT_EQ(image.height, 32);
    ASSERT_EQ(image.width, GetParam() == SphereChart::Equirectangular ? 64
                           : GetParam() == SphereChart::Octahedral    ? 32
                                                                      : 48);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const auto i = static_cast<std::size_t>(y * image.width + x);
        const Eigen::Vector2d center((x + 0.5) / image.width, 1.0 - (y + 0.5) / image.height);
        bool is_covered = false;
        double nearest = 1e9;
        for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
          const std::array<Eigen::Vector2d, 3> p = placesOf(atlas, t);
          if (internal::orientation2d(p[0], p[1], p[2]) <= 0)
            continue;
          Eigen::Vector3d weights;
          bool is_inside = true;
          for (std::size_t k = 0; k < 3; ++k) {
            is_inside =
                is_inside && internal::orientation2d(p[(k + 1) % 3], p[(k + 2) % 3], center) >= 0;
            weights[static_cast<Eigen::Index>(k)] =
                doubledArea({center, p[(k + 1) % 3], p[(k + 2) % 3]}) / doubledArea(p);
          }
          if (!is_inside)
            continue;
          is_covered = true;
          Eigen::Vector3d color = Eigen::Vector3d::Zero();
          for (Eigen::Index k = 0; k < 3; ++k)
            color += weights[k] * of_vertices.col(atlas.triangles(k, t));
          const Eigen::Vector3d baked(image.pixels[3 * i], image.pixels[3 * i + 1],
                                      image.pixels[3 * i + 2]);
          nearest = std::min(nearest, (color - baked).cwiseAbs().maxCoeff());
        }
        ASSERT_EQ(image.covered[i], is_covered ? 1 : 0) << mesh.name << x << " " << y;
        if (is_covered) {
          EXPECT_LE(nearest, 0.51) << mesh.name;  // rounding, and a little for thin triangles
        }
        if (GetParam() == SphereChart::Octahedral) {
          EXPECT_TRUE(is_covered) << mesh.name << " " << x << " " << y;
        }
      }
  }
}

TEST_P(EachChart, TheGutterHasTheColorOfTheNearestPixel) {
  const Mesh mesh = delaunay("random", randomSphere(40, 6));
  TextureAtlasOptions wide = options();
  wide.margin = 0.2;
  const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, wide);
  const Colors colors = 127.5 * (mesh.sphere.array() + 1.0).matrix();
  const TextureImage plain = bakeColors(atlas, colors, {40, 0, 1});
  const int gutter = 3;
  const TextureImage image = bakeColors(atlas, colors, {40, gutter, 1});
  const auto pixel = [](const TextureImage& of, int x, int y) {
    const auto i = static_cast<std::size_t>(3 * (y * of.width + x));
    return std::array<int, 3>{of.pixels[i], of.pixels[i + 1], of.pixels[i + 2]};
  };
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      int best = std::numeric_limits<int>::max();
      std::set<std::array<int, 3>> candidates;
      for (int v = 0; v < image.height; ++v)
        for (int u = 0; u < image.width; ++u) {
          if (plain.covered[static_cast<std::size_t>(v * image.width + u)] == 0)
            continue;
          int across = std::abs(u - x);
          if (GetParam() == SphereChart::Equirectangular)
            across = std::min(across, image.width - across);
          const int squared = across * across + (v - y) * (v - y);
          if (squared < best)
            candidates.clear();
          best = std::min(best, squared);
          if (squared == best)
            candidates.insert(pixel(plain, u, v));
        }
      const int covered = image.covered[static_cast<std::size_t>(y * image.width + x)];
      ASSERT_EQ(covered, best == 0 ? 1 : best <= gutter * gutter ? 2 : 0);
      if (covered != 0) {
        EXPECT_EQ(candidates.count(pixel(image, x, y)), 1U);
      }
    }
}

TEST_P(EachChart, TheImageIsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = delaunay("random", randomSphere(3000, 8));
  const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options());
  const Colors colors = 127.5 * (mesh.sphere.array() + 1.0).matrix();
  const TextureImage one = bakeColors(atlas, colors, {200, 5, 1});
  const TextureImage board = bakeCheckerboard(atlas, mesh.sphere, 8, {200, 5, 1});
  for (const int threads : {2, 3}) {
    const TextureImage more = bakeColors(atlas, colors, {200, 5, threads});
    EXPECT_EQ(more.pixels, one.pixels);
    EXPECT_EQ(more.covered, one.covered);
    EXPECT_EQ(bakeCheckerboard(atlas, mesh.sphere, 8, {200, 5, threads}).pixels, board.pixels);
  }
}

TEST_P(EachChart, ACheckerboardShowsTheSquareOfItsDirection) {
  Mesh mesh = octahedron();
  for (int i = 0; i < 5; ++i)
    mesh = divided(mesh);
  const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options());
  const int cells = 4;
  const TextureImage image = bakeCheckerboard(atlas, mesh.sphere, cells, {96, 0, 1});
  // Colours of the same square and octant are the same, of its neighbours in the octant another.
  std::map<std::array<int, 5>, std::set<std::array<int, 3>>> seen;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto i = static_cast<std::size_t>(y * image.width + x);
      if (image.covered[i] != 1)
        continue;
      const Eigen::Vector3d d =
          directionAt(options(), {(x + 0.5) / image.width, 1.0 - (y + 0.5) / image.height});
      Eigen::Index axis = 0;
      const double depth = d.cwiseAbs().maxCoeff(&axis);
      const double s = 4.0 * std::atan(d[(axis + 1) % 3] / depth) / kPi;
      const double t = 4.0 * std::atan(d[(axis + 2) % 3] / depth) / kPi;
      const double column = (s + 1.0) / 2.0 * cells;
      const double row = (t + 1.0) / 2.0 * cells;
      // Triangles are flat in the image: not too close to a border.
      if (std::abs(column - std::round(column)) < 0.03 || std::abs(row - std::round(row)) < 0.03)
        continue;
      const int octant = (d.x() > 0 ? 1 : 0) + (d.y() > 0 ? 2 : 0) + (d.z() > 0 ? 4 : 0);
      seen[{static_cast<int>(axis), octant, static_cast<int>(column), static_cast<int>(row), 0}]
          .insert({image.pixels[3 * i], image.pixels[3 * i + 1], image.pixels[3 * i + 2]});
    }
  EXPECT_EQ(seen.size(), 6U * cells * cells);
  std::set<std::array<int, 3>> all;
  for (const auto& [square, colors] : seen) {
    EXPECT_EQ(colors.size(), 1U);
    all.insert(colors.begin(), colors.end());
    std::array<int, 5> next = square;
    ++next[2];
    const auto neighbor = seen.find(next);
    if (neighbor != seen.end()) {
      EXPECT_NE(neighbor->second, colors);
    }
  }
  EXPECT_EQ(all.size(), 16U);  // light and dark for each octant
}

TEST(Equirectangular, APoleHasACoordinateInTheMiddleOfEachOfItsTriangles) {
  const Mesh mesh = delaunay("random", randomSphere(500, 3));
  const TextureAtlas atlas =
      makeTextureAtlas(mesh.triangles, mesh.sphere, {SphereChart::Equirectangular});
  int at_poles = 0;
  for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t) {
    const std::array<Eigen::Vector2d, 3> p = placesOf(atlas, t);
    for (std::size_t k = 0; k < 3; ++k)
      if (p[k].y() == 0.0 || p[k].y() == 1.0) {
        ++at_poles;
        EXPECT_EQ(p[k].x(), (p[(k + 1) % 3].x() + p[(k + 2) % 3].x()) / 2.0);
      }
  }
  // A pole within a triangle has 3 + 4 edges at least: to the corners and along the quarters.
  EXPECT_GE(at_poles, 14);
  // The seam has both of its sides at the ends of the image.
  EXPECT_EQ(atlas.coordinates.row(0).minCoeff(), 0.0);
  EXPECT_EQ(atlas.coordinates.row(0).maxCoeff(), 1.0);
}

TEST(Equirectangular, TheImageIsCoveredButAtThePoles) {
  const Mesh mesh = delaunay("random", randomSphere(3000, 3));
  const TextureAtlas atlas =
      makeTextureAtlas(mesh.triangles, mesh.sphere, {SphereChart::Equirectangular});
  double sum = 0.0;
  for (Eigen::Index t = 0; t < atlas.triangles.cols(); ++t)
    sum += doubledArea(placesOf(atlas, t)) / 2.0;
  EXPECT_GT(sum, 0.97);
  const TextureImage image = bakeColors(atlas, Colors::Constant(3, 3000, 200.0), {100, 4, 1});
  for (int y = 8; y < image.height - 8; ++y)
    for (int x = 0; x < image.width; ++x)
      EXPECT_EQ(image.covered[static_cast<std::size_t>(y * image.width + x)], 1);
}

TEST(CubeMap, FacesKeepTheirMargins) {
  const Mesh mesh = delaunay("random", randomSphere(500, 3));
  TextureAtlasOptions options{SphereChart::CubeMap, 0.1};
  const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere, options);
  for (Eigen::Index i = 0; i < atlas.coordinates.cols(); ++i) {
    const double u = 3.0 * atlas.coordinates(0, i);
    const double v = 2.0 * atlas.coordinates(1, i);
    for (const double part : {u - std::floor(u), v - std::floor(v)}) {
      EXPECT_GE(part, 0.1 - 1e-14);
      EXPECT_LE(part, 0.9 + 1e-14);
    }
  }
  // The layout in the header: +x, -x, +y above -y, +z, -z.
  const std::array<Eigen::Vector3d, 6> axes = {Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX(),
                                               Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitY(),
                                               Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ()};
  for (std::size_t face = 0; face < 6; ++face) {
    const Eigen::Vector2d middle = chartCoordinates(options, axes[face]);
    EXPECT_NEAR(middle.x(), (static_cast<double>(face % 3) + 0.5) / 3.0, 1e-15);
    EXPECT_NEAR(middle.y(), face < 3 ? 0.75 : 0.25, 1e-15);
  }
}

TEST(ChartCoordinates, AreThoseOfTheHeader) {
  const Positions directions = randomSphere(200, 2);
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const Eigen::Vector3d d = directions.col(i);
    const Eigen::Vector2d place = chartCoordinates({SphereChart::Equirectangular}, d);
    EXPECT_NEAR(place.x(), (1.0 + std::atan2(d.y(), d.x()) / kPi) / 2.0, 1e-15);
    EXPECT_NEAR(place.y(), 0.5 + std::asin(d.z()) / kPi, 1e-14);
  }
  EXPECT_EQ(chartCoordinates({SphereChart::Octahedral}, Eigen::Vector3d::UnitZ()),
            Eigen::Vector2d(0.5, 0.5));
  EXPECT_EQ(chartCoordinates({SphereChart::Octahedral}, Eigen::Vector3d::UnitX()),
            Eigen::Vector2d(1.0, 0.5));
  const Eigen::Vector2d corner =
      chartCoordinates({SphereChart::Octahedral}, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ((corner.array() - 0.5).abs().minCoeff(), 0.5);
}

TEST(TextureAtlas, RefusesMapsThatAreNotOneToOne) {
  const Mesh mesh = delaunay("random", randomSphere(50, 3));
  Triangles open = mesh.triangles.leftCols(mesh.triangles.cols() - 1);
  EXPECT_THROW(makeTextureAtlas(open, mesh.sphere), InvalidInput);
  Triangles inward = mesh.triangles;
  flipOrientation(inward);
  EXPECT_THROW(makeTextureAtlas(inward, mesh.sphere), InvalidInput);
  EXPECT_THROW(makeTextureAtlas(mesh.triangles, 2.0 * mesh.sphere), InvalidInput);
  EXPECT_THROW(makeTextureAtlas(mesh.triangles, mesh.sphere.leftCols(49)), InvalidInput);
  EXPECT_THROW(makeTextureAtlas(Triangles(3, 0), Positions(3, 0)), InvalidInput);
  Positions broken = mesh.sphere;
  broken(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(makeTextureAtlas(mesh.triangles, broken), InvalidInput);
  Positions flipped = mesh.sphere;
  flipped.col(3).swap(flipped.col(4));
  EXPECT_THROW(makeTextureAtlas(mesh.triangles, flipped), InvalidInput);
  for (const double margin : {-0.1, 0.25, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(makeTextureAtlas(mesh.triangles, mesh.sphere, {SphereChart::CubeMap, margin}),
                 InvalidInput);
  EXPECT_THROW(chartCoordinates({}, Eigen::Vector3d::Zero()), InvalidInput);
}

TEST(TextureAtlas, RefusesOptionsOutOfRangeAndColorsThatDoNotMatch) {
  const Mesh mesh = octahedron();
  const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere);
  const Colors colors = Colors::Constant(3, 6, 100.0);
  EXPECT_NO_THROW(bakeColors(atlas, colors, {16, 0, 1}));
  for (const BakeOptions& wrong :
       {BakeOptions{15, 0, 1}, BakeOptions{16385, 0, 1}, BakeOptions{16, -1, 1},
        BakeOptions{16, 257, 1}, BakeOptions{16, 0, -1}, BakeOptions{16, 0, 1025}}) {
    EXPECT_THROW(bakeColors(atlas, colors, wrong), InvalidInput);
    EXPECT_THROW(bakeCheckerboard(atlas, mesh.sphere, 8, wrong), InvalidInput);
  }
  EXPECT_THROW(bakeColors(atlas, colors.leftCols(5)), InvalidInput);
  EXPECT_THROW(bakeColors(atlas, Colors::Constant(3, 7, 100.0)), InvalidInput);
  EXPECT_THROW(bakeColors(atlas, Colors::Constant(3, 6, 256.0)), InvalidInput);
  EXPECT_THROW(bakeColors(atlas, Colors::Constant(3, 6, std::nan(""))), InvalidInput);
  EXPECT_THROW(bakeCheckerboard(atlas, mesh.sphere, 0), InvalidInput);
  EXPECT_THROW(bakeCheckerboard(atlas, mesh.sphere.leftCols(5)), InvalidInput);
}

}  // namespace
