// Reconstructions on several threads of the caller at once answer what they answer alone, and each
// answers the same bytes for any number of threads of its own. Also run with the thread sanitizer.
//
//   stress_threads [--quick] [--seed N]

#include "guarantees.h"
#include "nasty_sets.h"
#include "stress.h"

namespace {

using namespace spherical_param;

constexpr std::size_t kThreads = 8;

/// An ordinary cloud, or one in a plane, and options.
stress::NastySet makeSet(std::uint64_t seed, Index most_points) {
  stress::Random random(seed);
  const Index n = random.integer(8, most_points);
  stress::NastySet set;
  if (random.chance(0.25))
    set.points = Eigen::Vector3d(1.0, 0.6, 0.3).asDiagonal() * test::spiralSphere(n);
  else if (random.chance(0.33))
    set.points = test::withNoise(test::randomSphere(n, seed), 0.02, seed);
  else if (random.chance(0.5))
    set.points = test::cubeGrid(random.integer(2, 6));
  else  // each point twice
    set.points = test::randomSphere(n / 2, seed).replicate(1, 2);
  if (random.chance(0.05))
    set.points.row(1).setConstant(0.5);
  set.options = stress::someOptions(random, false);
  return set;
}

std::size_t differencesTogether(const stress::Arguments& arguments, std::size_t sets_of_thread) {
  std::vector<stress::NastySet> sets;
  std::vector<stress::Answer> alone;
  for (std::size_t i = 0; i < kThreads * sets_of_thread; ++i) {
    sets.push_back(makeSet(1000000 * arguments.seed + i, arguments.quick ? 100 : 400));
    alone.push_back(stress::answerTo(sets.back()));
    alone.back().result = {};
  }
  const auto together = test::runTogether(kThreads, [&](std::size_t thread) {
    std::vector<std::string> answers;
    for (std::size_t i = thread; i < sets.size(); i += kThreads)
      answers.push_back(stress::answerTo(sets[i], 1 + static_cast<int>(i / kThreads % 2)).bytes);
    return answers;
  });
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    std::string fault = alone[i].fault;
    if (fault.empty() && together[i % kThreads][i / kThreads] != alone[i].bytes)
      fault = "other bytes together with others than alone";
    if (fault.empty())
      continue;
    ++wrong;
    std::printf("set %zu: %s\n", i, fault.c_str());
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
  const std::size_t sets_of_thread = arguments.quick ? 6 : 200;
  std::size_t tried = kThreads * sets_of_thread;
  std::size_t wrong = differencesTogether(arguments, sets_of_thread);
  const std::vector<Index> sizes =
      arguments.quick ? std::vector<Index>{6000, 52000} : std::vector<Index>{6000, 52000, 200000};
  tried += 2 * 3 * sizes.size();
  wrong += differencesByThreads(sizes);
  return stress::finish("threads: together as alone, and with 1, 2 and 4", tried, wrong);
}
