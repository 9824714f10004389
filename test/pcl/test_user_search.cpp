#include "clouds.h"
#include "depth_images.h"

#include <pcl/search/brute_force.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/octree.h>
#include <pcl/search/organized.h>

#include <new>
#include <stdexcept>

namespace {

using namespace test;
using Search = pcl::search::Search<PointXYZ>;

class UserSearch : public Silent {};

TEST_F(UserSearch, GivesTheMeshOfTheDefaultOne) {
  const HardCase hard;
  // They return indices of the cloud or positions in the subset.
  for (const Search::Ptr& search : {Search::Ptr(new pcl::search::KdTree<PointXYZ>(false)),
                                    Search::Ptr(new pcl::search::Octree<PointXYZ>(0.1)),
                                    Search::Ptr(new pcl::search::BruteForce<PointXYZ>())}) {
    SCOPED_TRACE(search->getName());
    Reconstruction reconstruction = reconstructionOf(hard.cloud);
    reconstruction.setSearchMethod(search);
    EXPECT_EQ(meshed(reconstruction).size(), 2 * 396U - 4);
    EXPECT_EQ(search->getInputCloud(), hard.cloud) << "the search was not used";
    EXPECT_EQ(reconstruction.getSearchMethod(), search);
    reconstruction.setIndices(share(hard.indices));
    EXPECT_EQ(trianglesOf(meshed(reconstruction)), hard.expected());
    reconstruction.setIndices(share({29, 3, 1, 11}));
    EXPECT_EQ(meshed(reconstruction).size(), 4U);
    reconstruction.setSearchMethod(Search::Ptr());
    reconstruction.setIndices(pcl::IndicesPtr());
    reconstruction.setInputCloud(makeEllipsoid(50));
    EXPECT_FALSE(meshed(reconstruction).empty());
    EXPECT_EQ(search->getInputCloud(), hard.cloud) << "it was used once more";
  }
}

TEST_F(UserSearch, OrganizedNeighborWorksOnDepthImagesAlone) {
  const Cloud::Ptr image =
      makeCloud(spherical_param::test::depthImage(40, 30, [](double x, double y) {
        return 2.0 - std::sqrt(0.16 - x * x - 1.1 * y * y);  // NaN around the bulge
      }));
  image->width = 40;
  image->height = 30;
  image->is_dense = false;
  Reconstruction reconstruction = reconstructionOf(image);
  const Triangles by_default = trianglesOf(meshed(reconstruction));
  ASSERT_GT(by_default.cols(), 700);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(mesh.cloud.height, 30U);
  EXPECT_FALSE(mesh.cloud.is_dense);
  reconstruction.setSearchMethod(Search::Ptr(new pcl::search::OrganizedNeighbor<PointXYZ>()));
  EXPECT_EQ(trianglesOf(meshed(reconstruction)), by_default);
  // Not with the camera of the last image, which PCL keeps.
  const Cloud::Ptr cloud = makeEllipsoid(600);
  cloud->width = 30;
  cloud->height = 20;
  reconstruction.setInputCloud(cloud);
  expectFailure(reconstruction, "pinhole");
  reconstruction.setInputCloud(makeEllipsoid(100));
  expectFailure(reconstruction, "not organized");
}

/// An unusual but allowed search: it sorts in descending order, leaves the query point out and
/// finds fewer than it is asked for. One of its answers can be changed.
class OddSearch : public pcl::search::BruteForce<PointXYZ> {
public:
  explicit OddSearch(int at_most, std::function<void(pcl::index_t&)> change = {})
      : at_most_(at_most), change_(std::move(change)) {}

  using pcl::search::BruteForce<PointXYZ>::nearestKSearch;
  int nearestKSearch(const PointXYZ& point, int k, Indices& indices,
                     std::vector<float>& distances) const override {
    int found = pcl::search::BruteForce<PointXYZ>::nearestKSearch(point, k, indices, distances);
    std::reverse(indices.begin(), indices.end());
    if (k > 1)
      --found;  // the nearest, which is the query point, is the last now
    if (k > 1 && change_)
      change_(indices.front());
    return std::min(found, at_most_);
  }

private:
  int at_most_;
  std::function<void(pcl::index_t&)> change_;
};

TEST_F(UserSearch, OddAnswersOfASearchWorkAndWrongOnesFail) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  (*cloud)[5].x = kNan;
  const Triangles expected = trianglesOf(meshed(cloud));
  Reconstruction reconstruction = reconstructionOf(cloud);
  const auto search = [&](int at_most, const std::function<void(pcl::index_t&)>& change = {}) {
    reconstruction.setSearchMethod(Search::Ptr(new OddSearch(at_most, change)));
  };
  search(1000);
  EXPECT_EQ(trianglesOf(meshed(reconstruction)), expected);
  for (const int at_most : {1, 7}) {
    search(at_most);
    EXPECT_EQ(meshed(reconstruction).size(), 2 * 299U - 4);
  }
  search(0);  // it does not even find the points themselves
  expectFailure(reconstruction, "search object");
  // Out of the cloud on both sides, and in the cloud but not among the points that were asked for.
  for (const pcl::index_t wrong : {-1, 300, 5}) {
    search(1000, [wrong](pcl::index_t& index) { index = wrong; });
    expectFailure(reconstruction, "index " + std::to_string(wrong));
  }
  search(1000, [](pcl::index_t&) { throw std::runtime_error("index broken"); });
  expectFailure(reconstruction, "index broken");
  search(1000, [](pcl::index_t&) { throw std::bad_alloc(); });
  expectFailure(reconstruction, "out of memory");
  search(1000, [](pcl::index_t&) { throw 42; });
  expectFailure(reconstruction, "unknown");
}

}  // namespace
