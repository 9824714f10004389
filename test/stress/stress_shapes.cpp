// Meshes many nasty sets of points, in many ways. Exact arithmetic checks each answer, which must
// come within a minute.
//
//   stress_shapes [--quick] [--seed N]

#include "guarantees.h"
#include "nasty_sets.h"
#include "stress.h"

#include <atomic>
#include <future>

namespace {

using namespace spherical_param;

/// What is wrong with the answer to a set; empty if nothing is.
std::string tryOut(const stress::NastySet& set, std::uint64_t seed) {
  stress::Random random(seed ^ 0x5eedULL);
  const NeighborSearchFactory search_of =
      random.chance(0.4) ? test::bruteForceFactory(set.points) : NeighborSearchFactory();
  const stress::Answer answer = stress::answerTo(set, 1, search_of);
  if (!answer.fault.empty())
    return answer.fault;
  if (random.chance(0.25) && answer.bytes != stress::answerTo(set, 3, search_of).bytes)
    return "other bytes with 3 threads";
  return "";
}

/// Whether faults that are planted in a tetrahedron are found.
bool findsPlantedFaults() {
  const Positions points = test::horizontally(Positions::Zero(3, 1), Positions::Identity(3, 3));
  const Triangles sound = test::tetrahedron();
  Triangles flipped = sound;
  std::swap(flipped(0, 3), flipped(1, 3));
  Triangles inside_out = sound;
  inside_out.row(0).swap(inside_out.row(1));
  Triangles twice(3, 8);
  twice << sound, test::tetrahedron(4);
  return test::isSphereOverAll(sound, 4) && !test::isSphereOverAll(sound.leftCols(3), 4) &&
         !test::isSphereOverAll(twice, 8) && !test::isSphereOverAll(flipped, 4) &&
         !test::isSphereOverAll(sound, 5) && !stress::facesInward(points, sound) &&
         stress::facesInward(points, inside_out);
}

}  // namespace

int main(int argc, char** argv) {
  const stress::Arguments arguments = stress::parse(argc, argv);
  if (!findsPlantedFaults()) {
    std::printf("the checks overlook planted faults\n");
    return 2;
  }
  const std::size_t sets = arguments.quick ? 300 : 10000;
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> found{0};
  const auto work = [&](std::size_t) {
    for (std::size_t i = next++; i < sets; i = next++) {
      const stress::NastySet set = stress::makeNastySet(arguments.seed + i);
      std::future<std::string> answer =
          std::async(std::launch::async, [&] { return tryOut(set, arguments.seed + i); });
      if (answer.wait_for(std::chrono::seconds(60)) == std::future_status::timeout) {
        std::printf("seed %llu (%s): no end within 60 s\n", arguments.seed + i, set.family.c_str());
        stress::finish("nasty sets of points", i, found + 1);
        std::fflush(stdout);
        std::_Exit(1);  // the work cannot be ended
      }
      const std::string fault = answer.get();
      if (fault.empty())
        continue;
      ++found;
      std::printf("seed %llu (%s): %s\n", arguments.seed + i, set.family.c_str(), fault.c_str());
    }
    return 0;
  };
  test::runTogether(std::max(1U, std::thread::hardware_concurrency()), work);
  return stress::finish("nasty sets of points", sets, found);
}
