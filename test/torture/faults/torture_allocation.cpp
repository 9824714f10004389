// Every allocation of a call of the core, of the PCL classes or of the tools fails, each alone and
// each with all after it. What must come of it: std::bad_alloc or the failure that is documented,
// or the right answer; no leak; and the next call gives the same bytes as ever.
//
//   torture_allocation [--quick] [--only NAME] [--at K]

#include "common/output_file.h"
#include "failing_allocation.h"
#include "helpers.h"
#include "torture_row.h"

#include "spherical_param/errors.h"
#include "spherical_param/morphing.h"
#include "spherical_param/outliers.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/resampling.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/sphere_map.h"
#include "spherical_param/sphere_surface.h"
#include "spherical_param/spherical_harmonics.h"
#include "spherical_param/surface_diagnosis.h"
#include "spherical_param/texture_atlas.h"

#include <pcl/console/print.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/spherical_param_morph.h>
#include <pcl/surface/spherical_param_reconstruction.h>
#include <pcl/surface/spherical_param_remesh.h>
#include <pcl/surface/spherical_param_texture.h>

#include <execinfo.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param;
using failing_allocation::begin;
using failing_allocation::end;

/// Which allocation fails.
struct Fault {
  std::uint64_t first = 0;  ///< 0: none
  bool all_after = false;
};

/// What a call gave: its bytes, as a sum of them.
class Answer {
public:
  template <typename Matrix>
  Answer& add(const Matrix& values) {
    return addBytes(values.data(),
                    static_cast<std::size_t>(values.size()) * sizeof(*values.data()));
  }
  Answer& addBytes(const void* bytes, std::size_t size) {
    // FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo).
    for (std::size_t i = 0; i < size; ++i)
      sum_ = (sum_ ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3U;
    return *this;
  }
  std::uint64_t sum() const { return sum_; }

private:
  std::uint64_t sum_ = 0xcbf29ce484222325U;
};

/// The failure that a PCL class told as it says it does.
constexpr std::uint64_t told_failure = 0;

/// A call that faults are put into. \return the sum of its answer, or told_failure.
struct Call {
  std::string name;
  std::function<std::uint64_t(const Fault&)> run;
};

std::uint64_t sumOf(const Result& result) {
  Answer answer;
  answer.add(result.triangles).add(result.sphere).add(result.vertex_of_input);
  answer.add(result.smoothed).add(result.vertex_residuals).add(result.self_intersections);
  for (const std::string& warning : result.warnings)
    answer.addBytes(warning.data(), warning.size());
  return answer.sum();
}

/// Like an egg with a dent and some noise: no symmetry, no ties.
Positions egg(Index n, double noise) {
  Positions points = test::spiralSphere(n);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    points.col(i) *= 1.0 + 0.2 * points(0, i) - 0.15 * points(1, i) * points(2, i);
  return test::withNoise(points, noise, 5);
}

Options optionsOfOneThread() {
  Options options;
  options.threads = 1;
  return options;
}

Options optionsOfThePaper() {
  Options options = optionsOfOneThread();
  options.graph = GraphMethod::NearestNeighbors;
  options.solver = EmbeddingMethod::Iterative;
  options.hull = TriangulationMethod::Qhull;
  options.optimization = OptimizationMethod::None;
  options.max_iterations = 50;
  options.attempts = 1;
  options.k = 10;
  return options;
}

Call reconstruction(const std::string& name, const Positions& points, const Options& options) {
  const NeighborLists lists = test::bruteForceNeighbors(points, neighborsToSearch(options));
  return {name, [=](const Fault& fault) {
            begin(fault.first, fault.all_after);
            const Result result = reconstruct(points, lists, options);
            end();
            return sumOf(result);
          }};
}

Call searchingReconstruction(const std::string& name, const Positions& points,
                             const Options& options) {
  return {name, [=](const Fault& fault) {
            begin(fault.first, fault.all_after);
            const Result result = reconstruct(
                points,
                [](const Positions& distinct, const std::vector<Index>&) -> NeighborSearch {
                  return test::bruteForceSearch(distinct);
                },
                options);
            end();
            return sumOf(result);
          }};
}

/// A mesh with its map, for what begins with one.
struct Mapped {
  Positions points;
  Result mesh;
};

Mapped mapped(Index n) {
  Mapped made;
  made.points = egg(n, 0.0);
  made.mesh =
      reconstruct(made.points, test::bruteForceNeighbors(made.points, neighborsToSearch(Options())),
                  optionsOfOneThread());
  return made;
}

SphereSurface surfaceOf(const Mapped& mapped_mesh) {
  SphereSurfaceOptions options;
  options.threads = 1;
  return {mapped_mesh.points, mapped_mesh.mesh.triangles, mapped_mesh.mesh.sphere, options};
}

std::vector<Call> callsOfTheCore() {
  std::vector<Call> calls;
  const Positions clean = egg(90, 0.0);
  const Positions noisy = egg(120, 0.03);
  calls.push_back(reconstruction("reconstruct", clean, optionsOfOneThread()));
  calls.push_back(searchingReconstruction("reconstruct-search", clean, optionsOfOneThread()));
  calls.push_back(reconstruction("reconstruct-paper", clean, optionsOfThePaper()));
  calls.push_back(reconstruction("reconstruct-duplicates",
                                 test::horizontally(clean, clean.leftCols(30)),
                                 optionsOfOneThread()));
  // Qhull leaves out those that coincide on the sphere, and they are put back.
  calls.push_back(
      reconstruction("reconstruct-paper-lattice", test::cubeGrid(4), optionsOfThePaper()));
  Options options = optionsOfOneThread();
  options.smoothing_steps = 5;
  options.details = true;
  options.history.vertices = 50;
  calls.push_back(reconstruction("reconstruct-smoothed", noisy, options));
  options = optionsOfOneThread();
  options.attempts = 6;
  calls.push_back(reconstruction("reconstruct-attempts", test::withNoise(clean, 0.2, 3), options));
  options = optionsOfOneThread();
  options.tolerance = 1e-8;
  options.weights = EdgeWeights::Uniform;
  calls.push_back(reconstruction("reconstruct-tolerance", clean, options));
  calls.push_back(reconstruction(
      "reconstruct-parts",
      test::horizontally(clean, (0.3 * clean).colwise() + Eigen::Vector3d(3.0, 0.1, 0.2)),
      optionsOfOneThread()));

  const Mapped large = mapped(90);
  const Mapped other = mapped(70);
  calls.push_back({"computeSphereMap", [=](const Fault& fault) {
                     SphereMapOptions map_options;
                     map_options.threads = 1;
                     begin(fault.first, fault.all_after);
                     const SphereMap map = computeSphereMap(large.points, large.mesh.triangles,
                                                            large.mesh.sphere, map_options);
                     end();
                     return Answer().add(map.sphere).sum();
                   }});
  calls.push_back({"resample", [=](const Fault& fault) {
                     begin(fault.first, fault.all_after);
                     const SphereSurface surface = surfaceOf(large);
                     ResampledMesh mesh = resampleSurface(
                         surface, makeGridSphere(SphereGrid::Icosahedral,
                                                 gridFrequency(SphereGrid::Icosahedral, 162)));
                     untangle(surface, mesh, 1);
                     removeIntersections(mesh, 1);
                     const SurfacePoints even = sampleEvenly(surface, 60);
                     end();
                     return Answer().add(mesh.points).add(mesh.triangles).add(even.points).sum();
                   }});
  // Shuffled, so that there is something to take out.
  calls.push_back({"removeIntersections", [=](const Fault& fault) {
                     begin(fault.first, fault.all_after);
                     const SphereSurface surface = surfaceOf(large);
                     ResampledMesh mesh =
                         resampleSurface(surface, makeGridSphere(SphereGrid::Octahedral, 4));
                     for (Eigen::Index i = 0; i + 7 < mesh.points.cols(); i += 7)
                       mesh.points.col(i).swap(mesh.points.col(i + 1));
                     removeIntersections(mesh, 1);
                     untangle(surface, mesh, 1);
                     end();
                     return Answer().add(mesh.points).add(mesh.triangles).sum();
                   }});
  calls.push_back({"geometryImage", [=](const Fault& fault) {
                     begin(fault.first, fault.all_after);
                     const GeometryImage image = makeGeometryImage(surfaceOf(large), 17);
                     const ResampledMesh mesh = meshOfGeometryImage(image);
                     const GeometryImage again = geometryImageOfMesh(mesh);
                     end();
                     return Answer().add(image.positions).add(again.positions).sum();
                   }});
  calls.push_back({"sphericalHarmonics", [=](const Fault& fault) {
                     begin(fault.first, fault.all_after);
                     const SphericalHarmonics harmonics =
                         computeSphericalHarmonics(surfaceOf(large), 6, 1);
                     const Positions points =
                         evaluateSphericalHarmonics(harmonics, large.mesh.sphere, 1);
                     end();
                     return Answer().add(harmonics.coefficients).add(points).sum();
                   }});
  for (const MorphConnectivity connectivity :
       {MorphConnectivity::AllVertices, MorphConnectivity::Resampled})
    calls.push_back({connectivity == MorphConnectivity::Resampled ? "morph-resampled" : "morph",
                     [=](const Fault& fault) {
                       MorphOptions morph_options;
                       morph_options.threads = 1;
                       morph_options.connectivity = connectivity;
                       morph_options.samples = 162;
                       // The search for a rotation takes most of the time; once is enough.
                       morph_options.align = connectivity == MorphConnectivity::AllVertices;
                       begin(fault.first, fault.all_after);
                       morph_options.pairs = {{3, 2}, {40, 33}, {77, 60}};
                       const MorphResult morph =
                           morphSurfaces(surfaceOf(large), surfaceOf(other), morph_options);
                       const Positions middle = inBetween(morph, 0.5);
                       end();
                       return Answer().add(morph.triangles).add(morph.sphere).add(middle).sum();
                     }});
  for (const SphereChart chart :
       {SphereChart::Equirectangular, SphereChart::Octahedral, SphereChart::CubeMap})
    calls.push_back(
        {"texture-" + std::to_string(static_cast<int>(chart)), [=](const Fault& fault) {
           TextureAtlasOptions atlas_options;
           atlas_options.chart = chart;
           BakeOptions bake;
           bake.height = 48;
           bake.threads = 1;
           begin(fault.first, fault.all_after);
           const TextureAtlas atlas =
               makeTextureAtlas(large.mesh.triangles, large.mesh.sphere, atlas_options);
           const TextureImage colors = bakeColors(atlas, large.mesh.sphere.cwiseAbs(), bake);
           const TextureImage board = bakeCheckerboard(atlas, large.mesh.sphere, 4, bake);
           end();
           return Answer().add(atlas.triangles).add(colors.pixels).add(board.pixels).sum();
         }});
  Positions with_outliers = noisy;
  with_outliers.col(5) *= 3.0;
  with_outliers.col(50) *= 2.5;
  const NeighborLists lists = test::bruteForceNeighbors(with_outliers, 32);
  calls.push_back({"findOutliers", [=](const Fault& fault) {
                     OutlierOptions outlier_options;
                     outlier_options.threads = 1;
                     begin(fault.first, fault.all_after);
                     const Outliers outliers = findOutliers(with_outliers, lists, outlier_options);
                     end();
                     return Answer().add(outliers.indices).add(outliers.scores).sum();
                   }});
  return calls;
}

// --- PCL -----------------------------------------------------------------------------------------

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using PclReconstruction = pcl::SphericalParamReconstruction<pcl::PointXYZ>;

Cloud::Ptr cloudOf(const Positions& points) {
  Cloud::Ptr cloud(new Cloud);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3f point = points.col(i).cast<float>();
    cloud->emplace_back(point.x(), point.y(), point.z());
  }
  return cloud;
}

void prepare(PclReconstruction& reconstruction, const Cloud::Ptr& cloud) {
  reconstruction.setInputCloud(cloud);
  reconstruction.setNumberOfThreads(1);
}

Answer sumOf(const pcl::PolygonMesh& mesh) {
  Answer answer;
  answer.add(mesh.cloud.data);
  for (const pcl::Vertices& polygon : mesh.polygons)
    answer.add(polygon.vertices);
  return answer;
}

/// Of the class: a failure must be told, and leave nothing.
std::uint64_t answerOf(const PclReconstruction& reconstruction, const pcl::PolygonMesh& mesh) {
  if (reconstruction.getErrorMessage().empty() && !mesh.polygons.empty())
    return sumOf(mesh).sum();
  const bool says_so = reconstruction.getErrorMessage().find("memory") != std::string::npos;
  const bool is_empty = mesh.polygons.empty() && mesh.cloud.data.empty() &&
                        reconstruction.getResult().triangles.cols() == 0 &&
                        reconstruction.getUsedIndices().empty() &&
                        reconstruction.getVertexIndices().empty();
  if (!says_so)
    throw std::runtime_error("the class says: '" + reconstruction.getErrorMessage() + "'");
  if (!is_empty)
    throw std::runtime_error("something is left after a failure");
  return told_failure;
}

Call pclReconstruction(const std::string& name, const Positions& points, const Options& options,
                       bool own_search) {
  const Cloud::Ptr cloud = cloudOf(points);
  return {name, [=](const Fault& fault) {
            PclReconstruction reconstruction;
            prepare(reconstruction, cloud);
            reconstruction.setOptions(options);
            pcl::PolygonMesh mesh;
            // What was there before must not be left.
            mesh.polygons.resize(3);
            if (own_search) {
              // Outside: the first allocations of a search object are the caller's.
              reconstruction.setSearchMethod(
                  pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
            }
            begin(fault.first, fault.all_after);
            reconstruction.reconstruct(mesh);
            end();
            return answerOf(reconstruction, mesh);
          }};
}

std::vector<Call> callsOfPcl() {
  std::vector<Call> calls;
  const Positions clean = egg(90, 0.0);
  calls.push_back(pclReconstruction("pcl", clean, optionsOfOneThread(), false));
  calls.push_back(pclReconstruction("pcl-paper", clean, optionsOfThePaper(), false));
  calls.push_back(pclReconstruction("pcl-own-search", clean, optionsOfOneThread(), true));
  const Cloud::Ptr cloud = cloudOf(clean);
  const Cloud::Ptr other = cloudOf(egg(60, 0.0));
  calls.push_back({"pcl-remesh", [=](const Fault& fault) {
                     PclReconstruction reconstruction;
                     prepare(reconstruction, cloud);
                     pcl::PolygonMesh mesh;
                     begin(fault.first, fault.all_after);
                     const bool done = pcl::remeshSphericalParam(reconstruction, mesh);
                     end();
                     return done ? sumOf(mesh).sum() : told_failure;
                   }});
  calls.push_back(
      {"pcl-texture", [=](const Fault& fault) {
         PclReconstruction reconstruction;
         prepare(reconstruction, cloud);
         pcl::SphericalParamTextureOptions options;
         options.bake.height = 48;
         options.checkerboard = true;
         pcl::TextureMesh mesh;
         TextureImage image;
         begin(fault.first, fault.all_after);
         const bool done = pcl::textureSphericalParam(reconstruction, mesh, image, options);
         end();
         return done ? Answer().add(mesh.cloud.data).add(image.pixels).sum() : told_failure;
       }});
  calls.push_back({"pcl-morph", [=](const Fault& fault) {
                     PclReconstruction first;
                     PclReconstruction second;
                     prepare(first, cloud);
                     prepare(second, other);
                     std::vector<pcl::PolygonMesh> frames;
                     begin(fault.first, fault.all_after);
                     const bool done = pcl::morphSphericalParam(first, second, 3, frames);
                     end();
                     return done ? sumOf(frames[1]).sum() : told_failure;
                   }});
  return calls;
}

// --- the work ------------------------------------------------------------------------------------

/// What a child tells its parent, in memory that they share.
struct Shared {
  std::size_t next;  ///< the fault that is tried
  bool finished;
  std::uint64_t injected;
  std::uint64_t found;
  std::uint64_t shown;
};

Shared* shared = nullptr;

void showPlace() {
  const failing_allocation::Place& place = failing_allocation::firstFailure();
  backtrace_symbols_fd(place.frames.data(), place.depth, STDOUT_FILENO);
}

void tellFinding(const Call& call, const Fault& fault, const char* what) {
  ++shared->found;
  constexpr std::uint64_t most_shown = 5;
  if (++shared->shown > most_shown)
    return;
  std::printf("FOUND %s: allocation %llu%s: %s\n", call.name.c_str(),
              static_cast<unsigned long long>(fault.first), fault.all_after ? " and all after" : "",
              what);
  std::fflush(stdout);
  showPlace();
}

/// A program that ends shows where the allocation failed.
void showPlaceAtEnd(int signal_number) {
  end();
  if (shared->shown < 5)
    showPlace();
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

/// Runs a call with a fault and tells what is wrong. Must not allocate where it is measured.
void tryFault(const Call& call, const Fault& fault, std::uint64_t right) {
  const std::int64_t before = failing_allocation::bytesInUse();
  std::string wrong;
  bool failed_cleanly = false;
  try {
    const std::uint64_t sum = call.run(fault);
    end();
    failed_cleanly = sum == told_failure;
    if (!failed_cleanly && sum != right)
      wrong = "another answer";
  } catch (const std::bad_alloc&) {
    end();
    failed_cleanly = true;
    if (call.name.rfind("pcl", 0) == 0)
      wrong = "std::bad_alloc leaves the class";
  } catch (const ComputeError& error) {
    end();
    failed_cleanly = true;
    if (std::strstr(error.what(), "memory") == nullptr)
      wrong = std::string("ComputeError: ") + error.what();
  } catch (const std::exception& error) {
    end();
    wrong = error.what();
  } catch (...) {
    end();
    wrong = "something that is no exception";
  }
  const std::uint64_t failures = failing_allocation::failed();
  shared->injected += failures > 0 ? 1 : 0;
  if (failures == 0 && failed_cleanly)
    wrong = "a failure without a fault";
  const std::int64_t kept =
      failing_allocation::bytesInUse() - before -
      (wrong.capacity() > 15 ? static_cast<std::int64_t>(wrong.capacity()) : 0);
  if (!wrong.empty()) {
    tellFinding(call, fault, wrong.c_str());
  } else if (kept > 0) {
    wrong = "leaks " + std::to_string(kept) + " bytes";
    tellFinding(call, fault, wrong.c_str());
  }
}

/// The tools' own: a file that is written under another name, and nothing else there, whatever
/// fails.
std::vector<Call> callsOfTheTools() {
  return {{"output-file", [](const Fault& fault) -> std::uint64_t {
             static const std::string directory = [] {
               std::string pattern = std::filesystem::temp_directory_path() / "torture.XXXXXX";
               if (mkdtemp(pattern.data()) == nullptr)
                 throw std::runtime_error("no directory can be made");
               return pattern;
             }();
             const std::string path = directory + "/file";
             const auto left = [&] {
               std::uint64_t count = 0;
               for (const auto& entry : std::filesystem::directory_iterator(directory))
                 count += std::filesystem::remove(entry.path()) ? 1U : 0U;
               return count;
             };
             try {
               begin(fault.first, fault.all_after);
               tools::OutputFile file(path);
               file.write("all of it");
               file.commit();
               end();
             } catch (...) {
               end();
               if (left() > 0)
                 throw std::runtime_error("a file is left");
               throw;
             }
             return left() == 1 ? 1 : 2;
           }}};
}

/// What a callback throws; counts itself, so that none is lost or kept.
struct Thrown {
  int number;
};

/// The callback of the PCL class throws at each of its calls: the exception comes out, nothing is
/// left, and the object works as before. \return how many times it did.
std::uint64_t tortureCallback(const Options& options, std::uint64_t most_faults,
                              std::uint64_t& found) {
  const Cloud::Ptr cloud = cloudOf(egg(300, 0.0));
  PclReconstruction reconstruction;
  prepare(reconstruction, cloud);
  reconstruction.setOptions(options);
  pcl::PolygonMesh mesh;
  std::uint64_t calls = 0;
  const auto count = [&](const Progress&) { return ++calls > 0; };
  reconstruction.setProgressCallback(count);
  reconstruction.reconstruct(mesh);
  const std::uint64_t right = sumOf(mesh).sum();
  const std::uint64_t all = calls;
  const std::uint64_t stride = std::max<std::uint64_t>(1, (all + most_faults - 1) / most_faults);
  std::uint64_t injected = 0;
  for (std::uint64_t at = 1; at <= all; at += stride, ++injected) {
    std::uint64_t before = 0;
    std::uint64_t number = 0;
    const auto fail = [&](const char* what) {
      ++found;
      std::printf("FOUND callback, call %llu: %s\n", static_cast<unsigned long long>(at), what);
    };
    mesh = pcl::PolygonMesh();
    reconstruction.setProgressCallback({});
    reconstruction.setInputCloud(Cloud::Ptr(new Cloud));
    reconstruction.reconstruct();
    reconstruction.setInputCloud(cloud);
    reconstruction.setProgressCallback([&](const Progress&) {
      if (++number == at)
        throw Thrown{static_cast<int>(at)};
      return true;
    });
    before = static_cast<std::uint64_t>(failing_allocation::bytesInUse());
    try {
      reconstruction.reconstruct(mesh);
      fail("no exception comes out");
    } catch (const Thrown& thrown) {
      if (thrown.number != static_cast<int>(at))
        fail("another exception comes out");
    }
    // The message is kept, as it should be.
    constexpr std::uint64_t message_size = 256;
    if (static_cast<std::uint64_t>(failing_allocation::bytesInUse()) > before + message_size)
      fail("leaks");
    if (!mesh.polygons.empty() || reconstruction.getResult().triangles.cols() > 0 ||
        reconstruction.getErrorMessage().empty())
      fail("something is left");
    if (number != at)
      fail("it was called again");
    reconstruction.setProgressCallback({});
    reconstruction.reconstruct(mesh);
    if (sumOf(mesh).sum() != right)
      fail("the next call gives another answer");
  }
  std::printf("callback                   %6llu calls, every %llu., %6llu faults\n",
              static_cast<unsigned long long>(all), static_cast<unsigned long long>(stride),
              static_cast<unsigned long long>(injected));
  return injected;
}

/// \return how many faults there were.
std::uint64_t tortureCall(const Call& call, std::uint64_t most_faults, std::uint64_t only,
                          std::uint64_t& found) {
  std::memset(shared, 0, sizeof *shared);
  // Twice: what is made once and kept is made in the first.
  const std::uint64_t first = call.run({});
  const std::uint64_t right = call.run({});
  const std::uint64_t allocations = failing_allocation::counted();
  std::vector<Fault> faults;
  std::uint64_t stride = std::max<std::uint64_t>(1, (allocations + most_faults - 1) / most_faults);
  for (std::uint64_t k = only > 0 ? only : 1; k <= (only > 0 ? only : allocations); k += stride)
    for (const bool all_after : {false, true})
      faults.push_back({k, all_after});
  if (first != right) {
    std::printf("FOUND %s: two calls give two answers\n", call.name.c_str());
    ++shared->found;
  }
  while (shared->next < faults.size()) {
    std::fflush(stdout);
    shared->finished = false;
    const pid_t child = fork();
    if (child == 0) {
      for (const int signal_number : {SIGSEGV, SIGABRT, SIGALRM, SIGBUS, SIGFPE, SIGILL})
        std::signal(signal_number, showPlaceAtEnd);
      for (; shared->next < faults.size(); ++shared->next) {
        alarm(60);
        tryFault(call, faults[shared->next], right);
        // The next call is as any other.
        if (shared->next % 8 == 7 && call.run({}) != right)
          tellFinding(call, faults[shared->next], "the next call gives another answer");
      }
      shared->finished = true;
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (!shared->finished) {
      ++shared->injected;
      const std::string what =
          WIFSIGNALED(status)
              ? "ends the program by signal " + std::to_string(WTERMSIG(status))
              : "ends the program with exit code " + std::to_string(WEXITSTATUS(status));
      tellFinding(call, faults[shared->next], what.c_str());
      ++shared->next;
    }
  }
  std::printf("%-26s %6llu allocations, every %llu., %6llu faults, %llu found\n", call.name.c_str(),
              static_cast<unsigned long long>(allocations), static_cast<unsigned long long>(stride),
              static_cast<unsigned long long>(shared->injected),
              static_cast<unsigned long long>(shared->found));
  std::fflush(stdout);
  found += shared->found;
  return shared->injected;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t most_faults = 1000000;
  std::uint64_t at = 0;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick")
      most_faults = 60;
    else if (word == "--only" && i + 1 < argc)
      only = argv[++i];
    else if (word == "--at" && i + 1 < argc)
      at = std::strtoull(argv[++i], nullptr, 10);
    else {
      std::fprintf(stderr, "usage: torture_allocation [--quick] [--only NAME] [--at K]\n");
      return 2;
    }
  }
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  shared = static_cast<Shared*>(
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  if (shared == MAP_FAILED)
    return 2;

  std::vector<Call> calls = callsOfTheCore();
  for (Call& call : callsOfPcl())
    calls.push_back(std::move(call));
  for (Call& call : callsOfTheTools())
    calls.push_back(std::move(call));
  torture::Row row;
  row.part = "faults";
  row.load = "each allocation of " + std::to_string(calls.size()) +
             " calls fails, alone and with all after it";
  for (const Call& call : calls)
    if (only.empty() || call.name == only) {
      ++row.tried;
      row.injected += tortureCall(call, most_faults, at, row.found);
    }
  int exit_code = torture::print(row);

  if (only.empty() || only == "callback") {
    torture::Row callbacks;
    callbacks.part = "faults";
    callbacks.load = "progress callback of the PCL class throws at each of its calls";
    for (const Options& options : {optionsOfOneThread(), optionsOfThePaper()}) {
      ++callbacks.tried;
      callbacks.injected += tortureCallback(options, most_faults, callbacks.found);
    }
    exit_code = std::max(exit_code, torture::print(callbacks));
  }
  return exit_code;
}
