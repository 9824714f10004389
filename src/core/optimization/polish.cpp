#include "polish.h"

#include "optimization_constants.h"
#include "relocation.h"

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;

bool isEven(const Sampling& sampling) {
  return sampling.alignment < tuned::kMaxUnalignedSampling &&
         sampling.unevenness < tuned::kMaxEvenSampling;
}

}  // namespace

void flipFor(Workbench& bench, const Sampling& sampling, double mu) {
  SurfaceEnergy energy;
  energy.bend = isEven(sampling) ? SurfaceEnergy::Bend::Excess : SurfaceEnergy::Bend::Power;
  energy.mu = isEven(sampling) ? tuned::kEvenMu : mu;
  bench.mesh.setEnergy(energy);
  bench.flips.flipAll(bench.report, [&] { return bench.isOverdue(); });
}

void polish(Workbench& bench, const Sampling& sampling) {
  flipFor(bench, sampling, tuned::kPolishMu);
  if (!isEven(sampling))
    relocate(bench, roughVertices(bench.mesh));
}

}  // namespace spherical_param::internal
