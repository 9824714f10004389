// What holds of every stage and of reconstruct(), by one table: the result is the same, bit by bit,
// for any number of threads; progress comes from the calling thread and can end the work. What
// holds of every public function that takes a mesh, by another: bad arguments are refused.

#include "consolidation.h"
#include "embedding.h"
#include "graph_hierarchy.h"
#include "graphs.h"
#include "mesh_optimization.h"
#include "neighbor_search.h"
#include "open_shapes.h"
#include "optimization/optimization_cases.h"
#include "ordered_points.h"
#include "paper_method.h"
#include "quality/surface_scenes.h"
#include "reconstructions.h"
#include "sampling_analysis.h"
#include "smoothing.h"
#include "sphere_mesh.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_triangulation.h"
#include "surface_diagnosis.h"
#include "surface_topology.h"
#include "thread_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace spherical_param {
namespace {

using test::Numbers;

struct Stage {
  const char* name;
  std::function<Numbers(const Execution&)> run;
  bool reports = true;
};

/// More points than are left to a single thread, and what stages need of them.
struct Inputs {
  Positions points = test::withNoise(test::ellipsoid(40000), 0.001, 1);
  NeighborLists lists = findNearestNeighbors(points, 8);  // so few that more are searched for
  Graph graph = test::graphOf(points, lists, makeNeighborSearch(points)).graph;
  Triangles triangles = triangulateSphere(test::spiralSphere(40000));
  Triangles damaged = triangles;
  Positions holed = test::sphereWithHoles(40000, 3, 0.3);
  Graph holed_graph = test::graphOf(holed, findNearestNeighbors(holed, 24)).graph;
  test::Scene torus = test::cutTorus(2100, 24, 0.05);
  test::Mesh knot = test::bentTube(20.0, 2.2 * test::kPi, 86);  // into itself
  Positions rough = test::withNoise(test::randomSphere(6000, 8), 0.02, 9);
  Positions scattered = test::horizontally(points, 2.0 * test::spiralSphere(40));

  Inputs() {
    std::mt19937 random(7);
    for (int change = 0; change < 2000; ++change)
      damaged.data()[random() % static_cast<unsigned>(damaged.size())] =
          static_cast<Index>(random() % 40000);
  }
};

Numbers numbersOf(const Surface& surface) {
  Numbers numbers(surface.triangles, surface.sphere, surface.smoothed, surface.boundary,
                  surface.self_intersections, surface.measures.inertia, surface.embedding.residual,
                  surface.vertex_residuals, surface.diagnosis.triangle_marks,
                  surface.history.vertices, surface.smoothing.volume_after, surface.outliers);
  for (const HistoryFrame& frame : surface.history.frames)
    numbers.add(frame.sphere);
  return numbers;
}

Numbers numbersOf(const MeshTopology& topology) {
  return Numbers(topology.vertices, topology.edges, topology.components,
                 topology.euler_characteristic, topology.oriented, topology.nonmanifold_vertices,
                 topology.unused_vertices);
}

Numbers numbersOf(const MeshOptimization& optimization) {
  return Numbers(optimization.triangles, optimization.intersecting.pairs,
                 optimization.report.is_noisy, optimization.report.recreated);
}

Numbers numbersOf(const internal::GraphHierarchy& hierarchy) {
  Numbers numbers;
  for (const internal::HierarchyLevel& level : hierarchy.levels)
    numbers.add(Numbers(level.seeds, level.aggregate_of, level.graph.offsets, level.graph.neighbors,
                        level.graph.lengths, level.prolongation.coeffs()));
  return numbers;
}

void addEmbeddings(std::vector<Stage>& stages, const Inputs& in) {
  stages.push_back({"embedding", [&in](const Execution& e) {
                      EmbeddingOptions options;
                      options.starts = 3;
                      options.history_vertices = 100;
                      options.tolerance = 1e-7;
                      const Embedding result = embed(in.graph, in.points, options, 1, e);
                      Numbers numbers(result.directions, result.report.residuals);
                      for (const HistoryFrame& frame : result.history.frames)
                        numbers.add(frame.sphere);
                      return numbers;
                    }});
  for (const EdgeWeights weights :
       {EdgeWeights::Uniform, EdgeWeights::InverseLength, EdgeWeights::Adaptive})
    stages.push_back({"embedding", [&in, weights](const Execution& e) {
                        PaperOptions options;
                        options.weights = weights;
                        options.max_iterations = 5;
                        const Embedding result =
                            internal::paper::embed(in.graph, in.points, options, 1e-8, {}, e);
                        return Numbers(result.directions, result.report.residuals);
                      }});
}

void addMeshStages(std::vector<Stage>& stages, const Inputs& in) {
  stages.push_back({"triangulation", [](const Execution& e) {
                      return Numbers(triangulateSphere(test::spiralSphere(3000), e));
                    }});
  for (const test::Case& of :
       {test::noisySphere(2100, 0.3, 15), test::scrambledEllipsoid(2100, 0.6, 2500, 15)})
    stages.push_back({"optimization", [of](const Execution& e) {
                        return numbersOf(optimizeMesh(of.points, of.triangles, of.graph, {}, e));
                      }});
  stages.push_back({"self-intersections", [&in](const Execution& e) {
                      return Numbers(
                          findSelfIntersections(in.knot.points, in.knot.triangles, e),
                          findSelfIntersectionsOf(in.knot.points, in.knot.triangles, {0, 5}, e));
                    }});
  const auto add_silent = [&](const char* name, const std::function<Numbers(int)>& run) {
    stages.push_back({name, [run](const Execution& e) { return run(e.threads); }, false});
  };
  add_silent("mesh", [&in](int threads) {
    const internal::SphereMesh mesh(in.triangles, 40000, threads);
    Numbers neighbors;
    for (Index t = 0; t < mesh.size(); ++t)
      for (int k = 0; k < 3; ++k)
        neighbors.add(mesh.neighbor(t, k));
    return neighbors;
  });
  add_silent("topology",
             [&in](int threads) { return numbersOf(checkTopology(in.damaged, 40000, threads)); });
  add_silent("measures", [&in](int threads) {
    const MeshMeasures of = measureMesh(in.points, in.triangles, threads);
    return Numbers(of.volume, of.area, of.mean_edge_length, of.centroid, of.inertia);
  });
  for (const SmoothingMethod method : {SmoothingMethod::Umbrella, SmoothingMethod::Biharmonic})
    add_silent("smoothing", [&in, method](int threads) {
      const Smoothing result = smoothSurface(in.points, in.triangles, {method, 2}, threads);
      return Numbers(result.points, result.report.volume_after, result.report.mean_displacement);
    });
  add_silent("sampling", [&in](int threads) {
    const internal::Sampling result = internal::analyzeSampling(in.points, in.graph, threads);
    return Numbers(result.alignment, result.unevenness);
  });
  add_silent("diagnosis", [&in](int threads) {
    const SurfaceDiagnosis result = diagnoseSurface(in.torus.points, in.torus.triangles,
                                                    in.torus.graph.graph, {}, {}, {}, threads);
    Numbers numbers(result.edges_outside_graph);
    for (const Handle& handle : result.handles)
      numbers.add(handle.vertices);
    return numbers;
  });
}

void addReconstructions(std::vector<Stage>& stages, const Inputs& in) {
  Options smoothed = test::watched();
  smoothed.smoothing = 2;
  Options paper = test::watched(test::quick(test::paper()));
  paper.paper.max_iterations = 40;
  Options open = test::quick();
  open.surface = SurfaceMode::Open;
  for (const Options& options : {smoothed, paper, open})
    stages.push_back({"reconstruction", [&in, options](const Execution& e) {
                        Options with = options;
                        static_cast<Execution&>(with) = e;
                        const bool is_open = options.surface == SurfaceMode::Open;
                        return numbersOf(test::surfaceOf(is_open ? in.holed : in.rough, with));
                      }});
}

std::vector<Stage> stagesOf(const Inputs& in) {
  std::vector<Stage> stages{
      {"distinct points",
       [&](const Execution& e) {
         const auto ordered = internal::orderPoints(in.points, e.threads);
         return Numbers(ordered.points, ordered.input_of_node, ordered.distinct.vertex_of_input);
       },
       false},
      {"neighbors",
       [&](const Execution& e) { return Numbers(findNearestNeighbors(in.points, 6, e).indices); }},
      {"graph",
       [&](const Execution& e) {
         const NeighborGraph result =
             test::graphOf(in.points, in.lists, makeNeighborSearch(in.points), e);
         return Numbers(result.graph.offsets, result.graph.neighbors, result.graph.lengths);
       }},
      {"openings",
       [&](const Execution& e) {
         Options options;
         options.surface = SurfaceMode::Open;
         const internal::SurfaceTopology topology =
             internal::findTopology(in.holed, in.holed_graph, false, 1.0, options, e);
         const Openings& result = topology.openings.embeddedOpenings();
         Numbers numbers(result.spacing, result.false_edges);
         for (const Opening& opening : result.openings)
           numbers.add(opening.loop);
         return numbers;
       }},
      {"outliers",
       [&](const Execution& e) {
         Numbers numbers;
         for (const OutlierMode mode : {OutlierMode::Auto, OutlierMode::Deviation}) {
           Options options;
           static_cast<Execution&>(options) = e;
           options.outliers = mode;
           numbers.add(findOutliers(in.scattered, options));
         }
         return numbers;
       }},
      {"parts",
       [&](const Execution& e) {
         Options options;
         static_cast<Execution&>(options) = e;
         return Numbers(findParts(in.scattered, options));
       }},
      {"consolidation",
       [&](const Execution& e) {
         const Consolidation result = consolidate(in.rough, e);
         return Numbers(result.points, result.point_of_input, result.report.noise);
       }},
      {"hierarchy", [&](const Execution& e) {
         return numbersOf(internal::buildGraphHierarchy(in.graph, 1, 1000, e));
       }}};
  addEmbeddings(stages, in);
  addMeshStages(stages, in);
  addReconstructions(stages, in);
  return stages;
}

TEST(Threads, ChangeNoBitOfAnyStage) {
  const Inputs inputs;
  for (const Stage& stage : stagesOf(inputs)) {
    const Numbers alone = stage.run(test::onThreads(1));
    EXPECT_GT(alone.size(), 0U) << stage.name;
    EXPECT_TRUE(alone == stage.run(test::onThreads(3))) << stage.name;
  }
}

TEST(Threads, ThatCallReceiveTheProgressAndCanEndEveryStage) {
  const Inputs inputs;
  for (const Stage& stage : stagesOf(inputs)) {
    if (!stage.reports)
      continue;
    SCOPED_TRACE(stage.name);
    test::expectProgressThatCanCancel([&](const std::function<bool(double)>& callback) {
      Execution execution = test::reportingTo(callback);
      execution.threads = 3;
      return stage.run(execution);
    });
  }
}

struct MeshFunction {
  const char* name;
  std::function<void(const Positions&, const Triangles&, int threads)> call;
  bool takes_threads = true;
};

TEST(PublicFunctions, RefuseBadArguments) {
  const std::vector<MeshFunction> functions{
      {"checkTopology",
       [](const Positions& p, const Triangles& t, int threads) {
         checkTopology(t, static_cast<std::size_t>(p.cols()), threads);
       }},
      {"measureMesh",
       [](const Positions& p, const Triangles& t, int threads) { measureMesh(p, t, threads); }},
      {"findSelfIntersections",
       [](const Positions& p, const Triangles& t, int threads) {
         findSelfIntersections(p, t, test::onThreads(threads));
       }},
      {"findSelfIntersectionsOf",
       [](const Positions& p, const Triangles& t, int threads) {
         findSelfIntersectionsOf(p, t, {0}, test::onThreads(threads));
       }},
      {"areaWeightedNormals",
       [](const Positions& p, const Triangles& t, int) { areaWeightedNormals(p, t); }, false},
      {"signedVolume", [](const Positions& p, const Triangles& t, int) { signedVolume(p, t); },
       false},
      {"surfaceArea", [](const Positions& p, const Triangles& t, int) { surfaceArea(p, t); },
       false}};
  const Positions points = test::spiralSphere(9);
  const Triangles triangles = triangulateSphere(points);
  for (const auto& [name, call, takes_threads] : functions) {
    SCOPED_TRACE(name);
    EXPECT_NO_THROW(call(points, triangles, 1024));
    for (const int threads : {-1, 1025})
      if (takes_threads) {
        EXPECT_THROW(call(points, triangles, threads), InvalidInput);
      }
    for (const Index vertex : {-1, 9}) {
      Triangles wrong = triangles;
      wrong(1, 3) = vertex;
      EXPECT_THROW(call(points, wrong, 1), InvalidInput);
    }
  }
  for (const Index triangle : {-1, 14})
    EXPECT_THROW(findSelfIntersectionsOf(points, triangles, {triangle}), InvalidInput);
  EXPECT_THROW(triangulateSphere(points.leftCols(3)), InvalidInput);
  for (const double factor : {1.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
    Positions wrong = points;
    wrong.col(4) *= factor;
    EXPECT_THROW(triangulateSphere(wrong), InvalidInput);
    if (!std::isfinite(factor)) {
      EXPECT_THROW(findSelfIntersections(wrong, triangles), InvalidInput);
    }
  }
  // 50,000 lists of as many entries are more than 2^31.
  EXPECT_THROW(findNearestNeighbors(test::spiralSphere(50000), 50000), InvalidInput);
}

}  // namespace
}  // namespace spherical_param
