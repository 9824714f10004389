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

/** \brief Meshes a point cloud into a manifold, consistently oriented triangle mesh through its
 * points: by default with the parts, openings and handles that the cloud certainly shows, without
 * certain stray points; on request as one closed surface of genus 0 through every distinct finite
 * point (setTopology()). It needs no normals, no radius and no tuning.
 *
 * The method comes from M. Zwicker, C. Gotsman: "Meshing Point Clouds Using Spherical
 * Parameterization", Eurographics Symposium on Point-Based Graphics, 2004; setMethod(Method::Paper)
 * is their own. The mesh is optimised by moves that keep its topology, until no triangles
 * intersect, if possible (getSelfIntersections()). By default, points are never moved.
 * getDiagnosis() lists evidence against a closed surface without handles, and its place.
 *
 * Triangles face as the normals of the points do, if these have normals; else an open surface faces
 * the sensor, terrain up, and any other outward. The sensor is at sensor_origin_; an origin of 0
 * means no sensor if the cloud has no rows and 0 is within the box of the points.
 *
 * Drop-in for GreedyProjectionTriangulation: change the type and delete the radius and mu setters.
 * Polygons index the input cloud, also if setIndices() gave a subset. Points that are not finite
 * are left out; exact duplicates become one vertex, at the first of them; both are counted.
 * Unlike with the tools, points are not consolidated by default: the polygons would not fit the
 * input cloud. For a noisy scan, set setConsolidation(ConsolidationMode::AsTopology).
 *
 * Failure (null or empty cloud, an index out of range, fewer than 4 distinct finite points, all
 * points in one plane, an option out of range, cancellation) leaves an empty mesh and prints one
 * line with PCL_ERROR, which getErrorMessage() also returns. The class passes on exceptions of the
 * progress callback and throws no others.
 *
 * \note Two objects may work in two threads at the same time, unless they share a search object
 * (setSearchMethod()) whose setInputCloud() or queries would race. An object itself must not be
 * used from two threads at once.
 * \note The core finds the neighbours in double precision, unless setSearchMethod() sets a search
 * object, which is used from the calling thread only.
 * \note Memory: below 1 KB a point. Time: O(n log n), typically; Method::Paper adds iterations *
 * O(n k).
 * \ingroup surface
 */
template <typename PointInT>
class SphericalParamReconstruction : public MeshConstruction<PointInT> {
public:
  using Ptr = shared_ptr<SphericalParamReconstruction<PointInT>>;  ///< shared by several owners
  /** \brief Shared by several owners, none of whom changes it. */
  using ConstPtr = shared_ptr<const SphericalParamReconstruction<PointInT>>;

  using KdTree = typename MeshConstruction<PointInT>::KdTree;  ///< what setSearchMethod() takes
  using KdTreePtr = typename MeshConstruction<PointInT>::KdTreePtr;  ///< a shared one
  using PointCloudIn = pcl::PointCloud<PointInT>;  ///< the type of the input cloud

  using Method = spherical_param::Method;                        ///< how the cloud is meshed
  using EdgeWeights = spherical_param::EdgeWeights;              ///< of the Laplacian
  using ConsolidationMode = spherical_param::ConsolidationMode;  ///< of noisy points
  using TopologyMode = spherical_param::TopologyMode;            ///< of the mesh
  using SurfaceMode = spherical_param::SurfaceMode;              ///< whether openings are filled
  using FillMode = spherical_param::FillMode;                    ///< how openings are filled
  using HandleMode = spherical_param::HandleMode;                ///< whether the mesh has handles
  using IntersectionMode = spherical_param::IntersectionMode;    ///< what becomes of intersections
  using OutlierMode = spherical_param::OutlierMode;              ///< which points are left out
  using PartsMode = spherical_param::PartsMode;                  ///< which parts are meshed
  using ViewMode = spherical_param::ViewMode;                    ///< where the cloud is seen from
  /** \brief Receives the progress of the work; returning false cancels it. */
  using ProgressCallback = std::function<bool(const spherical_param::Progress&)>;

  SphericalParamReconstruction();
  ~SphericalParamReconstruction() override = default;

  /** \brief Set the topology of the mesh.
   * \param[in] mode default TopologyMode::Scan: what the cloud shows. Sphere: one closed surface of
   * genus 0 through every point.
   * \note setParts(), setSurface(), setHandles(), setIntersections() and setOutliers() override a
   * part each. */
  void setTopology(TopologyMode mode) { options_.topology = mode; }
  TopologyMode getTopology() const { return options_.topology; }  ///< As set. \return it

  /** \brief Set where the cloud is seen from. One that a place sees as one layer, as a depth camera
   * or a scanner on a tripod does, is meshed by the directions from there: in a fraction of the
   * time, and without intersections. The mesh ends where the depth jumps.
   * \param[in] mode default ViewMode::Auto: sensor_origin_ of the cloud, or a place that is
   * searched for, if it sees one layer. None: no place. Up: far above. \note getResult().view has
   * the place that was used. */
  void setView(ViewMode mode) { options_.view = mode; }
  ViewMode getView() const { return options_.view; }  ///< As set. \return it

  /** \brief Set the place that the cloud is seen from, instead of sensor_origin_.
   * \param[in] place of the sensor [unit of the input] */
  void setViewpoint(const Eigen::Vector3d& place) {
    options_.view = ViewMode::Place;
    options_.viewpoint = place;
  }
  /** \brief Get the value of setViewpoint(). \return it */
  const Eigen::Vector3d& getViewpoint() const { return options_.viewpoint; }

  /** \brief Set whether points are moved to the sampled surface and merged within their noise
   * before meshing: for noisy and for merged scans.
   *
   * \param[in] mode AsTopology: those of noisy parts of a scan; Auto: all. Default: None, since
   * polygons index the input cloud.
   *
   * \note Polygons then index the first of merged points; a pcl::PolygonMesh has it where it was
   * moved, Surface::consolidation of getResult() the figures. The search object is used for
   * setOutliers() and setParts() alone. */
  void setConsolidation(ConsolidationMode mode) { options_.consolidation = mode; }
  /** \brief Get the value of setConsolidation(). \return it */
  ConsolidationMode getConsolidation() const { return options_.consolidation; }

  /** \brief Set whether openings of the surface are filled.
   * \param[in] mode Closed: all are filled. Open leaves them open; Auto leaves certain ones open.
   * Default: as setTopology() says.
   * \note getResult() has the openings with their certainty, and the boundary of an open mesh. */
  void setSurface(SurfaceMode mode) { options_.surface = mode; }
  SurfaceMode getSurface() const { return options_.surface; }  ///< As set. \return it

  /** \brief Set up to which size openings are filled in any case.
   * \param[in] edges of the loop around an opening; default 0: none */
  void setFillHoles(int edges) { options_.fill_holes = edges; }
  int getFillHoles() const { return options_.fill_holes; }  ///< As set. \return it

  /** \brief Set whether the mesh has the handles of the surface.
   * \param[in] mode Auto: it has those that are certain. None: it has none and is one sphere, or
   * one with openings. Default: as setTopology() says.
   *
   * A mesh with handles has no map to one sphere: getSphereCoordinates() is empty. Set None for
   * remeshing and morphing. Surface::genus() of getResult() is the number of handles. */
  void setHandles(HandleMode mode) { options_.handles = mode; }
  HandleMode getHandles() const { return options_.handles; }  ///< As set. \return it

  /** \brief Set how openings are filled, if they are.
   * \param[in] mode Smooth: points are added, which go on as the surface around does. Default:
   * Flat. \note reconstruct(pcl::PolygonMesh&) appends the added points to the cloud, with the
   * other fields of the nearest vertex. The other overloads fill flat: their polygons index the
   * input. */
  void setFill(FillMode mode) { options_.fill = mode; }
  FillMode getFill() const { return options_.fill; }  ///< As set. \return it

  /** \brief Set what happens to triangles that still intersect at the end.
   * \param[in] mode Remove: they are taken apart, if need be by leaving out triangles and
   * points. Keep: they are counted. Default: as setTopology() says.
   * \note getResult().left_out.unmeshed has the points. */
  void setIntersections(IntersectionMode mode) { options_.intersections = mode; }
  /** \brief Get the value of setIntersections(). \return it */
  IntersectionMode getIntersections() const { return options_.intersections; }

  /** \brief Set which points are left out first because they belong to no surface.
   * \param[in] mode Auto: stray points, small clusters and isolated points near a surface.
   * Deviation: points too far from the average of their neighbours. Default: as setTopology() says.
   * \note getResult().left_out lists them. */
  void setOutliers(OutlierMode mode) { options_.outliers = mode; }
  OutlierMode getOutliers() const { return options_.outliers; }  ///< As set. \return it

  /** \brief Set the threshold of OutlierMode::Deviation.
   * \param[in] sigma number of standard deviations, 0 to 1000; default 4 */
  void setOutlierSigma(double sigma) { options_.outlier_sigma = sigma; }
  double getOutlierSigma() const { return options_.outlier_sigma; }  ///< As set. \return it

  /** \brief Set which parts of the cloud are meshed. A part is a set of points that neighbours
   * connect.
   * \param[in] mode All: all together, as one surface. Largest: the part with the most points.
   * Each: every part by itself, into polygons of one mesh. Default: as setTopology() says.
   * \note With Each, a part that cannot be meshed (all points in one plane, for example) is left
   * out with a warning (PCL_WARN). */
  void setParts(PartsMode mode) { options_.parts = mode; }
  PartsMode getParts() const { return options_.parts; }  ///< As set. \return it

  /** \brief Set the minimum number of distinct points of a part; smaller parts are left out. No
   * effect with PartsMode::All.
   * \param[in] points 4 and up; default 50 */
  void setMinPartSize(int points) { options_.min_points = points; }
  int getMinPartSize() const { return options_.min_points; }  ///< As set. \return it

  /** \brief Set how the cloud is meshed.
   * \param[in] method default Method::Default; Paper is the method as published in 2004, without
   * what this library adds to it.
   * \note Set Method::Paper to compare with it: it folds limbs, fills openings and takes longer. */
  void setMethod(Method method) { options_.method = method; }
  Method getMethod() const { return options_.method; }  ///< As set. \return it

  /** \brief Set the number of nearest neighbours of each point, of Method::Paper.
   * \param[in] k 3 and up; clouds with fewer than k + 1 points use all others. Default 25. */
  void setKSearch(int k) { options_.paper.k = k; }
  int getKSearch() const { return options_.paper.k; }  ///< As set. \return it

  /** \brief Set the weights of the Laplacian (equations 2 to 4 of the paper), of Method::Paper.
   * \param[in] weights default EdgeWeights::Adaptive
   * \note Only adaptive weights keep the embedding from collapsing by themselves. */
  void setWeights(EdgeWeights weights) { options_.paper.weights = weights; }
  EdgeWeights getWeights() const { return options_.paper.weights; }  ///< As set. \return it

  /** \brief Set the mean length of the tangential Laplacian at which the embedding has converged.
   * \param[in] tolerance in radii of the sphere, 0 to 1. Unset (std::nullopt, the default),
   * Method::Paper aims at 1e-8; Method::Default ends with its smoothing sweeps and does not
   * converge.
   * \note Set it, to 1e-8 for example, for a map that hardly depends on its start, and where
   * smoothing sweeps leave folds (getDiagnosis().edges_outside_graph), as on long thin limbs.
   * Otherwise the mesh hardly gains. */
  void setTolerance(std::optional<double> tolerance) { options_.embedding.tolerance = tolerance; }
  /** \brief Get the value of setTolerance(). \return it */
  std::optional<double> getTolerance() const { return options_.embedding.tolerance; }

  /** \brief Set the strength of smoothing.
   * \param[in] steps 0 (default) to 10000; 0: none. About as strong as this number of steps of the
   * paper's section 4.2.
   * \note A pcl::PolygonMesh has the smoothed points; Surface::smoothing of getResult() says how
   * far they moved. */
  void setSmoothing(int steps) { options_.smoothing = steps; }
  int getSmoothing() const { return options_.smoothing; }  ///< As set. \return it

  /** \brief Set whether what is not needed for the mesh is computed as well: the embedding on the
   * sphere (getSphereCoordinates()), the residual of each vertex and the findings at each triangle
   * (getResult()).
   * \param[in] details default false */
  void setDetails(bool details) { options_.details = details; }
  bool getDetails() const { return options_.details; }  ///< As set. \return it

  /** \brief Set the seed of all random choices: the order of coarsening in the embedding, and the
   * parts of the mesh that the optimisation rebuilds. The same seed gives the same result.
   * \param[in] seed any number; default 1 */
  void setSeed(std::uint32_t seed) { options_.seed = seed; }
  std::uint32_t getSeed() const { return options_.seed; }  ///< As set. \return it

  /** \brief Set the time after which the work ends with the best mesh so far, over all parts.
   * \param[in] seconds 0 to 1e9 [s]; unset (default): no limit; 0: the first mesh, however long it
   * takes. The first mesh of each part is always finished; Surface::is_out_of_time of getResult()
   * says whether the limit ended the work on a mesh. \note Set it if a scan must not delay the next
   * one. The mesh then depends on the machine. */
  void setTimeLimit(std::optional<double> seconds) { options_.time_limit = seconds; }
  /** \brief Get the value of setTimeLimit(). \return it */
  std::optional<double> getTimeLimit() const { return options_.time_limit; }

  /** \brief Set the number of threads. The result does not depend on it.
   * \param[in] threads 0 (default): one for each processor. */
  void setNumberOfThreads(unsigned int threads = 0) {
    options_.threads = static_cast<int>(threads);
  }
  /** \brief Get the value of setNumberOfThreads(). \return it */
  unsigned int getNumberOfThreads() const { return static_cast<unsigned int>(options_.threads); }

  /** \brief Set a function that receives the progress of the work; returning false cancels it.
   * \param[in] progress called from the thread that called reconstruct(); may be empty. \see
   * spherical_param::Progress for the stages */
  void setProgressCallback(const ProgressCallback& progress) { options_.progress = progress; }
  /** \brief Get the value of setProgressCallback(). \return it */
  const ProgressCallback& getProgressCallback() const { return options_.progress; }

  /** \brief Set all options at once, also the progress callback. For options without a setter,
   * change a copy of getOptions().
   * \param[in] options checked by reconstruct() */
  void setOptions(const spherical_param::Options& options) { options_ = options; }
  const spherical_param::Options& getOptions() const { return options_; }  ///< As set. \return it

  /** \brief Mesh the points given in setInputCloud() and setIndices().
   * \param[out] output header and cloud (with every field) are those of the whole input cloud, but
   * vertices are where consolidation and smoothing moved them, and added ones come last; polygons
   * are the triangles. It is cleared first, and empty after a failure. */
  void reconstruct(pcl::PolygonMesh& output) override;

  /** \brief Mesh the points given in setInputCloud() and setIndices().
   * \param[out] polygons the triangles, indices into the input cloud; cleared first.
   * \note Surface::points of getResult() are the vertices in double precision, where they were
   * moved. */
  void reconstruct(std::vector<pcl::Vertices>& polygons) override;

  /** \brief Mesh the points given in setInputCloud() and setIndices() for getResult() only: its
   * triangles take 24 bytes a point, polygons at least 112. */
  void reconstruct();

  /** \brief Get the number of surfaces that the last reconstruct() made.
   * \return the number; 1 after a failure */
  std::size_t getPartCount() const { return parts_.size(); }

  /** \brief Get the result of the last reconstruct(): the surface of each part, what was left out,
   * verdict and findings. Empty after a failure. Its input points are those of setIndices(), in
   * their order and without repetitions, or all points; getUsedIndices() and getVertexIndices() map
   * them to the cloud. getResult().surface() is the largest mesh, and fails after a failure.
   * \return the result, valid until the next reconstruct() */
  const spherical_param::Result& getResult() const { return result_; }

  /** \brief Get the indices into the input cloud of the points of a part: finite, without
   * repetitions.
   * \param[in] part below getPartCount()
   * \return their indices, in the order of the input */
  const pcl::Indices& getUsedIndices(std::size_t part = 0) const {
    return parts_.at(part).used_indices;
  }

  /** \brief Get the index into the input cloud of each vertex of a surface.
   * \param[in] part below getPartCount()
   * \return one index for each vertex */
  const pcl::Indices& getVertexIndices(std::size_t part = 0) const {
    return parts_.at(part).vertex_indices;
  }

  /** \brief Get the number of points left out because they are not finite.
   * \return their number */
  std::size_t getIgnoredPointCount() const { return result_.left_out.not_finite.size(); }

  /** \brief Get the embedding on the unit sphere, one point for each point of the input cloud, so
   * that the polygons fit. Duplicates have the place of their vertex; points that were not meshed
   * or whose mesh has handles are NaN. Empty after a failure and if no mesh has a sphere.
   * \note It needs setDetails(true), TopologyMode::Sphere, a tolerance, or a view: other meshes are
   * made without the sphere where that is possible.
   * \note Where the optimisation moved vertices, as on noise, some polygons are inverted on the
   * sphere; with Method::Paper only by rounding.
   * \return a new cloud of the size of the input */
  pcl::PointCloud<pcl::PointXYZ>::Ptr getSphereCoordinates() const;

  /** \brief Get the pairs of triangles of the mesh that intersect, {lower, higher}, ascending. They
   * are indices of triangles of the part's surface in getResult(), with one part those of the
   * polygons. Exact on Surface::points.
   * \note Noisy points often leave some; see setSmoothing().
   * \param[in] part below getPartCount()
   * \return the pairs; empty for a clean scan */
  const std::vector<std::array<spherical_param::Index, 2>>&
  getSelfIntersections(std::size_t part = 0) const {
    return getSurfaceOf(part).self_intersections;
  }

  /** \brief Get the evidence against a closed surface without handles, in one piece, and its place.
   * Indices are vertices, which getVertexIndices() maps to the cloud.
   * \param[in] part below getPartCount()
   * \return the diagnosis; getResult().verdict and getResult().findings put it in words */
  const spherical_param::SurfaceDiagnosis& getDiagnosis(std::size_t part = 0) const {
    return getSurfaceOf(part).diagnosis;
  }

  /** \brief Get the cause and the remedy of the last failure; empty after a success.
   * \return one sentence */
  const std::string& getErrorMessage() const { return error_message_; }

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
  const spherical_param::Surface& getSurfaceOf(std::size_t part) const {
    static const spherical_param::Surface none;
    return part == 0 && result_.surfaces.empty() ? none : result_.surfaces.at(part);
  }

  /** \brief The indices into the input cloud of the vertices of all surfaces. */
  pcl::Indices vertexIndices() const;

  /** \brief Fills the results. */
  void meshPoints(FillMode fill);

  /** \brief Clears the results, does the work and, if it fails, clears the results and says why. */
  void run(const std::function<void()>& work);

  void clearResults();

  /** \brief Throws InvalidInput for a cloud or indices that initCompute() must not see. */
  void checkInput() const;

  /** \brief Collects the points, 3 x n, finite or not, and their indices without repetitions. */
  spherical_param::Positions collectPoints(pcl::Indices& used_indices);

  /** \brief Collects the normals of these points, and the sensor. */
  spherical_param::CloudInfo infoOf(const spherical_param::Positions& points,
                                    const pcl::Indices& used_indices) const;

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
