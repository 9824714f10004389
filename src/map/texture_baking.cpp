#include "spherical_param/map/texture_atlas.h"

#include "spherical_param/errors.h"

#include "corner_table.h"
#include "exact_predicates.h"
#include "index_loops.h"
#include "input_checks.h"
#include "triangle_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

namespace spherical_param {
namespace {

/// Images are worked on in bands of this number of rows or columns, each by one thread.
constexpr int band_height = 32;

int widthOf(SphereChart chart, int height) {
  switch (chart) {
  case SphereChart::Equirectangular:
    return 2 * height;
  case SphereChart::Octahedral:
    return height;
  case SphereChart::CubeMap:
    return (3 * height + 1) / 2;
  }
  return height;
}

void checkOptions(const std::string& function, const BakeOptions& options) {
  internal::checkRange(function + ": height", options.height, 16, 16384);
  internal::checkRange(function + ": gutter", options.gutter, 0, 256);
  internal::checkThreads(options.threads);
}

using Color = std::array<std::uint8_t, 3>;

class Painter {
public:
  Painter(const TextureAtlas& atlas, const BakeOptions& options) : atlas_(atlas) {
    image_.height = options.height;
    image_.width = widthOf(atlas.chart, options.height);
    image_.covered.assign(at(0, image_.height), 0);
    image_.pixels.assign(3 * image_.covered.size(), 0);
    threads_ = internal::threadCount(options.threads, image_.covered.size());
  }

  /// \param color of a triangle and weights of its corners.
  template <typename ColorOf>
  void paintTriangles(const ColorOf& color) {
    // The triangles that may reach into a band, ascending.
    std::vector<std::vector<Index>> of_band(bandCount(image_.height));
    for (Index t = 0; t < atlas_.coordinate_triangles.cols(); ++t) {
      double lowest = 1.0;
      double highest = 0.0;
      for (Eigen::Index k = 0; k < 3; ++k) {
        const double v = atlas_.coordinates(1, atlas_.coordinate_triangles(k, t));
        lowest = std::min(lowest, v);
        highest = std::max(highest, v);
      }
      const int first = firstPixel(1.0 - highest, image_.height);
      const int last = lastPixel(1.0 - lowest, image_.height);
      for (int band = first / band_height; first <= last && band <= last / band_height; ++band)
        internal::entry(of_band, band).push_back(t);
    }
    internal::forEachTask(of_band.size(), threads_, [&](std::size_t band) {
      const int first = static_cast<int>(band) * band_height;
      const int last = std::min(first + band_height, image_.height) - 1;
      for (const Index t : of_band[band])
        paintTriangle(t, first, last, color);
    });
  }

  /// Gives pixels around the triangles the colour of the nearest pixel in one.
  ///
  /// \param gutter largest distance [pixels].
  void paintGutter(int gutter) {
    if (gutter == 0)
      return;
    // Of each pixel, the row of the nearest one in its column that is covered.
    std::vector<int> nearest(image_.covered.size(), -1);
    forEachLine(image_.width, [&](int x) {
      int above = -1;
      for (int y = 0; y < image_.height; ++y) {
        const std::size_t i = at(x, y);
        above = image_.covered[i] == 1 ? y : above;
        nearest[i] = above;
      }
      int below = -1;
      for (int y = image_.height - 1; y >= 0; --y) {
        const std::size_t i = at(x, y);
        below = image_.covered[i] == 1 ? y : below;
        if (below >= 0 && (nearest[i] < 0 || below - y < y - nearest[i]))
          nearest[i] = below;
      }
    });
    const bool wraps = atlas_.chart == SphereChart::Equirectangular;
    forEachLine(image_.height, [&](int y) {
      for (int x = 0; x < image_.width; ++x) {
        if (image_.covered[at(x, y)] == 1)
          continue;
        int best = gutter * gutter + 1;
        std::size_t source = 0;
        for (int step = 0; step <= gutter && step * step < best; ++step)
          for (const int side : {-1, 1}) {
            int column = x + side * step;
            if (wraps)
              column = ((column % image_.width) + image_.width) % image_.width;
            if (column < 0 || column >= image_.width)
              continue;
            const int other = nearest[at(column, y)];
            if (other < 0)
              continue;
            const int rows = std::min(std::abs(other - y), gutter + 1);
            const int squared = step * step + rows * rows;
            if (squared < best) {
              best = squared;
              source = at(column, other);
            }
          }
        if (best > gutter * gutter)
          continue;
        const std::size_t i = at(x, y);
        image_.covered[i] = 2;
        std::copy_n(&image_.pixels[3 * source], 3, &image_.pixels[3 * i]);
      }
    });
  }

  TextureImage take() { return std::move(image_); }

private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y * Eigen::Index{image_.width} + x);
  }
  static std::size_t bandCount(int lines) {
    return static_cast<std::size_t>((lines + band_height - 1) / band_height);
  }
  /// The first and last pixel whose centre may be on a side of a coordinate, with one to spare for
  /// rounding.
  static int firstPixel(double low, int count) {
    return std::clamp(static_cast<int>(std::floor(low * count - 0.5)), 0, count - 1);
  }
  static int lastPixel(double high, int count) {
    return std::clamp(static_cast<int>(std::ceil(high * count - 0.5)), 0, count - 1);
  }

  /// Calls work(line) for rows or columns, several next to each other by one thread.
  template <typename Work>
  void forEachLine(int count, const Work& work) {
    internal::forEachTask(bandCount(count), threads_, [&](std::size_t band) {
      const int first = static_cast<int>(band) * band_height;
      for (int line = first; line < std::min(first + band_height, count); ++line)
        work(line);
    });
  }

  /// Paints the pixels whose centres are in a triangle, its border included, unless one before it
  /// has done so: borders then have no gaps, as the test is exact.
  template <typename ColorOf>
  void paintTriangle(Index t, int first_row, int last_row, const ColorOf& color) {
    Eigen::Matrix<double, 2, 3> p;
    for (Index k = 0; k < 3; ++k)
      p.col(k) = atlas_.coordinates.col(atlas_.coordinate_triangles(k, t));
    if (internal::orientation2d(p.col(0), p.col(1), p.col(2)) <= 0)
      return;
    const Eigen::Vector2d low = p.rowwise().minCoeff();
    const Eigen::Vector2d high = p.rowwise().maxCoeff();
    first_row = std::max(first_row, firstPixel(1.0 - high.y(), image_.height));
    last_row = std::min(last_row, lastPixel(1.0 - low.y(), image_.height));
    const int first_column = firstPixel(low.x(), image_.width);
    const int last_column = lastPixel(high.x(), image_.width);
    for (int y = first_row; y <= last_row; ++y)
      for (int x = first_column; x <= last_column; ++x) {
        const std::size_t i = at(x, y);
        if (image_.covered[i] != 0)
          continue;
        const Eigen::Vector2d center((x + 0.5) / image_.width, 1.0 - (y + 0.5) / image_.height);
        Eigen::Vector3d weights;
        bool is_inside = true;
        for (Index k = 0; is_inside && k < 3; ++k) {
          const Eigen::Vector2d a = p.col((k + 1) % 3);
          const Eigen::Vector2d b = p.col((k + 2) % 3);
          is_inside = internal::orientation2d(a, b, center) >= 0;
          weights[k] = std::max(0.0, (a.x() - center.x()) * (b.y() - center.y()) -
                                         (a.y() - center.y()) * (b.x() - center.x()));
        }
        if (!is_inside)
          continue;
        const Color painted = color(t, internal::withSumOne(weights));
        image_.covered[i] = 1;
        std::copy(painted.begin(), painted.end(), &image_.pixels[3 * i]);
      }
  }

  const TextureAtlas& atlas_;
  int threads_ = 1;
  TextureImage image_;
};

/// Light for every other square, dark otherwise, of a hue for each octant.
Color checkerColor(const Eigen::Vector3d& direction, int cells) {
  // Squares of equal angles on the six sides of a cube.
  constexpr double half_side = 0.78539816339744830962;
  Eigen::Index axis = 0;
  const double depth = direction.cwiseAbs().maxCoeff(&axis);
  int squares = 0;
  for (const Eigen::Index other : {(axis + 1) % 3, (axis + 2) % 3}) {
    const double angle = depth > 0.0 ? std::atan(direction[other] / depth) : 0.0;
    const double place = (angle + half_side) / (2.0 * half_side) * cells;
    squares += std::clamp(static_cast<int>(std::floor(place)), 0, cells - 1);
  }
  // Three squares meet at a corner of the cube: along some of its edges, equal ones have to.
  const bool is_light = squares % 2 == 0;
  Color color{};
  for (Index d = 0; d < 3; ++d) {
    const bool is_positive = direction[d] >= 0.0;
    internal::entry(color, d) =
        static_cast<std::uint8_t>(is_light ? (is_positive ? 255 : 205) : (is_positive ? 150 : 45));
  }
  return color;
}

/// \param values of the vertices of the mesh; \param color of what they make at a pixel.
template <typename ColorOf>
TextureImage bake(const TextureAtlas& atlas, const Positions& values, const BakeOptions& options,
                  const ColorOf& color) {
  const Positions at_vertices = atCutVertices(atlas, values);
  Painter painter(atlas, options);
  painter.paintTriangles([&](Index t, const Eigen::Vector3d& weights) {
    return color(internal::blend(at_vertices, atlas.triangles, t, weights));
  });
  painter.paintGutter(options.gutter);
  return painter.take();
}

}  // namespace

TextureImage bakeColors(const TextureAtlas& atlas,
                        const Eigen::Matrix<double, 3, Eigen::Dynamic>& colors,
                        const BakeOptions& options) {
  checkOptions("bakeColors", options);
  internal::checkAtlas("bakeColors", atlas);
  if (!(colors.array() >= 0.0 && colors.array() <= 255.0).all())
    throw InvalidInput("bakeColors: a colour is out of range or not finite; give channels from 0 "
                       "to 255");
  return bake(atlas, colors, options, [](const Eigen::Vector3d& at_pixel) {
    Color color{};
    for (Index c = 0; c < 3; ++c)
      internal::entry(color, c) =
          static_cast<std::uint8_t>(std::clamp(std::floor(at_pixel[c] + 0.5), 0.0, 255.0));
    return color;
  });
}

TextureImage bakeCheckerboard(const TextureAtlas& atlas, const Positions& sphere, int cells,
                              const BakeOptions& options) {
  checkOptions("bakeCheckerboard", options);
  internal::checkAtlas("bakeCheckerboard", atlas);
  internal::checkRange("bakeCheckerboard: cells", cells, 1, 4096);
  if (!sphere.allFinite())
    throw InvalidInput("bakeCheckerboard: a vertex on the sphere is not finite; give unit vectors");
  // In the flat triangles of the mesh: pieces of a triangle have the pattern of the whole.
  return bake(atlas, sphere, options,
              [cells](const Eigen::Vector3d& at_pixel) { return checkerColor(at_pixel, cells); });
}

}  // namespace spherical_param
