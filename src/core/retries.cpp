#include "retries.h"

#include <string>

namespace spherical_param::internal {
namespace {

/// Neighbours of the graph of a retry, fewer than usual: no far ones.
constexpr int kFewNeighbors = 8;

}  // namespace

Plan planOf(int run, const Options& options) {
  Plan plan{"as asked", options};
  if (run == 0)
    return plan;
  if (options.graph.method == GraphMethod::LocalDelaunay) {
    if (run == 1) {
      plan.description = "one star is enough";
      plan.options.graph.agreement = StarAgreement::Either;
      return plan;
    }
    if (run == 2) {
      plan.description = std::to_string(kFewNeighbors) + " nearest neighbours";
      plan.options.graph.method = GraphMethod::NearestNeighbors;
      plan.options.graph.k = kFewNeighbors;
      return plan;
    }
    run -= 2;
  }
  if (run == 2) {
    plan.description = "radial start";
    plan.options.embedding.method = EmbeddingMethod::Iterative;
    plan.options.embedding.exponent = 3.0;
    plan.options.embedding.max_iterations = 0;
    return plan;
  }
  plan.options.seed += static_cast<std::uint32_t>(run);
  plan.description = "seed " + std::to_string(plan.options.seed);
  return plan;
}

}  // namespace spherical_param::internal
