#include "findings.h"

#include "core/reconstructions.h"

namespace spherical_param::test {
namespace {

constexpr std::size_t kPoints = 1000;

/// A result without findings.
Surface soundResult() {
  Surface result;
  result.vertex_of_input.resize(kPoints);
  result.input_of_vertex.resize(kPoints);
  result.triangles.resize(3, 2 * kPoints - 4);
  return result;
}

Opening filledOpening(std::size_t points, double certainty = 1.0) {
  Opening opening;
  opening.loop.resize(points);
  opening.certainty = certainty;
  opening.is_filled = true;
  return opening;
}

void addBridge(Surface& result, std::size_t points, std::size_t other_points) {
  PartBridge bridge;
  bridge.points = points;
  bridge.other_points = other_points;
  result.diagnosis.bridges.push_back(bridge);
  result.diagnosis.joined_parts = result.diagnosis.bridges.size() + 1;
}

struct Case {
  Finding expected;  ///< without text: there is none
  std::function<void(Surface&)> change;
};

void expectFindings(const std::vector<Case>& cases, const Options& options = {}) {
  for (const auto& [expected, change] : cases) {
    SCOPED_TRACE(expected.text);
    Surface result = soundResult();
    change(result);
    const std::vector<Finding> findings = findingsOf(options, result);
    ASSERT_EQ(findings.size(), expected.text.empty() ? 0U : 1U);
    if (!findings.empty()) {
      EXPECT_EQ(findings[0].text, expected.text);
      EXPECT_EQ(findings[0].option, expected.option);
      EXPECT_EQ(findings[0].value, expected.value);
      EXPECT_EQ(findings[0].is_fault, expected.is_fault);
    }
  }
}

TEST(Findings, EachNamesTheOptionThatDealsWithIt) {
  expectFindings({
      {{}, [](Surface&) {}},
      {{}, [](Surface& r) { r.diagnosis.edges_outside_graph = 0.05; }},
      {{"2,000 stray points in the mesh", "outliers", "auto", false},
       [](Surface& r) { r.outliers.resize(2000); }},
      {{"2 separate parts (39 and 40 points)", "min_points", "39", true},
       [](Surface& r) { addBridge(r, 39, 40); }},
      {{"3 separate parts (two of them of 1 and 4 points)", "", "", true},
       [](Surface& r) {
         addBridge(r, 1, 4);
         addBridge(r, 1, 3);
       }},
      {{"2 openings, the largest of 432 points, filled", "surface", "open", true},
       [](Surface& r) {
         r.openings = {filledOpening(40), filledOpening(432), filledOpening(500, 0.9)};
       }},
      {{"2 possible openings, the largest of 27 points, filled", "surface", "open", false},
       [](Surface& r) {
         r.openings = {filledOpening(27, 0.4), filledOpening(12, 0.6), filledOpening(28, 0.39)};
       }},
      {{"the points are noisy", "consolidation", "auto", false},
       [](Surface& r) { r.is_noisy = true; }},
      {{},
       [](Surface& r) {
         r.is_noisy = true;
         r.smoothing.emplace();
       }},
      {{"1 handle, cut: the mesh is a sphere", "", "", true},
       [](Surface& r) { r.diagnosis.cut_handles = 1; }},
      {{"2 more handles, cut", "", "", true},
       [](Surface& r) {
         r.topology.genus = 1;
         r.diagnosis.cut_handles = 2;
       }},
      {{"2 possible handles, cut: more points or less noise there would tell"},
       [](Surface& r) { r.diagnosis.possible_handles = 2; }},
      {{"the surface has only one side, like a Moebius strip: the mesh is torn", "", "", true},
       [](Surface& r) { r.diagnosis.is_one_sided = true; }},
      {{"the mesh is folded: 12 % of its edges join points that are far apart in the cloud", "", "",
        true},
       [](Surface& r) { r.diagnosis.edges_outside_graph = 0.12; }},
      {{"the time limit ended the work early: this is the best mesh so far"},
       [](Surface& r) { r.is_out_of_time = true; }},
      {{"self-intersections", "", "", true}, [](Surface& r) { r.intersecting_triangles = 2; }},
  });
}

/// Adds a base to a mesh with an area of 10.
void addBase(Surface& result, double area, bool is_filled) {
  result.measures.area = 10.0;
  Opening opening = filledOpening(61);
  opening.is_filled = is_filled;
  opening.is_base = true;
  opening.area = area;
  result.openings = {opening};
}

TEST(Findings, AnOpenBaseNamesTheOptionThatClosesIt) {
  expectFindings({{{"the base of 61 points is open", "surface", "closed", false},
                   [](Surface& r) { addBase(r, 3.0, false); }},
                  // What one place sees has an opening as large as itself.
                  {{}, [](Surface& r) { addBase(r, 4.0, false); }}});
  expectFindings({{{}, [](Surface& r) { addBase(r, 3.0, false); }}}, given("surface", "open"));
  // Filled on request it is no finding, unless it is as large as the mesh.
  expectFindings({{{}, [](Surface& r) { addBase(r, 3.0, true); }},
                  {{"opening of 61 points, filled", "surface", "open", true},
                   [](Surface& r) { addBase(r, 4.0, true); }}},
                 given("surface", "closed"));
}

TEST(Findings, AnOpeningThatIsFilledOnRequestIsNoFault) {
  expectFindings(
      {{{"opening of 432 points, filled"}, [](Surface& r) { r.openings = {filledOpening(432)}; }}},
      given("surface", "open", "fill_holes", 500));
}

TEST(Findings, OfAFoldedMeshAreNoNoiseButConsolidationMayHelp) {
  Surface result = soundResult();
  result.is_noisy = true;
  result.diagnosis.edges_outside_graph = 0.12;
  ASSERT_EQ(findingsOf({}, result).size(), 1U);
  EXPECT_EQ(findingsOf({}, result)[0].option, "consolidation");
  result.outliers = {3};
  EXPECT_TRUE(findingsOf({}, result).back().option.empty());
}

TEST(Findings, AFaultWithoutAnOptionBesideOneThatHasOneIsAConsequence) {
  Surface result = soundResult();
  result.intersecting_triangles = 2;
  EXPECT_FALSE(findingsOf({}, result).back().is_consequence);
  result.outliers = {3};
  const std::vector<Finding> findings = findingsOf({}, result);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_FALSE(findings[0].is_consequence);
  EXPECT_TRUE(findings[1].is_consequence);
}

TEST(Findings, OfSeveralPartsAreReportedOnceAKindByTheLargest) {
  const auto of_kind = [](const char* kind, double size, Finding finding) {
    finding.kind = kind;
    finding.size = size;
    return finding;
  };
  Result result;
  result.surfaces.resize(3, soundResult());
  result.surfaces[0].findings = {of_kind("fold", 0.2, {"20 %", "smoothing", "5", false})};
  result.surfaces[1].findings = {of_kind("side", 0.0, {"torn", "", "", true}),
                                 of_kind("lines", 0.0, {"lines"})};
  result.surfaces[2].findings = {of_kind("fold", 0.3, {"30 %", "", "", true}),
                                 of_kind("lines", 0.0, {"lines"})};
  EXPECT_EQ(failureOf(2, 1200, "slow"), "2 parts (1,200 points) cannot be meshed: slow");
  summarize(4, result);
  std::vector<std::string> texts;
  for (const Finding& finding : result.findings)
    texts.push_back(finding.text + " " + finding.option);
  EXPECT_EQ(texts, (std::vector<std::string>{"2 of 3 parts, at worst: 30 % smoothing",
                                             "part 2: torn ", "2 of 3 parts: lines "}));
  EXPECT_EQ(result.findings[0].parts, (std::vector<Index>{1, 3}));
  EXPECT_TRUE(result.findings[0].is_fault && !result.findings[2].is_fault);
  EXPECT_EQ(result.verdict, "3 surfaces, 2 with faults. 1 part cannot be meshed.");
  result = {};
  result.surfaces.resize(1, soundResult());
  result.surfaces[0].findings = {{"noisy", "consolidation", "auto", false}};
  result.surfaces[0].verdict = "Fine.";
  result.left_out.outliers.resize(5);
  result.left_out.unmeshed.resize(kPoints / 9);
  summarize(1, result);
  EXPECT_EQ(result.findings[0].text, "noisy");
  EXPECT_EQ(result.verdict,
            "Fine; 10 % of the points left out: 5 stray points, 111 points that cannot be meshed.");
}

TEST(Findings, ThePapersMethodHasItsOwn) {
  const std::string folded =
      "the mesh is folded: 0.2 % of its edges join points that are far apart in the cloud";
  expectFindings({{{folded, "method", "default", true},
                   [](Surface& r) { r.diagnosis.edges_outside_graph = 0.002; }},
                  {{}, [](Surface& r) { r.diagnosis.edges_outside_graph = 0.001; }},
                  {{"the embedding has not converged", "max_iterations", "1600", false},
                   [](Surface& r) { r.embedding.stop_reason = StopReason::IterationLimit; }},
                  {{"the embedding collapsed", "method", "default", false},
                   [](Surface& r) { r.embedding.stop_reason = StopReason::Collapsed; }}},
                 given(paper(), "max_iterations", 40));
  expectFindings({{{"the embedding has not converged: its residual no longer falls"},
                   [](Surface& r) { r.embedding.stop_reason = StopReason::Stagnated; }}});
}

TEST(Verdict, SaysInProportionWhatIsWrong) {
  const auto expect = [](const std::string& verdict, const std::function<void(Surface&)>& change) {
    Surface result = soundResult();
    change(result);
    EXPECT_EQ(verdictOf({}, result), verdict);
  };
  expect("A sound mesh.", [](Surface&) {});
  expect("A sound mesh, but it joins 2 separate parts, fills 1 opening and cuts 1 handle.",
         [](Surface& r) {
           addBridge(r, 1, 2);
           r.openings = {filledOpening(432)};
           r.diagnosis.cut_handles = 1;
         });
  expect(
      "A sound mesh in 3 pieces with 3 openings, but it has only the triangles that are certain.",
      [](Surface& r) {
        r.topology.components = 3;
        r.boundary.resize(3);
        r.has_certain_triangles_only = true;
      });
  expect("A sound mesh, but it leaves out 20 triangles that would intersect.",
         [](Surface& r) { r.left_out_triangles = 20; });
  expect("The mesh has faults: 7 of 1,996 triangles intersect.",
         [](Surface& r) { r.intersecting_triangles = 7; });
}

TEST(Verdict, MeshIsUsableUpToOnePercentOfItsTriangles) {
  Surface result = soundResult();
  result.triangles.resize(3, 1000);
  result.intersecting_triangles = 10;
  EXPECT_TRUE(result.isUsable() && result.hasVolume());
  result.intersecting_triangles = 11;
  EXPECT_FALSE(result.isUsable() || result.hasVolume());
  result.intersecting_triangles = 0;
  result.boundary.resize(1);
  EXPECT_FALSE(result.hasVolume());  // open
  result.boundary.clear();
  result.diagnosis.edges_outside_graph = 0.2;
  EXPECT_TRUE(result.isUsable());
  EXPECT_FALSE(result.hasVolume());
}

}  // namespace
}  // namespace spherical_param::test
