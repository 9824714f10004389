#include "clouds.h"
#include "depth_images.h"
#include "open_shapes.h"
#include "spherical_param/option_table.h"

namespace {

using spherical_param::Method;
using spherical_param::PartsMode;
using spherical_param::Progress;
using namespace test;

class SphericalParamReconstruction : public Silent {};

TEST_F(SphericalParamReconstruction, MeshIsThatOfTheCoreInIndicesOfTheCloud) {
  const HardCase hard;
  Reconstruction reconstruction = reconstructionOf(hard.cloud);
  reconstruction.setIndices(share(hard.indices));
  Options changed;
  changed.method = Method::Paper;
  changed.paper.k = 9;
  changed.paper.weights = spherical_param::EdgeWeights::InverseLength;
  changed.smoothing = 2;
  changed.seed = 99;
  for (const Options& options : {Options(), changed}) {
    reconstruction.setOptions(options);
    EXPECT_EQ(trianglesOf(meshed(reconstruction)), hard.expected(options));
    EXPECT_EQ(reconstruction.getUsedIndices(), hard.used);
    EXPECT_EQ(reconstruction.getIgnoredPointCount(), 3U);
    EXPECT_EQ(reconstruction.getVertexIndices().size(), hard.used.size() - 1);
    const Surface& surface = reconstruction.getResult().surface();
    for (std::size_t v = 0; v < reconstruction.getVertexIndices().size(); ++v)
      EXPECT_EQ(reconstruction.getVertexIndices()[v],
                hard.indices[static_cast<std::size_t>(surface.input_of_vertex[v])]);
    const Surface expected =
        spherical_param::reconstruct(positionsOf(*hard.cloud, hard.used), options).surface();
    EXPECT_EQ(surface.sphere, expected.sphere);
    EXPECT_EQ(surface.points, expected.points);
    EXPECT_EQ(reconstruction.getSelfIntersections(), expected.self_intersections);
    EXPECT_EQ(reconstruction.getResult().verdict, expected.verdict);
  }
}

TEST_F(SphericalParamReconstruction, IndicesMayHaveAnyOrderAndComeInAllTypesOfPcl) {
  const Cloud::Ptr cloud = makeEllipsoid(100);
  Reconstruction reconstruction = reconstructionOf(cloud);
  const auto expect_vertices = [&](Indices vertices) {
    EXPECT_EQ(meshed(reconstruction).size(), 2 * vertices.size() - 4);
    EXPECT_EQ(reconstruction.getVertexIndices(), vertices);
  };
  Indices descending(100);
  std::iota(descending.rbegin(), descending.rend(), 0);
  reconstruction.setIndices(share(descending));
  expect_vertices(descending);
  const Indices subset{3, 1, 4, 15, 92, 65, 35, 89, 79};
  reconstruction.setIndices(pcl::IndicesConstPtr(share(subset)));
  expect_vertices(subset);
  pcl::PointIndices::Ptr point_indices(new pcl::PointIndices);
  point_indices->indices = {5, 6, 40, 30};
  reconstruction.setIndices(pcl::PointIndices::ConstPtr(point_indices));
  expect_vertices({5, 6, 40, 30});
  cloud->width = cloud->height = 10;
  reconstruction.setIndices(2, 1, 2, 4);  // rows 2 and 3, columns 1 to 4
  expect_vertices({21, 22, 23, 24, 31, 32, 33, 34});
  reconstruction.setIndices(pcl::IndicesPtr());
  EXPECT_TRUE(isSphere(meshed(reconstruction), 100));
  reconstruction.setInputCloud(makeEllipsoid(60));  // all of its points, too
  EXPECT_TRUE(isSphere(meshed(reconstruction), 60));
}

TEST_F(SphericalParamReconstruction, SurfacesFaceAsTheNormalsOfThePoints) {
  pcl::PointCloud<pcl::PointNormal>::Ptr cloud(new pcl::PointCloud<pcl::PointNormal>);
  for (const PointXYZ& p : *makeEllipsoid(300))
    cloud->push_back(pcl::PointNormal(p.x, p.y, p.z, -p.x, -p.y, -p.z));
  pcl::SphericalParamReconstruction<pcl::PointNormal> inward;
  inward.setInputCloud(cloud);
  inward.reconstruct();
  EXPECT_EQ(inward.getResult().surface().faced_by, spherical_param::FacedBy::Normals);
  EXPECT_LT(inward.getResult().surface().measures.volume, 0.0);
}

TEST_F(SphericalParamReconstruction, SeesACloudFromItsSensorOrAGivenPlace) {
  const Eigen::Vector3d place(1.0, 2.0, 3.0);
  const auto two_walls = [](double x, double /*y*/) { return x < 0.0 ? 2.0 : 3.0; };
  const Cloud::Ptr cloud =
      makeCloud(spherical_param::test::depthImage(80, 60, two_walls).colwise() + place);
  Reconstruction reconstruction = reconstructionOf(cloud);
  const auto expect_view = [&](bool is_seen) {
    meshed(reconstruction);
    const auto& view = reconstruction.getResult().view;
    ASSERT_EQ(view.has_value(), is_seen);
    if (!is_seen)
      return;
    EXPECT_EQ(view->source, spherical_param::ViewSource::Given);
    EXPECT_EQ(view->place, place);
    EXPECT_EQ(reconstruction.getResult().surfaces.size(), 2U);
  };
  EXPECT_EQ(reconstruction.getView(), Reconstruction::ViewMode::Auto);
  expect_view(false);
  reconstruction.setViewpoint(place);
  EXPECT_EQ(reconstruction.getViewpoint(), place);
  expect_view(true);
  reconstruction.setView(Reconstruction::ViewMode::Auto);
  cloud->sensor_origin_ = Eigen::Vector4f(1.0F, 2.0F, 3.0F, 0.0F);
  expect_view(true);
  reconstruction.setView(Reconstruction::ViewMode::None);
  expect_view(false);
}

TEST_F(SphericalParamReconstruction, EachMistakeIsNamed) {
  const auto expect_failure = [](const std::string& words,
                                 const std::function<void(Reconstruction&)>& make_mistake) {
    for (const bool has_search : {false, true}) {
      Reconstruction reconstruction = reconstructionOf(makeEllipsoid(100), has_search);
      EXPECT_FALSE(meshed(reconstruction).empty());  // nothing of it is left
      make_mistake(reconstruction);
      expectFailure(reconstruction, words);
    }
  };
  const auto expect_failure_of = [&](const Cloud::Ptr& cloud, const std::string& words) {
    expect_failure(words, [&](Reconstruction& r) { r.setInputCloud(cloud); });
  };
  const auto expect_failure_at = [&](const Indices& indices, const std::string& words) {
    expect_failure(words, [&](Reconstruction& r) { r.setIndices(share(indices)); });
  };
  Reconstruction without_input;
  expectFailure(without_input, "setInputCloud");
  expect_failure_of({}, "setInputCloud");
  expect_failure_of(Cloud::Ptr(new Cloud), "empty");
  const Cloud::Ptr few = makeEllipsoid(3);
  few->push_back(PointXYZ(kNan, 0.0F, 0.0F));
  expect_failure_of(few, "left out: 1 point that is not finite");
  const Cloud::Ptr wrong_width = makeEllipsoid(100);
  wrong_width->width = 7;
  expect_failure_of(wrong_width, "width");
  expect_failure_at({}, "indices are empty");
  for (const pcl::index_t wrong : {-1, 100, std::numeric_limits<pcl::index_t>::max()})
    expect_failure_at({3, 2, 1, 0, wrong}, "entry 4 of the indices is " + std::to_string(wrong));
  expect_failure("k = 2", [](Reconstruction& r) { r.setKSearch(2); });
  expect_failure("threads", [](Reconstruction& r) { r.setNumberOfThreads(0xffffffffU); });
}

template <typename PointT>
class StandardPointType : public testing::Test {};
using StandardPointTypes = testing::Types<pcl::PointXYZ, pcl::PointXYZI, pcl::PointXYZRGB,
                                          pcl::PointNormal, pcl::PointXYZRGBNormal>;
TYPED_TEST_SUITE(StandardPointType, StandardPointTypes, );

TYPED_TEST(StandardPointType, WorksThroughMeshConstructionAndKeepsHeaderAndFields) {
  const auto cloud = makeEllipsoid<TypeParam>(100);
  auto* bytes = reinterpret_cast<std::uint8_t*>(cloud->points.data());
  for (std::size_t i = 0; i < 100; ++i)  // whatever comes after the coordinates
    for (std::size_t b = 16; b < sizeof(TypeParam); ++b)
      bytes[i * sizeof(TypeParam) + b] = static_cast<std::uint8_t>(7 * i + b);
  typename pcl::MeshConstruction<TypeParam>::Ptr mesher(
      new pcl::SphericalParamReconstruction<TypeParam>);
  mesher->setInputCloud(cloud);
  mesher->setSearchMethod(
      typename pcl::search::Search<TypeParam>::Ptr(new pcl::search::KdTree<TypeParam>));
  mesher->setIndices(share(shuffledRange(80, 7)));
  pcl::PolygonMesh mesh = staleMesh();
  mesher->reconstruct(mesh);
  EXPECT_TRUE(isSphere(mesh.polygons, 80));
  for (const pcl::PCLHeader& header : {mesh.header, mesh.cloud.header}) {
    EXPECT_EQ(header.seq, 12U);
    EXPECT_EQ(header.stamp, 42U);
    EXPECT_EQ(header.frame_id, "scanner");
  }
  pcl::PCLPointCloud2 expected;
  pcl::toPCLPointCloud2(*cloud, expected);
  EXPECT_EQ(mesh.cloud.data, expected.data);
  EXPECT_EQ(mesh.cloud.width, 100U);
  EXPECT_EQ(mesh.cloud.point_step, expected.point_step);
  ASSERT_EQ(mesh.cloud.fields.size(), expected.fields.size());
  for (std::size_t i = 0; i < expected.fields.size(); ++i)
    EXPECT_EQ(mesh.cloud.fields[i].name, expected.fields[i].name);
}

TEST_F(SphericalParamReconstruction, PolygonMeshHasSmoothedPointsAndBehindThemThoseOfFills) {
  const Cloud::Ptr cloud = makeCloud(
      kAxes.asDiagonal() * spherical_param::test::spiralSphere(2000).middleCols(250, 1500));
  Reconstruction reconstruction = reconstructionOf(cloud);
  reconstruction.setIndices(share(shuffledRange(1499, 7)));  // all but the last
  reconstruction.setSurface(spherical_param::SurfaceMode::Closed);
  reconstruction.setFill(spherical_param::FillMode::Smooth);
  reconstruction.setSmoothing(2);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  const Surface& surface = reconstruction.getResult().surface();
  const Cloud points = cloudOf<PointXYZ>(mesh.cloud);
  EXPECT_GT(surface.added_vertices, 0U);
  ASSERT_EQ(points.size(), cloud->size() + surface.added_vertices);
  EXPECT_EQ(mesh.polygons.size(), 2 * (points.size() - 1) - 4);
  Indices vertices = reconstruction.getVertexIndices();
  vertices.resize(1499);  // those of the cloud
  EXPECT_NE(positionsOf(points, vertices), positionsOf(*cloud, vertices));
  for (std::size_t i = cloud->size(); i < points.size(); ++i)
    vertices.push_back(static_cast<pcl::index_t>(i));
  EXPECT_EQ(positionsOf(points, vertices), surface.points.cast<float>().cast<double>());
  EXPECT_EQ(points[1499].getVector3fMap(), cloud->back().getVector3fMap());
  // Polygons alone are those of the input.
  EXPECT_EQ(meshed(reconstruction).size(), 2 * 1499U - 4);
}

TEST_F(SphericalParamReconstruction, SphereFitsTheCloudAndOutlivesIt) {
  const HardCase hard;
  Reconstruction reconstruction = reconstructionOf(hard.cloud);
  reconstruction.setIndices(share(hard.indices));
  reconstruction.setDetails(true);
  meshed(reconstruction);
  const Surface& result = reconstruction.getResult().surface();
  reconstruction.setInputCloud(makeEllipsoid(5));
  const auto cloud = reconstruction.getSphereCoordinates();
  ASSERT_EQ(cloud->size(), 400U);
  EXPECT_FALSE(cloud->is_dense);
  for (std::size_t v = 0; v < reconstruction.getVertexIndices().size(); ++v)
    EXPECT_EQ(
        (*cloud)[static_cast<std::size_t>(reconstruction.getVertexIndices()[v])].getVector3fMap(),
        result.sphere.col(static_cast<Eigen::Index>(v)).cast<float>());
  EXPECT_EQ((*cloud)[20].getVector3fMap(), (*cloud)[30].getVector3fMap());
  for (const std::size_t i : {0U, 7U, 8U, 350U, 399U})
    EXPECT_TRUE((*cloud)[i].getVector3fMap().array().isNaN().all()) << i;
}

/// A setter, what it sets, and whether the getter returns that.
struct Setter {
  const char* option;  ///< name in the table of options
  spherical_param::OptionValue value;
  std::function<void(Reconstruction&)> set;
  std::function<bool(const Reconstruction&)> is_returned;
};

/// A setter of a value, whose name in the table is given as well.
#define SETTER(option, text, name, value)                                                          \
  Setter {                                                                                         \
    option, text, [](Reconstruction& r) { r.set##name(value); },                                   \
        [](const Reconstruction& r) { return r.get##name() == (value); }                           \
  }

TEST_F(SphericalParamReconstruction, EachSetterSetsItsOptionAndNoOther) {
  using Integer = std::int64_t;
  const std::vector<Setter> setters{
      SETTER("topology", "sphere", Topology, spherical_param::TopologyMode::Sphere),
      SETTER("outliers", "auto", Outliers, spherical_param::OutlierMode::Auto),
      SETTER("parts", "each", Parts, PartsMode::Each),
      SETTER("min_points", Integer{7}, MinPartSize, 7),
      SETTER("consolidation", "auto", Consolidation, spherical_param::ConsolidationMode::Auto),
      SETTER("method", "paper", Method, Method::Paper),
      SETTER("k", Integer{17}, KSearch, 17),
      SETTER("weights", "inverse", Weights, spherical_param::EdgeWeights::InverseLength),
      SETTER("tolerance", 1e-5, Tolerance, 1e-5),
      SETTER("smoothing", Integer{8}, Smoothing, 8),
      SETTER("surface", "open", Surface, spherical_param::SurfaceMode::Open),
      SETTER("fill_holes", Integer{12}, FillHoles, 12),
      SETTER("fill", "smooth", Fill, spherical_param::FillMode::Smooth),
      SETTER("handles", "none", Handles, spherical_param::HandleMode::None),
      SETTER("intersections", "keep", Intersections, spherical_param::IntersectionMode::Keep),
      SETTER("seed", Integer{4294967295}, Seed, 4294967295U),
      SETTER("time_limit", 1.5, TimeLimit, 1.5),
      SETTER("threads", Integer{3}, NumberOfThreads, 3U),
  };
  for (const Setter& setter : setters) {
    Reconstruction reconstruction;
    EXPECT_FALSE(setter.is_returned(reconstruction)) << setter.option;
    setter.set(reconstruction);
    EXPECT_TRUE(setter.is_returned(reconstruction)) << setter.option;
    Options expected;
    expected.consolidation = spherical_param::ConsolidationMode::None;
    spherical_param::setOption(expected, setter.option, setter.value);
    for (const spherical_param::OptionRow& row : spherical_param::optionTable())
      EXPECT_EQ(row.get(reconstruction.getOptions()), row.get(expected))
          << setter.option << " changed " << row.name;
  }
  Reconstruction unset;
  EXPECT_EQ(unset.getKSearch(), 25);
  EXPECT_FALSE(unset.getTolerance().has_value());
  EXPECT_FALSE(unset.getProgressCallback());
  EXPECT_FALSE(unset.getDetails());
  unset.setDetails(true);
  EXPECT_TRUE(unset.getDetails() && unset.getOptions().details);
  unset.setOutlierSigma(6.0);  // beside the mode in the table
  EXPECT_EQ(unset.getOptions().outlier_sigma, 6.0);
  EXPECT_EQ(unset.getOutlierSigma(), 6.0);
}

TEST_F(SphericalParamReconstruction, TheCallbackCanEndTheWorkAndItsExceptionsPass) {
  struct CallersFault {};  // what no library throws
  for (const bool has_search : {false, true}) {
    Reconstruction reconstruction = reconstructionOf(makeEllipsoid(200), has_search);
    const Triangles expected = trianglesOf(meshed(reconstruction));
    for (const std::string stage : {"neighbors", "quality"}) {  // the first and the last
      reconstruction.setProgressCallback(
          [&](const Progress& progress) { return progress.stage != stage; });
      expectFailure(reconstruction, "cancelled");
      reconstruction.setProgressCallback([&](const Progress& progress) {
        return progress.stage != stage ? true : throw CallersFault();
      });
      pcl::PolygonMesh mesh = staleMesh();
      EXPECT_THROW(reconstruction.reconstruct(mesh), CallersFault) << stage;
      expectNothingLeft(reconstruction, mesh);
    }
    int calls = 0;
    reconstruction.setProgressCallback([&](const Progress&) {
      ++calls;
      reconstruction.setProgressCallback({});  // it may replace itself
      return true;
    });
    EXPECT_EQ(trianglesOf(meshed(reconstruction)), expected);
    EXPECT_GT(calls, 1);
  }
}

TEST_F(SphericalParamReconstruction, TheSearchOfTheUserCanBeEndedInTheMiddle) {
  Reconstruction reconstruction = reconstructionOf(makeEllipsoid(5000), true);
  reconstruction.setProgressCallback([](const Progress& progress) {
    return progress.stage != std::string("neighbors") || progress.fraction == 0.0 ||
           progress.fraction == 1.0;
  });
  expectFailure(reconstruction, "cancelled");
}

TEST_F(SphericalParamReconstruction, ObjectsInSeveralThreadsAndCopiesAreIndependent) {
  const Cloud::Ptr cloud = makeEllipsoid(500);
  const auto run = [&](std::size_t i) {
    Reconstruction reconstruction = reconstructionOf(cloud, i == 1);
    reconstruction.setNumberOfThreads(static_cast<unsigned int>(i % 3));
    reconstruction.setDetails(true);
    reconstruction.reconstruct();
    return reconstruction.getResult().surface().sphere;
  };
  for (const Positions& sphere : spherical_param::test::runTogether(4, run))
    EXPECT_TRUE(sphere == run(0));
  Reconstruction first = reconstructionOf(cloud);
  meshed(first);
  Reconstruction second = first;
  second.setInputCloud(makeEllipsoid(100));
  EXPECT_EQ(meshed(second).size(), 196U);
  EXPECT_EQ(first.getVertexIndices().size(), 500U);
  EXPECT_EQ(meshed(first).size(), 996U);
}

Cloud::Ptr beside(const Cloud::Ptr& cloud) {
  for (PointXYZ& point : *cloud)
    point.x += 5.0F;
  return cloud;
}

TEST(PartsOfCloud, AreMeshedAsIfTheyWereAloneAndThoseWithHandlesHaveNoPlaceOnTheSphere) {
  const Cloud::Ptr small = beside(makeEllipsoid(200));
  const Cloud::Ptr torus = makeTorus(24);
  const Cloud::Ptr cloud(new Cloud);
  for (std::size_t i = 0; i < torus->size(); ++i) {  // in turn as long as both last
    if (i < 200)
      cloud->push_back((*small)[i]);
    cloud->push_back((*torus)[i]);
  }
  for (const bool has_search : {false, true}) {
    Reconstruction reconstruction = reconstructionOf(cloud, has_search);
    reconstruction.setParts(PartsMode::Each);
    reconstruction.setDetails(true);
    const Polygons polygons = meshed(reconstruction);
    ASSERT_EQ(reconstruction.getPartCount(), 2U);
    const Triangles of_torus = trianglesOf(meshed(torus));
    EXPECT_EQ(polygons.size(), static_cast<std::size_t>(of_torus.cols()) + 396U);
    EXPECT_EQ(reconstruction.getUsedIndices(0).size(), torus->size());
    EXPECT_EQ(reconstruction.getUsedIndices(1).size(), 200U);
    EXPECT_EQ(reconstruction.getUsedIndices(1)[1], 2);
    EXPECT_EQ(reconstruction.getResult().surfaces[0].triangles, of_torus);
    EXPECT_EQ(reconstruction.getVertexIndices(0).at(static_cast<std::size_t>(of_torus(0, 0))),
              polygons.front().vertices.front());
    EXPECT_EQ(reconstruction.getResult().surfaces[1].triangles, trianglesOf(meshed(small)));
    EXPECT_EQ(reconstruction.getDiagnosis(1).triangle_marks, std::vector<std::uint8_t>(396, 0));
    const auto sphere = reconstruction.getSphereCoordinates();
    EXPECT_FALSE(sphere->is_dense);
    ASSERT_EQ(sphere->size(), cloud->size());
    for (std::size_t i = 0; i < sphere->size(); ++i) {
      const auto place = (*sphere)[i].getVector3fMap();
      const bool is_of_small = i < 400 && i % 2 == 0;
      EXPECT_TRUE(is_of_small ? std::abs(place.norm() - 1.0F) < 1e-6F
                              : place.array().isNaN().all());
    }
  }
}

TEST(PartsOfCloud, ThatAreFlatAreLeftOutWithAWarningAndFailuresArePrintedOnce) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  for (int i = 0; i < 100; ++i)
    cloud->push_back(PointXYZ(5.0F + 0.2F * static_cast<float>(i % 10),
                              0.2F * static_cast<float>(i / 10), 0.0F));
  Reconstruction reconstruction = reconstructionOf(cloud);
  reconstruction.setSurface(spherical_param::SurfaceMode::Closed);
  testing::internal::CaptureStderr();
  EXPECT_EQ(meshed(reconstruction).size(), 596U);
  const std::string warning = testing::internal::GetCapturedStderr();
  EXPECT_NE(warning.find("1 part (100 points) cannot be meshed"), std::string::npos);
  EXPECT_EQ(reconstruction.getPartCount(), 1U);
  EXPECT_EQ(reconstruction.getResult().left_out.other_parts.size(), 100U);
  reconstruction.setInputCloud(makeEllipsoid(2));
  testing::internal::CaptureStderr();
  reconstruction.reconstruct();
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "[pcl::SphericalParamReconstruction::reconstruct] " + reconstruction.getErrorMessage() +
                "\n");
}

}  // namespace
