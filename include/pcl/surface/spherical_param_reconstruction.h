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

/** \brief Meshes the point cloud of an object without holes through it (a topological sphere) into
 * a closed, manifold, consistently outward-oriented genus-0 triangle mesh through every distinct
 * finite input point. It needs no normals, no radius and no tuning.
 *
 * A graph of local Delaunay neighbourhoods is embedded on the unit sphere from coarse to fine, so
 * that limbs are unfolded, towards a vanishing tangential Laplacian. The Delaunay triangulation of
 * the embedded points, which is their convex hull, gives a first connectivity; its decisions are
 * exact. It is then optimised on the points themselves, by moves that keep a sphere a sphere, until
 * no triangles intersect, if possible (getSelfIntersections()); the points are never moved.
 * getDiagnosis() lists what speaks against a closed surface without handles, and where.
 *
 * The method comes from M. Zwicker, C. Gotsman: "Meshing Point Clouds Using Spherical
 * Parameterization", Eurographics Symposium on Point-Based Graphics, 2004. Their own way, with
 * k nearest neighbours, a damped iteration from the projection from the centroid, and qhull, is
 * setGraphMethod(GraphMethod::NearestNeighbors), setEmbeddingMethod(EmbeddingMethod::Iterative),
 * setTriangulationMethod(TriangulationMethod::Qhull) and
 * setOptimizationMethod(OptimizationMethod::None).
 *
 * Drop-in for GreedyProjectionTriangulation: change the type and delete the radius and mu setters.
 * Polygons index the input cloud, also if setIndices() gave a subset. Points that are not finite
 * are skipped, exact duplicates become one vertex (that of the first of them); both are counted.
 *
 * Failure (null or empty cloud, an index out of range, fewer than 4 distinct finite points, all
 * points in one plane, an option out of range, cancellation) leaves an empty mesh, prints one line
 * with PCL_ERROR, which getErrorMessage() returns as well; no exception leaves the class, except
 * one that the progress callback throws.
 *
 * \note Two objects may work in two threads at the same time, unless they share a search object
 * (setSearchMethod()) whose setInputCloud() or queries would race. An object itself must not be
 * used from two threads at once.
 * \note The core finds the neighbours, in double precision. A search object that is set by
 * setSearchMethod() is used instead, from the calling thread alone.
 * \note The memory is below 2 KB a point, besides that of the process itself; 3 KB where the
 * multilevel embedding has a tolerance on the graph of 25 nearest neighbours. The time is
 * O(n log n), typically, and with the iterative embedding iterations times O(n k) more.
 * \ingroup surface
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
  /** \brief Whether points are consolidated before they are meshed. */
  using ConsolidationMode = spherical_param::ConsolidationMode;
  /** \brief What becomes of openings of the surface. */
  using SurfaceMode = spherical_param::SurfaceMode;
  /** \brief Which points are left out. */
  using OutlierMode = spherical_param::OutlierMode;
  /** \brief Which parts of the cloud are meshed. */
  using PartsMode = spherical_param::PartsMode;
  /** \brief Receives the progress of the work; returning false cancels it. */
  using ProgressCallback = std::function<bool(const spherical_param::Progress&)>;

  SphericalParamReconstruction();
  ~SphericalParamReconstruction() override = default;

  /** \brief Set whether the points are moved to the surface that they sample, and merged below
   * their noise, before they are meshed: for noisy scans, and several that were merged. \param[in]
   * mode default ConsolidationMode::None \note The polygons then join the first input points of the
   * merged ones; their places are those of getMovedPoints(). Neighbours are found in double
   * precision then, not by the search object. How many points were merged, and how far they moved,
   * is in Surface::consolidation of getResult(). */
  inline void setConsolidation(ConsolidationMode mode) { options_.consolidation = mode; }
  /** \brief Get whether the points are consolidated.
   * \return the mode */
  inline ConsolidationMode getConsolidation() const { return options_.consolidation; }

  /** \brief Set what becomes of openings of the surface.
   * \param[in] mode default SurfaceMode::Closed: they are filled. Open leaves them open; Auto those
   * alone that are certain.
   * \note The openings, and how certain they are, are in getResult(), and so is the boundary of a
   * mesh that is left open. */
  inline void setSurface(SurfaceMode mode) { options_.surface = mode; }
  /** \brief Get what becomes of openings of the surface.
   * \return the mode */
  inline SurfaceMode getSurface() const { return options_.surface; }

  /** \brief Set up to which size openings are filled although the surface is left open.
   * \param[in] edges of the loop around an opening; default 0, none */
  inline void setFillHoles(int edges) { options_.fill_holes = edges; }
  /** \brief Get up to which size openings are filled.
   * \return the number of edges around them */
  inline int getFillHoles() const { return options_.fill_holes; }

  /** \brief Set which points are left out before all else, as they belong to no surface.
   * \param[in] mode default OutlierMode::None. Auto: stray points, small clusters of them and
   * single points near a surface. Deviation: points too far from the average of their neighbours.
   * \note Which they are is in getResult().left_out. */
  inline void setOutliers(OutlierMode mode) { options_.outliers = mode; }
  /** \brief Get which points are left out.
   * \return the mode */
  inline OutlierMode getOutliers() const { return options_.outliers; }

  /** \brief Set how far off outliers are with OutlierMode::Deviation.
   * \param[in] sigma number of standard deviations, 0 to 1000; default 4 */
  inline void setOutlierSigma(double sigma) { options_.outlier_sigma = sigma; }
  /** \brief Get how far off outliers are with OutlierMode::Deviation.
   * \return number of standard deviations */
  inline double getOutlierSigma() const { return options_.outlier_sigma; }

  /** \brief Set which parts of the cloud are meshed. A part is a surface of its own: points that
   * neighbours join.
   * \param[in] mode default PartsMode::All: all together, as one surface. Largest meshes that of
   * most points; Each meshes all, each as if it were alone, to polygons of one mesh.
   * \note With Each, a part that cannot be meshed, as its points are in one plane, say, is left out
   * with a warning (PCL_WARN). */
  inline void setParts(PartsMode mode) { options_.parts = mode; }
  /** \brief Get which parts of the cloud are meshed.
   * \return the mode */
  inline PartsMode getParts() const { return options_.parts; }

  /** \brief Set how many distinct points a part has at least; smaller ones are left out. With
   * PartsMode::All it has no effect.
   * \param[in] points 4 and up; default 50 */
  inline void setMinPartSize(int points) { options_.min_points = points; }
  /** \brief Get how many distinct points a part has at least.
   * \return their number */
  inline int getMinPartSize() const { return options_.min_points; }

  /** \brief Set how points become neighbours.
   * \param[in] method default GraphMethod::LocalDelaunay
   * \note Set GraphMethod::NearestNeighbors to compare with the paper, or to join parts of a cloud
   * by a large k (setKSearch()). */
  inline void setGraphMethod(GraphMethod method) { options_.graph = method; }
  /** \brief Get how points become neighbours.
   * \return the method */
  inline GraphMethod getGraphMethod() const { return options_.graph; }

  /** \brief Set the number of nearest neighbours of each point that are searched for.
   * \param[in] k 3 and up; clouds with fewer than k + 1 points use all others. Unless it is set,
   * 25 (the paper's) for GraphMethod::NearestNeighbors and 12 for GraphMethod::LocalDelaunay, which
   * asks for more where it needs them.
   * \note For nearest neighbours, raise it for clouds with noise or uneven density along scan
   * lines, and lower it where sheets of the surface come close to each other. Local Delaunay
   * neighbourhoods hardly depend on it, and use no more than 32. */
  inline void setKSearch(int k) { options_.k = k; }
  /** \brief Get the number of nearest neighbours of each point that are searched for.
   * \return that of setKSearch(), or the default of the graph method */
  inline int getKSearch() const { return spherical_param::neighborsToSearch(options_); }

  /** \brief Set how the graph is embedded on the sphere.
   * \param[in] method default EmbeddingMethod::Multilevel
   * \note Set EmbeddingMethod::Iterative for the paper's iteration; it folds limbs. */
  inline void setEmbeddingMethod(EmbeddingMethod method) { options_.embedding.method = method; }
  /** \brief Get how the graph is embedded on the sphere.
   * \return the method */
  inline EmbeddingMethod getEmbeddingMethod() const { return options_.embedding.method; }

  /** \brief Set the weights of the Laplacian (equations 2 to 4 of the paper).
   * \param[in] weights default EdgeWeights::Adaptive
   * \note Only adaptive weights keep the embedding from collapsing by themselves. The other two are
   * for comparison: with them, the multilevel embedding has to hold the centroid, and their
   * tangential Laplacian vanishes only together with that pull. */
  inline void setWeights(EdgeWeights weights) { options_.embedding.weights = weights; }
  /** \brief Get the weights of the Laplacian.
   * \return the weights */
  inline EdgeWeights getWeights() const { return options_.embedding.weights; }

  /** \brief Set the mean length of the tangential Laplacian at which the embedding has converged.
   * \param[in] tolerance in radii of the sphere, 0 to 1. Unset (std::nullopt, the default), the
   * iterative embedding aims at 1e-8; the multilevel embedding ends with its smoothing sweeps and
   * does not converge.
   * \note Set it, 1e-8 say, for a map that hardly depends on how it was reached, and where
   * smoothing alone leaves folds (getDiagnosis().edges_outside_graph), as it may on long
   * thin limbs. The mesh hardly gains otherwise. */
  inline void setTolerance(std::optional<double> tolerance) {
    options_.embedding.tolerance = tolerance;
  }
  /** \brief Get the mean length of the tangential Laplacian at convergence.
   * \return that of setTolerance(); unset by default */
  inline std::optional<double> getTolerance() const { return options_.embedding.tolerance; }

  /** \brief Set how the points on the sphere are triangulated.
   * \param[in] method default TriangulationMethod::Incremental
   * \note Set TriangulationMethod::Qhull to compare with the paper; it is slower, and has to
   * reinsert points where they are dense. */
  inline void setTriangulationMethod(TriangulationMethod method) {
    options_.triangulation = method;
  }
  /** \brief Get how the points on the sphere are triangulated.
   * \return the method */
  inline TriangulationMethod getTriangulationMethod() const { return options_.triangulation; }

  /** \brief Set how far the mesh is optimised on the points.
   * \param[in] method default OptimizationMethod::Full
   * \note Set OptimizationMethod::None for the mesh that the sphere gives, and
   * OptimizationMethod::Flips where time matters more than the last self-intersections. */
  inline void setOptimizationMethod(OptimizationMethod method) { options_.optimization = method; }
  /** \brief Get how far the mesh is optimised on the points.
   * \return the method */
  inline OptimizationMethod getOptimizationMethod() const { return options_.optimization; }

  /** \brief Set the strength of the smoothing that takes noise off the points.
   * \param[in] steps 0 (default) to 10000; 0: none. The strength is about that of as many steps of
   * the paper's section 4.2.
   * \note The mesh keeps the points of the input; the smoothed ones are those of
   * getMovedPoints(), for which the same polygons hold. */
  inline void setSmoothing(int steps) { options_.smoothing = steps; }
  /** \brief Get the strength of the smoothing.
   * \return the steps; 0: none */
  inline int getSmoothing() const { return options_.smoothing; }

  /** \brief Set the seed of all random choices: the order in which the multilevel embedding
   * coarsens the graph, and the parts of the mesh that OptimizationMethod::Full takes out.
   * \param[in] seed any number; default 1. The same seed gives the same result.
   * \note Change it to see how much the result depends on it. */
  inline void setSeed(std::uint32_t seed) { options_.seed = seed; }
  /** \brief Get the seed of all random choices.
   * \return the seed */
  inline std::uint32_t getSeed() const { return options_.seed; }

  /** \brief Set the time after which the work ends with the best mesh so far.
   * \param[in] seconds 0 to 1e9 [s]; unset (default): no limit. A first mesh is made in any case;
   * Surface::is_out_of_time of getResult() says whether the limit ended the work.
   * \note Set it where a scan must not hold up what comes after it. The same limit may give another
   * mesh on another machine. */
  inline void setTimeLimit(std::optional<double> seconds) { options_.time_limit = seconds; }
  /** \brief Get the time after which the work ends.
   * \return that of setTimeLimit() [s]; unset by default */
  inline std::optional<double> getTimeLimit() const { return options_.time_limit; }

  /** \brief Set the number of threads. The result does not depend on it.
   * \param[in] threads 0 (default): as many as OpenMP would use. */
  inline void setNumberOfThreads(unsigned int threads = 0) {
    options_.threads = static_cast<int>(threads);
  }
  /** \brief Get the number of threads.
   * \return their number; 0: as many as OpenMP would use */
  inline unsigned int getNumberOfThreads() const {
    return static_cast<unsigned int>(options_.threads);
  }

  /** \brief Set a function that receives the progress of the work; returning false cancels it.
   * \param[in] progress called from the thread that called reconstruct(); may be empty. \see
   * spherical_param::Progress for the stages */
  inline void setProgressCallback(const ProgressCallback& progress) {
    options_.progress = progress;
  }
  /** \brief Get the function that receives the progress of the work.
   * \return the function; may be empty */
  inline const ProgressCallback& getProgressCallback() const { return options_.progress; }

  /** \brief Set all options at once, the progress callback among them, in place of what was set.
   * The options that have no setter of their own are set here: change a copy of getOptions().
   * \param[in] options checked by reconstruct() */
  inline void setOptions(const spherical_param::Options& options) { options_ = options; }
  /** \brief Get all options at once.
   * \return those in force */
  inline const spherical_param::Options& getOptions() const { return options_; }

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

  /** \brief Get the number of parts that the last reconstruct() meshed.
   * \return 1, or with PartsMode::Each their number; 1 after a failure as well */
  inline std::size_t getPartCount() const { return parts_.size(); }

  /** \brief Get the result of the last reconstruct(): the surface of each part, what was left out,
   * verdict and findings. Empty after a failure. Its input points are those of setIndices() without
   * repetitions, in their order, or all points; getUsedIndices() and getVertexIndices() list their
   * indices in the cloud.
   * \return the result, which the next reconstruct() replaces */
  inline const spherical_param::Result& getResult() const { return result_; }

  /** \brief Get the indices into the input cloud of the points that were meshed: those of
   * setIndices() (or all), without repetitions and without points that are not finite, of the part.
   * \param[in] part below getPartCount()
   * \return their indices, in the order of the input */
  inline const pcl::Indices& getUsedIndices(std::size_t part = 0) const {
    return parts_.at(part).used_indices;
  }

  /** \brief Get the index into the input cloud of each vertex of a surface.
   * \param[in] part below getPartCount()
   * \return one index for each vertex */
  inline const pcl::Indices& getVertexIndices(std::size_t part = 0) const {
    return parts_.at(part).vertex_indices;
  }

  /** \brief Get the number of points that were skipped because they are not finite.
   * \return their number */
  inline std::size_t getIgnoredPointCount() const { return result_.left_out.not_finite.size(); }

  /** \brief Get the embedding on the unit sphere, one point for each point of the input cloud, so
   * that the polygons fit it as well. Duplicates have the place of their vertex; points that were
   * skipped or not in the indices are NaN. Empty after a failure.
   * \note Where the optimisation moved vertices, as it does on noise, some polygons are inverted on
   * the sphere; with OptimizationMethod::None none are, but for rounding.
   * \return a new cloud of the size of the input */
  pcl::PointCloud<pcl::PointXYZ>::Ptr getSphereCoordinates() const;

  /** \brief Get the points after setConsolidation() and setSmoothing(), one for each point of the
   * input cloud, so that the polygons fit them as well. Duplicates and merged points have the place
   * of their vertex; points that were skipped or not in the indices are NaN. Empty without both and
   * after a failure.
   * \note In double precision, by vertex, they are Surface::moved() of getResult(); how far they
   * moved is in Surface::consolidation and Surface::smoothing. \return a new cloud of the size of
   * the input, or an empty one */
  pcl::PointCloud<pcl::PointXYZ>::Ptr getMovedPoints() const;

  /** \brief Get the pairs of triangles of the mesh that intersect, as indices of triangles of
   * getResult(), with one part those of the polygons, {lower, higher}, ascending. Measured on the
   * points of the input, in exact arithmetic.
   * \note On noisy points some are often left; see setSmoothing().
   * \param[in] part below getPartCount()
   * \return the pairs; none is what a clean scan should give */
  inline const std::vector<std::array<spherical_param::Index, 2>>&
  getSelfIntersections(std::size_t part = 0) const {
    return getSurfaceOf(part).self_intersections;
  }

  /** \brief Get what speaks against a closed surface without handles, in one piece, and where. Its
   * indices are vertices, which getVertexIndices() maps to the cloud.
   * \param[in] part below getPartCount()
   * \note The mesh is a sphere whatever the cloud shows; the diagnosis says whether it should be.
   * \return what was found; getResult().verdict and getResult().findings say it in words */
  inline const spherical_param::SurfaceDiagnosis& getDiagnosis(std::size_t part = 0) const {
    return getSurfaceOf(part).diagnosis;
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
  /** \brief The indices in the cloud of the points and vertices of a part. */
  struct PartIndices {
    pcl::Indices used_indices;
    pcl::Indices vertex_indices;
  };

  /** \brief The surface of a part; an empty one after a failure. */
  inline const spherical_param::Surface& getSurfaceOf(std::size_t part) const {
    static const spherical_param::Surface none;
    return part == 0 && result_.surfaces.empty() ? none : result_.surfaces.at(part);
  }

  /** \brief Makes a cloud of the size of the input from the places of vertices, a member of
   * spherical_param::Surface. */
  template <typename Places>
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloudOf(Places places) const;

  /** \brief Fills the results. */
  void meshPoints();

  /** \brief Clears the results, does the work and, if that fails, clears results and output and
   * says why. */
  void run(const std::function<void()>& work, const std::function<void()>& clear_output);

  void clearResults();

  /** \brief Throws InvalidInput for a cloud or indices that initCompute() must not see. */
  void checkInput() const;

  /** \brief Collects the points, finite or not, without repeated indices.
   * \param[out] used_indices of these points
   * \return the points, 3 x used_indices.size() */
  spherical_param::Positions collectPoints(pcl::Indices& used_indices);

  spherical_param::Options options_;
  spherical_param::Result result_;
  std::vector<PartIndices> parts_{1};
  std::size_t input_size_ = 0;
  std::string error_message_;
};

}  // namespace pcl

#ifdef PCL_NO_PRECOMPILE
#include <pcl/surface/impl/spherical_param_reconstruction.hpp>
#endif
