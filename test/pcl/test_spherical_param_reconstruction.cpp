#include "spherical_param/errors.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/option_table.h"
#include "spherical_param/point_set.h"
#include "spherical_param/self_intersection.h"

#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/brute_force.h>
#include <pcl/search/flann_search.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/octree.h>
#include <pcl/search/organized.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

using pcl::Indices;
using pcl::PointXYZ;
using spherical_param::EdgeWeights;
using spherical_param::EmbeddingMethod;
using spherical_param::GraphMethod;
using spherical_param::OptimizationMethod;
using spherical_param::Progress;
using spherical_param::SurfaceKind;
using spherical_param::TriangulationMethod;
using Cloud = pcl::PointCloud<PointXYZ>;
using Reconstruction = pcl::SphericalParamReconstruction<PointXYZ>;
using Polygons = std::vector<pcl::Vertices>;
using Search = pcl::search::Search<PointXYZ>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Points spread evenly over an ellipsoid, in the order of a spiral; the axes differ so that no two
/// distances are the same.
template <typename PointT = PointXYZ>
typename pcl::PointCloud<PointT>::Ptr makeEllipsoid(int count) {
  typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = i * 2.399963229728653;  // the golden angle
    PointT point{};
    point.x = static_cast<float>(1.5 * radius * std::cos(angle) + 0.1);
    point.y = static_cast<float>(1.1 * radius * std::sin(angle) - 0.2);
    point.z = static_cast<float>(0.8 * z);
    cloud->push_back(point);
  }
  return cloud;
}

/// 0 ... count - 1 in a random order that is the same in each run.
Indices shuffledIndices(int count) {
  Indices indices(static_cast<std::size_t>(count));
  std::iota(indices.begin(), indices.end(), 0);
  std::mt19937 generator(7);
  // std::shuffle differs between standard libraries.
  for (std::size_t i = indices.size(); i > 1; --i)
    std::swap(indices[i - 1], indices[generator() % i]);
  return indices;
}

pcl::IndicesPtr share(const Indices& indices) {
  return pcl::IndicesPtr(new Indices(indices));
}

std::vector<Indices> asLists(const Polygons& polygons) {
  std::vector<Indices> lists;
  for (const pcl::Vertices& polygon : polygons)
    lists.push_back(polygon.vertices);
  return lists;
}

std::set<pcl::index_t> usedVertices(const Polygons& polygons) {
  std::set<pcl::index_t> used;
  for (const pcl::Vertices& polygon : polygons)
    used.insert(polygon.vertices.begin(), polygon.vertices.end());
  return used;
}

/// Six times the volume that closed, outward-oriented triangles enclose.
template <typename PointT>
double sixfoldVolume(const Polygons& polygons, const pcl::PointCloud<PointT>& cloud) {
  double volume = 0.0;
  for (const pcl::Vertices& polygon : polygons) {
    Eigen::Matrix3d corners;
    for (int corner = 0; corner < 3; ++corner)
      corners.col(corner) =
          cloud[static_cast<std::size_t>(polygon.vertices[static_cast<std::size_t>(corner)])]
              .getVector3fMap()
              .template cast<double>();
    volume += corners.determinant();
  }
  return volume;
}

/// Expects triangles that are closed, manifold, oriented outward, in one piece and of genus 0, with
/// exactly the given vertices.
template <typename PointT>
void expectSphere(const Polygons& polygons, const pcl::PointCloud<PointT>& cloud,
                  const std::set<pcl::index_t>& vertices) {
  using Edge = std::pair<pcl::index_t, pcl::index_t>;
  // The third corner of the triangle at the left of each directed edge.
  std::map<Edge, pcl::index_t> corner_of_edge;
  std::map<pcl::index_t, std::size_t> triangles_of_vertex;
  for (const pcl::Vertices& polygon : polygons) {
    ASSERT_EQ(polygon.vertices.size(), 3U);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Edge edge(polygon.vertices[corner], polygon.vertices[(corner + 1) % 3]);
      ASSERT_NE(edge.first, edge.second);
      ASSERT_TRUE(corner_of_edge.emplace(edge, polygon.vertices[(corner + 2) % 3]).second)
          << "edge " << edge.first << " " << edge.second << " has two triangles at one side";
      ++triangles_of_vertex[edge.first];
    }
  }
  for (const auto& [edge, corner] : corner_of_edge)
    ASSERT_EQ(corner_of_edge.count({edge.second, edge.first}), 1U)
        << "edge " << edge.first << " " << edge.second << " is open";

  ASSERT_EQ(usedVertices(polygons), vertices);
  const auto v = static_cast<long long>(vertices.size());
  const auto e = static_cast<long long>(corner_of_edge.size() / 2);
  const auto f = static_cast<long long>(polygons.size());
  EXPECT_EQ(v - e + f, 2);

  // Vertex-manifold: the fan that starts at any edge of a vertex holds all of its triangles. With
  // it, V - E + F = 2 and one piece, the surface is a sphere.
  std::set<pcl::index_t> fans_checked;
  for (const auto& [edge, unused] : corner_of_edge) {
    if (!fans_checked.insert(edge.first).second)
      continue;
    std::size_t fan = 0;
    pcl::index_t spoke = edge.second;
    do {
      spoke = corner_of_edge.at({edge.first, spoke});
      ++fan;
    } while (spoke != edge.second && fan <= triangles_of_vertex.at(edge.first));
    EXPECT_EQ(fan, triangles_of_vertex.at(edge.first)) << "at vertex " << edge.first;
  }

  std::map<pcl::index_t, std::vector<pcl::index_t>> neighbors;
  for (const auto& [edge, unused] : corner_of_edge)
    neighbors[edge.first].push_back(edge.second);
  std::set<pcl::index_t> reached{*vertices.begin()};
  std::vector<pcl::index_t> open(reached.begin(), reached.end());
  while (!open.empty()) {
    const pcl::index_t vertex = open.back();
    open.pop_back();
    for (const pcl::index_t neighbor : neighbors[vertex])
      if (reached.insert(neighbor).second)
        open.push_back(neighbor);
  }
  EXPECT_EQ(reached.size(), vertices.size()) << "the mesh is in pieces";

  EXPECT_GT(sixfoldVolume(polygons, cloud), 0.0);
}

template <typename PointT>
void expectSphere(const Polygons& polygons, const pcl::PointCloud<PointT>& cloud) {
  std::set<pcl::index_t> all;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    all.insert(static_cast<pcl::index_t>(i));
  expectSphere(polygons, cloud, all);
}

/// Expects that nothing of an earlier run is left.
void expectCleared(const Reconstruction& reconstruction) {
  EXPECT_NE(reconstruction.getErrorMessage(), "");
  const spherical_param::Result& result = reconstruction.getResult();
  EXPECT_EQ(result.triangles.cols(), 0);
  EXPECT_EQ(result.sphere.cols(), 0);
  EXPECT_TRUE(result.vertex_of_input.empty());
  EXPECT_TRUE(result.input_of_vertex.empty());
  EXPECT_TRUE(result.embedding.residuals.empty());
  EXPECT_TRUE(result.stages.empty());
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_TRUE(reconstruction.getUsedIndices().empty());
  EXPECT_TRUE(reconstruction.getVertexIndices().empty());
  EXPECT_EQ(reconstruction.getIgnoredPointCount(), 0U);
  EXPECT_TRUE(reconstruction.getSelfIntersections().empty());
  EXPECT_TRUE(reconstruction.getDiagnosis().summary.empty());
  EXPECT_TRUE(result.runs.empty());
  ASSERT_TRUE(reconstruction.getSphereCoordinates());
  EXPECT_TRUE(reconstruction.getSphereCoordinates()->empty());
  ASSERT_TRUE(reconstruction.getSmoothedPoints());
  EXPECT_TRUE(reconstruction.getSmoothedPoints()->empty());
}

void expectEmpty(const pcl::PolygonMesh& mesh) {
  EXPECT_TRUE(mesh.polygons.empty());
  EXPECT_EQ(mesh.cloud.width, 0U);
  EXPECT_EQ(mesh.cloud.height, 0U);
  EXPECT_TRUE(mesh.cloud.data.empty());
}

/// What a caller might reuse.
pcl::PolygonMesh makeStaleMesh() {
  pcl::PolygonMesh mesh;
  pcl::toPCLPointCloud2(*makeEllipsoid(10), mesh.cloud);
  mesh.polygons.resize(5);
  for (pcl::Vertices& polygon : mesh.polygons)
    polygon.vertices = {1000, 1001, 1002};
  mesh.header.frame_id = "stale";
  return mesh;
}

/// Runs both overloads on outputs that are not empty and expects that both fail cleanly.
/// \return the error message.
std::string expectFailure(Reconstruction& reconstruction) {
  pcl::PolygonMesh mesh = makeStaleMesh();
  reconstruction.reconstruct(mesh);
  expectEmpty(mesh);
  expectCleared(reconstruction);
  const std::string message = reconstruction.getErrorMessage();

  Polygons polygons = makeStaleMesh().polygons;
  reconstruction.reconstruct(polygons);
  EXPECT_TRUE(polygons.empty());
  expectCleared(reconstruction);
  EXPECT_EQ(reconstruction.getErrorMessage(), message);
  return message;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The method of Zwicker and Gotsman 2004.
template <typename PointT>
void setPapersMethod(pcl::SphericalParamReconstruction<PointT>& reconstruction) {
  reconstruction.setGraphMethod(GraphMethod::NearestNeighbors);
  reconstruction.setEmbeddingMethod(EmbeddingMethod::Iterative);
  reconstruction.setTriangulationMethod(TriangulationMethod::Qhull);
  reconstruction.setOptimizationMethod(OptimizationMethod::None);
}

Polygons reconstructPolygons(Reconstruction& reconstruction) {
  Polygons polygons;
  reconstruction.reconstruct(polygons);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  return polygons;
}

/// Silences PCL, since most of the tests here provoke failures.
class SphericalParamReconstruction : public testing::Test {
protected:
  void SetUp() override { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }
  void TearDown() override { pcl::console::setVerbosityLevel(pcl::console::L_INFO); }
};

// ---------------------------------------------------------------------------------------- the mesh

TEST_F(SphericalParamReconstruction, EveryPointIsAVertexOfAClosedOutwardGenus0Mesh) {
  const Cloud::Ptr cloud = makeEllipsoid(1000);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  expectSphere(mesh.polygons, *cloud);
  EXPECT_TRUE(reconstruction.getResult().topology.isSphere());
}

TEST_F(SphericalParamReconstruction, PapersMethodMeshesEveryPointToo) {
  const Cloud::Ptr cloud = makeEllipsoid(1000);
  Reconstruction reconstruction;
  setPapersMethod(reconstruction);
  reconstruction.setInputCloud(cloud);
  expectSphere(reconstructPolygons(reconstruction), *cloud);
  const spherical_param::Result& result = reconstruction.getResult();
  // The traces of the three stages: a graph of 25 neighbours, iterations, no levels.
  EXPECT_GE(result.graph.edges, 1000U * 25U / 2U);
  EXPECT_GT(result.embedding.iterations, 10);
  EXPECT_TRUE(result.embedding.levels.empty());
}

TEST_F(SphericalParamReconstruction, FourPointsGiveATetrahedron) {
  Cloud::Ptr cloud(new Cloud);
  cloud->push_back(PointXYZ(0.0F, 0.0F, 0.0F));
  cloud->push_back(PointXYZ(1.0F, 0.0F, 0.0F));
  cloud->push_back(PointXYZ(0.0F, 1.0F, 0.0F));
  cloud->push_back(PointXYZ(0.0F, 0.0F, 1.0F));
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  const Polygons polygons = reconstructPolygons(reconstruction);
  EXPECT_EQ(polygons.size(), 4U);
  expectSphere(polygons, *cloud);
}

TEST_F(SphericalParamReconstruction, FewerThanFourDistinctPointsFail) {
  for (int count = 1; count < 4; ++count) {
    Cloud::Ptr cloud = makeEllipsoid(count);
    cloud->push_back(cloud->front());  // a repetition makes no fourth point
    cloud->push_back(PointXYZ(kNan, 0.0F, 0.0F));
    Reconstruction reconstruction;
    reconstruction.setInputCloud(cloud);
    const std::string message = expectFailure(reconstruction);
    EXPECT_TRUE(contains(message, "at least 4")) << message;
    EXPECT_TRUE(contains(message, "1 are not finite")) << message;
  }
}

TEST_F(SphericalParamReconstruction, CoplanarPointsFail) {
  Cloud::Ptr cloud = makeEllipsoid(100);
  for (PointXYZ& point : *cloud)
    point.z = 0.25F;
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  const std::string message = expectFailure(reconstruction);
  EXPECT_TRUE(contains(message, "plane")) << message;
}

TEST_F(SphericalParamReconstruction, DuplicatesBecomeTheVertexOfTheFirstOfThem) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  for (int repetition = 0; repetition < 40; ++repetition)  // more than k at one place
    cloud->push_back((*cloud)[17]);
  for (std::size_t i = 100; i < 200; ++i)
    cloud->push_back((*cloud)[i]);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  const Polygons polygons = reconstructPolygons(reconstruction);
  std::set<pcl::index_t> firsts;
  for (pcl::index_t i = 0; i < 300; ++i)
    firsts.insert(i);
  expectSphere(polygons, *cloud, firsts);
  EXPECT_EQ(reconstruction.getResult().duplicates(), 140U);
  EXPECT_EQ(reconstruction.getIgnoredPointCount(), 0U);
  EXPECT_EQ(reconstruction.getUsedIndices().size(), 440U);

  // They neither fill each other's neighbour lists nor change those of others.
  Reconstruction without;
  without.setInputCloud(makeEllipsoid(300));
  EXPECT_EQ(asLists(polygons), asLists(reconstructPolygons(without)));
}

TEST_F(SphericalParamReconstruction, MeshDoesNotDependOnTheScaleOfTheCloud) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(300));
  const std::vector<Indices> expected = asLists(reconstructPolygons(reconstruction));
  // Squared distances of the small cloud underflow in float, those of the large one overflow.
  for (const int exponent : {-100, -20, 20, 120}) {
    const Cloud::Ptr cloud = makeEllipsoid(300);
    for (PointXYZ& point : *cloud)
      for (float& coordinate : point.data)
        coordinate = std::ldexp(coordinate, exponent);
    reconstruction.setInputCloud(cloud);
    EXPECT_EQ(asLists(reconstructPolygons(reconstruction)), expected) << "2^" << exponent;
  }
}

// ------------------------------------------------------------------------------- input and indices

TEST_F(SphericalParamReconstruction, NullCloudFails) {
  Reconstruction reconstruction;
  EXPECT_TRUE(contains(expectFailure(reconstruction), "setInputCloud"));
  reconstruction.setInputCloud(Cloud::ConstPtr());
  EXPECT_TRUE(contains(expectFailure(reconstruction), "setInputCloud"));
}

TEST_F(SphericalParamReconstruction, EmptyCloudFails) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(Cloud::Ptr(new Cloud));
  EXPECT_TRUE(contains(expectFailure(reconstruction), "empty"));
}

TEST_F(SphericalParamReconstruction, EmptyIndicesFail) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(100));
  reconstruction.setIndices(share({}));
  EXPECT_TRUE(contains(expectFailure(reconstruction), "indices are empty"));
}

TEST_F(SphericalParamReconstruction, NullIndicesMeanAllPoints) {
  const Cloud::Ptr cloud = makeEllipsoid(100);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share({1, 2, 3, 4, 5}));
  EXPECT_EQ(reconstructPolygons(reconstruction).size(), 6U);
  reconstruction.setIndices(pcl::IndicesPtr());
  expectSphere(reconstructPolygons(reconstruction), *cloud);
}

TEST_F(SphericalParamReconstruction, IndicesAreNotKeptFromAnotherCloud) {
  Reconstruction reconstruction;
  for (const int count : {500, 60, 200}) {
    const Cloud::Ptr cloud = makeEllipsoid(count);
    reconstruction.setInputCloud(cloud);
    expectSphere(reconstructPolygons(reconstruction), *cloud);
    EXPECT_EQ(reconstruction.getSphereCoordinates()->size(), cloud->size());
  }
}

TEST_F(SphericalParamReconstruction, PolygonsOfASubsetIndexTheWholeCloud) {
  const Cloud::Ptr cloud = makeEllipsoid(600);
  Indices every_third;
  for (pcl::index_t i = 1; i < 600; i += 3)
    every_third.push_back(i);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(every_third));
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  expectSphere(mesh.polygons, *cloud, {every_third.begin(), every_third.end()});
  EXPECT_EQ(mesh.cloud.width, 600U) << "the output cloud is the whole input";
  EXPECT_EQ(reconstruction.getUsedIndices(), every_third);
}

TEST_F(SphericalParamReconstruction, MeshOfASubsetIsThatOfACloudOfItsPoints) {
  const Cloud::Ptr cloud = makeEllipsoid(500);
  Indices subset = shuffledIndices(500);
  subset.resize(300);
  Cloud::Ptr part(new Cloud(*cloud, subset));
  Reconstruction of_subset;
  of_subset.setInputCloud(cloud);
  of_subset.setIndices(share(subset));
  Reconstruction of_part;
  of_part.setInputCloud(part);
  std::vector<Indices> expected = asLists(reconstructPolygons(of_part));
  for (Indices& triangle : expected)
    for (pcl::index_t& vertex : triangle)
      vertex = subset[static_cast<std::size_t>(vertex)];
  EXPECT_EQ(asLists(reconstructPolygons(of_subset)), expected);
}

TEST_F(SphericalParamReconstruction, IndicesMayHaveAnyOrder) {
  const Cloud::Ptr cloud = makeEllipsoid(500);
  Indices descending(500);
  std::iota(descending.rbegin(), descending.rend(), 0);
  for (const Indices& order : {descending, shuffledIndices(500)}) {
    Reconstruction reconstruction;
    reconstruction.setInputCloud(cloud);
    reconstruction.setIndices(share(order));
    expectSphere(reconstructPolygons(reconstruction), *cloud);
    EXPECT_EQ(reconstruction.getUsedIndices(), order);
    EXPECT_EQ(reconstruction.getVertexIndices(), order);
  }
}

TEST_F(SphericalParamReconstruction, IndicesMayComeInAllTypesOfPcl) {
  const Cloud::Ptr cloud = makeEllipsoid(100);
  const Indices subset{3, 1, 4, 15, 92, 65, 35, 89, 79};
  const std::set<pcl::index_t> vertices(subset.begin(), subset.end());
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(pcl::IndicesConstPtr(share(subset)));
  expectSphere(reconstructPolygons(reconstruction), *cloud, vertices);
  pcl::PointIndices::Ptr point_indices(new pcl::PointIndices);
  point_indices->indices = subset;
  reconstruction.setIndices(pcl::PointIndices::ConstPtr(point_indices));
  expectSphere(reconstructPolygons(reconstruction), *cloud, vertices);
  cloud->width = 10;
  cloud->height = 10;
  reconstruction.setIndices(2, 1, 3, 4);  // rows 2 to 4, columns 1 to 4
  expectSphere(reconstructPolygons(reconstruction), *cloud,
               {21, 22, 23, 24, 31, 32, 33, 34, 41, 42, 43, 44});
}

TEST_F(SphericalParamReconstruction, IndicesOutOfRangeFail) {
  for (const pcl::index_t wrong : {-1, 100, std::numeric_limits<pcl::index_t>::max(),
                                   std::numeric_limits<pcl::index_t>::min()}) {
    Indices indices = shuffledIndices(100);
    indices[42] = wrong;
    Reconstruction reconstruction;
    reconstruction.setInputCloud(makeEllipsoid(100));
    reconstruction.setIndices(share(indices));
    const std::string message = expectFailure(reconstruction);
    EXPECT_TRUE(contains(message, "entry 42 of the indices is " + std::to_string(wrong)))
        << message;
  }
}

TEST_F(SphericalParamReconstruction, IndicesOfAShrunkenCloudFail) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(100));
  reconstruction.setIndices(share(shuffledIndices(100)));
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  reconstruction.setInputCloud(makeEllipsoid(50));
  EXPECT_TRUE(contains(expectFailure(reconstruction), "50 points"));
}

TEST_F(SphericalParamReconstruction, RepeatedIndicesCountOnceAtTheirFirstPlace) {
  const Cloud::Ptr cloud = makeEllipsoid(200);
  const Indices once = shuffledIndices(200);
  Indices repeated;
  for (std::size_t i = 0; i < once.size(); ++i) {
    repeated.push_back(once[i]);
    repeated.push_back(once[i / 2]);
  }
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(once));
  const std::vector<Indices> expected = asLists(reconstructPolygons(reconstruction));
  reconstruction.setIndices(share(repeated));
  const Polygons polygons = reconstructPolygons(reconstruction);
  expectSphere(polygons, *cloud);
  EXPECT_EQ(asLists(polygons), expected);
  EXPECT_EQ(reconstruction.getUsedIndices(), once);
  EXPECT_EQ(reconstruction.getResult().duplicates(), 0U);
}

TEST_F(SphericalParamReconstruction, NonFinitePointsAreSkippedWhateverIsDenseSays) {
  for (const bool is_dense : {true, false}) {
    const Cloud::Ptr cloud = makeEllipsoid(400);
    (*cloud)[0].x = kNan;
    (*cloud)[7].y = kNan;
    (*cloud)[8].z = kInfinity;
    (*cloud)[9].x = -kInfinity;
    (*cloud)[399] = PointXYZ(kNan, kNan, kNan);
    cloud->is_dense = is_dense;
    std::set<pcl::index_t> finite;
    for (pcl::index_t i = 1; i < 399; ++i)
      if (i < 7 || i > 9)
        finite.insert(i);
    Reconstruction reconstruction;
    reconstruction.setInputCloud(cloud);
    pcl::PolygonMesh mesh;
    reconstruction.reconstruct(mesh);
    EXPECT_EQ(reconstruction.getErrorMessage(), "");
    expectSphere(mesh.polygons, *cloud, finite);
    EXPECT_EQ(reconstruction.getIgnoredPointCount(), 5U);
    EXPECT_EQ(mesh.cloud.width, 400U);
    EXPECT_EQ(mesh.cloud.is_dense != 0, is_dense);
  }
}

TEST_F(SphericalParamReconstruction, OnlyNonFinitePointsOfTheIndicesAreCounted) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  for (std::size_t i = 0; i < 300; i += 10)
    (*cloud)[i].z = kNan;
  Indices first_half(150);
  std::iota(first_half.begin(), first_half.end(), 0);
  first_half.push_back(0);  // a repetition is not counted twice
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(first_half));
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  EXPECT_EQ(reconstruction.getIgnoredPointCount(), 15U);
  EXPECT_EQ(reconstruction.getUsedIndices().size(), 135U);
}

TEST_F(SphericalParamReconstruction, CloudWithoutAFinitePointFails) {
  const Cloud::Ptr cloud = makeEllipsoid(50);
  for (PointXYZ& point : *cloud)
    point.y = kNan;
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  EXPECT_TRUE(contains(expectFailure(reconstruction), "50 are not finite"));
}

TEST_F(SphericalParamReconstruction, OrganizedCloudWithNanIsMeshedByTheDefaultSearch) {
  for (const bool is_dense : {true, false}) {
    const Cloud::Ptr cloud = makeEllipsoid(600);
    cloud->width = 30;
    cloud->height = 20;
    cloud->is_dense = is_dense;
    std::set<pcl::index_t> finite;
    for (pcl::index_t i = 0; i < 600; ++i)
      if (i % 30 == 4)
        (*cloud)[static_cast<std::size_t>(i)] = PointXYZ(kNan, kNan, kNan);
      else
        finite.insert(i);
    Reconstruction reconstruction;
    reconstruction.setInputCloud(cloud);
    pcl::PolygonMesh mesh;
    reconstruction.reconstruct(mesh);
    EXPECT_EQ(reconstruction.getErrorMessage(), "");
    expectSphere(mesh.polygons, *cloud, finite);
    EXPECT_EQ(mesh.cloud.width, 30U);
    EXPECT_EQ(mesh.cloud.height, 20U);
    EXPECT_FALSE(reconstruction.getSearchMethod());
  }
}

TEST_F(SphericalParamReconstruction, CloudWhoseSizeContradictsItsWidthAndHeightFails) {
  const Cloud::Ptr cloud = makeEllipsoid(100);
  cloud->width = 7;
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  EXPECT_TRUE(contains(expectFailure(reconstruction), "width"));
}

TEST_F(SphericalParamReconstruction, CloudWithoutWidthAndHeightIsMeshed) {
  const Cloud::Ptr cloud = makeEllipsoid(100);
  cloud->width = 0;
  cloud->height = 0;
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  expectSphere(mesh.polygons, *cloud);
  EXPECT_EQ(mesh.cloud.width, 100U);
}

// ------------------------------------------------------------------------------ search of the user

Search::Ptr makeFlannSearch() {
  using Flann = pcl::search::FlannSearch<PointXYZ>;
  return Search::Ptr(
      new Flann(false, Flann::FlannIndexCreatorPtr(new Flann::KdTreeIndexCreator(15))));
}

Search::Ptr makeApproximateFlannSearch() {
  using Flann = pcl::search::FlannSearch<PointXYZ>;
  return Search::Ptr(
      new Flann(false, Flann::FlannIndexCreatorPtr(new Flann::KdTreeMultiIndexCreator(4))));
}

struct NamedSearch {
  const char* name;
  std::function<Search::Ptr()> make;
};

class UserSearch : public testing::TestWithParam<NamedSearch> {};

INSTANTIATE_TEST_SUITE_P(
    AllTypes, UserSearch,
    testing::Values(
        NamedSearch{"KdTree", [] { return Search::Ptr(new pcl::search::KdTree<PointXYZ>(false)); }},
        NamedSearch{"SortedKdTree",
                    [] { return Search::Ptr(new pcl::search::KdTree<PointXYZ>(true)); }},
        NamedSearch{"Octree", [] { return Search::Ptr(new pcl::search::Octree<PointXYZ>(0.1)); }},
        NamedSearch{"BruteForce",
                    [] { return Search::Ptr(new pcl::search::BruteForce<PointXYZ>()); }},
        NamedSearch{"FlannSearch", makeFlannSearch}),
    [](const testing::TestParamInfo<NamedSearch>& parameter) {
      return std::string(parameter.param.name);
    });

TEST_P(UserSearch, GivesTheMeshOfTheDefaultSearch) {
  const Cloud::Ptr cloud = makeEllipsoid(400);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  const std::vector<Indices> expected = asLists(reconstructPolygons(reconstruction));
  const Search::Ptr search = GetParam().make();
  reconstruction.setSearchMethod(search);
  EXPECT_EQ(asLists(reconstructPolygons(reconstruction)), expected);
  EXPECT_EQ(reconstruction.getSearchMethod(), search);
  EXPECT_EQ(search->getInputCloud(), cloud) << "the search was not used";
}

// PCL's searches answer with indices of the cloud or with positions in the subset, depending on
// their type: a mistake in the mapping gives another mesh.
TEST_P(UserSearch, GivesTheMeshOfTheDefaultSearchOnASubsetWithNanAndDuplicates) {
  for (const bool is_dense : {true, false}) {
    const Cloud::Ptr cloud = makeEllipsoid(600);
    for (std::size_t i = 0; i < 600; i += 7)
      (*cloud)[i].x = kNan;
    for (std::size_t i = 1; i < 600; i += 25)
      (*cloud)[i] = (*cloud)[i + 2];
    cloud->is_dense = is_dense;
    Indices subset = shuffledIndices(600);
    subset.resize(450);
    Reconstruction reconstruction;
    reconstruction.setInputCloud(cloud);
    reconstruction.setIndices(share(subset));
    const Polygons expected = reconstructPolygons(reconstruction);
    ASSERT_FALSE(expected.empty());
    reconstruction.setSearchMethod(GetParam().make());
    const Polygons polygons = reconstructPolygons(reconstruction);
    EXPECT_EQ(asLists(polygons), asLists(expected));
    const Indices& vertices = reconstruction.getVertexIndices();
    expectSphere(polygons, *cloud, {vertices.begin(), vertices.end()});
  }
}

TEST_P(UserSearch, GivesTheMeshOfTheDefaultSearchOnAPermutation) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(shuffledIndices(300)));
  const std::vector<Indices> expected = asLists(reconstructPolygons(reconstruction));
  reconstruction.setSearchMethod(GetParam().make());
  EXPECT_EQ(asLists(reconstructPolygons(reconstruction)), expected);
}

TEST_P(UserSearch, WorksWithFourPoints) {
  const Cloud::Ptr cloud = makeEllipsoid(30);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share({29, 3, 0, 11}));
  reconstruction.setSearchMethod(GetParam().make());
  expectSphere(reconstructPolygons(reconstruction), *cloud, {0, 3, 11, 29});
}

TEST_F(SphericalParamReconstruction, ApproximateSearchOfTheUserGivesASphere) {
  const Cloud::Ptr cloud = makeEllipsoid(600);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(shuffledIndices(600)));
  reconstruction.setSearchMethod(makeApproximateFlannSearch());
  expectSphere(reconstructPolygons(reconstruction), *cloud);
}

TEST_F(SphericalParamReconstruction, DefaultSearchIsNotKept) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(100));
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  EXPECT_FALSE(reconstruction.getSearchMethod());
}

TEST_F(SphericalParamReconstruction, UserSearchCanBeUnset) {
  Reconstruction reconstruction;
  const Cloud::Ptr cloud = makeEllipsoid(100);
  reconstruction.setInputCloud(cloud);
  const Search::Ptr search(new pcl::search::BruteForce<PointXYZ>());
  reconstruction.setSearchMethod(search);
  expectSphere(reconstructPolygons(reconstruction), *cloud);
  reconstruction.setSearchMethod(Search::Ptr());
  reconstruction.setInputCloud(makeEllipsoid(50));
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  EXPECT_EQ(search->getInputCloud(), cloud);
}

/// A depth image of a ball by a pinhole camera; NaN around the ball.
Cloud::Ptr makeDepthImage() {
  Cloud::Ptr cloud(new Cloud(40, 30));
  const Eigen::Vector3d center(0.03, 0.017, 2.0);
  for (std::uint32_t row = 0; row < cloud->height; ++row)
    for (std::uint32_t column = 0; column < cloud->width; ++column) {
      const Eigen::Vector3d ray =
          Eigen::Vector3d((column - 19.5) / 60.0, (row - 14.5) / 60.0, 1.0).normalized();
      const double along = ray.dot(center);
      const double discriminant = along * along - center.squaredNorm() + 0.5 * 0.5;
      PointXYZ& point = (*cloud)(column, row);
      if (discriminant < 0.0)
        point = PointXYZ(kNan, kNan, kNan);
      else
        point.getVector3fMap() = (ray * (along - std::sqrt(discriminant))).cast<float>();
    }
  cloud->is_dense = false;
  return cloud;
}

TEST_F(SphericalParamReconstruction, OrganizedNeighborOfTheUserWorksOnADepthImageWithNan) {
  const Cloud::Ptr cloud = makeDepthImage();
  Indices subset;
  std::set<pcl::index_t> finite;
  for (pcl::index_t i = 0; i < static_cast<pcl::index_t>(cloud->size()); ++i)
    if (std::isfinite((*cloud)[static_cast<std::size_t>(i)].x) && i % 5 != 0) {
      finite.insert(i);
      subset.push_back(i);
    }
  ASSERT_GT(finite.size(), 400U);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(subset));
  const Polygons by_default = reconstructPolygons(reconstruction);
  const std::size_t edges = reconstruction.getResult().graph.edges;
  reconstruction.setSearchMethod(Search::Ptr(new pcl::search::OrganizedNeighbor<PointXYZ>()));
  const Polygons polygons = reconstructPolygons(reconstruction);
  // A depth image shows one side only; the mesh is closed nevertheless.
  expectSphere(polygons, *cloud, finite);
  EXPECT_EQ(reconstruction.getResult().graph.edges, edges);
  EXPECT_EQ(asLists(polygons), asLists(by_default));
}

TEST_F(SphericalParamReconstruction, OrganizedNeighborOfTheUserFailsOnAnUnorganizedCloud) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(100));
  reconstruction.setSearchMethod(Search::Ptr(new pcl::search::OrganizedNeighbor<PointXYZ>()));
  EXPECT_TRUE(contains(expectFailure(reconstruction), "not organized"));
}

TEST_F(SphericalParamReconstruction, OrganizedNeighborOfTheUserFailsWithoutAPinholeCamera) {
  const Cloud::Ptr cloud = makeEllipsoid(600);
  cloud->width = 30;
  cloud->height = 20;
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  const Search::Ptr search(new pcl::search::OrganizedNeighbor<PointXYZ>());
  reconstruction.setSearchMethod(search);
  EXPECT_TRUE(contains(expectFailure(reconstruction), "pinhole"));
  // Not even with the camera of another image, which PCL keeps.
  reconstruction.setInputCloud(makeDepthImage());
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  reconstruction.setInputCloud(cloud);
  EXPECT_TRUE(contains(expectFailure(reconstruction), "pinhole"));
}

/// An unusual but allowed search: it sorts in descending order, leaves the query point out and
/// finds fewer than it is asked for.
class OddSearch : public Search {
public:
  explicit OddSearch(int at_most) : Search("OddSearch"), at_most_(at_most) {}

  void setInputCloud(const Cloud::ConstPtr& cloud, const pcl::IndicesConstPtr& indices) override {
    Search::setInputCloud(cloud, indices);
    exact_.setInputCloud(cloud, indices);
  }

  int nearestKSearch(const PointXYZ& point, int k, Indices& indices,
                     std::vector<float>& distances) const override {
    int found = exact_.nearestKSearch(point, k, indices, distances);
    std::reverse(indices.begin(), indices.end());
    std::reverse(distances.begin(), distances.end());
    if (k > 1)
      --found;  // the nearest, which is the query point, is the last now
    return std::min(found, at_most_);
  }

  int radiusSearch(const PointXYZ& /*point*/, double /*radius*/, Indices& /*indices*/,
                   std::vector<float>& /*distances*/, unsigned int /*max_nn*/) const override {
    throw std::logic_error("radiusSearch");
  }

protected:
  pcl::search::BruteForce<PointXYZ> exact_;
  int at_most_;
};

TEST_F(SphericalParamReconstruction, SearchNeitherSortedNorWithTheQueryPointWorks) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  const std::vector<Indices> expected = asLists(reconstructPolygons(reconstruction));
  reconstruction.setSearchMethod(Search::Ptr(new OddSearch(1000)));
  EXPECT_EQ(asLists(reconstructPolygons(reconstruction)), expected);
}

TEST_F(SphericalParamReconstruction, SearchThatFindsFewPointsWorks) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  for (const int at_most : {0, 1, 7}) {
    Reconstruction reconstruction;
    reconstruction.setInputCloud(cloud);
    reconstruction.setSearchMethod(Search::Ptr(new OddSearch(at_most)));
    expectSphere(reconstructPolygons(reconstruction), *cloud);
  }
}

TEST_F(SphericalParamReconstruction, SearchThatFindsNothingFailsOnASubset) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(300));
  reconstruction.setIndices(share(shuffledIndices(300)));
  reconstruction.setSearchMethod(Search::Ptr(new OddSearch(0)));
  EXPECT_TRUE(contains(expectFailure(reconstruction), "search object"));
}

/// Answers with one index that it was not given, or throws.
class WrongSearch : public OddSearch {
public:
  explicit WrongSearch(std::function<pcl::index_t()> wrong)
      : OddSearch(1000), wrong_(std::move(wrong)) {}

  int nearestKSearch(const PointXYZ& point, int k, Indices& indices,
                     std::vector<float>& distances) const override {
    const int found = exact_.nearestKSearch(point, k, indices, distances);
    if (k > 1)
      indices.back() = wrong_();
    return found;
  }

private:
  std::function<pcl::index_t()> wrong_;
};

TEST_F(SphericalParamReconstruction, SearchThatAnswersWithWrongIndicesFails) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  (*cloud)[5].x = kNan;
  // Out of the cloud on both sides, and in the cloud but not among the points that were asked for.
  for (const pcl::index_t wrong : {-1, 300, 1000000000, 5}) {
    Reconstruction reconstruction;
    reconstruction.setInputCloud(cloud);
    reconstruction.setSearchMethod(Search::Ptr(new WrongSearch([wrong] { return wrong; })));
    const std::string message = expectFailure(reconstruction);
    EXPECT_TRUE(contains(message, "index " + std::to_string(wrong))) << message;
  }
}

TEST_F(SphericalParamReconstruction, ExceptionsOfASearchBecomeAMessage) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(100));
  reconstruction.setSearchMethod(Search::Ptr(
      new WrongSearch([]() -> pcl::index_t { throw std::runtime_error("index broken"); })));
  EXPECT_TRUE(contains(expectFailure(reconstruction), "index broken"));
  reconstruction.setSearchMethod(
      Search::Ptr(new WrongSearch([]() -> pcl::index_t { throw std::bad_alloc(); })));
  EXPECT_TRUE(contains(expectFailure(reconstruction), "out of memory"));
  reconstruction.setSearchMethod(Search::Ptr(new WrongSearch([]() -> pcl::index_t { throw 42; })));
  EXPECT_TRUE(contains(expectFailure(reconstruction), "unknown"));
  reconstruction.setSearchMethod(Search::Ptr());
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
}

// ------------------------------------------------------------------------------------------ output

template <typename PointT>
class StandardPointType : public testing::Test {};
using StandardPointTypes =
    testing::Types<pcl::PointXYZ, pcl::PointXYZI, pcl::PointXYZRGB, pcl::PointXYZRGBA,
                   pcl::PointNormal, pcl::PointXYZRGBNormal, pcl::PointXYZINormal>;
struct StandardPointTypeName {
  template <typename PointT>
  static std::string GetName(int index) {
    return std::array{"PointXYZ",    "PointXYZI",         "PointXYZRGB",    "PointXYZRGBA",
                      "PointNormal", "PointXYZRGBNormal", "PointXYZINormal"}
        .at(static_cast<std::size_t>(index));
  }
};
TYPED_TEST_SUITE(StandardPointType, StandardPointTypes, StandardPointTypeName);

TYPED_TEST(StandardPointType, WorksThroughMeshConstruction) {
  const auto cloud = makeEllipsoid<TypeParam>(300);
  typename pcl::MeshConstruction<TypeParam>::Ptr mesher(
      new pcl::SphericalParamReconstruction<TypeParam>);
  mesher->setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  mesher->reconstruct(mesh);
  expectSphere(mesh.polygons, *cloud);
  Polygons polygons;
  mesher->reconstruct(polygons);
  EXPECT_EQ(asLists(polygons), asLists(mesh.polygons));
  mesher->setSearchMethod(
      typename pcl::search::Search<TypeParam>::Ptr(new pcl::search::KdTree<TypeParam>));
  mesher->reconstruct(polygons);
  EXPECT_EQ(asLists(polygons), asLists(mesh.polygons));
}

TYPED_TEST(StandardPointType, FailsThroughMeshConstructionWithoutAnInput) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  typename pcl::MeshConstruction<TypeParam>::Ptr mesher(
      new pcl::SphericalParamReconstruction<TypeParam>);
  pcl::PolygonMesh mesh = makeStaleMesh();
  mesher->reconstruct(mesh);
  expectEmpty(mesh);
  pcl::console::setVerbosityLevel(pcl::console::L_INFO);
}

TYPED_TEST(StandardPointType, HeaderAndAllFieldsAreKept) {
  const auto cloud = makeEllipsoid<TypeParam>(100);
  std::mt19937 generator(3);
  for (TypeParam& point : *cloud) {
    if constexpr (pcl::traits::has_field<TypeParam, pcl::fields::intensity>::value)
      point.intensity = static_cast<float>(generator() % 1000);
    if constexpr (pcl::traits::has_normal<TypeParam>::value) {
      point.normal_x = static_cast<float>(generator() % 1000);
      point.curvature = static_cast<float>(generator() % 1000);
    }
    if constexpr (pcl::traits::has_color<TypeParam>::value) {
      point.r = static_cast<std::uint8_t>(generator() % 256);
      point.g = static_cast<std::uint8_t>(generator() % 256);
    }
  }
  (*cloud)[50].x = kNan;  // skipped, but not lost
  cloud->header.seq = 12;
  cloud->header.stamp = 3456789;
  cloud->header.frame_id = "scanner";

  pcl::SphericalParamReconstruction<TypeParam> reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(shuffledIndices(80)));
  pcl::PolygonMesh mesh = makeStaleMesh();
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  ASSERT_FALSE(mesh.polygons.empty());

  for (const pcl::PCLHeader& header : {mesh.header, mesh.cloud.header}) {
    EXPECT_EQ(header.seq, 12U);
    EXPECT_EQ(header.stamp, 3456789U);
    EXPECT_EQ(header.frame_id, "scanner");
  }
  pcl::PCLPointCloud2 expected;
  pcl::toPCLPointCloud2(*cloud, expected);
  EXPECT_EQ(mesh.cloud.data, expected.data);
  EXPECT_EQ(mesh.cloud.width, expected.width);
  EXPECT_EQ(mesh.cloud.height, expected.height);
  EXPECT_EQ(mesh.cloud.point_step, expected.point_step);
  EXPECT_EQ(mesh.cloud.row_step, expected.row_step);
  ASSERT_EQ(mesh.cloud.fields.size(), expected.fields.size());
  for (std::size_t i = 0; i < expected.fields.size(); ++i) {
    EXPECT_EQ(mesh.cloud.fields[i].name, expected.fields[i].name);
    EXPECT_EQ(mesh.cloud.fields[i].offset, expected.fields[i].offset);
  }
}

TEST_F(SphericalParamReconstruction, WorksThroughPclSurfaceBase) {
  const Cloud::Ptr cloud = makeEllipsoid(100);
  const pcl::PCLSurfaceBase<PointXYZ>::Ptr mesher(new Reconstruction);
  mesher->setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  mesher->reconstruct(mesh);
  expectSphere(mesh.polygons, *cloud);
}

TEST_F(SphericalParamReconstruction, StaleOutputIsReplaced) {
  const Cloud::Ptr cloud = makeEllipsoid(200);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh = makeStaleMesh();
  reconstruction.reconstruct(mesh);
  expectSphere(mesh.polygons, *cloud);
  EXPECT_EQ(mesh.header.frame_id, "");
  reconstruction.reconstruct(mesh);
  expectSphere(mesh.polygons, *cloud);
  Polygons polygons = makeStaleMesh().polygons;
  reconstruction.reconstruct(polygons);
  expectSphere(polygons, *cloud);
}

TEST_F(SphericalParamReconstruction, AllOverloadsAgree) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(500));
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(asLists(reconstructPolygons(reconstruction)), asLists(mesh.polygons));
  const spherical_param::Triangles triangles = reconstruction.getResult().triangles;
  reconstruction.reconstruct();
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  EXPECT_EQ(reconstruction.getResult().triangles, triangles);
  EXPECT_EQ(reconstruction.getVertexIndices().size(), 500U);
}

TEST_F(SphericalParamReconstruction, ReconstructWithoutOutputSaysWhatIsWrong) {
  Reconstruction reconstruction;
  reconstruction.reconstruct();
  EXPECT_TRUE(contains(reconstruction.getErrorMessage(), "no input cloud"));
  expectCleared(reconstruction);
}

TEST_F(SphericalParamReconstruction, FailureAfterSuccessLeavesNothingStale) {
  Reconstruction reconstruction;
  const Cloud::Ptr cloud = makeEllipsoid(200);
  cloud->header.frame_id = "scanner";
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  ASSERT_FALSE(mesh.polygons.empty());
  reconstruction.setKSearch(1);
  reconstruction.reconstruct(mesh);
  expectEmpty(mesh);
  expectCleared(reconstruction);
  EXPECT_EQ(mesh.header.frame_id, "scanner");
  // And a success after it leaves no message.
  reconstruction.setKSearch(12);
  reconstruction.reconstruct(mesh);
  expectSphere(mesh.polygons, *cloud);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
}

TEST_F(SphericalParamReconstruction, FailureIsPrintedOnceWithTheNameOfTheClass) {
  pcl::console::setVerbosityLevel(pcl::console::L_INFO);
  for (const bool with_cloud : {false, true}) {
    Reconstruction reconstruction;
    if (with_cloud)
      reconstruction.setInputCloud(makeEllipsoid(2));
    pcl::PolygonMesh mesh;
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    reconstruction.reconstruct(mesh);
    const std::string errors = testing::internal::GetCapturedStderr();
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_TRUE(contains(errors, "[pcl::SphericalParamReconstruction::reconstruct] " +
                                     reconstruction.getErrorMessage()))
        << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
  }
}

TEST_F(SphericalParamReconstruction, SuccessPrintsNothing) {
  pcl::console::setVerbosityLevel(pcl::console::L_INFO);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(100));
  pcl::PolygonMesh mesh;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_FALSE(mesh.polygons.empty());
}

// ------------------------------------------------------------------------------------------ result

TEST_F(SphericalParamReconstruction, SphereCoordinatesFitThePolygons) {
  const Cloud::Ptr cloud = makeEllipsoid(400);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  const Polygons polygons = reconstructPolygons(reconstruction);
  const Cloud::Ptr sphere = reconstruction.getSphereCoordinates();
  ASSERT_EQ(sphere->size(), cloud->size());
  EXPECT_TRUE(sphere->is_dense);
  for (const PointXYZ& point : *sphere)
    EXPECT_NEAR(point.getVector3fMap().norm(), 1.0F, 1e-6F);  // of float
  for (const pcl::Vertices& polygon : polygons) {
    Eigen::Matrix3f corners;
    for (int corner = 0; corner < 3; ++corner)
      corners.col(corner) =
          (*sphere)[static_cast<std::size_t>(polygon.vertices[static_cast<std::size_t>(corner)])]
              .getVector3fMap();
    EXPECT_GT(corners.determinant(), 0.0F) << "a triangle faces inward on the sphere";
  }
}

TEST_F(SphericalParamReconstruction, SphereCoordinatesOfSkippedPointsAreNan) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  (*cloud)[10].x = kNan;
  (*cloud)[20] = (*cloud)[30];
  Indices indices = shuffledIndices(200);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(indices));
  const std::set<pcl::index_t> vertices = usedVertices(reconstructPolygons(reconstruction));
  const Cloud::Ptr sphere = reconstruction.getSphereCoordinates();
  ASSERT_EQ(sphere->size(), 300U);
  EXPECT_FALSE(sphere->is_dense);
  for (pcl::index_t i = 0; i < 300; ++i) {
    const Eigen::Vector3f point = (*sphere)[static_cast<std::size_t>(i)].getVector3fMap();
    if (i == 10 || i >= 200) {
      EXPECT_TRUE(point.array().isNaN().all()) << i;
    } else {
      EXPECT_NEAR(point.norm(), 1.0F, 1e-6F) << i;
    }
    EXPECT_TRUE(vertices.count(i) == 0 || point.allFinite());
  }
  // Of the two at one place one is a vertex; both are at its place on the sphere.
  EXPECT_EQ(vertices.count(20) + vertices.count(30), 1U);
  EXPECT_EQ((*sphere)[20].getVector3fMap(), (*sphere)[30].getVector3fMap());
}

TEST_F(SphericalParamReconstruction, SphereCoordinatesOutliveTheInput) {
  Reconstruction reconstruction;
  EXPECT_TRUE(reconstruction.getSphereCoordinates()->empty());
  reconstruction.setInputCloud(makeEllipsoid(120));
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  reconstruction.setInputCloud(makeEllipsoid(5));
  EXPECT_EQ(reconstruction.getSphereCoordinates()->size(), 120U);
}

TEST_F(SphericalParamReconstruction, ResultNamesTheTrianglesOfThePolygons) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  (*cloud)[4].z = kNan;
  (*cloud)[9] = (*cloud)[8];
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(shuffledIndices(300)));
  const Polygons polygons = reconstructPolygons(reconstruction);
  const spherical_param::Result& result = reconstruction.getResult();
  const Indices& used = reconstruction.getUsedIndices();
  const Indices& vertices = reconstruction.getVertexIndices();
  ASSERT_EQ(used.size(), 299U);
  ASSERT_EQ(result.vertex_of_input.size(), used.size());
  ASSERT_EQ(vertices.size(), 298U);
  ASSERT_EQ(result.vertexCount(), vertices.size());
  EXPECT_EQ(result.duplicates(), 1U);
  for (std::size_t v = 0; v < vertices.size(); ++v)
    EXPECT_EQ(vertices[v], used[static_cast<std::size_t>(result.input_of_vertex[v])]);
  ASSERT_EQ(static_cast<std::size_t>(result.triangles.cols()), polygons.size());
  for (std::size_t t = 0; t < polygons.size(); ++t)
    for (int corner = 0; corner < 3; ++corner)
      EXPECT_EQ(polygons[t].vertices[static_cast<std::size_t>(corner)],
                vertices[static_cast<std::size_t>(
                    result.triangles(corner, static_cast<Eigen::Index>(t)))]);
}

/// A mesh of polygons in the types of the core, with a point for each of a cloud.
struct CoreMesh {
  spherical_param::Positions points;
  spherical_param::Triangles triangles;
};

CoreMesh toCore(const Polygons& polygons, const Cloud& cloud) {
  CoreMesh mesh{spherical_param::Positions(3, static_cast<Eigen::Index>(cloud.size())),
                spherical_param::Triangles(3, static_cast<Eigen::Index>(polygons.size()))};
  for (std::size_t i = 0; i < cloud.size(); ++i)
    mesh.points.col(static_cast<Eigen::Index>(i)) = cloud[i].getVector3fMap().cast<double>();
  for (std::size_t t = 0; t < polygons.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner)
      mesh.triangles(static_cast<Eigen::Index>(corner), static_cast<Eigen::Index>(t)) =
          polygons[t].vertices[corner];
  return mesh;
}

/// Moves each point of a cloud at random, the same in each run.
void addNoise(Cloud& cloud, float size) {
  std::mt19937 generator(5);
  const auto step = [&] {
    return size * (static_cast<float>(generator() % 2001) / 1000.0F - 1.0F);
  };
  for (PointXYZ& point : cloud) {
    point.x += step();
    point.y += step();
    point.z += step();
  }
}

TEST_F(SphericalParamReconstruction, SelfIntersectionsAreThoseOfThePolygons) {
  const Cloud::Ptr cloud = makeEllipsoid(1000);
  addNoise(*cloud, 0.3F);  // three times the distance of neighbours
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(shuffledIndices(1000)));
  reconstruction.setOptimizationMethod(OptimizationMethod::None);
  const CoreMesh mesh = toCore(reconstructPolygons(reconstruction), *cloud);
  EXPECT_FALSE(reconstruction.getSelfIntersections().empty());
  EXPECT_EQ(reconstruction.getSelfIntersections(),
            spherical_param::findSelfIntersections(mesh.points, mesh.triangles));
}

TEST_F(SphericalParamReconstruction, MeshOfACleanScanDoesNotIntersectItselfAndLooksClosed) {
  const Cloud::Ptr cloud = makeEllipsoid(2000);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  const CoreMesh mesh = toCore(reconstructPolygons(reconstruction), *cloud);
  EXPECT_TRUE(spherical_param::findSelfIntersections(mesh.points, mesh.triangles).empty());
  EXPECT_TRUE(reconstruction.getSelfIntersections().empty());
  EXPECT_TRUE(reconstruction.getDiagnosis().looksClosedGenus0());
  ASSERT_EQ(reconstruction.getResult().runs.size(), 1U);
  EXPECT_TRUE(reconstruction.getResult().runs[0].chosen);
  const spherical_param::MeshMeasures expected =
      spherical_param::measureMesh(mesh.points, mesh.triangles);
  const spherical_param::MeshMeasures& measures = reconstruction.getResult().measures;
  EXPECT_NEAR(measures.volume, expected.volume, 1e-12 * expected.volume);
  EXPECT_NEAR(measures.area, expected.area, 1e-12 * expected.area);
  EXPECT_LT((measures.centroid - expected.centroid).norm(), 1e-12);
  EXPECT_EQ(measures.box_max, expected.box_max);
}

// The upper third is missing: the diagnosis reports it, in terms of the vertices.
TEST_F(SphericalParamReconstruction, VertexIndicesMapFindingsToTheCloud) {
  const Cloud::Ptr cloud = makeEllipsoid(3000);
  Indices indices;
  for (const pcl::index_t i : shuffledIndices(3000))
    if ((*cloud)[static_cast<std::size_t>(i)].z < 0.3F)
      indices.push_back(i);
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(indices));
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  const spherical_param::SurfaceDiagnosis& diagnosis = reconstruction.getDiagnosis();
  EXPECT_EQ(diagnosis.kind, SurfaceKind::Open);
  ASSERT_EQ(diagnosis.filled_holes.size(), 1U);
  // Neighbours are some 0.07 apart.
  EXPECT_NEAR(diagnosis.filled_holes[0].center.z(), 0.3, 0.1);
  EXPECT_FALSE(diagnosis.filled_holes[0].vertices.empty());
  for (const spherical_param::Index vertex : diagnosis.filled_holes[0].vertices) {
    const pcl::index_t point = reconstruction.getVertexIndices()[static_cast<std::size_t>(vertex)];
    EXPECT_NEAR((*cloud)[static_cast<std::size_t>(point)].z, 0.3F, 0.1F);
  }
}

TEST_F(SphericalParamReconstruction, SmoothedPointsFitThePolygonsAndLeaveTheMeshAlone) {
  const Cloud::Ptr cloud = makeEllipsoid(2000);
  addNoise(*cloud, 0.04F);
  (*cloud)[10].x = kNan;
  (*cloud)[20] = (*cloud)[30];
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setIndices(share(shuffledIndices(1900)));
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  EXPECT_TRUE(reconstruction.getSmoothedPoints()->empty());

  reconstruction.setSmoothing(5);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  pcl::PCLPointCloud2 input;
  pcl::toPCLPointCloud2(*cloud, input);
  EXPECT_EQ(mesh.cloud.data, input.data);

  const Cloud::Ptr smoothed = reconstruction.getSmoothedPoints();
  ASSERT_EQ(smoothed->size(), cloud->size());
  EXPECT_FALSE(smoothed->is_dense);
  const auto shift = [&](std::size_t i) {
    return ((*smoothed)[i].getVector3fMap() - (*cloud)[i].getVector3fMap()).norm();
  };
  float largest = 0.0F;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (i == 10 || i >= 1900) {
      EXPECT_TRUE((*smoothed)[i].getVector3fMap().array().isNaN().all()) << i;
    } else {
      largest = std::max(largest, shift(i));
    }
  }
  EXPECT_EQ((*smoothed)[20].getVector3fMap(), (*smoothed)[30].getVector3fMap());
  const spherical_param::SmoothingReport& report = reconstruction.getResult().smoothing;
  // Coordinates around 1 in float.
  EXPECT_NEAR(static_cast<double>(largest), report.max_displacement, 1e-6);
  EXPECT_GT(largest, 0.01F);
  EXPECT_EQ(report.self_intersections, 0U);
  EXPECT_NEAR(sixfoldVolume(mesh.polygons, *smoothed) / 6.0, report.volume_after, 1e-5);
  EXPECT_EQ(spherical_param::findSelfIntersections(reconstruction.getResult().smoothed,
                                                   reconstruction.getResult().triangles)
                .size(),
            report.self_intersections);
}

// ----------------------------------------------------------------------------------------- options

/// A setter, and what it sets.
struct Setter {
  const char* option;  ///< name in the table of options
  spherical_param::OptionValue value;
  std::function<void(Reconstruction&)> set;
  std::function<bool(const Reconstruction&)> is_returned;  ///< by the getter
};

std::vector<Setter> allSetters() {
  return {
      {"graph", "knn", [](Reconstruction& r) { r.setGraphMethod(GraphMethod::NearestNeighbors); },
       [](const Reconstruction& r) { return r.getGraphMethod() == GraphMethod::NearestNeighbors; }},
      {"k", std::int64_t{17}, [](Reconstruction& r) { r.setKSearch(17); },
       [](const Reconstruction& r) { return r.getKSearch() == 17; }},
      {"embedding", "iterative",
       [](Reconstruction& r) { r.setEmbeddingMethod(EmbeddingMethod::Iterative); },
       [](const Reconstruction& r) {
         return r.getEmbeddingMethod() == EmbeddingMethod::Iterative;
       }},
      {"weights", "inverse", [](Reconstruction& r) { r.setWeights(EdgeWeights::InverseLength); },
       [](const Reconstruction& r) { return r.getWeights() == EdgeWeights::InverseLength; }},
      {"tolerance", 1e-5, [](Reconstruction& r) { r.setTolerance(1e-5); },
       [](const Reconstruction& r) { return r.getTolerance() == 1e-5; }},
      {"triangulation", "qhull",
       [](Reconstruction& r) { r.setTriangulationMethod(TriangulationMethod::Qhull); },
       [](const Reconstruction& r) {
         return r.getTriangulationMethod() == TriangulationMethod::Qhull;
       }},
      {"optimization", "flips",
       [](Reconstruction& r) { r.setOptimizationMethod(OptimizationMethod::Flips); },
       [](const Reconstruction& r) {
         return r.getOptimizationMethod() == OptimizationMethod::Flips;
       }},
      {"smoothing", std::int64_t{8}, [](Reconstruction& r) { r.setSmoothing(8); },
       [](const Reconstruction& r) { return r.getSmoothing() == 8; }},
      {"retries", std::int64_t{9}, [](Reconstruction& r) { r.setRetries(9); },
       [](const Reconstruction& r) { return r.getRetries() == 9; }},
      {"seed", std::int64_t{4294967295}, [](Reconstruction& r) { r.setSeed(4294967295U); },
       [](const Reconstruction& r) { return r.getSeed() == 4294967295U; }},
      {"threads", std::int64_t{3}, [](Reconstruction& r) { r.setNumberOfThreads(3); },
       [](const Reconstruction& r) { return r.getNumberOfThreads() == 3U; }},
  };
}

TEST_F(SphericalParamReconstruction, EachSetterSetsItsOptionAndNoOther) {
  for (const Setter& setter : allSetters()) {
    Reconstruction reconstruction;
    EXPECT_FALSE(setter.is_returned(reconstruction)) << setter.option;
    setter.set(reconstruction);
    EXPECT_TRUE(setter.is_returned(reconstruction)) << setter.option;
    spherical_param::Options expected;
    spherical_param::setOption(expected, setter.option, setter.value);
    for (const spherical_param::OptionRow& row : spherical_param::optionTable())
      EXPECT_EQ(row.get(reconstruction.getOptions()), row.get(expected))
          << setter.option << " changed " << row.name;
  }
}

TEST_F(SphericalParamReconstruction, OptionsSetAtOnceReplaceThoseOfTheSetters) {
  Reconstruction reconstruction;
  reconstruction.setSmoothing(9);
  spherical_param::Options options;
  options.graph.k = 17;
  options.embedding.weights = EdgeWeights::Uniform;
  reconstruction.setOptions(options);
  EXPECT_EQ(reconstruction.getKSearch(), 17);
  EXPECT_EQ(reconstruction.getWeights(), EdgeWeights::Uniform);
  EXPECT_EQ(reconstruction.getSmoothing(), 0);
  reconstruction.setSeed(6);
  EXPECT_EQ(reconstruction.getOptions().seed, 6U);
  EXPECT_EQ(reconstruction.getOptions().graph.k, 17);
}

TEST_F(SphericalParamReconstruction, UnsetOptionsHaveTheDefaultOfTheMethod) {
  Reconstruction reconstruction;
  EXPECT_EQ(reconstruction.getKSearch(), 12);
  reconstruction.setGraphMethod(GraphMethod::NearestNeighbors);
  EXPECT_EQ(reconstruction.getKSearch(), 25);
  EXPECT_FALSE(reconstruction.getTolerance().has_value());
  reconstruction.setTolerance(1e-3);
  reconstruction.setTolerance(std::nullopt);
  EXPECT_FALSE(reconstruction.getTolerance().has_value());
  EXPECT_FALSE(reconstruction.getProgressCallback());
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
}

spherical_param::Positions positionsOf(const Cloud& cloud) {
  spherical_param::Positions points(3, static_cast<Eigen::Index>(cloud.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = cloud[i].getVector3fMap().cast<double>();
  return points;
}

/// Options of which each has an influence on the result.
std::vector<spherical_param::Options> differentOptions() {
  std::vector<spherical_param::Options> all(3);
  all[1].graph.method = GraphMethod::NearestNeighbors;
  all[1].embedding.method = EmbeddingMethod::Iterative;
  all[1].embedding.max_iterations = 50;
  all[1].triangulation.method = TriangulationMethod::Qhull;
  all[1].optimization.method = OptimizationMethod::None;
  all[2].graph.k = 8;
  all[2].embedding.weights = EdgeWeights::Uniform;
  all[2].embedding.tolerance = 1e-6;
  all[2].smoothing.steps = 4;
  all[2].seed = 99;
  return all;
}

void expectSameResult(const spherical_param::Result& result,
                      const spherical_param::Result& expected) {
  EXPECT_EQ(result.triangles, expected.triangles);
  EXPECT_EQ(result.sphere, expected.sphere);
  EXPECT_EQ(result.smoothed, expected.smoothed);
  EXPECT_EQ(result.self_intersections, expected.self_intersections);
  EXPECT_EQ(result.graph.edges, expected.graph.edges);
  EXPECT_EQ(result.graph.searched_again, expected.graph.searched_again);
  EXPECT_EQ(result.embedding.residuals, expected.embedding.residuals);
}

TEST_F(SphericalParamReconstruction, ResultIsThatOfTheCoreOnTheSamePoints) {
  const Cloud::Ptr cloud = makeEllipsoid(1200);  // enough that the graph is coarsened
  for (const spherical_param::Options& options : differentOptions()) {
    Reconstruction reconstruction;
    reconstruction.setOptions(options);
    reconstruction.setInputCloud(cloud);
    EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
    expectSameResult(reconstruction.getResult(),
                     spherical_param::reconstruct(positionsOf(*cloud), options));
  }
}

/// Brute-force neighbours.
spherical_param::NeighborLists findNeighbors(const spherical_param::Positions& points,
                                             const std::vector<spherical_param::Index>& queries,
                                             int count) {
  spherical_param::NeighborLists lists;
  for (const spherical_param::Index i : queries) {
    std::vector<std::pair<double, spherical_param::Index>> by_distance;
    for (Eigen::Index j = 0; j < points.cols(); ++j)
      by_distance.emplace_back((points.col(i) - points.col(j)).squaredNorm(),
                               static_cast<spherical_param::Index>(j));
    std::sort(by_distance.begin(), by_distance.end());
    const std::size_t found = std::min(static_cast<std::size_t>(count) + 1, by_distance.size());
    for (std::size_t j = 0; j < found; ++j)
      lists.indices.push_back(by_distance[j].second);
    lists.offsets.push_back(lists.indices.size());
  }
  return lists;
}

TEST_F(SphericalParamReconstruction, ResultWithAUserSearchIsThatOfTheCoreWithItsLists) {
  const Cloud::Ptr cloud = makeEllipsoid(1200);
  const spherical_param::Positions points = positionsOf(*cloud);
  std::vector<spherical_param::Index> all(cloud->size());
  std::iota(all.begin(), all.end(), 0);
  const auto search = [&](const std::vector<spherical_param::Index>& queries, int count) {
    return findNeighbors(points, queries, count);
  };
  for (const spherical_param::Options& options : differentOptions()) {
    Reconstruction reconstruction;
    reconstruction.setOptions(options);
    reconstruction.setInputCloud(cloud);
    reconstruction.setSearchMethod(Search::Ptr(new pcl::search::BruteForce<PointXYZ>()));
    EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
    expectSameResult(reconstruction.getResult(),
                     spherical_param::reconstruct(
                         points, search(all, spherical_param::neighborsToSearch(options.graph)),
                         options, search));
  }
}

TEST_F(SphericalParamReconstruction, OptionsOutOfRangeFail) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, std::function<void(Reconstruction&)>>> mistakes{
      {"k = 2", [](Reconstruction& r) { r.setKSearch(2); }},
      {"k = -7", [](Reconstruction& r) { r.setKSearch(-7); }},
      {"tolerance", [](Reconstruction& r) { r.setTolerance(-1e-9); }},
      {"tolerance", [nan](Reconstruction& r) { r.setTolerance(nan); }},
      {"retries", [](Reconstruction& r) { r.setRetries(-1); }},
      {"retries", [](Reconstruction& r) { r.setRetries(100); }},
      {"smoothing", [](Reconstruction& r) { r.setSmoothing(-1); }},
      {"smoothing", [](Reconstruction& r) { r.setSmoothing(10001); }},
      {"damping",
       [](Reconstruction& r) {
         spherical_param::Options options;
         options.embedding.damping = 0.0;
         r.setOptions(options);
       }},
      {"threads",
       [](Reconstruction& r) { r.setNumberOfThreads(std::numeric_limits<unsigned int>::max()); }},
  };
  for (const auto& [word, make] : mistakes)
    for (const bool with_search : {false, true}) {
      Reconstruction reconstruction;
      reconstruction.setInputCloud(makeEllipsoid(100));
      if (with_search)
        reconstruction.setSearchMethod(Search::Ptr(new pcl::search::BruteForce<PointXYZ>()));
      make(reconstruction);
      const std::string message = expectFailure(reconstruction);
      EXPECT_TRUE(contains(message, word)) << word << ": " << message;
    }
}

// ---------------------------------------------------------------------------------------- progress

TEST_F(SphericalParamReconstruction, ProgressOfAllStagesComesFromTheCallingThread) {
  for (const bool with_search : {false, true}) {
    const std::thread::id caller = std::this_thread::get_id();
    std::map<std::string, int> reports;
    std::vector<std::string> stages;  // by their first report
    Reconstruction reconstruction;
    reconstruction.setInputCloud(makeEllipsoid(6000));  // enough to search in parallel
    if (with_search)
      reconstruction.setSearchMethod(Search::Ptr(new pcl::search::KdTree<PointXYZ>()));
    reconstruction.setNumberOfThreads(4);
    reconstruction.setSmoothing(2);
    reconstruction.setProgressCallback([&](const Progress& progress) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      EXPECT_GE(progress.fraction, 0.0);
      EXPECT_LE(progress.fraction, 1.0);
      if (reports[progress.stage]++ == 0)
        stages.emplace_back(progress.stage);
      return true;
    });
    EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
    EXPECT_EQ(stages, (std::vector<std::string>{"neighbors", "graph", "embedding", "triangulation",
                                                "optimization", "smoothing", "quality"}));
    EXPECT_GE(reports["neighbors"], 3);
  }
}

TEST_F(SphericalParamReconstruction, CallbackChangesNoResult) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(300));
  const std::vector<Indices> expected = asLists(reconstructPolygons(reconstruction));
  reconstruction.setProgressCallback([](const Progress&) { return true; });
  EXPECT_EQ(asLists(reconstructPolygons(reconstruction)), expected);
}

TEST_F(SphericalParamReconstruction, CancellationInAnyStageFails) {
  for (const std::string stage :
       {"neighbors", "graph", "embedding", "triangulation", "optimization", "smoothing", "quality"})
    for (const double from : {0.0, 1.0}) {
      Reconstruction reconstruction;
      const Cloud::Ptr cloud = makeEllipsoid(200);
      reconstruction.setInputCloud(cloud);
      reconstruction.setSmoothing(2);
      reconstruction.setProgressCallback([&](const Progress& progress) {
        return progress.stage != stage || progress.fraction < from;
      });
      const std::string message = expectFailure(reconstruction);
      EXPECT_TRUE(contains(message, "cancelled")) << stage << ": " << message;
      reconstruction.setProgressCallback({});
      expectSphere(reconstructPolygons(reconstruction), *cloud);
    }
}

TEST_F(SphericalParamReconstruction, CancellationWorksWithASearchOfTheUser) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(200));
  reconstruction.setSearchMethod(Search::Ptr(new pcl::search::BruteForce<PointXYZ>()));
  reconstruction.setProgressCallback(
      [](const Progress& progress) { return progress.fraction < 0.5; });
  EXPECT_TRUE(contains(expectFailure(reconstruction), "cancelled"));
}

TEST_F(SphericalParamReconstruction, ExceptionsOfTheCallbackPassAndLeaveTheObjectClean) {
  for (const std::string stage : {"neighbors", "graph", "embedding", "triangulation", "quality"}) {
    Reconstruction reconstruction;
    const Cloud::Ptr cloud = makeEllipsoid(200);
    reconstruction.setInputCloud(cloud);
    EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
    reconstruction.setProgressCallback([&](const Progress& progress) -> bool {
      if (progress.stage == stage)
        throw std::domain_error("mine");
      return true;
    });
    pcl::PolygonMesh mesh = makeStaleMesh();
    EXPECT_THROW(reconstruction.reconstruct(mesh), std::domain_error) << stage;
    expectEmpty(mesh);
    expectCleared(reconstruction);
    Polygons polygons = makeStaleMesh().polygons;
    EXPECT_THROW(reconstruction.reconstruct(polygons), std::domain_error) << stage;
    EXPECT_TRUE(polygons.empty());
    expectCleared(reconstruction);
    reconstruction.setProgressCallback([](const Progress&) -> bool { throw 5; });
    EXPECT_THROW(reconstruction.reconstruct(mesh), int);
    reconstruction.setProgressCallback({});
    expectSphere(reconstructPolygons(reconstruction), *cloud);
  }
}

TEST_F(SphericalParamReconstruction, CallbackMayReplaceItself) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeEllipsoid(100));
  int calls = 0;
  reconstruction.setProgressCallback([&](const Progress&) {
    ++calls;
    reconstruction.setProgressCallback({});
    return true;
  });
  EXPECT_FALSE(reconstructPolygons(reconstruction).empty());
  EXPECT_GT(calls, 1);
}

// ----------------------------------------------------------------------------------------- threads

TEST_F(SphericalParamReconstruction, ThreadCountDoesNotChangeTheResult) {
  const Cloud::Ptr cloud = makeEllipsoid(6000);  // enough to search in parallel
  std::vector<Indices> expected;
  spherical_param::Positions sphere;
  for (const unsigned int threads : {1U, 2U, 3U, 4U, 0U}) {
    Reconstruction reconstruction;
    reconstruction.setInputCloud(cloud);
    reconstruction.setNumberOfThreads(threads);
    const std::vector<Indices> lists = asLists(reconstructPolygons(reconstruction));
    ASSERT_EQ(lists.size(), 2 * cloud->size() - 4);
    if (threads == 1U) {
      expected = lists;
      sphere = reconstruction.getResult().sphere;
    }
    EXPECT_EQ(lists, expected) << threads;
    EXPECT_EQ(reconstruction.getResult().sphere, sphere) << threads;
  }
}

TEST_F(SphericalParamReconstruction, TwoObjectsInTwoThreadsGiveWhatEachGivesAlone) {
  const std::vector<Cloud::Ptr> clouds{makeEllipsoid(700), makeEllipsoid(900)};
  const auto run = [&](std::size_t i) {
    Reconstruction reconstruction;
    reconstruction.setInputCloud(clouds[i % 2]);
    if (i == 1)  // of its own, not shared
      reconstruction.setSearchMethod(Search::Ptr(new pcl::search::Octree<PointXYZ>(0.1)));
    if (i == 2)
      setPapersMethod(reconstruction);
    pcl::PolygonMesh mesh;
    reconstruction.reconstruct(mesh);
    const spherical_param::Positions& sphere = reconstruction.getResult().sphere;
    return std::make_pair(asLists(mesh.polygons),
                          std::vector<double>(sphere.data(), sphere.data() + sphere.size()));
  };
  std::vector<decltype(run(0))> together(5);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < together.size(); ++i)
    threads.emplace_back([&, i] { together[i] = run(i); });
  for (std::thread& thread : threads)
    thread.join();
  for (std::size_t i = 0; i < together.size(); ++i) {
    const auto alone = run(i);
    EXPECT_FALSE(alone.first.empty());
    EXPECT_EQ(together[i].first, alone.first);
    EXPECT_EQ(together[i].second.size(), alone.second.size());
    EXPECT_EQ(std::memcmp(together[i].second.data(), alone.second.data(),
                          alone.second.size() * sizeof(double)),
              0);
  }
}

TEST_F(SphericalParamReconstruction, CopiesAreIndependent) {
  Reconstruction first;
  first.setInputCloud(makeEllipsoid(200));
  first.setKSearch(10);
  const std::vector<Indices> expected = asLists(reconstructPolygons(first));
  Reconstruction second = first;
  second.setInputCloud(makeEllipsoid(100));
  EXPECT_EQ(reconstructPolygons(second).size(), 196U);
  EXPECT_EQ(first.getVertexIndices().size(), 200U);
  EXPECT_EQ(asLists(reconstructPolygons(first)), expected);
}

}  // namespace
