#pragma once

#include "core/helpers.h"
#include "result_bytes.h"
#include "spherical_param/errors.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/sphere_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <random>
#include <string>

/// Reconstructions of different clouds with different options, and all that they answer as bytes.
namespace torture {

using spherical_param::Index;
using spherical_param::Positions;
namespace test = spherical_param::test;

/// A cloud and what is to be made of it.
struct Job {
  Positions points;
  spherical_param::Options options;
  bool has_map = false;    ///< its map of low distortion, too
  bool is_valid = true;    ///< else InvalidInput is the right answer
  bool is_spiral = false;  ///< test::spiralSphere(): neighbours are known without a search
};

/// How many points jobs have, and what else they may be.
struct JobLimits {
  Index least = 4;
  Index most = 400;
  bool with_invalid = true;  ///< a few clouds that cannot be meshed
  /// Every so-manieth has so many points that the work is shared out among OpenMP's threads.
  std::size_t large_every = 0;
};

/// The same job for the same seed and number.
inline Job makeJob(std::uint64_t seed, std::size_t number, const JobLimits& limits) {
  using namespace spherical_param;
  std::seed_seq sequence{seed, static_cast<std::uint64_t>(number)};
  std::mt19937_64 random(sequence);
  // Not std::uniform_int_distribution: other libraries have another one.
  const auto below = [&random](std::uint64_t count) { return random() % count; };
  Job job;
  // Small ones more often, as many of each order of magnitude.
  const double share = static_cast<double>(below(1000)) / 999.0;
  const double ratio = static_cast<double>(limits.most) / limits.least;
  const auto n = static_cast<Index>(limits.least * std::pow(ratio, share));
  const std::uint64_t shape_seed = random();
  switch (below(6)) {
  case 0:
    job.points = test::spiralSphere(n);
    break;
  case 1:
    job.points = test::randomSphere(n, shape_seed);
    break;
  case 2:
    job.points = Eigen::Vector3d(1.0, 0.6, 0.3).asDiagonal() * test::spiralSphere(n);
    break;
  case 3:
    job.points = test::withNoise(test::spiralSphere(n), 0.02, shape_seed);
    break;
  case 4: {
    const int side = std::max(2, static_cast<int>(std::sqrt(n / 6.0)) + 1);
    job.points = test::cubeGrid(side);
    break;
  }
  default:
    // Each point twice, far from the origin.
    job.points = test::randomSphere(std::max<Index>(4, n / 2), shape_seed);
    job.points = test::horizontally(job.points, job.points);
    job.points.colwise() += Eigen::Vector3d(5e5, 5e6, 100.0);
    break;
  }
  if (limits.large_every > 0 && number % limits.large_every == 1) {
    job.is_spiral = true;
    job.points = test::spiralSphere(4200 + static_cast<Index>(below(600)));
  }
  if (limits.with_invalid && below(40) == 0) {
    job.is_valid = false;
    if (below(2) == 0)
      job.points.row(2).setZero();
    else
      job.points(1, job.points.cols() / 2) = std::numeric_limits<double>::quiet_NaN();
  }

  Options& options = job.options;
  options.graph = below(3) == 0 ? GraphMethod::NearestNeighbors : GraphMethod::LocalDelaunay;
  options.solver = below(5) == 0 ? EmbeddingMethod::Iterative : EmbeddingMethod::Multilevel;
  options.max_iterations = 60;
  options.hull = below(3) == 0 ? TriangulationMethod::Qhull : TriangulationMethod::Incremental;
  options.optimization = std::array{OptimizationMethod::None, OptimizationMethod::Flips,
                                    OptimizationMethod::Full}[below(3)];
  if (below(3) == 0)
    options.k = 5 + static_cast<int>(below(12));
  options.smoothing_steps = below(3) == 0 ? 5 : 0;
  options.attempts = 1 + static_cast<int>(below(3));
  options.starts = 1 + static_cast<int>(below(3));
  options.seed = static_cast<std::uint32_t>(below(1000));
  options.details = below(4) == 0;
  options.history.vertices = below(4) == 0 ? 40 : 0;
  options.threads = 1 + static_cast<int>(below(2));
  job.has_map = below(4) == 0;
  return job;
}

/// The answer to a job.
struct Answer {
  std::string bytes;
  bool is_right = false;  ///< a mesh over all points where there should be one, else InvalidInput
};

/// Makes a job through the core.
inline Answer answer(const Job& job) {
  using namespace spherical_param;
  Bytes bytes;
  try {
    const int k = neighborsToSearch(job.options);
    const NeighborLists lists = job.is_spiral ? test::spiralNeighbors(job.points, k)
                                              : test::bruteForceNeighbors(job.points, k);
    const Result result = reconstruct(
        job.points, lists, job.options,
        job.is_spiral ? NeighborSearch() : NeighborSearch(test::bruteForceSearch(job.points)));
    bytes.add(result);
    const bool is_sphere =
        test::isSphereOverAll(result.triangles, static_cast<Index>(result.vertexCount()));
    if (job.has_map) {
      Positions vertices(3, result.sphere.cols());
      for (std::size_t v = 0; v < result.vertexCount(); ++v)
        vertices.col(static_cast<Eigen::Index>(v)) = job.points.col(result.input_of_vertex[v]);
      SphereMapOptions options;
      options.threads = job.options.threads;
      const SphereMap map = computeSphereMap(vertices, result.triangles, result.sphere, options);
      bytes.add(map.sphere);
      bytes.add(map.distortion.stretch_efficiency);
    }
    return {bytes.take(), job.is_valid && is_sphere};
  } catch (const InvalidInput& error) {
    bytes.add(std::string(error.what()));
    return {bytes.take(), !job.is_valid};
  } catch (const std::exception& error) {
    bytes.add(std::string(error.what()));
    return {bytes.take(), false};
  }
}

}  // namespace torture
