#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/reconstruction.h>

#include "spherical_param/reconstruct.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcl {
namespace detail {
struct NeighborSource;
}

/** \brief Meshes the point cloud of an object without holes through it (a topological sphere) into
 * a closed, manifold, consistently outward-oriented genus-0 triangle mesh through every distinct
 * finite input point. It needs no normals, no radius and no tuning.
 *
 * A graph of local Delaunay neighbourhoods is embedded on the unit sphere from coarse to fine, so
 * that limbs are unfolded, towards a vanishing tangential Laplacian. The Delaunay triangulation of
 * the embedded points, which is their convex hull, gives a first connectivity; its decisions are
 * exact. It is then optimised on the points themselves, by moves that keep a sphere a sphere, until
 * no triangles intersect, if possible (getSelfIntersections()); the points are never moved. Where
 * some are left although the cloud looks like a closed surface, other runs are tried
 * (setAttempts()). getDiagnosis() tells what speaks against such a surface, and where.
 *
 * The method comes from M. Zwicker, C. Gotsman: "Meshing Point Clouds Using Spherical
 * Parameterization", Eurographics Symposium on Point-Based Graphics, 2004. Their own way, with
 * k nearest neighbours, a damped iteration from the projection from the centroid, and qhull, is
 * setGraphMethod(GraphMethod::NearestNeighbors), setSolver(EmbeddingMethod::Iterative),
 * setTriangulationMethod(TriangulationMethod::Qhull), setOptimization(OptimizationMethod::None) and
 * setAttempts(1).
 *
 * Drop-in for GreedyProjectionTriangulation: change the type and delete the radius and mu setters.
 * Polygons index the input cloud, also if setIndices() gave a subset. Points that are not finite
 * are skipped, exact duplicates become one vertex (that of the first of them); both are counted.
 *
 * Failure (null or empty cloud, an index out of range, fewer than 4 distinct finite points, all
 * points in one plane, an option out of range, cancellation) leaves an empty mesh, prints one line
 * with PCL_ERROR and is told by getErrorMessage(); no exception leaves the class, except one that
 * the progress callback throws.
 *
 * \note Two objects may work in two threads at the same time, unless they share a search object
 * (setSearchMethod()) whose setInputCloud() or queries would race. An object itself must not be
 * used from two threads at once.
 * \note The memory is below 2 KB a point, besides that of the process itself; 3 KB where the
 * multilevel solver has a tolerance on the graph of 25 nearest neighbours. The time is O(n log n),
 * typically, and with the iterative solver iterations times O(n k) more. \note Without a search
 * object of the user, neighbours are found in single precision: within a cluster smaller than 1e-19
 * of the largest coordinate they are arbitrary (the mesh stays sound). \ingroup surface
 */
template <typename PointInT>
class SphericalParamReconstruction : public MeshConstruction<PointInT> {
public:
  /** \brief Shared by several owners. */
  using Ptr = shared_ptr<SphericalParamReconstruction<PointInT>>;
  /** \brief Shared by several owners, none of whom changes it. */
  using ConstPtr = shared_ptr<const SphericalParamReconstruction<PointInT>>;

  /** \brief What setSearchMethod() takes: any pcl::search::Search. */
  using KdTree = typename MeshConstruction<PointInT>::KdTree;
  /** \brief Shared pointer to such a search object. */
  using KdTreePtr = typename MeshConstruction<PointInT>::KdTreePtr;
  /** \brief The type of the input cloud. */
  using PointCloudIn = pcl::PointCloud<PointInT>;

  /** \brief How points become neighbours. */
  using GraphMethod = spherical_param::GraphMethod;
  /** \brief How the graph is embedded on the sphere. */
  using EmbeddingMethod = spherical_param::EmbeddingMethod;
  /** \brief How the points on the sphere are triangulated. */
  using TriangulationMethod = spherical_param::TriangulationMethod;
  /** \brief Weights of the Laplacian. */
  using EdgeWeights = spherical_param::EdgeWeights;
  /** \brief How far the mesh is optimised on the points. */
  using OptimizationMethod = spherical_param::OptimizationMethod;
  /** \brief Told how far the work is; returning false cancels it. */
  using ProgressCallback = std::function<bool(const spherical_param::Progress&)>;

  SphericalParamReconstruction();
  ~SphericalParamReconstruction() override = default;

  /** \brief Set how points become neighbours.
   * \param[in] method default GraphMethod::LocalDelaunay
   * \note Set GraphMethod::NearestNeighbors to compare with the paper, or to join parts of a cloud
   * by a large k (setKSearch()). */
  inline void setGraphMethod(GraphMethod method) { options_.graph = method; }
  /** \brief Get how points become neighbours.
   * \return that of setGraphMethod(), or the default */
  inline GraphMethod getGraphMethod() const { return options_.graph; }

  /** \brief Set how the graph is embedded on the sphere.
   * \param[in] method default EmbeddingMethod::Multilevel
   * \note Set EmbeddingMethod::Iterative for the paper's iteration; it folds limbs. */
  inline void setSolver(EmbeddingMethod method) { options_.solver = method; }
  /** \brief Get how the graph is embedded on the sphere.
   * \return that of setSolver(), or the default */
  inline EmbeddingMethod getSolver() const { return options_.solver; }

  /** \brief Set how the points on the sphere are triangulated.
   * \param[in] method default TriangulationMethod::Incremental
   * \note Set TriangulationMethod::Qhull to compare with the paper; it is slower, and has to put
   * back points where they are dense. */
  inline void setTriangulationMethod(TriangulationMethod method) { options_.hull = method; }
  /** \brief Get how the points on the sphere are triangulated.
   * \return that of setTriangulationMethod(), or the default */
  inline TriangulationMethod getTriangulationMethod() const { return options_.hull; }

  /** \brief Set the number of neighbours of each point that are searched for.
   * \param[in] k 3 and up; clouds with fewer than k + 1 points use all others. Unless it is set,
   * 25 (the paper's) for GraphMethod::NearestNeighbors and 12 for GraphMethod::LocalDelaunay, which
   * asks for more where it needs them.
   * \note For nearest neighbours, raise it for clouds with noise or uneven density along scan
   * lines, and lower it where sheets of the surface come close to each other. Local Delaunay
   * neighbourhoods hardly depend on it, and use no more than 32. */
  inline void setKSearch(int k) { options_.k = k; }
  /** \brief Get the number of neighbours of each point that are searched for: that of setKSearch(),
   * or the default of the graph method.
   * \return that of setKSearch(), or the default */
  inline int getKSearch() const { return spherical_param::neighborsToSearch(options_); }

  /** \brief Set the weights of the Laplacian (equations 2 to 4 of the paper).
   * \param[in] weights default EdgeWeights::Adaptive
   * \note Adaptive weights alone keep the embedding from collapsing by themselves. Of the other
   * two, which are for comparison, the multilevel solver has to hold the centroid, and their
   * tangential Laplacian vanishes only together with that pull. */
  inline void setWeights(EdgeWeights weights) { options_.weights = weights; }
  /** \brief Get the weights of the Laplacian.
   * \return that of setWeights(), or the default */
  inline EdgeWeights getWeights() const { return options_.weights; }

  /** \brief Set the exponent p of the energy that adaptive weights minimise.
   * \param[in] exponent in (2, 16]; default 3, that of the paper's weights and all that the
   * iterative solver takes. Other weights use it for their start alone.
   * \note Raise it where the tips of long limbs become too dense on the sphere: along a limb of
   * radius r the map shrinks like exp(-s / (r sqrt(p - 1))). Above 4, set a tolerance as well:
   * smoothing alone then leaves folds; far above it Newton's method may not converge either. */
  inline void setExponent(double exponent) { options_.exponent = exponent; }
  /** \brief Get the exponent p of the energy that adaptive weights minimise.
   * \return that of setExponent(), or the default */
  inline double getExponent() const { return options_.exponent; }

  /** \brief Set the damping of the iteration, and of the smoothing sweeps of the multilevel solver.
   * \param[in] lambda share of the tangential Laplacian that a step makes, in (0, 1]; default 0.5,
   * the paper's.
   * \note Lower it if the residuals oscillate. */
  inline void setLambda(double lambda) { options_.lambda = lambda; }
  /** \brief Get the damping of the iteration and of the smoothing sweeps.
   * \return that of setLambda(), or the default */
  inline double getLambda() const { return options_.lambda; }

  /** \brief Set how many starts the multilevel solver tries on its coarsest level.
   * \param[in] starts 1 to 100; default 2. The one of least energy is kept.
   * \note Raise it where starts collapse (getResult().embedding.collapsed_starts); it costs little
   * for large clouds. */
  inline void setStarts(int starts) { options_.starts = starts; }
  /** \brief Get how many starts the multilevel solver tries.
   * \return that of setStarts(), or the default */
  inline int getStarts() const { return options_.starts; }

  /** \brief Set the seed of all that is random: the order in which the multilevel solver coarsens
   * the graph, and the parts of the mesh that OptimizationMethod::Full takes out.
   * \param[in] seed any number; default 1. The same seed gives the same result.
   * \note Change it to see how much the result rests on it. */
  inline void setSeed(std::uint32_t seed) { options_.seed = seed; }
  /** \brief Get the seed of all that is random.
   * \return that of setSeed(), or the default */
  inline std::uint32_t getSeed() const { return options_.seed; }

  /** \brief Set the number of iterations of the iterative solver at most.
   * \param[in] iterations 0 and up; default 1600, as in Table 1 of the paper.
   * \note Has no effect once the iteration has stagnated (getResult().embedding.stop_reason). */
  inline void setMaximumIterations(int iterations) { options_.max_iterations = iterations; }
  /** \brief Get the number of iterations of the iterative solver at most.
   * \return that of setMaximumIterations(), or the default */
  inline int getMaximumIterations() const { return options_.max_iterations; }

  /** \brief Set the mean length of the tangential Laplacian at which the embedding has converged.
   * \param[in] tolerance in radii of the sphere, 0 and up. Unless it is set, the iterative solver
   * aims at 1e-8; the multilevel solver ends with its smoothing sweeps and does not converge.
   * \note Set it, 1e-8 say, for a map that hardly depends on how it was reached, and where
   * smoothing alone leaves folds (getResult().edges_outside_graph), as it may on long thin limbs.
   * Otherwise the mesh hardly gains by the time. */
  inline void setTolerance(double tolerance) { options_.tolerance = tolerance; }
  /** \brief Take back setTolerance().
   * \note The way back to the default of the solver at hand. */
  inline void unsetTolerance() { options_.tolerance.reset(); }
  /** \brief Get the mean length of the tangential Laplacian at convergence that is in force: that
   * of setTolerance(), or the default of the solver; none if convergence is not asked for.
   * \return that of setTolerance(), or the default */
  inline std::optional<double> getTolerance() const {
    if (!options_.tolerance && options_.solver == EmbeddingMethod::Iterative)
      return spherical_param::EmbeddingOptions().tolerance;
    return options_.tolerance;
  }

  /** \brief Set the number of iterations over which the iterative solver judges stagnation.
   * \param[in] window 2 and up, or 0 to never stop for stagnation; default 100.
   * \note Set 0 to reproduce the paper's fixed number of iterations. */
  inline void setStagnationWindow(int window) { options_.stagnation_window = window; }
  /** \brief Get the number of iterations over which the iterative solver judges stagnation.
   * \return that of setStagnationWindow(), or the default */
  inline int getStagnationWindow() const { return options_.stagnation_window; }

  /** \brief Set how far the mesh is optimised on the points.
   * \param[in] method default OptimizationMethod::Full
   * \note Set OptimizationMethod::None for the mesh that the sphere gives, and
   * OptimizationMethod::Flips where time matters more than the last self-intersections. */
  inline void setOptimization(OptimizationMethod method) { options_.optimization = method; }
  /** \brief Get how far the mesh is optimised on the points.
   * \return that of setOptimization(), or the default */
  inline OptimizationMethod getOptimization() const { return options_.optimization; }

  /** \brief Set how many whole runs are tried, at most, while the mesh intersects itself although
   * the cloud looks like a closed surface.
   * \param[in] attempts 1 to 100; default 4. The best counts (getResult().attempts).
   * \note Set 1 where time matters; a run that needs no other takes no longer for a larger one. */
  inline void setAttempts(int attempts) { options_.attempts = attempts; }
  /** \brief Get how many whole runs are tried at most.
   * \return that of setAttempts(), or the default */
  inline int getAttempts() const { return options_.attempts; }

  /** \brief Set the strength of the smoothing that takes noise off the points.
   * \param[in] steps 0 (default) to 10000; 0: none. About that of so many steps of the paper's
   * section 4.2.
   * \note The mesh keeps the points of the input; the smoothed ones are those of
   * getSmoothedPoints(), for which the same polygons hold. */
  inline void setSmoothingSteps(int steps) { options_.smoothing_steps = steps; }
  /** \brief Get the strength of the smoothing, 0: none.
   * \return that of setSmoothingSteps(), or the default */
  inline int getSmoothingSteps() const { return options_.smoothing_steps; }

  /** \brief Set what is kept of how the embedding unfolded (getResult().history).
   * \param[in] limits most vertices and states; by default nothing is kept.
   * \note Its vertices are those that getVertexIndices() lists. The mesh does not depend on it. */
  inline void setHistory(const spherical_param::HistoryLimits& limits) {
    options_.history = limits;
  }
  /** \brief Get what is kept of how the embedding unfolded.
   * \return the limits that were set. */
  inline const spherical_param::HistoryLimits& getHistory() const { return options_.history; }

  /** \brief Set whether residuals of single vertices (getResult().vertex_residuals) and marks of
   * suspicious triangles (getDiagnosis().triangle_marks) are kept as well.
   * \param[in] details default false
   * \note Set it to show where a mesh is not to be trusted. The mesh does not depend on it. */
  inline void setDetails(bool details) { options_.details = details; }
  /** \brief Get whether residuals of single vertices and marks of triangles are kept.
   * \return what was set. */
  inline bool getDetails() const { return options_.details; }

  /** \brief Set the number of threads. The result does not depend on it.
   * \param[in] threads 0 (default): as many as OpenMP would use. */
  inline void setNumberOfThreads(unsigned int threads = 0) {
    options_.threads = static_cast<int>(threads);
  }
  /** \brief Get the number of threads, 0: as many as OpenMP would use.
   * \return that of setNumberOfThreads(), or the default */
  inline unsigned int getNumberOfThreads() const {
    return static_cast<unsigned int>(options_.threads);
  }

  /** \brief Set all options at once, the progress callback among them, in place of what was set.
   * \param[in] options checked by reconstruct() */
  inline void setOptions(const spherical_param::Options& options) { options_ = options; }
  /** \brief Get all options at once.
   * \return those in force */
  inline const spherical_param::Options& getOptions() const { return options_; }

  /** \brief Set a function that is told how far the work is; returning false cancels it.
   * \param[in] progress called from the thread that called reconstruct(); may be empty. Its stages
   * are those of spherical_param::Progress, after one named "neighbors" for the search. */
  inline void setProgressCallback(const ProgressCallback& progress) {
    options_.progress = progress;
  }
  /** \brief Get the function that is told how far the work is.
   * \return that of setProgressCallback(), or the default */
  inline const ProgressCallback& getProgressCallback() const { return options_.progress; }

  /** \brief Mesh the points given in setInputCloud() and setIndices().
   * \param[out] output header and cloud (with every field) are those of the whole input cloud,
   * polygons are the triangles; both are cleared first. Empty after a failure. */
  void reconstruct(pcl::PolygonMesh& output) override;

  /** \brief Mesh the points given in setInputCloud() and setIndices().
   * \param[out] polygons the triangles, indices into the input cloud; cleared first. */
  void reconstruct(std::vector<pcl::Vertices>& polygons) override;

  /** \brief Mesh the points given in setInputCloud() and setIndices(), for getResult() alone: its
   * triangles take 24 bytes a point, polygons 112 and more. */
  void reconstruct();

  /** \brief Get the result of the last reconstruct(); a default-constructed one after a failure.
   * Its "inputs" are the points getUsedIndices() lists; its vertices are the points that
   * getVertexIndices() lists. Its first stage is "neighbors", the search. Volume, area, centroid
   * and inertia of the mesh are in `measures`.
   * \return the result, which the next reconstruct() replaces */
  inline const spherical_param::Result& getResult() const { return result_; }

  /** \brief Get the indices into the input cloud of the points that were meshed: those of
   * setIndices() (or all), without repetitions and without points that are not finite.
   * \return their indices, in the order of the input */
  inline const pcl::Indices& getUsedIndices() const { return used_indices_; }

  /** \brief Get the index into the input cloud of each vertex of getResult().
   * \return one index for each vertex */
  inline const pcl::Indices& getVertexIndices() const { return vertex_indices_; }

  /** \brief Get the number of points that were skipped because they are not finite.
   * \return their number */
  inline std::size_t getIgnoredPointCount() const { return ignored_points_; }

  /** \brief Get the embedding on the unit sphere, one point for each point of the input cloud, so
   * that the polygons fit it as well. Duplicates have the place of their vertex; points that were
   * skipped or not in the indices are NaN. Empty after a failure.
   * \note Where the optimisation moved vertices, as it does on noise, some polygons are inverted on
   * the sphere; with OptimizationMethod::None none are, but for rounding.
   * \return a new cloud of the size of the input */
  pcl::PointCloud<pcl::PointXYZ>::Ptr getSphereCoordinates() const;

  /** \brief Get the points after the steps of setSmoothingSteps(), one for each point of the input
   * cloud, so that the polygons fit them as well. Duplicates have the place of their vertex; points
   * that were skipped or not in the indices are NaN. Empty without smoothing and after a failure.
   * \note In double precision, by vertex, they are getResult().smoothed; how far they moved is in
   * getResult().smoothing.
   * \return a new cloud of the size of the input, or an empty one */
  pcl::PointCloud<pcl::PointXYZ>::Ptr getSmoothedPoints() const;

  /** \brief Get the pairs of triangles of the mesh that intersect, as indices of polygons of the
   * last reconstruct(), {lower, higher}, ascending. Measured on the points of the input, in exact
   * arithmetic.
   * \note On noisy points some are often left; see setSmoothingSteps().
   * \return the pairs; none is what a clean scan should give */
  inline const std::vector<std::array<spherical_param::Index, 2>>& getSelfIntersections() const {
    return result_.self_intersections;
  }

  /** \brief Get what speaks against a closed surface without handles, in one piece, and where. Its
   * indices are vertices, which getVertexIndices() maps to the cloud.
   * \note The mesh is a sphere whatever the cloud shows: this tells whether it should be.
   * \return what was found, with one sentence in `summary` */
  inline const spherical_param::SurfaceDiagnosis& getDiagnosis() const { return result_.diagnosis; }

  /** \brief Tell whether the embedding of the last reconstruct() reached the tolerance; false if
   * none was in force (getTolerance()).
   * \note Where the multilevel solver holds the centroid by a barrier (uniform and inverse-length
   * weights, or getResult().embedding.added_barrier), its pull mostly keeps the tangential
   * Laplacian above a small tolerance.
   * \return whether it did */
  inline bool hasConverged() const {
    return result_.sphere.cols() > 0 &&
           result_.embedding.stop_reason == spherical_param::StopReason::Converged;
  }

  /** \brief Get the cause and the remedy of the last failure; empty after a success.
   * \return one sentence */
  inline const std::string& getErrorMessage() const { return error_message_; }

protected:
  using MeshConstruction<PointInT>::input_;
  using MeshConstruction<PointInT>::indices_;
  using MeshConstruction<PointInT>::fake_indices_;
  using MeshConstruction<PointInT>::initCompute;
  using MeshConstruction<PointInT>::deinitCompute;
  using MeshConstruction<PointInT>::tree_;
  using MeshConstruction<PointInT>::check_tree_;

  /** \brief Get the name that messages begin with.
   * \return the name of the class */
  std::string getClassName() const override { return "SphericalParamReconstruction"; }

  /** \brief Do the work of reconstruct().
   * \param[out] output as there */
  void performReconstruction(pcl::PolygonMesh& output) override;
  /** \brief Do the work of reconstruct().
   * \param[out] polygons as there */
  void performReconstruction(std::vector<pcl::Vertices>& polygons) override;

private:
  /** \brief Fills the results. */
  void meshPoints();

  /** \brief Clears the results, does the work and, if that fails, clears results and output and
   * says why. */
  void run(const std::function<void()>& work, const std::function<void()>& clear_output);

  void clearResults();

  /** \brief Throws InvalidInput for a cloud or indices that initCompute() must not see. */
  void checkInput() const;

  /** \brief Fills used_indices_ and counts ignored_points_.
   * \return the used points, 3 x used_indices_.size() */
  spherical_param::Positions collectPoints();

  /** \brief Gives the distinct points to the search object of setSearchMethod().
   * \param[in] point_of_distinct the first of the used points at each of them */
  detail::NeighborSource
  useSearchMethod(const std::vector<spherical_param::Index>& point_of_distinct) const;

  spherical_param::Options options_;
  spherical_param::Result result_;
  pcl::Indices used_indices_;
  pcl::Indices vertex_indices_;
  std::size_t input_size_ = 0;
  std::size_t ignored_points_ = 0;
  std::string error_message_;
};

}  // namespace pcl

#ifdef PCL_NO_PRECOMPILE
#include <pcl/surface/impl/spherical_param_reconstruction.hpp>
#endif
