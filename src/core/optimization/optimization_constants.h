#pragma once

#include <cstddef>

/// All tuned constants of the optimisation.
///
/// Their effect on models and scans is in the tables of `tools/benchmark.sh OUT MODELS --only
/// comparison`: self-intersections, distance from the true mesh, its edges that are found, and
/// time.
namespace spherical_param::internal::optimization_constants {

// --- Energy --------------------------------------------------------------------------------------

/// mu of equation (1), and that of the polish of uneven and of even samplings. A larger kMu leaves
/// self-intersections in raw scans and random samples. The two others, and the polish itself, find
/// more of the edges of designed models.
constexpr double kMu = 0.3;
constexpr double kPolishMu = 0.8;
constexpr double kEvenMu = 4.0;

/// Up to this alignment and unevenness the sampling is even, and angles count only beyond the free
/// angle. Simplified and designed models have an alignment of 0.19 to 0.63, scans and even or
/// random samplings -0.01 to 0.13; scans and even samplings have an unevenness of 0.03 to 0.22,
/// random samplings 0.33 to 0.39. With all samplings taken as uneven, or all as even, models are
/// meshed much farther from the truth.
constexpr double kMaxUnalignedSampling = 0.16;
constexpr double kMaxEvenSampling = 0.3;

// --- Gains ---------------------------------------------------------------------------------------

/// Changes of the energy below this are rounding [mean length of the graph's edges].
constexpr double kMinGain = 1e-9;

// --- Rough vertices ------------------------------------------------------------------------------

/// Edges with a smaller cosine between their triangles' normals (37 degrees) are sharp, those below
/// the other one (120 degrees) folded. Other values leave more self-intersections in noisy clouds.
constexpr double kMinSmoothCosine = 0.8;
constexpr double kMinUnfoldedCosine = -0.5;
/// Neighbours in the graph up to this distance [mean length of a vertex's edges] should be near on
/// the mesh. With 1 or 2.5, noisy clouds keep more self-intersections.
constexpr double kMaxNearNeighbor = 1.5;
/// Maximum number of rounds of relocation, and of closing open triangles without a loop, of which
/// untangling may leave more. With 2, some models keep self-intersections.
constexpr int kMaxRounds = 4;

// --- Ruin and recreate ---------------------------------------------------------------------------

/// Maximum number of rounds of unfolding. With fewer, some models and noisy clouds stay tangled.
constexpr int kMaxUnfoldingRounds = 5;
/// Vertices of a part around a folded edge: this number, doubled up to 8 times as many. Larger
/// first parts, or smaller last ones, leave self-intersections.
constexpr std::size_t kMinRuin = 4;
/// Maximum work of all repairs for each point, and 1,000 more [vertices taken out and put back]. A
/// vertex takes 10 to 16 us, a point of a clean mesh needs some 10 in all.
constexpr std::size_t kMaxWorkOfPoint = 10;
/// The maximum beyond 3,300 points: this, and 1 for each point. Less work leaves more clouds with
/// self-intersections; more is time spent on tangles.
constexpr std::size_t kMaxWork = 40000;
/// A part of a cloud has its fraction of kMaxWork, and at least this.
constexpr std::size_t kMinWork = 2000;
/// Fraction of the work that unfolding may take: what folds many times would leave nothing for the
/// rest.
constexpr double kUnfoldingWork = 0.5;

// --- Untangling ----------------------------------------------------------------------------------

/// Maximum number of rounds by energy only: the energy resolves more than the number of
/// intersections, but may get stuck with the last ones. Noisy points have none.
constexpr int kMaxRoundsByEnergy = 2;
/// Rounds by number in a row without a gain: one for each size of the parts. clearIntersections()
/// clears the rest sooner than further rounds.
constexpr int kMaxIdleRounds = 3;
/// Maximum number of rounds by number: each searches the whole mesh for intersections. Noisy and
/// coarse clouds take up to 30.
constexpr int kMaxRoundsByNumber = 100;
/// Vertices of a part around two triangles that intersect: this number, doubled up to 16 times as
/// many. Rounds by number begin with parts up to four times as many; each round without a gain
/// doubles that. Of parts of 6 vertices 61 % gain, of those of 96, 6 %, in 20 times as long. Rounds
/// by energy have parts up to 8 times as many.
constexpr std::size_t kMinUntangled = 6;
/// Vertices around two intersecting triangles whose edges are flipped. With 96, a folded tube keeps
/// its spikes.
constexpr std::size_t kFlipRegion = 64;
/// Intersections are counted among twice the vertices of the part plus this number. With 0, or with
/// 96, more of them stay.
constexpr std::size_t kWatchedVertices = 200;

}  // namespace spherical_param::internal::optimization_constants
