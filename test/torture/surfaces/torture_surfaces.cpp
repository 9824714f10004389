// Clouds that show no sphere, and clouds that do: the tool makes a closed mesh of each through all
// points, says what is wrong where something is, with numbers that are compared with the truth, and
// nothing where nothing is. Exit code 0 with warnings, 1 with -strict, and the mesh in both cases.

#include "scan_shapes.h"
#include "tool_runner.h"
#include "torture_row.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace {

using Eigen::Vector3d;
using nlohmann::json;
using spherical_param::Index;
using spherical_param::Positions;
using namespace spherical_param::tools;

constexpr double pi = 3.14159265358979323846;

/// A boundary of the surface that was scanned.
struct Opening {
  Vector3d center = Vector3d::Zero();
  double length = 0.0;
  double area = 0.0;  ///< of its loop, as a vector

  double diameter() const { return std::min(4.0 * area / length, length / pi); }
};

/// Centre, length and area of a closed loop of points.
Opening measured(const std::vector<Vector3d>& loop) {
  Opening opening;
  for (const Vector3d& p : loop)
    opening.center += p / static_cast<double>(loop.size());
  Vector3d doubled = Vector3d::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vector3d& a = loop[i];
    const Vector3d& b = loop[(i + 1) % loop.size()];
    opening.length += (b - a).norm();
    doubled += (a - opening.center).cross(b - opening.center);
  }
  opening.area = doubled.norm() / 2.0;
  return opening;
}

/// What is true of a shape.
struct Truth {
  std::string kind = "closed genus 0";
  double area = 0.0;
  std::vector<Opening> openings;
  std::size_t handles = 0;
  std::size_t parts = 1;
  double gap = 0.0;
};

Truth truthOf(const ShapeInfo& shape) {
  Truth truth;
  const TruthMesh mesh = referenceMesh(shape.shape, 100000);
  const auto at = [&](Index v) { return Vector3d(mesh.vertices.col(v)); };
  std::map<std::pair<Index, Index>, int> sides;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vector3d a = at(mesh.triangles(0, t));
    truth.area += (at(mesh.triangles(1, t)) - a).cross(at(mesh.triangles(2, t)) - a).norm() / 2.0;
    for (Eigen::Index k = 0; k < 3; ++k)
      ++sides[{mesh.triangles(k, t), mesh.triangles((k + 1) % 3, t)}];
  }
  std::map<Index, Index> next;
  for (const auto& [side, count] : sides)
    if (sides.count({side.second, side.first}) == 0)
      next[side.first] = side.second;
  while (!next.empty()) {
    std::vector<Vector3d> loop;
    for (auto step = next.begin(); step != next.end();) {
      const Index to = step->second;
      next.erase(step);
      loop.push_back(at(to));
      step = next.find(to);
    }
    truth.openings.push_back(measured(loop));
  }
  if (!truth.openings.empty())
    truth.kind = "open";
  if (shape.shape == Shape::Torus || shape.shape == Shape::DoubleTorus) {
    truth.kind = "handles";
    truth.handles = shape.shape == Shape::Torus ? 1 : 2;
  }
  if (shape.shape == Shape::Pair) {
    truth.kind = "several parts";
    truth.parts = 2;
    truth.gap = 0.2;  // between the two spheres
  }
  return truth;
}

struct Case {
  ShapeInfo shape;
  std::size_t points = 0;
  double noise = 0.0;
  std::uint64_t seed = 1;

  std::string name() const {
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(), "%-12s %6zu points, noise %.2f, seed %llu",
                  std::string(shape.name).c_str(), points, noise,
                  static_cast<unsigned long long>(seed));
    return text.data();
  }
};

/// What is wrong with an answer, one line each.
using Complaints = std::vector<std::string>;

/// Checks a mesh in OFF against the points, without any of the library. \return points lost.
std::size_t checkMesh(const std::string& text, const Positions& points, Complaints& complaints) {
  std::istringstream file(text);
  std::string keyword;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t ignored = 0;
  file >> keyword >> vertices >> triangles >> ignored;
  using Place = std::array<float, 3>;
  std::vector<Place> places(vertices);
  for (Place& place : places)
    file >> place[0] >> place[1] >> place[2];
  std::vector<std::array<std::size_t, 3>> mesh(triangles);
  for (auto& triangle : mesh)
    file >> ignored >> triangle[0] >> triangle[1] >> triangle[2];
  if (!file || keyword != "OFF") {
    complaints.emplace_back("the mesh cannot be read");
    return static_cast<std::size_t>(points.cols());
  }
  // Each directed edge once and its reverse once; the triangles around each vertex are one fan.
  std::unordered_map<std::uint64_t, std::size_t> opposite;
  std::vector<std::size_t> valence(vertices, 0);
  std::vector<std::size_t> start(vertices, 0);
  const auto key = [&](std::size_t a, std::size_t b) {
    return static_cast<std::uint64_t>(a) * vertices + b;
  };
  bool good = true;
  for (const auto& triangle : mesh)
    for (std::size_t k = 0; k < 3 && good; ++k) {
      const std::size_t a = triangle[k];
      const std::size_t b = triangle[(k + 1) % 3];
      good = a < vertices && b < vertices && a != b &&
             opposite.emplace(key(a, b), triangle[(k + 2) % 3]).second;
      if (good) {
        ++valence[a];
        start[a] = b;
      }
    }
  for (std::size_t v = 0; v < vertices && good; ++v) {
    std::size_t steps = 0;
    std::size_t at = start[v];
    do {
      const auto next = opposite.find(key(v, at));
      good = next != opposite.end();
      at = good ? next->second : start[v];
      ++steps;
    } while (good && at != start[v] && steps <= valence[v]);
    good = good && valence[v] > 0 && steps == valence[v];
  }
  // Connected, by the triangles over the edges.
  if (good) {
    std::vector<char> seen(vertices, 0);
    std::vector<std::size_t> pending = {0};
    seen[0] = 1;
    std::size_t reached = 0;
    while (!pending.empty()) {
      const std::size_t v = pending.back();
      pending.pop_back();
      ++reached;
      std::size_t at = start[v];
      do {
        if (seen[at] == 0) {
          seen[at] = 1;
          pending.push_back(at);
        }
        at = opposite.at(key(v, at));
      } while (at != start[v]);
    }
    good = reached == vertices && triangles + 4 == 2 * vertices;  // V - E + F = 2
  }
  if (!good)
    complaints.emplace_back("the mesh is no closed surface without handles");
  // Every point is a vertex: generated scans have no two alike.
  std::vector<Place> wanted;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    wanted.push_back({static_cast<float>(points(0, i)), static_cast<float>(points(1, i)),
                      static_cast<float>(points(2, i))});
  std::sort(wanted.begin(), wanted.end());
  std::sort(places.begin(), places.end());
  std::vector<Place> missing;
  std::set_difference(wanted.begin(), wanted.end(), places.begin(), places.end(),
                      std::back_inserter(missing));
  if (!missing.empty() || places.size() != wanted.size())
    complaints.push_back(std::to_string(missing.size()) + " of the points are no vertices");
  return missing.size();
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

Vector3d toVector(const json& array) {
  return {array.at(0).get<double>(), array.at(1).get<double>(), array.at(2).get<double>()};
}

/// The openings that were found against those there are.
void checkOpenings(const json& lids, const Truth& truth, const Positions& points, double spacing,
                   Complaints& complaints, std::string& numbers) {
  // Narrower ones are not told from uneven sampling, see surface_diagnosis.h.
  constexpr double told_spacings = 8.0;
  std::vector<std::size_t> hits(truth.openings.size(), 0);
  for (const json& lid : lids) {
    if (lid.at("cause") != "open")
      continue;
    std::vector<Vector3d> loop;
    for (const json& index : lid.at("loops").at(0))
      loop.emplace_back(points.col(index.get<Eigen::Index>()));
    const Opening found = measured(loop);
    const auto nearest = std::min_element(
        truth.openings.begin(), truth.openings.end(), [&](const Opening& a, const Opening& b) {
          return (a.center - found.center).norm() < (b.center - found.center).norm();
        });
    if (nearest == truth.openings.end() ||
        (nearest->center - found.center).norm() > nearest->diameter() / 2.0) {
      complaints.push_back("an opening that is none, at " + number(found.center.x()) + " " +
                           number(found.center.y()) + " " + number(found.center.z()));
      continue;
    }
    ++hits[static_cast<std::size_t>(nearest - truth.openings.begin())];
    const double area = lid.at("area").get<double>();
    numbers += "; loop of " + std::to_string(loop.size()) + ", " + number(found.length) + " (" +
               number(nearest->length) + "), area " + number(area) + " (" + number(nearest->area) +
               ")";
    // The points at the rim are up to a spacing off it, and the path along them is no straight one.
    if (lid.at("loops").size() != 1)
      complaints.push_back("a lid of " + std::to_string(lid.at("loops").size()) + " loops");
    const double across = std::sqrt(4.0 * nearest->area / pi);
    if (std::abs(std::sqrt(4.0 * area / pi) - across) > 2.0 * spacing + 0.02 * across)
      complaints.push_back("an area of " + number(area) + " instead of " + number(nearest->area));
    if (found.length < nearest->length - 2.0 * pi * spacing ||
        found.length > 1.25 * nearest->length + 2.0 * pi * spacing)
      complaints.push_back("a loop of " + number(found.length) + " instead of " +
                           number(nearest->length));
  }
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const bool told = truth.openings[i].diameter() >= told_spacings * spacing;
    if (hits[i] > 1 || (told && hits[i] == 0))
      complaints.push_back("the opening of " + number(truth.openings[i].diameter() / spacing) +
                           " spacings was found " + std::to_string(hits[i]) + " times");
  }
}

/// The report against the truth.
void checkReport(const json& report, const Truth& truth, const Case& input, const Positions& points,
                 Complaints& complaints, std::string& numbers) {
  const json& diagnosis = report.at("diagnosis");
  const double spacing =
      std::sqrt(truth.area / (static_cast<double>(input.points) * std::sqrt(3.0) / 2.0));
  bool any_told = truth.openings.empty();
  for (const Opening& opening : truth.openings)
    any_told = any_told || opening.diameter() >= 8.0 * spacing;
  const std::string kind = diagnosis.at("kind").get<std::string>();
  numbers += kind;
  if (kind != truth.kind && any_told)
    complaints.push_back("it says \"" + kind + "\" of what is \"" + truth.kind + "\"");
  // One handle may be cut in several places, or in none that can be told where the mesh is folded.
  const json& genus = diagnosis.at("genus");
  if (truth.handles > 0 && genus != truth.handles)
    complaints.push_back("genus " + genus.dump() + " instead of " + std::to_string(truth.handles));
  if (truth.handles == 0 && (!diagnosis.at("handles").empty() || (genus.is_number() && genus != 0)))
    complaints.push_back("handles, and genus " + genus.dump());
  if (truth.handles > 0)
    numbers += "; genus " + genus.dump() + " (" + std::to_string(truth.handles) + ")";
  for (const json& handle : diagnosis.at("handles"))
    numbers += "; " + std::to_string(handle.at("edges").get<int>()) + " edges torn within " +
               number(handle.at("size").get<double>());
  if (diagnosis.at("bridges").size() + 1 != truth.parts)
    complaints.push_back(std::to_string(diagnosis.at("bridges").size()) + " bridges");
  for (const json& bridge : diagnosis.at("bridges")) {
    const double gap = bridge.at("size").get<double>();
    numbers += "; gap " + number(gap) + " (" + number(truth.gap) + ")";
    // The nearest points are off the nearest places.
    if (gap < truth.gap - (2.0 * input.noise + 0.01) * spacing || gap > truth.gap + 2.0 * spacing)
      complaints.push_back("a gap of " + number(gap));
    if (toVector(bridge.at("location")).norm() > 3.0 * spacing)
      complaints.emplace_back("a bridge elsewhere");
  }
  checkOpenings(diagnosis.at("lids"), truth, points, spacing, complaints, numbers);
  const bool warns = !report.at("warnings").empty();
  if (truth.kind != "closed genus 0" && any_told && !warns)
    complaints.emplace_back("no warning");
  // Fewer points are too coarse for some of the shapes, and that is said.
  constexpr std::size_t enough_points = 3000;
  if (truth.kind == "closed genus 0" && input.noise == 0.0 && input.points >= enough_points &&
      warns)
    complaints.push_back("a false alarm: " + report.at("warnings").at(0).get<std::string>());
}

/// What was tried, and what came of it.
struct Count {
  std::uint64_t runs = 0;
  std::uint64_t defects = 0;
  std::uint64_t found = 0;
  std::uint64_t lost = 0;
};

/// \param quick spares the optimisation where it is long and in vain.
void tryCase(const Case& input, const Truth& truth, bool also_strict, bool quick, Count& count) {
  ScanOptions scan_options;
  scan_options.shape = input.shape.shape;
  scan_options.points = input.points;
  scan_options.noise = input.noise;
  scan_options.seed = input.seed;
  const Scan scan = generateScan(scan_options);
  std::string text;
  for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
    std::array<char, 96> line{};
    const Eigen::Vector3f p = scan.points.col(i).cast<float>();
    std::snprintf(line.data(), line.size(), "%.9g %.9g %.9g\n", static_cast<double>(p.x()),
                  static_cast<double>(p.y()), static_cast<double>(p.z()));
    text += line.data();
  }
  const tool_test::TemporaryDirectory directory;
  tool_test::writeFile(directory.file("scan.xyz"), text);

  Complaints complaints;
  std::string numbers;
  tool_test::RunOptions how;
  how.directory = directory.path();
  how.time_limit = 600;
  std::string first_mesh;
  bool warns = false;
  for (const bool strict : {false, true}) {
    if (strict && !also_strict)
      continue;
    std::vector<std::string> words = {"scan.xyz", "mesh.off", "-json", "-"};
    if (strict)
      words.emplace_back("-strict");
    if (quick && (truth.handles > 0 || truth.parts > 1))
      words.insert(words.end(), {"-optimize", "flips"});
    const tool_test::RunResult result = tool_test::run(RECONSTRUCTION_TOOL, words, how);
    ++count.runs;
    const json report = json::parse(result.output, nullptr, false);
    if (report.is_discarded()) {
      complaints.push_back("exit code " + std::to_string(result.exit_code) + ", signal " +
                           std::to_string(result.signal) + ", no report: " + result.errors);
      count.lost += input.points;
      continue;
    }
    const std::string mesh = tool_test::readFile(directory.file("mesh.off"));
    if (!strict) {
      warns = !report.at("warnings").empty();
      first_mesh = mesh;
      count.lost += checkMesh(mesh, scan.points, complaints);
      checkReport(report, truth, input, scan.points, complaints, numbers);
    } else if (mesh != first_mesh) {
      complaints.emplace_back("another mesh with -strict");
    }
    const int expected = strict && warns ? 1 : 0;
    if (result.exit_code != expected)
      complaints.push_back("exit code " + std::to_string(result.exit_code) + " instead of " +
                           std::to_string(expected) + (strict ? " with -strict" : ""));
    if (result.errorLines().size() != (expected == 1 ? 2U : 0U))
      complaints.push_back("on the standard error: " + result.errors);
    std::remove(directory.file("mesh.off").c_str());
  }
  count.defects += truth.openings.size() + truth.handles + truth.parts - 1;
  count.found += complaints.empty() ? 0 : 1;
  std::printf("%s: %s\n", input.name().c_str(), numbers.c_str());
  for (const std::string& complaint : complaints)
    std::printf("  WRONG: %s\n", complaint.c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  bool quick = false;
  std::vector<std::uint64_t> seeds = {1, 2, 3};
  std::string only;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else if (std::strcmp(argv[i], "--seed") == 0 && i + 1 < argc) {
      seeds = {std::strtoull(argv[++i], nullptr, 10)};
    } else if (std::strcmp(argv[i], "--shape") == 0 && i + 1 < argc) {
      only = argv[++i];
    } else {
      std::fprintf(stderr, "usage: torture_surfaces [--quick] [--seed N] [--shape NAME]\n");
      return 2;
    }
  }
  if (quick)
    seeds.resize(1);
  const std::string seed_list =
      std::to_string(seeds.front()) +
      (seeds.size() > 1 ? " to " + std::to_string(seeds.back()) : std::string());
  const std::vector<std::size_t> sizes =
      quick ? std::vector<std::size_t>{2000} : std::vector<std::size_t>{2000, 8000, 30000};
  const std::vector<double> noises =
      quick ? std::vector<double>{0.0} : std::vector<double>{0.0, 0.1};
  const auto in_quick_strict = [](Shape shape) {
    return shape == Shape::Holed || shape == Shape::Torus || shape == Shape::Sphere ||
           shape == Shape::Hand || shape == Shape::Bird;
  };
  Count closed;
  Count others;
  for (const ShapeInfo& shape : allShapes()) {
    if (!only.empty() && only != shape.name)
      continue;
    const Truth truth = truthOf(shape);
    for (const std::size_t points : sizes)
      for (const double noise : noises)
        for (const std::uint64_t seed : seeds)
          tryCase({shape, points, noise, seed}, truth,
                  quick ? in_quick_strict(shape.shape)
                        : seed == seeds.front() && points < sizes.back(),
                  quick, shape.genus_zero ? closed : others);
  }
  const std::string load = "2,000 to 30,000 points, noise 0 and 0.1, seed " + seed_list;
  const std::string quick_load = "2,000 points, seed " + seed_list;
  int code = 0;
  code |= torture::print(
      {"surfaces, not spheres",
       "torus, double torus, bowl, pair, holed, room; " + (quick ? quick_load : load), others.runs,
       others.defects, others.found, others.lost});
  code |=
      torture::print({"surfaces, closed", "ten shapes, no alarm; " + (quick ? quick_load : load),
                      closed.runs, closed.defects, closed.found, closed.lost});
  return code;
}
