#include "common/report_mesh.h"

#include "spherical_param/mesh_optimization.h"
#include "spherical_param/neighbor_graph.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_triangulation.h"
#include "spherical_param/surface_diagnosis.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>

namespace spherical_param::tools {
namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// The triangles around each vertex.
class Fans {
public:
  Fans(const Triangles& triangles, std::size_t vertex_count) : offsets_(vertex_count + 1, 0) {
    for (Eigen::Index i = 0; i < triangles.size(); ++i) {
      ++offsets_[at(triangles.data()[i]) + 1];
    }
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    triangles_.resize(offsets_.back());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for (Index t = 0; t < triangles.cols(); ++t) {
      for (Index k = 0; k < 3; ++k) {
        triangles_[next[at(triangles(k, t))]++] = t;
      }
    }
  }

  const Index* begin(Index v) const { return triangles_.data() + offsets_[at(v)]; }
  const Index* end(Index v) const { return triangles_.data() + offsets_[at(v) + 1]; }

private:
  std::vector<std::size_t> offsets_;
  std::vector<Index> triangles_;
};

/// A triangle, seen from one of its corners.
struct Spoke {
  Index triangle;
  Index first;   ///< the next corner
  Index second;  ///< the one after it
};

/// The triangles around a vertex, counter-clockwise, from the one whose next corner comes first in
/// an order; those that do not follow at the end. `unordered` is for scratch.
void collectSpokes(const Triangles& triangles, const Fans& fans, Index v,
                   const std::vector<Index>& number, std::vector<Spoke>& unordered,
                   std::vector<Spoke>& spokes) {
  unordered.clear();
  spokes.clear();
  for (const Index* t = fans.begin(v); t != fans.end(v); ++t) {
    Index k = 0;
    while (triangles(k, *t) != v) {
      ++k;
    }
    unordered.push_back({*t, triangles((k + 1) % 3, *t), triangles((k + 2) % 3, *t)});
  }
  if (unordered.empty()) {
    return;
  }
  const auto rank = [&](const Spoke& spoke) {
    // What has no number yet comes last.
    return static_cast<std::uint32_t>(number[at(spoke.first)]);
  };
  Index next =
      std::min_element(unordered.begin(), unordered.end(), [&](const Spoke& a, const Spoke& b) {
        return rank(a) < rank(b);
      })->first;
  // A vertex may have as many triangles as the mesh: each of them is looked for in a sorted list.
  std::sort(unordered.begin(), unordered.end(), [](const Spoke& a, const Spoke& b) {
    return std::tie(a.first, a.triangle) < std::tie(b.first, b.triangle);
  });
  constexpr Index taken = -1;
  while (spokes.size() < unordered.size()) {
    const auto found =
        std::lower_bound(unordered.begin(), unordered.end(), next,
                         [](const Spoke& spoke, Index first) { return spoke.first < first; });
    if (found == unordered.end() || found->first != next || found->triangle == taken) {
      break;
    }
    spokes.push_back(*found);
    next = found->second;
    found->triangle = taken;
  }
  std::copy_if(unordered.begin(), unordered.end(), std::back_inserter(spokes),
               [](const Spoke& spoke) { return spoke.triangle != taken; });
}

/// Distortion of the map at the vertices.
struct Distortion {
  std::vector<double> area;
  std::vector<double> angle;
};

/// A triangle in its plane, by its edges from one corner: (length, 0) and (x, height).
struct InPlane {
  double length;
  double x;
  double height;

  InPlane(const Eigen::Vector3d& first, const Eigen::Vector3d& second)
      : length(first.norm()), x(length > 0.0 ? first.dot(second) / length : second.norm()),
        height(length > 0.0 ? first.cross(second).norm() / length : 0.0) {}
};

/// sigma_1 / sigma_2 of the linear map from a flat triangle to another.
double anisotropy(const InPlane& source, const InPlane& image) {
  constexpr double most = 1e6;
  if (!(source.length > 0.0) || !(source.height > 0.0)) {
    return most;
  }
  const double a = image.length / source.length;
  const double b = (image.x - a * source.x) / source.height;
  const double d = image.height / source.height;
  // sigma_1 + sigma_2 and sigma_1 - sigma_2 are the moduli of the conformal and the anticonformal
  // part; the determinant, which is their product, does not cancel out.
  const double sigma_1 = 0.5 * (std::hypot(a + d, b) + std::hypot(a - d, b));
  const double determinant = a * d;
  return sigma_1 * sigma_1 < most * determinant ? sigma_1 * sigma_1 / determinant : most;
}

Distortion distortionOf(const Positions& points, const Triangles& triangles,
                        const Positions& sphere) {
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<double> in_space(n, 0.0);
  std::vector<double> on_sphere(n, 0.0);
  std::vector<double> weighted(n, 0.0);
  double all_space = 0.0;
  double all_sphere = 0.0;
  for (Index t = 0; t < triangles.cols(); ++t) {
    const auto edges = [&](const Positions& of) {
      const Eigen::Vector3d corner = of.col(triangles(0, t));
      return std::pair<Eigen::Vector3d, Eigen::Vector3d>(of.col(triangles(1, t)) - corner,
                                                         of.col(triangles(2, t)) - corner);
    };
    const auto [a, b] = edges(points);
    const auto [c, d] = edges(sphere);
    const double area = a.cross(b).norm() / 2.0;
    const double image = c.cross(d).norm() / 2.0;
    const double angle = anisotropy(InPlane(a, b), InPlane(c, d));
    all_space += area;
    all_sphere += image;
    for (Index k = 0; k < 3; ++k) {
      const std::size_t v = at(triangles(k, t));
      in_space[v] += area;
      on_sphere[v] += image;
      weighted[v] += area * angle;
    }
  }
  Distortion distortion;
  constexpr double least = 1e-300;
  for (std::size_t v = 0; v < n; ++v) {
    const double share = std::max(in_space[v] / std::max(all_space, least), least);
    const double image = std::max(on_sphere[v] / std::max(all_sphere, least), least);
    distortion.area.push_back(std::log2(image) - std::log2(share));
    distortion.angle.push_back(in_space[v] > 0.0 ? std::max(1.0, weighted[v] / in_space[v]) : 1.0);
  }
  return distortion;
}

/// Marks of the triangles where they are shown.
std::vector<std::uint8_t> marksOf(const Result& result, int threads) {
  std::vector<std::uint8_t> marks = result.diagnosis.triangle_marks;
  marks.resize(static_cast<std::size_t>(result.triangles.cols()), 0);
  if (result.smoothed.cols() == 0) {
    return marks;
  }
  // The self-intersections of the result are those of the points of the input.
  for (std::uint8_t& mark : marks) {
    mark = static_cast<std::uint8_t>(mark & ~TriangleMarks::self_intersection);
  }
  if (result.smoothing.self_intersections > 0) {
    SelfIntersectionOptions options;
    options.threads = threads;
    for (const auto& pair : findSelfIntersections(result.smoothed, result.triangles, options)) {
      for (const Index t : pair) {
        marks[at(t)] = static_cast<std::uint8_t>(marks[at(t)] | TriangleMarks::self_intersection);
      }
    }
  }
  return marks;
}

/// The edges of a mesh as the graph of its points.
Graph graphOf(const Positions& points, const Triangles& triangles) {
  const auto n = static_cast<std::size_t>(points.cols());
  Graph graph;
  graph.offsets.assign(n + 1, 0);
  for (Index t = 0; t < triangles.cols(); ++t) {
    for (Index k = 0; k < 3; ++k) {
      ++graph.offsets[at(triangles(k, t)) + 1];
    }
  }
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
  graph.neighbors.resize(graph.offsets.back());
  graph.lengths.resize(graph.offsets.back());
  std::vector<std::size_t> next(graph.offsets.begin(), graph.offsets.end() - 1);
  for (Index t = 0; t < triangles.cols(); ++t) {
    for (Index k = 0; k < 3; ++k) {
      graph.neighbors[next[at(triangles(k, t))]++] = triangles((k + 1) % 3, t);
    }
  }
  for (std::size_t v = 0; v < n; ++v) {
    std::sort(graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[v]),
              graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[v + 1]));
    for (std::size_t e = graph.offsets[v]; e < graph.offsets[v + 1]; ++e) {
      graph.lengths[e] =
          (points.col(static_cast<Eigen::Index>(v)) - points.col(graph.neighbors[e])).norm();
    }
  }
  return graph;
}

/// The triangulation of vertices on the sphere, its edges flipped where that suits their places in
/// space.
Triangles triangulated(const Positions& positions, const Positions& sphere, int threads) {
  Triangles triangles = triangulateSphere(sphere).triangles;
  const Eigen::AlignedBox3d box(positions.rowwise().minCoeff(), positions.rowwise().maxCoeff());
  const Positions scaled = (positions.colwise() - box.min()) / box.sizes().maxCoeff();
  OptimizationOptions options;
  options.method = OptimizationMethod::Flips;
  options.threads = threads;
  return optimizeMesh(scaled, triangles, graphOf(scaled, triangles), options).triangles;
}

template <typename Value>
std::vector<Value> picked(const std::vector<Value>& values, const std::vector<Index>& numbers) {
  std::vector<Value> result;
  result.reserve(numbers.size());
  for (const Index number : numbers) {
    result.push_back(values[at(number)]);
  }
  return result;
}

Positions picked(const Positions& points, const std::vector<Index>& numbers) {
  Positions result(3, static_cast<Eigen::Index>(numbers.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    result.col(static_cast<Eigen::Index>(i)) = points.col(numbers[i]);
  }
  return result;
}

/// Puts a subset of the vertices in the place of all. A triangle between vertices of suspicious
/// ones is taken for suspicious as well.
void decimate(std::size_t count, int threads, ReportMesh& mesh) {
  const auto n = static_cast<std::size_t>(mesh.positions.cols());
  std::vector<std::uint8_t> marks_around(n, 0);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (Index k = 0; k < 3; ++k) {
      std::uint8_t& mark = marks_around[at(mesh.triangles(k, t))];
      mark = static_cast<std::uint8_t>(mark | mesh.marks[at(t)]);
    }
  }
  std::vector<bool> kept(n);
  std::transform(marks_around.begin(), marks_around.end(), kept.begin(),
                 [](std::uint8_t mark) { return mark != 0; });
  const std::vector<Index> subset = evenSubset(mesh.positions, kept, count);
  mesh.positions = picked(mesh.positions, subset);
  mesh.sphere = picked(mesh.sphere, subset);
  mesh.area_distortion = picked(mesh.area_distortion, subset);
  mesh.angle_distortion = picked(mesh.angle_distortion, subset);
  mesh.residual = picked(mesh.residual, subset);
  mesh.colors = mesh.colors.empty() ? mesh.colors : picked(mesh.colors, subset);
  marks_around = picked(marks_around, subset);
  mesh.triangles = triangulated(mesh.positions, mesh.sphere, threads);
  mesh.marks.resize(static_cast<std::size_t>(mesh.triangles.cols()));
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    mesh.marks[at(t)] = static_cast<std::uint8_t>(marks_around[at(mesh.triangles(0, t))] &
                                                  marks_around[at(mesh.triangles(1, t))] &
                                                  marks_around[at(mesh.triangles(2, t))]);
  }
  mesh.decimated = true;
}

/// A point in its cell of a grid.
struct Place {
  std::uint64_t cell;
  double distance;  ///< from the middle of the cell, squared
  Index point;
};

/// The points of a set in the cells of a grid, sorted by cell, the nearest to its middle first.
std::vector<Place> placesOf(const Positions& points, const std::vector<Index>& numbers,
                            double cell_size) {
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  constexpr double most_cells = 2097151.0;  // 21 bits an axis
  std::vector<Place> places;
  places.reserve(numbers.size());
  for (const Index i : numbers) {
    const Eigen::Array3d place = ((points.col(i) - low) / cell_size).array();
    const Eigen::Array3d cell = place.floor().min(most_cells);
    const auto key = [&](Eigen::Index axis) { return static_cast<std::uint64_t>(cell[axis]); };
    places.push_back(
        {key(0) << 42U | key(1) << 21U | key(2), (place - cell - 0.5).matrix().squaredNorm(), i});
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.cell, a.distance, a.point) < std::tie(b.cell, b.distance, b.point);
  });
  places.erase(std::unique(places.begin(), places.end(),
                           [](const Place& a, const Place& b) { return a.cell == b.cell; }),
               places.end());
  return places;
}

}  // namespace

double residualExponent(double residual) {
  // Less is rounding, or 0, which has no logarithm.
  constexpr double least = 1e-17;
  return std::log10(std::isfinite(residual) ? std::max(residual, least) : least);
}

MeshOrder traversalOrder(const Triangles& triangles, std::size_t vertex_count) {
  const Fans fans(triangles, vertex_count);
  MeshOrder order;
  order.renumbered.resize(3, triangles.cols());
  std::vector<Index> number(vertex_count, -1);
  std::vector<bool> done(static_cast<std::size_t>(triangles.cols()), false);
  std::vector<Spoke> spokes;
  std::vector<Spoke> unordered;
  auto left = number.cbegin();  // all before it have a number
  const auto visit = [&](Index v) {
    if (number[at(v)] < 0) {
      number[at(v)] = static_cast<Index>(order.vertices.size());
      order.vertices.push_back(v);
    }
  };
  for (std::size_t i = 0; i < vertex_count; ++i) {
    if (i == order.vertices.size()) {
      // The first, and one of each further part.
      left = std::find(left, number.cend(), -1);
      visit(static_cast<Index>(left - number.cbegin()));
    }
    const Index v = order.vertices[i];
    collectSpokes(triangles, fans, v, number, unordered, spokes);
    for (const Spoke& spoke : spokes) {
      visit(spoke.first);
      visit(spoke.second);
    }
    // All triangles with an earlier vertex are done.
    for (const Spoke& spoke : spokes) {
      if (!done[at(spoke.triangle)]) {
        done[at(spoke.triangle)] = true;
        order.renumbered.col(static_cast<Eigen::Index>(order.triangles.size())) << number[at(v)],
            number[at(spoke.first)], number[at(spoke.second)];
        order.triangles.push_back(spoke.triangle);
      }
    }
  }
  return order;
}

std::vector<Index> evenSubset(const Positions& points, const std::vector<bool>& kept,
                              std::size_t count) {
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<Index> subset;
  std::vector<Index> others;
  for (std::size_t i = 0; i < n; ++i) {
    (kept[i] ? subset : others).push_back(static_cast<Index>(i));
  }
  const auto thin = [](std::vector<Index>& numbers, std::size_t most) {
    if (numbers.size() <= most) {
      return;
    }
    for (std::size_t i = 0; i < most; ++i) {
      numbers[i] = numbers[i * numbers.size() / most];
    }
    numbers.resize(most);
  };
  // Half of the room at most: the rest of the object is to be seen as well.
  thin(subset, std::max(count / 2, count - std::min(count, others.size())));
  const std::size_t room = count - subset.size();
  if (others.size() > room && room > 0) {
    const double extent = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
    double cell_size = std::max(extent, 1e-300) / std::sqrt(static_cast<double>(room));
    constexpr int most_rounds = 8;
    constexpr double enough = 0.85;
    std::vector<Index> best;
    for (int round = 0; round < most_rounds; ++round) {
      const std::vector<Place> places = placesOf(points, others, cell_size);
      const double share = static_cast<double>(places.size()) / static_cast<double>(room);
      if (places.size() <= room && places.size() > best.size()) {
        best.clear();
        for (const Place& place : places) {
          best.push_back(place.point);
        }
      }
      if (share <= 1.0 && share >= enough) {
        break;
      }
      // The number of cells that a surface meets goes with the square of their number along it.
      cell_size *= std::sqrt(share / ((1.0 + enough) / 2.0));
    }
    if (2 * best.size() < room) {
      thin(others, room);
    } else {
      others = std::move(best);
    }
  }
  subset.insert(subset.end(), others.begin(), others.end());
  thin(subset, count);
  std::sort(subset.begin(), subset.end());
  return subset;
}

ReportMesh reportMesh(const CloudReconstruction& cloud, std::size_t most_triangles, int threads) {
  const Result& result = cloud.result();
  ReportMesh mesh;
  mesh.positions = vertexPositions(cloud);
  mesh.sphere = result.sphere;
  mesh.triangles = result.triangles;
  Distortion distortion = distortionOf(mesh.positions, mesh.triangles, mesh.sphere);
  mesh.area_distortion = std::move(distortion.area);
  mesh.angle_distortion = std::move(distortion.angle);
  mesh.residual.assign(result.vertexCount(), residualExponent(0.0));
  std::transform(result.vertex_residuals.begin(), result.vertex_residuals.end(),
                 mesh.residual.begin(), residualExponent);
  mesh.marks = marksOf(result, threads);
  if (!cloud.data.colors.empty()) {
    for (const int index : cloud.reconstruction.getVertexIndices()) {
      mesh.colors.push_back(cloud.data.colors[static_cast<std::size_t>(index)]);
    }
  }
  if (static_cast<std::size_t>(mesh.triangles.cols()) > most_triangles) {
    decimate(most_triangles / 2 + 2, threads, mesh);
  }
  const MeshOrder order =
      traversalOrder(mesh.triangles, static_cast<std::size_t>(mesh.positions.cols()));
  mesh.positions = picked(mesh.positions, order.vertices);
  mesh.sphere = picked(mesh.sphere, order.vertices);
  mesh.area_distortion = picked(mesh.area_distortion, order.vertices);
  mesh.angle_distortion = picked(mesh.angle_distortion, order.vertices);
  mesh.residual = picked(mesh.residual, order.vertices);
  mesh.colors = mesh.colors.empty() ? mesh.colors : picked(mesh.colors, order.vertices);
  mesh.marks = picked(mesh.marks, order.triangles);
  mesh.triangles = order.renumbered;
  return mesh;
}

}  // namespace spherical_param::tools
