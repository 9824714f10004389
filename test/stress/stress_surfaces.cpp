// Clouds of surfaces that are no spheres, and of some that are: each becomes a closed mesh through
// all of its points, with its handles; the diagnosis names the defect where there is one, and there
// is no warning where there is none.
//
//   stress_surfaces [--quick] [--seed N]

#include "guarantees.h"
#include "open_shapes.h"
#include "scan_shapes.h"
#include "spherical_param/mesh_topology.h"
#include "stress.h"

namespace {

using Eigen::Vector3d;
using namespace spherical_param;
using namespace spherical_param::tools;
using Complaints = std::vector<std::string>;

double diameterOf(double area) {
  return std::sqrt(4.0 * area / test::kPi);
}

/// Center and area of a boundary loop.
Opening measured(const std::vector<Vector3d>& loop) {
  Opening opening;
  for (const Vector3d& p : loop)
    opening.center += p / static_cast<double>(loop.size());
  Vector3d doubled = Vector3d::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i)
    doubled += (loop[i] - opening.center).cross(loop[(i + 1) % loop.size()] - opening.center);
  opening.area = doubled.norm() / 2.0;
  opening.is_flat = std::all_of(loop.begin(), loop.end(), [&](const Vector3d& p) {
    return std::abs(doubled.normalized().dot(p - opening.center)) < 1e-6;
  });
  return opening;
}

std::vector<Opening> openingsOf(const TruthMesh& mesh) {
  const auto boundaries = test::loopsOf(mesh.triangles);
  std::vector<Opening> openings;
  for (const std::vector<Index>& boundary : boundaries.value()) {
    std::vector<Vector3d> loop;
    for (const Index v : boundary)
      loop.emplace_back(mesh.vertices.col(v));
    openings.push_back(measured(loop));
  }
  return openings;
}

struct Truth {
  double area = 0.0;
  std::vector<Opening> openings;
  std::size_t handles = 0;
  std::size_t parts = 1;

  bool isSphere() const { return openings.empty() && handles == 0 && parts == 1; }
};

Truth truthOf(const std::string& shape) {
  const TruthMesh mesh = referenceMesh(shape);
  Truth truth;
  truth.openings = openingsOf(mesh);
  truth.handles = shape == "torus" ? 1 : shape == "chair" ? 4 : 0;
  truth.area = surfaceArea(mesh.vertices, mesh.triangles);
  truth.parts = shape == "pair" ? 2 : 1;
  return truth;
}

/// Whether an opening must be certain: 9 spacings wide, with a ragged rim, and not flat.
bool isWide(const Opening& opening, double spacing) {
  return diameterOf(opening.area) >= 12.0 * spacing && !opening.is_flat;
}

/// The openings that were found for certain against those there are.
void checkOpenings(const std::vector<Opening>& all, const Truth& truth, double spacing,
                   Complaints& complaints) {
  std::vector<int> hits(truth.openings.size(), 0);
  for (const Opening& found : all) {
    if (!found.isCertain())
      continue;
    bool exists = false;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const Opening& opening = truth.openings[i];
      const double diameter = diameterOf(opening.area);
      if ((opening.center - found.center).norm() > diameter / 2.0)
        continue;
      exists = true;
      ++hits[i];
      // The points at the rim are up to a spacing off it.
      if (std::abs(diameterOf(found.area) - diameter) > 2.0 * spacing + 0.02 * diameter)
        complaints.push_back("an area of " + std::to_string(found.area) + " instead of " +
                             std::to_string(opening.area));
    }
    if (!exists)
      complaints.emplace_back("an opening that does not exist");
  }
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i] > 1 || (hits[i] == 0 && isWide(truth.openings[i], spacing)))
      complaints.push_back("an opening was found " + std::to_string(hits[i]) + " times");
}

Complaints complaintsAbout(const Truth& truth, const ScanOptions& scan_options) {
  // Rounded as by a file.
  const Positions points = generateScan(scan_options).points.cast<float>().cast<double>();
  Options options;
  options.topology = TopologyMode::Sphere;
  options.handles = HandleMode::Auto;
  options = withTopology(options);
  const Surface result = reconstruct(points, options).surface();
  const SurfaceDiagnosis& found = result.diagnosis;
  Complaints complaints;
  const std::string fault = stress::faultOf(points, options, result);
  if (!fault.empty())
    complaints.push_back(fault);
  const double spacing =
      std::sqrt(truth.area / (static_cast<double>(points.cols()) * std::sqrt(3.0) / 2.0));
  const bool is_wide =
      truth.openings.empty() ||
      std::any_of(truth.openings.begin(), truth.openings.end(),
                  [&](const Opening& opening) { return isWide(opening, spacing); });
  if (result.genus() + found.cut_handles != truth.handles)
    complaints.push_back("not of genus " + std::to_string(truth.handles) + ": " + result.verdict);
  if (found.bridges.size() + 1 != truth.parts)
    complaints.push_back(std::to_string(found.bridges.size()) + " bridges");
  checkOpenings(result.openings, truth, spacing, complaints);
  if (!truth.isSphere() && result.genus() == 0 && is_wide && result.findings.empty())
    complaints.emplace_back("nothing is said of it");
  // Fewer points are too coarse for some of the shapes, which is said.
  if (truth.isSphere() && points.cols() >= 3000 && !result.findings.empty())
    complaints.push_back("a false alarm: " + result.findings.front().text);
  return complaints;
}

}  // namespace

int main(int argc, char** argv) {
  const stress::Arguments arguments = stress::parse(argc, argv);
  const std::vector<std::size_t> sizes = arguments.quick
                                             ? std::vector<std::size_t>{2000}
                                             : std::vector<std::size_t>{2000, 8000, 30000};
  std::size_t tried = 0;
  std::size_t found = 0;
  for (const Shape& shape : allShapes()) {
    const Truth truth = truthOf(shape.name);
    const bool has_noise = !arguments.quick && !truth.isSphere();
    for (const std::size_t points : sizes)
      for (const double noise : has_noise ? std::vector<double>{0.0, 0.1} : std::vector{0.0}) {
        ScanOptions options;
        options.shape = shape.name;
        options.points = points;
        options.noise = noise;
        options.seed = arguments.seed;
        ++tried;
        for (const std::string& complaint : complaintsAbout(truth, options)) {
          ++found;
          std::printf("%s, %zu points, noise %g: %s\n", shape.name.c_str(), points, noise,
                      complaint.c_str());
        }
      }
  }
  return stress::finish("surfaces, spheres and others", tried, found);
}
