#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/reconstruction.h>

#include "spherical_param/reconstruct.h"

#include <functional>
#include <string>
#include <vector>

namespace pcl {

/** \brief Meshes the point cloud of an object without holes through it (a topological sphere) into
 * a closed, manifold, consistently outward-oriented genus-0 triangle mesh through every distinct
 * finite input point. It needs no normals, no radius and no tuning.
 *
 * M. Zwicker, C. Gotsman: "Meshing Point Clouds Using Spherical Parameterization", Eurographics
 * Symposium on Point-Based Graphics, 2004: the k-nearest-neighbour graph is embedded on the unit
 * sphere so that its tangential Laplacian vanishes, and the convex hull of the embedded points
 * gives the connectivity.
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
 * \note The memory for k = 25 is below 2 KB a point, besides that of the process itself; the time
 * O(n log n) plus iterations times O(n k).
 * \note Without a search object of the user, neighbours are found in single precision: within a
 * cluster smaller than 1e-19 of the largest coordinate they are arbitrary (the mesh stays sound).
 * \ingroup surface
 */
template <typename PointInT>
class SphericalParamReconstruction : public MeshConstruction<PointInT> {
public:
  using Ptr = shared_ptr<SphericalParamReconstruction<PointInT>>;
  using ConstPtr = shared_ptr<const SphericalParamReconstruction<PointInT>>;

  using KdTree = typename MeshConstruction<PointInT>::KdTree;
  using KdTreePtr = typename MeshConstruction<PointInT>::KdTreePtr;
  using PointCloudIn = pcl::PointCloud<PointInT>;

  using EdgeWeights = spherical_param::EdgeWeights;
  using ProgressCallback = std::function<bool(const spherical_param::Progress&)>;

  SphericalParamReconstruction();
  ~SphericalParamReconstruction() override = default;

  /** \brief Set the number of nearest neighbours of each point in the neighbourhood graph.
   * \param[in] k 3 and up; clouds with fewer than k + 1 points use all others. Default 25, the
   * paper's.
   * \note Raise it for clouds with noise or uneven density along scan lines; lower it where sheets
   * of the surface come close to each other. */
  inline void setKSearch(int k) { options_.k = k; }
  /** \brief Get the number of nearest neighbours of each point in the neighbourhood graph. */
  inline int getKSearch() const { return options_.k; }

  /** \brief Set the weights of the Laplacian (equations 2 to 4 of the paper).
   * \param[in] weights default EdgeWeights::Adaptive
   * \note Adaptive weights keep the embedding from collapsing; the other two are for comparison. */
  inline void setWeights(EdgeWeights weights) { options_.weights = weights; }
  /** \brief Get the weights of the Laplacian. */
  inline EdgeWeights getWeights() const { return options_.weights; }

  /** \brief Set the damping of the iteration.
   * \param[in] lambda share of the tangential Laplacian that a step makes, in (0, 1]; default 0.5,
   * the paper's.
   * \note Lower it if the residuals oscillate. */
  inline void setLambda(double lambda) { options_.lambda = lambda; }
  /** \brief Get the damping of the iteration. */
  inline double getLambda() const { return options_.lambda; }

  /** \brief Set the number of iterations at most.
   * \param[in] iterations 0 and up; default 1600, as in Table 1 of the paper.
   * \note Has no effect once the iteration has stagnated (getResult().embedding.stop_reason). */
  inline void setMaximumIterations(int iterations) { options_.max_iterations = iterations; }
  /** \brief Get the number of iterations at most. */
  inline int getMaximumIterations() const { return options_.max_iterations; }

  /** \brief Set the mean length of the tangential Laplacian at which the embedding has converged.
   * \param[in] tolerance in radii of the sphere, 0 and up; default 1e-8.
   * \note Raise it to save time where only the mesh matters. */
  inline void setTolerance(double tolerance) { options_.tolerance = tolerance; }
  /** \brief Get the mean length of the tangential Laplacian at convergence. */
  inline double getTolerance() const { return options_.tolerance; }

  /** \brief Set the number of iterations over which stagnation is judged.
   * \param[in] window 2 and up, or 0 to never stop for stagnation; default 100.
   * \note Set 0 to reproduce the paper's fixed number of iterations. */
  inline void setStagnationWindow(int window) { options_.stagnation_window = window; }
  /** \brief Get the number of iterations over which stagnation is judged. */
  inline int getStagnationWindow() const { return options_.stagnation_window; }

  /** \brief Set the number of threads. The result does not depend on it.
   * \param[in] threads 0 (default): as many as OpenMP would use. */
  inline void setNumberOfThreads(unsigned int threads = 0) {
    options_.threads = static_cast<int>(threads);
  }
  /** \brief Get the number of threads, 0: as many as OpenMP would use. */
  inline unsigned int getNumberOfThreads() const {
    return static_cast<unsigned int>(options_.threads);
  }

  /** \brief Set a function that is told how far the work is; returning false cancels it.
   * \param[in] progress called from the thread that called reconstruct(); may be empty. Its stages
   * are those of spherical_param::Progress, after one named "neighbors" for the search. */
  inline void setProgressCallback(const ProgressCallback& progress) {
    options_.progress = progress;
  }
  /** \brief Get the function that is told how far the work is. */
  inline const ProgressCallback& getProgressCallback() const { return options_.progress; }

  /** \brief Mesh the points given in setInputCloud() and setIndices().
   * \param[out] output header and cloud (with every field) are those of the whole input cloud,
   * polygons are the triangles; both are cleared first. Empty after a failure. */
  void reconstruct(pcl::PolygonMesh& output) override;

  /** \brief Mesh the points given in setInputCloud() and setIndices().
   * \param[out] polygons the triangles, indices into the input cloud; cleared first. */
  void reconstruct(std::vector<pcl::Vertices>& polygons) override;

  /** \brief Get the result of the last reconstruct(); a default-constructed one after a failure.
   * Its "inputs" are the points getUsedIndices() lists; its vertices are the points that
   * getVertexIndices() lists. Its first stage is "neighbors", the search. */
  inline const spherical_param::Result& getResult() const { return result_; }

  /** \brief Get the indices into the input cloud of the points that were meshed: those of
   * setIndices() (or all), without repetitions and without points that are not finite. */
  inline const pcl::Indices& getUsedIndices() const { return used_indices_; }

  /** \brief Get the index into the input cloud of each vertex of getResult(). */
  inline const pcl::Indices& getVertexIndices() const { return vertex_indices_; }

  /** \brief Get the number of points that were skipped because they are not finite. */
  inline std::size_t getIgnoredPointCount() const { return ignored_points_; }

  /** \brief Get the embedding on the unit sphere, one point for each point of the input cloud, so
   * that the polygons fit it as well. Duplicates have the place of their vertex; points that were
   * skipped or not in the indices are NaN. Empty after a failure. */
  pcl::PointCloud<pcl::PointXYZ>::Ptr getSphereCoordinates() const;

  /** \brief Tell whether the embedding of the last reconstruct() reached the tolerance. */
  inline bool hasConverged() const {
    return result_.sphere.cols() > 0 &&
           result_.embedding.stop_reason == spherical_param::StopReason::Converged;
  }

  /** \brief Get the cause and the remedy of the last failure; empty after a success. */
  inline const std::string& getErrorMessage() const { return error_message_; }

protected:
  using MeshConstruction<PointInT>::input_;
  using MeshConstruction<PointInT>::indices_;
  using MeshConstruction<PointInT>::fake_indices_;
  using MeshConstruction<PointInT>::initCompute;
  using MeshConstruction<PointInT>::deinitCompute;
  using MeshConstruction<PointInT>::tree_;
  using MeshConstruction<PointInT>::check_tree_;

  std::string getClassName() const override { return "SphericalParamReconstruction"; }

  void performReconstruction(pcl::PolygonMesh& output) override;
  void performReconstruction(std::vector<pcl::Vertices>& polygons) override;

private:
  /** \brief Clears output and results, calls performReconstruction() and, if that fails, clears
   * both again and says why. */
  template <typename Output>
  void run(Output& output);

  void clearResults();

  /** \brief Throws InvalidInput for a cloud or indices that initCompute() must not see. */
  void checkInput() const;

  /** \brief Fills used_indices_ and counts ignored_points_.
   * \return the used points, 3 x used_indices_.size() */
  spherical_param::Positions collectPoints();

  spherical_param::Result reconstructPoints(const spherical_param::Positions& points,
                                            const spherical_param::Options& options) const;

  /** \brief Finds the k nearest neighbours of each distinct point; the lists of points that repeat
   * an earlier one are empty. */
  spherical_param::NeighborLists findNeighbors(const spherical_param::Positions& points,
                                               const spherical_param::Options& options) const;

  /** \brief Writes list_size neighbours of each distinct point to neighbors, as positions in
   * used_indices_, found by a tree of our own that is gone afterwards. */
  void searchWithKdTree(const spherical_param::Positions& points,
                        const std::vector<spherical_param::Index>& distinct, std::size_t list_size,
                        int threads, const std::function<void(double)>& report,
                        std::vector<spherical_param::Index>& neighbors) const;

  /** \brief Does the same with the search object of setSearchMethod(). */
  void searchWithUserTree(const std::vector<spherical_param::Index>& distinct,
                          std::size_t list_size, const std::function<void(double)>& report,
                          std::vector<spherical_param::Index>& neighbors) const;

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
