#include "smooth_fill.h"

#include "corner_table.h"
#include "indexed.h"
#include "pi.h"
#include "progress.h"
#include "rows.h"
#include "spherical_param/errors.h"
#include "spherical_param/self_intersection.h"
#include "time_left.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace spherical_param::internal {
namespace {

using Corners = std::array<Index, 3>;
using Edge = std::pair<Index, Index>;
using Edges = std::set<Edge>;
using Places = Indexed<Eigen::Vector3d>;

Edge undirected(Index a, Index b) {
  return {std::min(a, b), std::max(a, b)};
}

/// How a patch bends: in the first of these ways that does not add intersections.
enum Bend { ThinPlate, Membrane, AsGiven };

/// A disc of triangles over an opening. Its vertices have numbers of their own: `given` first, then
/// the added ones.
struct FillPatch {
  Index opening = 0;
  std::vector<Index> at;          // its triangles in the mesh
  Indexed<Index> given;           // in the mesh: the vertices of the patch, then those around it
  std::map<Index, Index> number;  // of each given one
  Index own = 0;                  // number of those of the patch
  std::vector<Corners> ring;      // triangles around it
  Indexed<Corners> triangles;     // of the patch
  std::map<Edge, Index> left_of;  // the triangle of each directed edge of the patch
  Indexed<double> spacing;        // wanted at each vertex
  Places flat;                    // added vertices are on the given triangles
  Places plate;
  Places membrane;
  Bend bend = ThinPlate;

  Index added() const { return flat.count() - given.count(); }

  /// Changes a triangle, or adds the next one.
  void put(Index t, const Corners& corners) {
    triangles.resize(std::max(triangles.size(), static_cast<std::size_t>(t) + 1));
    triangles[t] = corners;
    for (std::size_t k = 0; k < 3; ++k)
      left_of[{corners[k], corners[(k + 1) % 3]}] = t;
  }
};

/// Whether the connected triangles of a patch form a disc: no vertex is twice on its boundary, and
/// its Euler characteristic is 1.
bool isDisc(const FillPatch& patch) {
  std::set<Index> boundary;
  for (const auto& [edge, t] : patch.left_of)
    if (patch.left_of.count({edge.second, edge.first}) == 0 && !boundary.insert(edge.first).second)
      return false;
  const std::size_t edges = (patch.left_of.size() + boundary.size()) / 2;
  return !boundary.empty() &&
         static_cast<std::size_t>(patch.own) + patch.triangles.size() == edges + 1;
}

Eigen::Vector3d normalOf(const Places& x, Index a, Index b, Index c) {
  return (x[b] - x[a]).cross(x[c] - x[a]);
}

/// Whether an edge ab of the triangles abc and bad should be cd: the angles at c and d exceed pi.
bool shouldFlip(const Places& x, Index a, Index b, Index c, Index d) {
  const auto angle = [&](Index at) {
    const Eigen::Vector3d u = x[a] - x[at];
    const Eigen::Vector3d v = x[b] - x[at];
    return std::atan2(u.cross(v).norm(), u.dot(v));
  };
  const Eigen::Vector3d normal = normalOf(x, a, b, c) + normalOf(x, b, a, d);
  return angle(c) + angle(d) > kPi + 1e-9 && normalOf(x, a, d, c).dot(normal) > 0.0 &&
         normalOf(x, d, b, c).dot(normal) > 0.0;
}

/// Flips edges towards a Delaunay mesh. \param taken edges of the mesh between given vertices; one
/// that was flipped away stays taken, as the patch may return to it.
void relax(FillPatch& patch, Edges& taken) {
  constexpr int max_sweeps = 50;  // for edges that flip back and forth
  bool has_flipped = true;
  for (int sweep = 0; has_flipped && sweep < max_sweeps; ++sweep) {
    has_flipped = false;
    for (Index t = 0; t < patch.triangles.count(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b, c] = Corners{patch.triangles[t][k], patch.triangles[t][(k + 1) % 3],
                                       patch.triangles[t][(k + 2) % 3]};
        const auto found = patch.left_of.find({b, a});
        if (found == patch.left_of.end())
          continue;
        const Index other = found->second;
        const Corners& across = patch.triangles[other];
        const Index d = std::accumulate(across.begin(), across.end(), Index{0}) - a - b;
        const bool is_given = std::max(c, d) < patch.own;
        if (!shouldFlip(patch.plate, a, b, c, d) || patch.left_of.count({c, d}) > 0 ||
            patch.left_of.count({d, c}) > 0 ||
            (is_given && !taken.insert(undirected(patch.given[c], patch.given[d])).second))
          continue;
        patch.left_of.erase({a, b});
        patch.left_of.erase({b, a});
        patch.put(t, {a, d, c});
        patch.put(other, {d, b, c});
        has_flipped = true;
        break;
      }
  }
}

/// Splits triangles at their centroids where they are wider than the spacing wanted (Liepa 2003,
/// section 4). \return whether any was split
bool split(FillPatch& patch, Index max_added) {
  const Index count = patch.triangles.count();
  for (Index t = 0; t < count && patch.added() < max_added; ++t) {
    const Corners corners = patch.triangles[t];
    const auto mean = [&](const auto& values) {
      return ((values[corners[0]] + values[corners[1]] + values[corners[2]]) / 3.0);
    };
    const Eigen::Vector3d center = mean(patch.plate);
    const double spacing = mean(patch.spacing);
    if (!std::all_of(corners.begin(), corners.end(), [&](Index v) {
          const double reach = std::sqrt(2.0) * (center - patch.plate[v]).norm();
          return reach > spacing && reach > patch.spacing[v];
        }))
      continue;
    const Index v = patch.plate.count();
    const Eigen::Vector3d flat = mean(patch.flat);
    patch.plate.push_back(center);
    patch.flat.push_back(flat);
    patch.spacing.push_back(spacing);
    patch.put(t, {corners[0], corners[1], v});
    for (std::size_t k = 1; k < 3; ++k)
      patch.put(patch.triangles.count(), {corners[k], corners[(k + 1) % 3], v});
  }
  return patch.triangles.count() > count;
}

using Sparse = Eigen::SparseMatrix<double>;

/// The cotangent Laplacian at the vertices of a patch, divided by the roots of their areas if it is
/// for a thin plate. Rows of vertices at an opening of the mesh are empty.
Sparse laplacianOf(const FillPatch& patch, const Places& x, bool is_plate) {
  std::vector<Corners> triangles(patch.ring);
  triangles.insert(triangles.end(), patch.triangles.begin(), patch.triangles.end());
  Indexed<double> area(x.size(), 0.0);
  Indexed<long long> open(x.size(), 0);  // 0: each neighbour is once the next, once the previous
  for (const Corners& corners : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      area[corners[k]] += normalOf(x, corners[0], corners[1], corners[2]).norm() / 6.0;
      open[corners[k]] += corners[(k + 1) % 3] - corners[(k + 2) % 3];
    }
  const double least = 1e-9 * *std::max_element(area.begin(), area.end());
  std::vector<Eigen::Triplet<double>> entries;
  for (const Corners& corners : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b, c] = Corners{corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]};
      const Eigen::Vector3d u = x[a] - x[c];
      const Eigen::Vector3d v = x[b] - x[c];
      const double sine = u.cross(v).norm();
      const double cotangent = u.dot(v) / std::max(sine, 1e-3 * u.norm() * v.norm() + 1e-300);
      for (const auto& [row, column] : {Edge{a, b}, Edge{b, a}}) {
        if (open[row] != 0 || (row >= patch.own && row < patch.given.count()))
          continue;
        const double weight = cotangent / (is_plate ? std::sqrt(std::max(area[row], least)) : 1.0);
        entries.emplace_back(row, row, weight);
        entries.emplace_back(row, column, -weight);
      }
    }
  Sparse laplacian(x.count(), x.count());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

/// Moves the added vertices to the least energy of a thin plate, with the slope of the surface
/// around, or of a membrane.
void fair(const FillPatch& patch, bool is_plate, Places& x) {
  const Index given = patch.given.count();
  const Index added = patch.added();
  if (added == 0)
    return;
  const Sparse laplacian = laplacianOf(patch, x, is_plate);
  const Sparse to_added = laplacian.rightCols(added);
  Eigen::MatrixXd fixed(given, 3);
  for (Index v = 0; v < given; ++v)
    fixed.row(v) = x[v];
  const Eigen::MatrixXd of_fixed = laplacian.leftCols(given) * fixed;
  const Sparse matrix = is_plate ? Sparse(to_added.transpose() * to_added)
                                 : Sparse(Sparse(to_added.transpose()).rightCols(added));
  const Eigen::MatrixXd right =
      is_plate ? Eigen::MatrixXd(to_added.transpose() * of_fixed) : of_fixed.bottomRows(added);
  const Eigen::SimplicialLDLT<Sparse> solver(matrix);
  if (solver.info() != Eigen::Success)
    return;
  const Eigen::MatrixXd solved = -solver.solve(right);
  if (solved.allFinite())
    for (Index i = 0; i < added; ++i)
      x[given + i] = solved.row(i);
}

/// Makes the patches of a mesh.
class SmoothFiller {
public:
  SmoothFiller(Surface& mesh, int threads)
      : mesh_(mesh), points_(mesh.points), triangles_(mesh.triangles),
        corners_(triangles_, columnCount(points_), threadCount(threads, columnCount(points_))),
        opening_of_(columnCount(triangles_), -1), spacing_(columnCount(points_), 0.0) {
    for (std::size_t i = 0; i < mesh.openings.size(); ++i)
      for (const Index t : mesh.openings[i].triangles)
        opening_of_[t] = static_cast<Index>(i);
    measureSpacing();
    for (const Opening& opening : mesh.openings)
      for (const Index first : opening.triangles)
        if (opening_of_[first] >= 0)
          addPatch(first);
  }

  /// Refines and fairs all patches; leaves out those that need no vertices.
  void bend(const FractionReport& report) {
    double done = 0.0;
    // Wide openings between sparse points take no more vertices than the cloud has.
    Index left = static_cast<Index>(points_.cols()) + 1000;
    for (FillPatch& patch : patches_) {
      for (int round = 0; round < 5; ++round) {  // the bent patch is larger, and bends on
        for (bool is_coarse = round < 3; is_coarse; is_coarse = split(patch, left)) {
          reportFraction(report, done);
          relax(patch, taken_);
        }
        reportFraction(report, done);
        fair(patch, true, patch.plate);
      }
      patch.membrane = patch.flat;
      fair(patch, false, patch.membrane);
      left -= patch.added();
      done += 1.0 / static_cast<double>(patches_.size());
    }
    patches_.erase(std::remove_if(patches_.begin(), patches_.end(),
                                  [](const FillPatch& patch) { return patch.added() == 0; }),
                   patches_.end());
  }

  /// Gives the mesh the patches, bent as far as they do not intersect more than the given ones.
  void fill(const Execution& execution) {
    const auto& given = mesh_.self_intersections;
    for (;;) {
      Indexed<Index> patch_of;
      Surface filled = assembled(patch_of);
      if (filled.added_vertices == 0)
        return;
      filled.self_intersections = findSelfIntersections(filled.points, filled.triangles, execution);
      // For each patch, the pairs now without those before.
      Indexed<Index> more(patches_.size(), 0);
      const auto count = [&](const auto& pairs, Index by) {
        for (const auto& pair : pairs)
          for (const Index t : pair)
            if (patch_of[t] >= 0)
              more[patch_of[t]] += by;
      };
      count(filled.self_intersections, 1);
      count(given, -1);
      bool has_changed = false;
      for (const Index i : indicesOf(more))
        if (more[i] > 0 && patches_[i].bend != AsGiven) {
          patches_[i].bend = static_cast<Bend>(patches_[i].bend + 1);
          has_changed = true;
        }
      const bool is_given = std::all_of(patches_.begin(), patches_.end(),
                                        [](const auto& patch) { return patch.bend == AsGiven; });
      if (!has_changed && (is_given || filled.self_intersections.size() <= given.size())) {
        mesh_ = std::move(filled);
        return;
      }
      for (FillPatch& patch : patches_)
        patch.bend = has_changed ? patch.bend : AsGiven;
    }
  }

private:
  /// The mean length of the edges at a vertex that are not over openings; elsewhere the mean of
  /// all.
  void measureSpacing() {
    double sum = 0.0;
    double all = 0.0;
    Indexed<double> count(spacing_.size(), 0.0);
    for (Index t = 0; t < triangles_.cols(); ++t)
      for (Index k = 0; opening_of_[t] < 0 && k < 3; ++k) {
        const Index a = triangles_(k, t);
        const Index b = triangles_(nextCorner(k), t);
        const double length = (points_.col(a) - points_.col(b)).norm();
        for (const Index v : {a, b}) {
          spacing_[v] += length;
          count[v] += 1.0;
        }
        sum += length;
        all += 1.0;
      }
    for (const Index v : indicesOf(spacing_))
      spacing_[v] = count[v] > 0.0 ? spacing_[v] / count[v] : sum / std::max(all, 1.0);
  }

  /// The corners of a triangle of the mesh in a patch, which gets those that it lacks.
  Corners cornersIn(FillPatch& patch, Index t) const {
    Corners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = triangles_(static_cast<Index>(k), t);
      const auto [place, is_new] = patch.number.emplace(v, patch.given.count());
      if (is_new)
        patch.given.push_back(v);
      corners[k] = place->second;
    }
    return corners;
  }

  /// Adds the connected triangles over an opening from one on, if they form a disc.
  void addPatch(Index first) {
    FillPatch patch;
    patch.opening = std::exchange(opening_of_[first], -1);
    patch.at = {first};
    for (std::size_t i = 0; i < patch.at.size(); ++i) {
      patch.put(static_cast<Index>(i), cornersIn(patch, patch.at[i]));
      for (Index k = 0; k < 3; ++k) {
        const Index v = triangles_(k, patch.at[i]);
        const Index next = triangles_(nextCorner(k), patch.at[i]);
        corners_.forEachCorner(next, [&](Index t, Index at) {
          if (opening_of_[t] == patch.opening && triangles_(nextCorner(at), t) == v) {
            opening_of_[t] = -1;
            patch.at.push_back(t);
          }
        });
      }
    }
    patch.own = patch.given.count();
    if (!isDisc(patch))
      return;
    std::set<Index> seen(patch.at.begin(), patch.at.end());
    for (Index own = 0; own < patch.own; ++own)
      corners_.forEachCorner(patch.given[own], [&](Index t, Index) {
        if (seen.insert(t).second)
          patch.ring.push_back(cornersIn(patch, t));
      });
    for (const Index t : seen)
      for (Index k = 0; k < 3; ++k)
        taken_.insert(undirected(triangles_(k, t), triangles_(nextCorner(k), t)));
    for (const Index v : patch.given) {
      patch.flat.push_back(points_.col(v));
      patch.spacing.push_back(spacing_[v]);
    }
    patch.plate = patch.flat;
    patches_.push_back(std::move(patch));
  }

  /// The mesh with the patches as they bend now. \param patch_of of each triangle; -1: none
  Surface assembled(Indexed<Index>& patch_of) const {
    using Triangle = Eigen::Matrix<Index, 3, 1>;
    Surface filled = mesh_;
    std::vector<Eigen::Vector3d> added;
    std::vector<Triangle> more;
    Index last = -1;  // opening with added vertices
    patch_of.assign(columnCount(triangles_), -1);
    for (Index i = 0; i < patches_.count(); ++i) {
      const FillPatch& patch = patches_[i];
      for (const Index t : patch.at)
        patch_of[t] = i;
      if (patch.bend == AsGiven)
        continue;
      const Index first = static_cast<Index>(points_.cols()) + static_cast<Index>(added.size());
      for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
        Triangle triangle(patch.triangles[t].data());
        for (Index& v : triangle)
          v = v < patch.given.count() ? patch.given[v] : first + v - patch.given.count();
        if (t < patch.at.size()) {
          filled.triangles.col(patch.at[t]) = triangle;
        } else {
          filled.openings[static_cast<std::size_t>(patch.opening)].triangles.push_back(
              patch_of.count());
          more.push_back(triangle);
          patch_of.push_back(i);
        }
      }
      const Places& places = patch.bend == Membrane ? patch.membrane : patch.plate;
      for (Index v = patch.given.count(); v < places.count(); ++v) {
        added.push_back(places[v]);
        const auto distance = [&](Index other) {
          return (points_.col(other) - added.back()).squaredNorm();
        };
        const Index nearest = *std::min_element(
            patch.given.begin(), patch.given.begin() + patch.own,
            [&](Index one, Index other) { return distance(one) < distance(other); });
        filled.input_of_vertex.push_back(mesh_.input_of_vertex[static_cast<std::size_t>(nearest)]);
      }
      filled.smoothly_filled += std::exchange(last, patch.opening) == patch.opening ? 0 : 1;
    }
    filled.added_vertices = added.size();
    const auto append = [](const auto& columns, auto& matrix) {
      const Eigen::Index before = matrix.cols();
      matrix.conservativeResize(3, before + static_cast<Eigen::Index>(columns.size()));
      std::copy(columns.begin(), columns.end(), matrix.colwise().begin() + before);
    };
    append(added, filled.points);
    append(more, filled.triangles);
    return filled;
  }

  Surface& mesh_;
  const Positions& points_;
  const Triangles& triangles_;
  CornerTable corners_;
  Indexed<Index> opening_of_;  // of each triangle; -1: none, or it has been seen
  Indexed<double> spacing_;    // of each vertex
  Indexed<FillPatch> patches_;
  Edges taken_;  // of the mesh, at the vertices of patches
};

}  // namespace

void fillSmoothly(const Execution& execution, Surface& mesh) {
  const bool has_filled = std::any_of(mesh.openings.begin(), mesh.openings.end(),
                                      [](const auto& of) { return !of.triangles.empty(); });
  if (!has_filled || mesh.intersections_are_sampled)
    return;
  const TimeLeft left(execution.time_limit);
  Execution limited = execution;
  bool is_late = false;
  if (execution.time_limit)
    limited.progress = [&](const Progress& progress) {
      is_late = left() == 0.0;
      return !is_late && (!execution.progress || execution.progress(progress));
    };
  try {
    SmoothFiller filler(mesh, execution.threads);
    filler.bend(reportOf(limited, "fill"));
    filler.fill(limited);
  } catch (const Cancelled&) {
    if (!is_late)
      throw;
    mesh.is_out_of_time = true;
  }
}

}  // namespace spherical_param::internal
