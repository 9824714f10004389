#include "findings.h"

#include "spherical_param/option_table.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// A number as people write it: 49,996.
std::string grouped(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t end = text.size(); end > 3; end -= 3)
    text.insert(end - 3, ",");
  return text;
}

std::string counted(std::size_t count, const std::string& noun, const std::string& plural = {}) {
  return grouped(count) + " " + (count == 1 ? noun : plural.empty() ? noun + "s" : plural);
}

std::string decimal(double number, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, number);
  return text.data();
}

std::string percent(double fraction) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2g %%", 100.0 * fraction);
  return text.data();
}

/// Whether more triangles are left out than may intersect in a usable mesh.
bool hasTangle(const Surface& result) {
  return 100 * result.left_out_triangles > static_cast<std::size_t>(result.triangles.cols());
}

/// Whether the points sample no surface: they fill a volume, or lie in layers or along curves.
bool isNoSurface(const SurfaceDiagnosis& diagnosis) {
  return diagnosis.fills_volume || diagnosis.is_layered || diagnosis.is_on_curves;
}

/// Whether the mesh is rough and only noise explains it.
bool isRough(const Surface& result) {
  return result.is_noisy && !result.consolidation && !result.smoothing && result.outliers.empty() &&
         result.diagnosis.bridges.empty() && result.diagnosis.cut_handles == 0 &&
         !result.diagnosis.is_on_lines && !isNoSurface(result.diagnosis);
}

/// A finding about something that the cloud shows and the mesh lacks. It names the topology if
/// that asks for a sphere and the option does not override it, else the option.
Finding shown(const std::string& text, const Options& given, const std::string& option,
              const std::string& value, bool is_fault) {
  const bool is_overridden = textOf(findOption(option).get(given)) != "topology";
  if (given.topology == TopologyMode::Sphere && !is_overridden)
    return {text, "topology", "scan", is_fault};
  return {text, option, value, is_fault};
}

bool isFolded(const Options& options, const Surface& result) {
  // Above this fraction of edges outside the graph, a mesh without optimisation is folded. Unfolded
  // embeddings of closed surfaces have at most 0.0005, the filled opening of a bowl of some
  // thousand points 0.002, folded limbs at least 0.003.
  constexpr double max_edges_outside = 0.001;
  return result.isFolded() || (options.method == Method::Paper &&
                               result.diagnosis.edges_outside_graph > max_edges_outside);
}

Finding partsOf(const SurfaceDiagnosis& diagnosis, const Options& given) {
  const PartBridge& bridge = diagnosis.bridges.front();
  const std::string text = counted(diagnosis.joined_parts, "separate part") + " (" +
                           (diagnosis.joined_parts > 2 ? "two of them of " : "") +
                           grouped(bridge.points) + " and " +
                           counted(bridge.other_points, "point") + ")";
  const bool is_each = withTopology(given).parts == PartsMode::Each;
  const bool are_small = bridge.other_points < static_cast<std::size_t>(given.min_points);
  if (is_each && bridge.points >= 4)
    return {text, "min_points", std::to_string(bridge.points), true};
  if (is_each || (given.parts == PartsMode::All && are_small))
    return {text, "", "", true};
  return shown(text, given, "parts", "each", true);
}

/// Handles that the mesh lacks.
Finding handlesOf(const Surface& result, const Options& given) {
  const std::size_t missing = result.diagnosis.cut_handles;
  const std::string text = result.genus() == 0
                               ? counted(missing, "handle") + ", cut: the mesh is a sphere"
                               : counted(missing, "more handle") + ", cut";
  const bool may_have =
      withTopology(given).handles == HandleMode::None && given.method == Method::Default;
  return may_have ? shown(text, given, "handles", "auto", true) : Finding{text, "", "", true};
}

/// Whether an opening is the base of an object, which may be closed.
bool isSmallBase(const Opening& opening, const Surface& result) {
  // Of a view of one side, the opening is as large as the mesh.
  constexpr double max_area = 1.0 / 3.0;
  return opening.is_base && opening.area <= max_area * result.measures.area;
}

/// A base without points, which is left open.
std::optional<Finding> baseOf(const Surface& result, const Options& given) {
  if (withTopology(given).surface != SurfaceMode::Auto)
    return std::nullopt;
  for (const Opening& opening : result.openings)
    if (!opening.is_filled && isSmallBase(opening, result))
      return Finding{"the base of " + counted(opening.loop.size(), "point") + " is open", "surface",
                     "closed", false};
  return std::nullopt;
}

/// Reports the certain openings that the mesh fills, which is a fault unless the options ask for
/// it. If it fills none, reports the possible openings.
std::optional<Finding> filledOf(const Surface& result, const Options& given) {
  const bool is_open = given.surface == SurfaceMode::Open;
  const std::size_t certain = result.filledOpenings();
  std::size_t count = 0;
  std::size_t points = 0;
  // Of a width of 5.4 spacings. Clouds of whole objects hardly ever have such an opening, most
  // clouds with holes do.
  constexpr double min_certainty = 0.4;
  const auto is_possible = [](const Opening& opening) {
    return opening.certainty >= min_certainty && !opening.is_flat;
  };
  const auto is_wanted = [&](const Opening& opening) {
    return given.surface == SurfaceMode::Closed && isSmallBase(opening, result);
  };
  for (const Opening& opening : result.openings)
    if (opening.is_filled && !is_wanted(opening) &&
        (certain > 0 ? opening.isCertain() : is_possible(opening))) {
      ++count;
      points = std::max(points, opening.loop.size());
    }
  if (count == 0 || (certain == 0 && is_open))
    return std::nullopt;
  const std::string of = " of " + counted(points, "point") + ", filled";
  const std::string kind = certain > 0 ? "opening" : "possible opening";
  const std::string text = count == 1 ? kind + of : counted(count, kind) + ", the largest" + of;
  const bool is_fault = certain > 0 && given.fill_holes == 0;
  Finding finding = certain > 0 && !is_open
                        ? shown(text, given, "surface", "open", is_fault)
                        : Finding{text, is_open ? "" : "surface", is_open ? "" : "open", is_fault};
  finding.size = static_cast<double>(points);
  return finding;
}

/// Twice as many, at least the default, without overflow.
int moreIterations(int iterations) {
  return std::max(PaperOptions().max_iterations,
                  iterations < std::numeric_limits<int>::max() / 2 ? 2 * iterations : iterations);
}

std::optional<Finding> embeddingOf(const Options& options, const Surface& result) {
  const EmbeddingReport& embedding = result.embedding;
  if (embedding.fallback_start)
    return Finding{"the embedding collapsed and was replaced by one of lower quality"};
  if (embedding.stop_reason == StopReason::Collapsed)
    return Finding{"the embedding collapsed", "method", "default", false};
  if (embedding.stop_reason == StopReason::IterationLimit)
    return Finding{"the embedding has not converged", "max_iterations",
                   std::to_string(moreIterations(options.paper.max_iterations)), false};
  if (embedding.stop_reason == StopReason::Stagnated)
    return Finding{"the embedding has not converged: its residual no longer falls"};
  return std::nullopt;
}

Finding foldOf(const Options& given, const Surface& result) {
  const auto fold_with = [&](const char* option, const char* value) {
    return Finding{"the mesh is folded: " + percent(result.diagnosis.edges_outside_graph) +
                       " of its edges join points that are far apart in the cloud",
                   option, value, true};
  };
  if (given.method == Method::Paper)
    return fold_with("method", "default");
  if (isRough(result))
    return fold_with("consolidation", "auto");
  if (result.is_noisy && result.consolidation && given.smoothing == 0)
    return fold_with("smoothing", "5");
  return fold_with("", "");
}

/// Adds a finding of a part to those of all parts. Of each kind the largest finding stays; if it
/// names no option, it gets that of another one.
void addTo(std::vector<Finding>& all, Finding finding, Index part) {
  auto same = std::find_if(all.begin(), all.end(),
                           [&](const Finding& other) { return other.kind == finding.kind; });
  if (same == all.end())
    same = all.insert(same, finding);
  std::vector<Index> parts = std::move(same->parts);
  if (parts.empty() || parts.back() != part)
    parts.push_back(part);
  if (finding.size > same->size)
    std::swap(finding, *same);
  if (same->option.empty())
    std::tie(same->option, same->value) = std::tie(finding.option, finding.value);
  same->is_fault = same->is_fault || finding.is_fault;
  same->is_consequence = same->is_consequence && finding.is_consequence;
  same->parts = std::move(parts);
}

}  // namespace

std::vector<Finding> findingsOf(const Options& given, const Surface& result) {
  const SurfaceDiagnosis& diagnosis = result.diagnosis;
  std::vector<Finding> findings;
  const auto add = [&](const std::string& kind, Finding finding, double size = 0.0) {
    finding.kind = kind;
    finding.size = size;
    findings.push_back(std::move(finding));
  };
  const auto add_count = [&](const char* kind, std::size_t count, const Finding& finding) {
    if (count > 0)
      add(kind, finding, static_cast<double>(count));
  };
  const bool is_consolidated = given.consolidation == ConsolidationMode::Auto;
  const std::size_t outliers = result.outliers.size();
  add_count(
      "stray points", outliers,
      shown(counted(outliers, "stray point") + " in the mesh", given, "outliers", "auto", false));
  if (!diagnosis.bridges.empty())
    add_count("separate parts", diagnosis.joined_parts, partsOf(diagnosis, given));
  if (const std::optional<Finding> filled = filledOf(result, given))
    add(result.filledOpenings() > 0 ? "openings" : "possible openings", *filled, filled->size);
  if (const std::optional<Finding> base = baseOf(result, given))
    add("open base", *base);
  if (isRough(result) && !result.isFolded())
    add("noise", {"the points are noisy", "consolidation", "auto", false});
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double step = diagnosis.coarse_steps[axis];
    const std::string name(1, "xyz"[axis]);
    if (step > 0.0)
      add("steps of " + name,
          {name + " has steps of " + decimal(step, 6) +
           ": the file lost digits; subtract an offset before writing single precision"},
          step);
  }
  if (diagnosis.is_scattered)
    add("few points", {"the points are too few or too noisy to show a surface"});
  if (diagnosis.fills_volume)
    add("volume", {"the points fill a volume: they sample no surface; take its boundary"});
  else if (diagnosis.is_layered)
    add("layers", {"the points are several layers of voxels, no surface: take their boundary",
                   is_consolidated ? "" : "consolidation", is_consolidated ? "" : "auto", false});
  else if (diagnosis.is_on_curves)
    add("curves", {"the points lie along curves, like centre lines, without a surface between: "
                   "put points around the curves"});
  else if (diagnosis.is_on_lines)
    add("lines", {"the points lie along lines, and the surface between these is a guess"});
  add_count("handles", diagnosis.cut_handles, handlesOf(result, given));
  add_count("possible handles", diagnosis.possible_handles,
            {counted(diagnosis.possible_handles, "possible handle") +
             ", cut: more points or less noise there would tell"});
  if (diagnosis.is_one_sided)
    add("one side",
        {"the surface has only one side, like a Moebius strip: the mesh is torn", "", "", true});
  if (isFolded(given, result))
    add("fold", foldOf(given, result), diagnosis.edges_outside_graph);
  if (const std::optional<Finding> embedding = embeddingOf(given, result))
    add("embedding", *embedding);
  if (result.is_out_of_time)
    add("time limit", {"the time limit ended the work early: this is the best mesh so far"});
  add_count("triangles left out", result.left_out_triangles,
            {counted(result.left_out_triangles, "triangle") +
                 " that would intersect others, left out: small openings",
             "", "", hasTangle(result)});
  if (result.has_certain_triangles_only)
    add("certain triangles",
        {"only triangles that are certain: a mesh of all points is a tangle", "", "", true});
  if (result.intersecting_triangles > 0)
    add("self-intersections", {"self-intersections", "", "", true});
  const bool has_option = std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return !finding.option.empty();
  });
  for (Finding& finding : findings)
    finding.is_consequence =
        (has_option || isNoSurface(diagnosis)) && finding.is_fault && finding.option.empty();
  return findings;
}

std::string verdictOf(const Options& options, const Surface& result) {
  if (result.intersecting_triangles > 0)
    return std::string("The mesh has faults: ") +
           (result.intersections_are_sampled ? "at least " : "") +
           grouped(result.intersecting_triangles) + " of " +
           counted(static_cast<std::size_t>(result.triangles.cols()), "triangle") + " intersect.";
  const SurfaceDiagnosis& diagnosis = result.diagnosis;
  std::string text = "A sound mesh";
  if (result.topology.components > 1)
    text += " in " + counted(result.topology.components, "piece");
  if (result.genus() > 0)
    text += " with " + counted(result.genus(), "handle");
  if (!result.boundary.empty())
    text += (result.genus() > 0 ? " and " : " with ") + counted(result.boundary.size(), "opening");
  std::vector<std::string> doubts;
  if (!diagnosis.bridges.empty())
    doubts.emplace_back("joins " + counted(diagnosis.joined_parts, "separate part"));
  if (result.filledOpenings() > 0)
    doubts.emplace_back("fills " + counted(result.filledOpenings(), "opening"));
  if (diagnosis.is_one_sided)
    doubts.emplace_back("tears a surface with one side");
  else if (diagnosis.cut_handles > 0)
    doubts.emplace_back("cuts " + counted(diagnosis.cut_handles, "handle"));
  if (isFolded(options, result))
    doubts.emplace_back("is folded");
  if (result.has_certain_triangles_only)
    doubts.emplace_back("has only the triangles that are certain");
  else if (hasTangle(result))
    doubts.emplace_back("leaves out " + counted(result.left_out_triangles, "triangle") +
                        " that would intersect");
  for (std::size_t i = 0; i < doubts.size(); ++i)
    text += (i == 0 ? ", but it " : i + 1 < doubts.size() ? ", " : " and ") + doubts[i];
  if (result.added_vertices > 0)
    text += "; " + counted(result.added_vertices, "vertex", "vertices") + " added in " +
            counted(result.smoothly_filled, "filled opening");
  return text + ".";
}

std::string failureOf(std::size_t parts, std::size_t points, std::string error) {
  const std::string function = "reconstruct: ";
  if (error.compare(0, function.size(), function) == 0)
    error.erase(0, function.size());
  return counted(parts, "part") + " (" + counted(points, "point") + ") cannot be meshed: " + error;
}

void summarize(std::size_t parts_in_all, Result& result) {
  std::vector<Surface>& surfaces = result.surfaces;
  std::size_t faulty = 0;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    faulty += hasFault(surfaces[i].findings) ? 1 : 0;
    for (const Finding& finding : surfaces[i].findings)
      addTo(result.findings, finding, static_cast<Index>(i) + 1);
  }
  if (surfaces.size() == 1) {
    result.verdict = surfaces.front().verdict;
    result.findings = surfaces.front().findings;
  } else {
    for (Finding& finding : result.findings) {
      const std::size_t count = finding.parts.size();
      finding.text.insert(0, count == 1
                                 ? "part " + std::to_string(finding.parts.front()) + ": "
                                 : grouped(count) + " of " + counted(surfaces.size(), "part") +
                                       (finding.size > 0.0 ? ", at worst: " : ": "));
    }
    const auto count = [&](const std::string& of, const auto& has) {
      const auto found = std::count_if(surfaces.begin(), surfaces.end(), has);
      return found == 0 ? "" : grouped(static_cast<std::size_t>(found)) + of;
    };
    const bool are_open = std::none_of(surfaces.begin(), surfaces.end(),
                                       [](const Surface& s) { return s.isClosed(); });
    result.verdict =
        grouped(surfaces.size()) + " surfaces" +
        (result.view && are_open
             ? " with openings, "
             : ", " + count(" with openings, ", [](const Surface& s) { return !s.isClosed(); })) +
        count(" with handles, ", [](const Surface& s) { return s.genus() > 0; }) +
        (faulty == 0 ? "all sound." : grouped(faulty) + " with faults.");
  }
  if (result.view) {
    result.verdict[0] = result.verdict[0] == 'A' ? 'a' : result.verdict[0];
    result.verdict.insert(0, "Seen from one place: ");
  }
  std::size_t merged = 0;
  double distance = 0.0;
  for (const Surface& surface : surfaces)
    if (surface.consolidation) {
      merged += surface.consolidation->merged;
      distance = std::max(distance, surface.consolidation->distance_95);
    }
  if (distance > 0.0)
    result.verdict.replace(result.verdict.size() - 1, 1,
                           "; consolidated: " + counted(merged, "point") + " merged, 95 % within " +
                               decimal(distance, 3) + " of the mesh.");
  LeftOut stray = result.left_out;
  stray.not_finite.clear();
  if (const std::string text = stray.text(); !text.empty()) {
    constexpr double min_fraction = 0.01;
    std::size_t taken = 0;
    for (const Surface& surface : surfaces)
      taken += surface.vertex_of_input.size();
    const auto count = static_cast<double>(stray.count());
    const double fraction = count / (count + static_cast<double>(taken));
    result.verdict.replace(result.verdict.size() - 1, 1,
                           fraction < min_fraction ? "; " + text + " left out."
                                                   : "; " + percent(fraction) +
                                                         " of the points left out: " + text + ".");
  }
  if (parts_in_all > surfaces.size())
    result.verdict += " " + counted(parts_in_all - surfaces.size(), "part") + " cannot be meshed.";
  if (surfaces.size() == 1)
    surfaces.front().verdict = result.verdict;
}

}  // namespace spherical_param::internal

namespace spherical_param {

std::size_t LeftOut::count() const {
  return not_finite.size() + unused.size() + outliers.size() + other_parts.size() + unmeshed.size();
}

std::string LeftOut::text() const {
  std::string text;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0)
      text += (text.empty() ? "" : ", ") + internal::counted(count, one, many);
  };
  add(not_finite.size(), "point that is not finite", "points that are not finite");
  add(unused.size(), "point in no face", "points in no face");
  add(outliers.size(), "stray point", "stray points");
  add(other_parts.size(), "point in other parts", "points in other parts");
  add(unmeshed.size(), "point that cannot be meshed", "points that cannot be meshed");
  return text;
}

}  // namespace spherical_param
