// Reconstructions on several threads of the caller at once answer what they answer alone, and each
// answers the same bytes for any number of threads of its own. Also run with the thread sanitizer.
//
//   stress_threads [--quick] [--seed N]

#include "guarantees.h"
#include "helpers.h"
#include "random.h"
#include "spherical_param/errors.h"
#include "spherical_param/reconstruct.h"
#include "stress.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace spherical_param;

constexpr std::size_t kThreads = 8;

/// A cloud and the options for it.
struct Job {
  Positions points;
  Options options;
  bool is_valid = true;
};

/// The same job for the same seed and number.
Job makeJob(std::uint64_t seed, std::size_t number, Index most_points) {
  stress::Random random(1000000 * seed + number);
  const auto below = [&random](int count) { return random.integer(0, count - 1); };
  Job job;
  const Index n = 8 + below(most_points);
  switch (below(4)) {
  case 0:
    job.points = Eigen::Vector3d(1.0, 0.6, 0.3).asDiagonal() * test::spiralSphere(n);
    break;
  case 1:
    job.points = test::withNoise(test::randomSphere(n, number), 0.02, number);
    break;
  case 2:
    job.points = test::cubeGrid(2 + below(5));
    break;
  default:  // each point twice
    job.points = test::randomSphere(n / 2, number);
    job.points = test::horizontally(job.points, job.points);
    break;
  }
  if (below(20) == 0) {
    job.is_valid = false;
    job.points.row(1).setConstant(0.5);
  }
  Options& options = job.options;
  options.method = below(4) == 0 ? Method::Paper : Method::Default;
  options.paper.max_iterations = 60;
  options.smoothing = below(3) == 0 ? 5 : 0;
  options.seed = static_cast<std::uint32_t>(below(1000));
  options.details = below(4) == 0;
  options.threads = 1 + below(2);
  options.outliers = below(4) == 0 ? OutlierMode::Auto : OutlierMode::None;
  options.parts = below(4) == 0 ? PartsMode::Each : PartsMode::All;
  options.topology = TopologyMode::Sphere;
  options = withTopology(options);
  return job;
}

/// All of the answer as bytes; nothing if it is of the wrong kind.
std::string answerTo(const Job& job) {
  try {
    const Result result = reconstruct(job.points, job.options);
    bool is_right = job.is_valid && stress::faultOfLists(job.points, job.options, result).empty();
    for (const Surface& surface : result.surfaces)
      is_right = is_right && stress::faultOf(job.points, job.options, surface).empty();
    return is_right ? stress::bytesOf(result) : std::string();
  } catch (const InvalidInput& error) {
    return stress::mustBeMeshed(job.points, job.options) ? std::string() : error.what();
  }
}

std::size_t differencesTogether(const stress::Arguments& arguments, std::size_t jobs_of_thread) {
  std::vector<Job> jobs;
  std::vector<std::string> alone;
  for (std::size_t i = 0; i < kThreads * jobs_of_thread; ++i) {
    jobs.push_back(makeJob(arguments.seed, i, arguments.quick ? 100 : 400));
    alone.push_back(answerTo(jobs.back()));
  }
  const auto together = test::runTogether(kThreads, [&](std::size_t thread) {
    std::vector<std::string> answers;
    for (std::size_t i = thread; i < jobs.size(); i += kThreads)
      answers.push_back(answerTo(jobs[i]));
    return answers;
  });
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const bool is_right = !alone[i].empty() && together[i % kThreads][i / kThreads] == alone[i];
    if (!is_right)
      std::printf("job %zu: %s\n", i,
                  alone[i].empty() ? "not the right kind of answer"
                                   : "other bytes together with others than alone");
    wrong += is_right ? 0 : 1;
  }
  return wrong;
}

/// Clouds large enough to be divided among threads.
std::size_t differencesByThreads(const std::vector<Index>& sizes) {
  std::size_t wrong = 0;
  for (const Index size : sizes)
    for (const bool is_paper : {false, true}) {
      const Positions points =
          Eigen::Vector3d(1.0, 0.8, 0.5).asDiagonal() * test::spiralSphere(size);
      Options options;
      if (is_paper) {
        options.method = Method::Paper;
        options.paper.max_iterations = 20;
      }
      std::array<std::string, 3> bytes;
      for (std::size_t i = 0; i < bytes.size(); ++i) {
        options.threads = 1 << i;
        bytes[i] = stress::bytesOf(reconstruct(points, options));
        if (bytes[i] == bytes[0])
          continue;
        ++wrong;
        std::printf("%d points: other bytes with %d threads\n", size, options.threads);
      }
    }
  return wrong;
}

}  // namespace

int main(int argc, char** argv) {
  const stress::Arguments arguments = stress::parse(argc, argv);
  const std::size_t jobs_of_thread = arguments.quick ? 6 : 200;
  std::size_t tried = kThreads * jobs_of_thread;
  std::size_t wrong = differencesTogether(arguments, jobs_of_thread);
  const std::vector<Index> sizes =
      arguments.quick ? std::vector<Index>{6000, 52000} : std::vector<Index>{6000, 52000, 200000};
  tried += 2 * 3 * sizes.size();
  wrong += differencesByThreads(sizes);
  return stress::finish("threads: together as alone, and with 1, 2 and 4", tried, wrong);
}
