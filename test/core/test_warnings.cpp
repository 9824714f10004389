#include "warnings.h"

#include "spherical_param/reconstruct.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace spherical_param {
namespace {

constexpr std::size_t kPoints = 1000;

/// Nothing is to be said of it.
Result soundResult() {
  Result result;
  result.vertex_of_input.resize(kPoints);
  result.input_of_vertex.resize(kPoints);
  result.graph.components = 1;
  return result;
}

struct Case {
  std::string text;  ///< of the warning; empty: there is none
  std::function<void(Result&)> change;
};

void expectWarnings(const std::vector<Case>& cases, const Options& options = {}) {
  for (const auto& [text, change] : cases) {
    SCOPED_TRACE(text);
    Result result = soundResult();
    change(result);
    const std::vector<std::string> warnings = internal::warningsOf(options, result);
    ASSERT_EQ(warnings.size(), text.empty() ? 0U : 1U);
    if (!text.empty()) {
      EXPECT_NE(warnings[0].find(text), std::string::npos) << warnings[0];
    }
  }
}

TEST(Warnings, EachFindingHasItsOwn) {
  expectWarnings({
      {"", [](Result&) {}},
      {"7 points repeat", [](Result& r) { r.vertex_of_input.resize(kPoints + 7); }},
      {"1 point looks like an outlier", [](Result& r) { r.outliers = {3}; }},
      {"2 points look like outliers",
       [](Result& r) {
         r.outliers = {3, 4};
       }},
      {"2 pieces", [](Result& r) { r.graph.components = 2; }},
      {"11 points have no trustworthy",
       [](Result& r) { r.graph.without_tangent_plane.resize(11); }},
      {"11 points may have", [](Result& r) { r.graph.uncertified = 11; }},
      {"collapsed to one place", [](Result& r) { r.embedding.fallback_start = true; }},
      {"held by a barrier", [](Result& r) { r.embedding.added_barrier = true; }},
      {"limit of iterations",
       [](Result& r) { r.embedding.stop_reason = StopReason::IterationLimit; }},
      {"no longer changes", [](Result& r) { r.embedding.stop_reason = StopReason::Stagnated; }},
      {"", [](Result& r) { r.embedding.stop_reason = StopReason::Converged; }},
      {"11 points coincide", [](Result& r) { r.triangulation.coincident = 11; }},
      {"It is open.",
       [](Result& r) {
         r.diagnosis.kind = SurfaceKind::Open;
         r.diagnosis.summary = "It is open.";
       }},
      {"noisy", [](Result& r) { r.optimization.noise_steps = 3; }},
      {"",
       [](Result& r) {
         r.optimization.noise_steps = 3;
         r.smoothed.resize(3, kPoints);
       }},
      {"time limit", [](Result& r) { r.optimization.is_out_of_time = true; }},
      {"2 pairs of triangles intersect.", [](Result& r) { r.self_intersections.resize(2); }},
      {"2 pairs of triangles intersect (1 on the smoothed points)",
       [](Result& r) {
         r.self_intersections.resize(2);
         r.smoothed.resize(3, kPoints);
         r.smoothing.self_intersections = 1;
       }},
  });
}

TEST(Warnings, OnePercentOfThePointsIsNotYetMany) {
  expectWarnings({{"", [](Result& r) { r.graph.without_tangent_plane.resize(10); }},
                  {"", [](Result& r) { r.graph.uncertified = 10; }},
                  {"", [](Result& r) { r.triangulation.coincident = 10; }}});
}

TEST(Warnings, FoldedEmbeddingIsOneOnlyWhereNothingOptimisesTheMesh) {
  const auto fold = [](Result& r) { r.diagnosis.edges_outside_graph = 0.002; };
  expectWarnings({{"", fold}});
  Options unoptimized;
  unoptimized.optimization.method = OptimizationMethod::None;
  expectWarnings({{"0.20 % of the mesh's edges", fold},
                  {"(a tolerance may unfold it)", fold},
                  {"folded, or",
                   [&](Result& r) {
                     fold(r);
                     r.embedding.stop_reason = StopReason::Converged;
                   }},
                  {"", [](Result& r) { r.diagnosis.edges_outside_graph = 0.001; }}},
                 unoptimized);
}

}  // namespace
}  // namespace spherical_param
