// Meshes many nasty sets of points, in many ways. Exact arithmetic checks each answer.
//
//   stress_shapes [--quick] [--seed N]

#include "guarantees.h"
#include "nasty_sets.h"
#include "stress.h"

#include <atomic>

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

/// Whether faults that are planted in an octahedron are found.
bool findsPlantedFaults() {
  Positions points(3, 6);
  points << 1, -1, 0, 0, 0, 0,  //
      0, 0, 1, -1, 0, 0,        //
      0, 0, 0, 0, 1, -1;
  Triangles sound(3, 8);
  sound << 0, 2, 1, 3, 2, 1, 3, 0,  //
      2, 1, 3, 0, 0, 2, 1, 3,       //
      4, 4, 4, 4, 5, 5, 5, 5;
  Triangles flipped = sound;
  std::swap(flipped(0, 3), flipped(1, 3));
  Triangles inside_out = sound;
  inside_out.row(0).swap(inside_out.row(1));
  Triangles twice(3, 16);
  twice << sound, (sound.array() + 6).matrix();
  return test::isSphereOverAll(sound, 6) && !test::isSphereOverAll(sound.leftCols(7), 6) &&
         !test::isSphereOverAll(twice, 12) && !test::isSphereOverAll(flipped, 6) &&
         !test::isSphereOverAll(sound, 7) && !stress::facesInward(points, sound) &&
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
      const std::string fault = tryOut(set, arguments.seed + i);
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
