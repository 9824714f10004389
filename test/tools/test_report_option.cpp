// -report of the reconstruction tool. What the page shows: common/test_html_report.cpp.

#include "common/report_page.h"
#include "page_data.h"
#include "tool_test.h"

#include <gtest/gtest.h>

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
  RunResult tool(const Words& arguments) const { return run(RECONSTRUCTION_TOOL, arguments); }

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
  ASSERT_EQ(tool({"in.ply", "a.ply", "-sphere", "sa.ply"}).exit_code, 0);
  const RunResult result = tool({"in.ply", "b.ply", "-sphere", "sb.ply", "-report", "page.html"});
  ASSERT_EQ(result.exit_code, 0);
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
  const RunResult result = tool({input, output, "-report", "page.HTML", "-json", "report.json",
                                 "-smoothing", "2", "-quiet", "-damping=0.25"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string html = content("page.HTML");
  // Nothing but the data is between the two parts of the page, and these are elements of base64.
  const std::string whole(reportPage());
  const std::size_t place = whole.find(marker);
  const std::string rest = whole.substr(place + marker.size());
  ASSERT_GT(html.size(), rest.size());
  EXPECT_TRUE(html.compare(0, place, whole, 0, place) == 0);
  EXPECT_TRUE(html.compare(html.size() - rest.size(), rest.size(), rest) == 0);
  std::istringstream elements(html.substr(place, html.size() - rest.size() - place));
  for (std::string line; std::getline(elements, line);) {
    EXPECT_EQ(line.rfind("<script type=\"text/plain\" id=\"", 0), 0U);
    const std::size_t begin = line.find('>') + 1;
    const std::size_t end = line.find_first_not_of(
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=", begin);
    EXPECT_EQ(line.substr(end), "</script>");
  }
  // It may load nothing, and holds the licence of what it contains of others.
  EXPECT_NE(whole.find("content=\"default-src 'none'; script-src 'sha256-"), std::string::npos);
  for (const char* attribute : {"src=\"", "href=\""})
    for (std::size_t at = whole.find(attribute); at != std::string::npos;
         at = whole.find(attribute, at + 1))
      EXPECT_EQ(whole.compare(whole.find('"', at) + 1, 5, "data:"), 0);
  EXPECT_NE(whole.find("three.js authors"), std::string::npos);
  EXPECT_NE(whole.find("Permission is hereby granted, free of charge"), std::string::npos);

  const Page page = decodedPage(html);
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
      (Words{"pcl_spherical_param_reconstruction", input, output, "-damping", "0.25", "-smoothing",
             "2", "-seed", "1", "-report", "page.HTML", "-json", "report.json", "-quiet"}));
}

TEST_F(ReportOption, ItsCommandRepeatsTheRun) {
  write("-it's in.ply", content("in.ply"));
  for (const Words& options :
       {Words{"-seed", "3", "-outliers", "9"},
        Words{"-embedding", "iterative", "-optimization", "none", "-max-iterations", "20"}}) {
    Words words = {"-report", "page.html", "-quiet"};
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), {"--", "-it's in.ply", "out.ply"});
    ASSERT_EQ(tool(words).exit_code, 0);
    const Page first = decodedPage(content("page.html"));
    const std::string mesh = content("out.ply");
    Words again = shellWords(first.data["command"]);
    again.erase(again.begin());
    std::filesystem::remove(directory.file("out.ply"));
    std::filesystem::remove(directory.file("page.html"));
    const RunResult result = tool(again);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(content("out.ply") == mesh);
    const Page second = decodedPage(content("page.html"));
    EXPECT_TRUE(second.texts == first.texts);
    EXPECT_EQ(second.data["command"], first.data["command"]);
  }
}

}  // namespace
