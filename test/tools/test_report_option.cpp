// -report of the reconstruction tool. What the page shows: common/test_html_report.cpp.

#include "common/report_page.h"
#include "page_data.h"
#include "tool_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::tools::reportPage;
using tool_test::decodedPage;
using tool_test::Page;
using tool_test::RunOptions;
using tool_test::RunResult;
using Words = std::vector<std::string>;

constexpr std::string_view marker = "<!--DATA-->";

class ReportOption : public tool_test::ToolTest {
protected:
  void SetUp() override {
    write("in.ply", tool_test::plyOf(tool_test::ellipsoid(300)));
    if (reportPage().empty()) {
      expectRefused(RECONSTRUCTION_TOOL, {"in.ply", "out.ply", "-report", "page.html"}, 2,
                    "built without the page");
      GTEST_SKIP() << "this build has no page of the report";
    }
  }
  RunResult tool(const Words& arguments) const {
    return expectSuccess(RECONSTRUCTION_TOOL, arguments);
  }

  /// The words of a command line as a shell takes them apart.
  Words shellWords(const std::string& command) const {
    std::istringstream stream(run("/bin/sh", {"-c", "printf '%s\\n' " + command}).output);
    Words words;
    for (std::string line; std::getline(stream, line);)
      words.push_back(line);
    return words;
  }
};

TEST_F(ReportOption, WhatIsNoPageIsRefused) {
  for (const std::string name : {"", "-", "page", "page.htm", "page.json", ".html", "in.ply"}) {
    SCOPED_TRACE(name);
    expectRefused(RECONSTRUCTION_TOOL, {"in.ply", "out.ply", "-report=" + name}, 2, "-report");
  }
  expectRefused(RECONSTRUCTION_TOOL, {"in.ply", "out.ply", "-report", "no/page.html"}, 1,
                "missing directory");
  expectRefused(RECONSTRUCTION_TOOL, {"in.ply", "out.ply", "-report", "r.html", "-json", "r.html"},
                2, "would overwrite");
}

TEST_F(ReportOption, AFullDiskLeavesNothingBehind) {
  RunOptions options;
  options.file_size_limit = 100000;  // room for the mesh, not for the page
  expectRefused(RECONSTRUCTION_TOOL, {"in.ply", "out.ply", "-report", "page.html"}, 1,
                "cannot write 'page.html'", options);
}

TEST_F(ReportOption, MeshAndSphereAreTheSameWithAndWithoutIt) {
  tool({"in.ply", "a.ply", "-sphere", "sa.ply"});
  const RunResult result = tool({"in.ply", "b.ply", "-sphere", "sb.ply", "-report", "page.html"});
  EXPECT_NE(result.output.find("\nwritten   b.ply, sb.ply, page.html\n"), std::string::npos);
  EXPECT_TRUE(content("a.ply") == content("b.ply"));
  EXPECT_TRUE(content("sa.ply") == content("sb.ply"));
}

TEST_F(ReportOption, PageLoadsNothingAndHoldsTheReportOfJson) {
  const std::string input = "a </script><!-- \"it's\" &.ply";
  const std::string output = "b </script>.ply";
  std::filesystem::create_directories(directory.file("a <"));
  std::filesystem::create_directories(directory.file("b <"));
  write(input, content("in.ply"));
  tool({input, output, "-report", "page.HTML", "-json", "report.json", "-smoothing", "2", "-quiet",
        "-starts=7"});
  const std::string html = content("page.HTML");
  const std::string whole(reportPage());
  const std::size_t place = whole.find(marker);
  const std::string rest = whole.substr(place + marker.size());
  EXPECT_EQ(html.compare(0, place, whole, 0, place), 0);
  EXPECT_EQ(html.compare(html.size() - rest.size(), rest.size(), rest), 0);
  // It may load nothing, and holds the licence of what it contains of others.
  EXPECT_NE(whole.find("content=\"default-src 'none'; script-src 'sha256-"), std::string::npos);
  EXPECT_NE(whole.find("three.js authors"), std::string::npos);
  EXPECT_NE(whole.find("Permission is hereby granted, free of charge"), std::string::npos);

  const Page page = decodedPage(html);
  // Nothing but the elements of program, data and arrays is between these parts.
  const std::string between = html.substr(place, html.size() - rest.size() - place);
  EXPECT_EQ(std::count(between.begin(), between.end(), '<'),
            2 * static_cast<std::ptrdiff_t>(page.arrays.size() + 2));
  json expected = json::parse(content("report.json"));
  json report = page.data["report"];
  EXPECT_EQ(report["input"], input);
  EXPECT_EQ(report["output"], output);
  EXPECT_EQ(report["options"]["report"], "page.HTML");
  EXPECT_EQ(expected["stages"].back()["name"], "report");
  for (json* each : {&expected, &report}) {
    each->erase("peak_memory_bytes");
    each->erase("stages");
  }
  EXPECT_EQ(report, expected);
  EXPECT_EQ(page.data["tool"]["name"], "pcl_spherical_param_reconstruction");
  EXPECT_EQ(
      shellWords(page.data["command"]),
      (Words{"pcl_spherical_param_reconstruction", input, output, "-starts", "7", "-smoothing", "2",
             "-seed", "1", "-report", "page.HTML", "-json", "report.json", "-quiet"}));
}

TEST_F(ReportOption, ItsCommandRepeatsTheRun) {
  write("-it's in.ply", content("in.ply"));
  for (const Words& options : {Words{"-seed", "3", "-outliers", "9"},
                               Words{"-method", "paper", "-max-iterations", "20"}}) {
    tool(tool_test::with(options,
                         {"-report", "page.html", "-quiet", "--", "-it's in.ply", "out.ply"}));
    const Page first = decodedPage(content("page.html"));
    const std::string mesh = content("out.ply");
    Words again = shellWords(first.data["command"]);
    again.erase(again.begin());
    std::filesystem::remove(directory.file("out.ply"));
    std::filesystem::remove(directory.file("page.html"));
    tool(again);
    EXPECT_TRUE(content("out.ply") == mesh);
    const Page second = decodedPage(content("page.html"));
    EXPECT_TRUE(second.texts == first.texts);
    EXPECT_EQ(second.data["command"], first.data["command"]);
  }
}

}  // namespace
