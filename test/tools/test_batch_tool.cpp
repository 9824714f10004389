// pcl_spherical_param_reconstruction on many inputs, run as a user does.

#include "tool_runner.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using tool_test::readFile;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;

// A sanitizer needs memory of its own, answers signals of its own and takes time to start.
#ifdef SPHERICAL_PARAM_SANITIZED
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

/// An ellipsoid, each with other points.
std::string cloud(int count, int variant) {
  std::ostringstream text;
  text.precision(9);
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = (2.399963229728653 + 0.01 * variant) * i;
    text << radius * std::cos(angle) * (1.0 + 0.05 * variant) << ' ' << radius * std::sin(angle)
         << ' ' << 2.0 * z << '\n';
  }
  return text.str();
}

/// Clouds in `in`: c00.xyz, c01.xyz and so on.
void writeClouds(const TemporaryDirectory& directory, int clouds, int points) {
  fs::create_directories(directory.file("in"));
  for (int i = 0; i < clouds; ++i) {
    writeFile(directory.file("in/c" + std::to_string(i / 10) + std::to_string(i % 10) + ".xyz"),
              cloud(points, i));
  }
}

RunResult runTool(const TemporaryDirectory& directory, const std::vector<std::string>& arguments,
                  RunOptions options = {}) {
  options.directory = directory.path();
  options.time_limit = 600;
  return tool_test::run(RECONSTRUCTION_TOOL, arguments, options);
}

std::vector<json> records(const std::string& path) {
  std::vector<json> found;
  std::istringstream lines(readFile(path));
  for (std::string line; std::getline(lines, line);) {
    json record = json::parse(line, nullptr, false);
    if (record.is_object()) {
      found.push_back(std::move(record));
    }
  }
  return found;
}

std::map<std::string, json> recordsByInput(const std::string& path) {
  std::map<std::string, json> found;
  for (const json& record : records(path)) {
    found[record["input"].get<std::string>()] = record;
  }
  return found;
}

/// The mesh that a run of the tool on this file alone makes.
std::string singleMesh(const TemporaryDirectory& directory, const std::string& input,
                       std::vector<std::string> options = {}) {
  const TemporaryDirectory other;
  options.insert(options.end(), {"--", input, other.file("m.ply")});
  EXPECT_EQ(runTool(directory, options).exit_code, 0) << input;
  return readFile(other.file("m.ply"));
}

/// Names of files that are not finished.
std::vector<std::string> temporaryFiles(const TemporaryDirectory& directory) {
  std::vector<std::string> found;
  for (const auto& file : directory.listing()) {
    if (file.first.find(".spherical_param.") != std::string::npos) {
      found.push_back(file.first);
    }
  }
  return found;
}

/// The programs that a program has started, with their command lines.
std::map<int, std::string> childrenOf(int parent) {
  std::map<int, std::string> found;
  DIR* const processes = opendir("/proc");
  while (const dirent* entry = readdir(processes)) {
    const int process = std::atoi(entry->d_name);
    if (process <= 0) {
      continue;
    }
    const std::string stat = readFile("/proc/" + std::to_string(process) + "/stat");
    const std::size_t end = stat.rfind(')');
    int its_parent = 0;
    char state = 0;
    if (end != std::string::npos &&
        std::sscanf(stat.c_str() + end + 1, " %c %d", &state, &its_parent) == 2 &&
        its_parent == parent && state != 'Z') {
      found[process] = readFile("/proc/" + std::to_string(process) + "/cmdline");
    }
  }
  closedir(processes);
  return found;
}

void pause() {
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

/// Tells whether a program has ended, reaped or not.
bool hasEnded(int process) {
  const std::string stat = readFile("/proc/" + std::to_string(process) + "/stat");
  const std::size_t end = stat.rfind(')');
  return end == std::string::npos || stat.compare(end, 3, ") Z") == 0;
}

using Stamp = std::pair<std::int64_t, std::int64_t>;

/// What changes if a file is written anew.
Stamp stampOf(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
  return {static_cast<std::int64_t>(status.st_ino),
          std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec};
}

/// A job took no more memory than was thought.
void expectNeedIsBound(const json& record) {
  const auto peak = record["peak_memory_bytes"].get<std::uint64_t>();
  EXPECT_GT(peak, 0U);
  EXPECT_TRUE(is_sanitized || peak <= record["memory_need_bytes"].get<std::uint64_t>()) << record;
}

TEST(BatchTool, GoodAndBadInputsMixed) {
  const TemporaryDirectory directory;
  writeClouds(directory, 4, 300);
  writeFile(directory.file("in/bad.ply"), "garbage");
  writeFile(directory.file("in/empty.pcd"), "");
  writeFile(directory.file("few.xyz"), "0 0 0\n1 0 0\n");
  writeFile(directory.file("-odd 'name' {ext}.xyz"), cloud(200, 7));
  writeFile(directory.file("list"), "-odd 'name' {ext}.xyz\nmissing.pcd\nfew.xyz\n");
  const RunResult result = runTool(
      directory, {"in", "-inputs", "list", "-output", "out/deep/{name}.ply", "-sphere",
                  "out/{name}_sphere.ply", "-json", "out/{name}.json", "-jsonl", "r.jsonl"});
  EXPECT_EQ(result.exit_code, 1);
  const std::vector<std::string> errors = result.errorLines();
  ASSERT_EQ(errors.size(), 2U) << result.errors;
  EXPECT_NE(errors[0].find("4 of 9 inputs failed"), std::string::npos);

  const auto found = recordsByInput(directory.file("r.jsonl"));
  ASSERT_EQ(found.size(), 9U);
  ASSERT_EQ(records(directory.file("r.jsonl")).size(), 9U);
  const std::set<std::string> bad = {"in/bad.ply", "in/empty.pcd", "missing.pcd", "few.xyz"};
  for (const auto& [input, record] : found) {
    // The table has a line for each, with the cause of a failure and what to do.
    EXPECT_NE(result.output.find(input), std::string::npos) << input;
    if (bad.count(input) > 0) {
      EXPECT_EQ(record["status"], "failed") << input;
      EXPECT_EQ(record["exit_code"], 1);
      EXPECT_NE(result.output.find(record["cause"].get<std::string>()), std::string::npos);
      EXPECT_NE(result.output.find("remedy: " + record["remedy"].get<std::string>()),
                std::string::npos);
      EXPECT_FALSE(fs::exists(directory.file(record["output"].get<std::string>())));
      continue;
    }
    EXPECT_EQ(record["status"], "done") << input;
    EXPECT_TRUE(record["cause"].is_null());
    EXPECT_GT(record["points"].get<int>(), 0);
    EXPECT_EQ(record["triangles"].get<int>(), 2 * record["vertices"].get<int>() - 4);
    EXPECT_EQ(record["files"].size(), 3U);
    expectNeedIsBound(record);
    EXPECT_EQ(readFile(directory.file(record["output"].get<std::string>())),
              singleMesh(directory, input));
    for (const json& file : record["files"]) {
      EXPECT_EQ(fs::file_size(directory.file(file["path"].get<std::string>())), file["bytes"]);
    }
  }
  EXPECT_TRUE(fs::exists(directory.file("out/deep/-odd 'name' {ext}.ply")));
  EXPECT_TRUE(temporaryFiles(directory).empty());
}

TEST(BatchTool, SameBytesForAnyNumberOfJobsAndThreads) {
  const TemporaryDirectory directory;
  writeClouds(directory, 5, 500);
  std::map<std::string, std::string> first;
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{"-jobs", "1"}, std::vector<std::string>{"-jobs", "2"},
        std::vector<std::string>{"-jobs", "3", "-threads", "2"}}) {
    const TemporaryDirectory out;
    std::vector<std::string> arguments = {"in", "-output", out.file("{name}.ply"), "-quiet"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    const RunResult result = runTool(directory, arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.output + result.errors, "");
    const auto meshes = out.listing();
    ASSERT_EQ(meshes.size(), 5U);
    first = first.empty() ? meshes : first;
    EXPECT_EQ(meshes, first);
  }
}

TEST(BatchTool, ResumeRunsOnlyWhatIsMissingOrChanged) {
  const TemporaryDirectory directory;
  writeClouds(directory, 4, 200);
  writeFile(directory.file("in/c99.xyz"), "no cloud");
  const std::vector<std::string> arguments = {"in",      "-output", "out/{name}.ply", "-jsonl",
                                              "r.jsonl", "-resume", "-optimize",      "flips"};
  const auto run_again = [&](std::vector<std::string> words = {}) {
    std::map<std::string, Stamp> before;
    for (const auto& file : directory.listing()) {
      if (file.first.rfind("out/", 0) == 0) {
        before[file.first] = stampOf(directory.file(file.first));
      }
    }
    const std::size_t count = records(directory.file("r.jsonl")).size();
    const RunResult result = runTool(directory, words.empty() ? arguments : words);
    EXPECT_EQ(result.exit_code, 1);
    const std::vector<json> all = records(directory.file("r.jsonl"));
    std::set<std::string> again;
    for (std::size_t i = count; i < all.size(); ++i) {
      again.insert(fs::path(all[i]["input"].get<std::string>()).stem().string());
    }
    // Files of those that did not run are the very same.
    for (const auto& [file, stamp] : before) {
      EXPECT_EQ(stampOf(directory.file(file)) == stamp,
                again.count(fs::path(file).stem().string()) == 0)
          << file;
    }
    return again;
  };
  using Names = std::set<std::string>;
  EXPECT_EQ(run_again(), (Names{"c00", "c01", "c02", "c03", "c99"}));
  // What failed is tried again.
  EXPECT_EQ(run_again(), (Names{"c99"}));
  fs::remove(directory.file("out/c01.ply"));
  EXPECT_EQ(run_again(), (Names{"c01", "c99"}));
  writeFile(directory.file("in/c02.xyz"), cloud(210, 2));
  EXPECT_EQ(run_again(), (Names{"c02", "c99"}));
  writeFile(directory.file("in/c04.xyz"), cloud(210, 4));
  EXPECT_EQ(run_again(), (Names{"c04", "c99"}));
  // A mesh that something else wrote there, of the same size.
  const std::string mesh = readFile(directory.file("out/c03.ply"));
  writeFile(directory.file("out/c03.ply"), mesh);
  EXPECT_EQ(run_again(), (Names{"c03", "c99"}));
  // Another option; the number of jobs and threads changes nothing.
  std::vector<std::string> words = arguments;
  words.insert(words.end(), {"-jobs", "3", "-threads", "1"});
  EXPECT_EQ(run_again(words), (Names{"c99"}));
  words.back() = "2";
  words.insert(words.end(), {"-seed", "5"});
  EXPECT_EQ(run_again(words), (Names{"c00", "c01", "c02", "c03", "c04", "c99"}));
  words.insert(words.end(), {"-sphere", "out/{name}.off"});
  EXPECT_EQ(run_again(words), (Names{"c00", "c01", "c02", "c03", "c04", "c99"}));
  EXPECT_EQ(run_again(words), (Names{"c99"}));
}

/// So many that they are not all done before a signal arrives.
constexpr int many_clouds = 20;
constexpr int points_of_many = is_sanitized ? 700 : 3000;

TEST(BatchTool, KilledInTheMiddleItResumes) {
  const TemporaryDirectory directory;
  writeClouds(directory, many_clouds, points_of_many);
  const std::vector<std::string> arguments = {"in",      "-output", "out/{name}.ply", "-jsonl",
                                              "r.jsonl", "-resume", "-jobs",          "2"};
  std::map<int, std::string> children;
  RunOptions options;
  options.meanwhile = [&](int process) {
    while (records(directory.file("r.jsonl")).size() < 3 && !hasEnded(process)) {
      pause();
    }
    children = childrenOf(process);
    kill(process, SIGKILL);
  };
  EXPECT_EQ(runTool(directory, arguments, options).signal, SIGKILL);
  // Nothing goes on behind its back.
  for (const auto& child : children) {
    for (int i = 0; i < 5000 && !hasEnded(child.first); ++i) {
      pause();
    }
    EXPECT_TRUE(hasEnded(child.first)) << child.second;
  }
  EXPECT_TRUE(temporaryFiles(directory).empty());
  const std::size_t done = records(directory.file("r.jsonl")).size();
  EXPECT_GE(done, 3U);
  EXPECT_LT(done, std::size_t{many_clouds});
  std::map<std::string, Stamp> before;
  for (const json& record : records(directory.file("r.jsonl"))) {
    const auto output = record["output"].get<std::string>();
    before[output] = stampOf(directory.file(output));
  }
  // The kill may have cut a record off.
  std::ofstream(directory.file("r.jsonl"), std::ios::app) << R"({"input":"in/c07.xyz","out)";

  const RunResult result = runTool(directory, arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(std::to_string(done) + " up to date"), std::string::npos);
  EXPECT_EQ(records(directory.file("r.jsonl")).size(), std::size_t{many_clouds});
  const auto found = recordsByInput(directory.file("r.jsonl"));
  ASSERT_EQ(found.size(), std::size_t{many_clouds});
  for (const auto& [input, record] : found) {
    EXPECT_EQ(record["status"], "done");
    EXPECT_EQ(readFile(directory.file(record["output"].get<std::string>())),
              singleMesh(directory, input));
  }
  for (const auto& [output, stamp] : before) {
    EXPECT_EQ(stampOf(directory.file(output)), stamp) << output;
  }
}

TEST(BatchTool, ASignalEndsItInGoodOrder) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryDirectory directory;
    writeClouds(directory, many_clouds, points_of_many);
    RunOptions options;
    options.meanwhile = [&](int process) {
      while ((records(directory.file("r.jsonl")).size() < 2 || childrenOf(process).empty()) &&
             !hasEnded(process)) {
        pause();
      }
      kill(process, signal);
    };
    const RunResult result = runTool(
        directory, {"in", "-output", "out/{name}.ply", "-jsonl", "r.jsonl", "-jobs", "2"}, options);
    EXPECT_EQ(result.signal, signal);
    // The table so far.
    EXPECT_NE(result.output.find(std::to_string(many_clouds) + " inputs: "), std::string::npos)
        << result.output;
    EXPECT_NE(result.output.find("not started"), std::string::npos) << result.output;
    EXPECT_EQ(result.output.find("running\n"), std::string::npos) << result.output;
    EXPECT_TRUE(temporaryFiles(directory).empty());
    std::size_t meshes = 0;
    for (const json& record : records(directory.file("r.jsonl"))) {
      const bool is_done = record["status"] == "done";
      EXPECT_TRUE(is_done || record["status"] == "cancelled") << record;
      const auto output = record["output"].get<std::string>();
      EXPECT_EQ(fs::exists(directory.file(output)), is_done);
      meshes += is_done ? 1 : 0;
    }
    EXPECT_GE(meshes, 2U);
    EXPECT_LT(meshes, std::size_t{many_clouds});
    const RunResult resumed =
        runTool(directory, {"in", "-output", "out/{name}.ply", "-jsonl", "r.jsonl", "-resume"});
    EXPECT_EQ(resumed.exit_code, 0) << resumed.errors;
    EXPECT_NE(resumed.output.find(std::to_string(meshes) + " up to date"), std::string::npos);
  }
}

TEST(BatchTool, ACrashOfOneTakesNoOtherDown) {
  const TemporaryDirectory directory;
  writeClouds(directory, 4, 300);
  writeFile(directory.file("in/b-large.xyz"), cloud(60000, 1));
  for (const int signal : {is_sanitized ? SIGKILL : SIGSEGV, SIGKILL}) {
    bool sent = false;
    RunOptions options;
    options.meanwhile = [&](int process) {
      while (!sent && !hasEnded(process)) {
        for (const auto& [child, words] : childrenOf(process)) {
          if (words.find("b-large.xyz") != std::string::npos) {
            sent = kill(child, signal) == 0;
          }
        }
        pause();
      }
    };
    const std::string log = "r" + std::to_string(signal) + ".jsonl";
    const RunResult result = runTool(
        directory, {"in", "-output", "out/{name}.ply", "-jsonl", log, "-jobs", "2"}, options);
    EXPECT_TRUE(sent);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.output.find(signal == SIGSEGV ? "SIGSEGV" : "SIGKILL"), std::string::npos);
    for (const auto& [input, record] : recordsByInput(directory.file(log))) {
      const bool is_large = input == "in/b-large.xyz";
      EXPECT_EQ(record["status"], is_large ? "failed" : "done") << record;
      EXPECT_EQ(record["signal"], is_large ? json(signal) : json(nullptr));
      EXPECT_EQ(record["remedy"].is_string(), is_large);
    }
    EXPECT_FALSE(fs::exists(directory.file("out/b-large.ply")));
    EXPECT_TRUE(temporaryFiles(directory).empty());
  }
}

TEST(BatchTool, MemoryBudgetIsKept) {
  const TemporaryDirectory directory;
  writeClouds(directory, 4, 20000);
  writeFile(directory.file("in/huge.xyz"), cloud(60000, 1));
  std::size_t most = 0;
  RunOptions options;
  options.meanwhile = [&](int process) {
    while (!hasEnded(process)) {
      most = std::max(most, childrenOf(process).size());
      pause();
    }
  };
  // 64 MiB and 864 bytes a point: one of 20,000 points at a time, and never 60,000.
  const RunResult result = runTool(
      directory,
      {"in", "-output", "out/{name}.ply", "-jsonl", "r.jsonl", "-jobs", "3", "-memory", "110M"},
      options);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(most, 1U);
  for (const auto& [input, record] : recordsByInput(directory.file("r.jsonl"))) {
    const bool is_huge = input == "in/huge.xyz";
    EXPECT_EQ(record["status"], is_huge ? "failed" : "done") << record;
    if (is_huge) {
      EXPECT_NE(record["cause"].get<std::string>().find("-memory"), std::string::npos);
    } else {
      expectNeedIsBound(record);
    }
  }
}

TEST(BatchTool, NeedsAreBoundsWithWhatElseIsAskedFor) {
  const TemporaryDirectory directory;
  writeClouds(directory, 1, is_sanitized ? 2000 : 40000);
  std::vector<std::vector<std::string>> options = {
      {"-outliers", "4", "-outlier-method", "statistical"},
      {"-smooth", "5", "-sphere", "out/{name}_s.ply"}};
  if (runTool(directory, {"in/c00.xyz", "page.ply", "-report", "page.html"}).exit_code == 0) {
    // There is a page in this build.
    options.push_back({"-outliers", "4", "-smooth", "5", "-report", "out/{name}.html"});
  }
  for (std::vector<std::string> arguments : options) {
    arguments.insert(arguments.end(),
                     {"in", "-output", "out/{name}.ply", "-jsonl", "r.jsonl", "-quiet"});
    EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
  }
  const std::vector<json> found = records(directory.file("r.jsonl"));
  ASSERT_EQ(found.size(), options.size());
  for (const json& record : found) {
    expectNeedIsBound(record);
  }
}

// Clang's sanitizer of virtual calls opens a pipe to look at the object's memory, and calls the
// object invalid if it gets none.
#ifndef SPHERICAL_PARAM_SANITIZED
TEST(BatchTool, AStartThatFailsIsTriedAgainWhenAnotherHasEnded) {
  const TemporaryDirectory directory;
  writeClouds(directory, 12, 1500);
  RunOptions options;
  options.directory = directory.path();
  options.time_limit = 600;
  // So few files at a time that pipes to some eight programs are too many: with the last numbers
  // taken by the pipes of a program, or by half of them.
  for (const char* limit : {"16", "17", "18", "19"}) {
    const std::string name = std::string("r") + limit + ".jsonl";
    const RunResult result =
        tool_test::run("/bin/sh",
                       {"-c", "ulimit -n $0 && exec \"$@\"", limit, RECONSTRUCTION_TOOL, "in",
                        "-output", "out/{name}.ply", "-jsonl", name, "-jobs", "8"},
                       options);
    EXPECT_EQ(result.exit_code, 0) << limit << result.output << result.errors;
    EXPECT_EQ(records(directory.file(name)).size(), 12U) << limit;
  }
}
#endif

TEST(BatchTool, ItWorksWithStandardStreamsClosed) {
  const TemporaryDirectory directory;
  writeClouds(directory, 2, 200);
  RunOptions options;
  options.directory = directory.path();
  const RunResult result =
      tool_test::run("/bin/sh",
                     {"-c", "exec \"$0\" \"$@\" <&- >&-", RECONSTRUCTION_TOOL, "in", "-output",
                      "out/{name}.ply", "-jsonl", "r.jsonl", "-quiet"},
                     options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  for (const json& record : records(directory.file("r.jsonl"))) {
    EXPECT_EQ(record["status"], "done");
    EXPECT_EQ(record["points"], 200) << record;
  }
}

TEST(BatchTool, ASignalIsHeardWhileNothingCanRun) {
  const TemporaryDirectory directory;
  writeClouds(directory, 1, 100);
  const int count = 20000;
  std::string list;
  for (int i = 0; i < count; ++i) {
    list += "in/c00.xyz\n";
  }
  writeFile(directory.file("list"), list);
  RunOptions options;
  options.meanwhile = [&](int process) {
    while (readFile(directory.file("r.jsonl")).empty() && !hasEnded(process)) {
      pause();
    }
    kill(process, SIGINT);
  };
  const RunResult result = runTool(directory,
                                   {"-inputs", "list", "-output", "out/{index}.ply", "-memory",
                                    "1M", "-jsonl", "r.jsonl", "-quiet"},
                                   options);
  EXPECT_EQ(result.signal, SIGINT);
  EXPECT_LT(records(directory.file("r.jsonl")).size(), std::size_t{count});
}

TEST(BatchTool, LaterRunsRemoveWhatKilledOnesLeft) {
  const TemporaryDirectory directory;
  writeClouds(directory, 1, 100);
  std::array<char, 64> host{};
  gethostname(host.data(), host.size() - 1);
  fs::create_directory(directory.file("out"));
  const std::string prefix = "out/.spherical_param." + std::string(host.data()) + "-";
  // No program has the first number; the second is that of this one.
  const std::string ended = prefix + "999999999.abcdef";
  const std::string running = prefix + std::to_string(getpid()) + ".abcdef";
  const std::string recent = prefix + "999999999.ghijkl";
  const auto leave = [&](const std::string& file, bool is_old) {
    writeFile(directory.file(file), "half");
    if (is_old) {
      fs::last_write_time(directory.file(file),
                          fs::file_time_type::clock::now() - std::chrono::hours(1));
    }
  };
  leave(ended, true);
  leave(running, true);
  leave(recent, false);
  const std::vector<std::string> arguments = {"in", "-output", "out/{name}.ply", "-jsonl",
                                              "r.jsonl"};
  EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
  EXPECT_FALSE(fs::exists(directory.file(ended)));
  // Also if nothing is left to be made.
  leave(ended, true);
  std::vector<std::string> resumed = arguments;
  resumed.emplace_back("-resume");
  EXPECT_EQ(runTool(directory, resumed).exit_code, 0);
  EXPECT_FALSE(fs::exists(directory.file(ended)));
  EXPECT_TRUE(fs::exists(directory.file(running)));
  EXPECT_TRUE(fs::exists(directory.file(recent)));
}

TEST(SlurmArray, SharesAreThoseOfTheListOrRefused) {
  const auto run_task = [](const std::string& task, const std::string& variables) {
    const TemporaryDirectory directory;
    RunOptions options;
    options.directory = directory.path();
    return tool_test::run("/bin/sh",
                          {"-c",
                           "export SPHERICAL_PARAM_TOOL=/bin/echo SLURM_ARRAY_TASK_ID=" + task +
                               " " + variables + "; exec \"$0\" list '{name}.ply' records",
                           SLURM_ARRAY},
                          options);
  };
  const auto array = [](int least, int most, int step, int count) {
    return "SLURM_ARRAY_TASK_MIN=" + std::to_string(least) +
           " SLURM_ARRAY_TASK_MAX=" + std::to_string(most) +
           " SLURM_ARRAY_TASK_STEP=" + std::to_string(step) +
           " SLURM_ARRAY_TASK_COUNT=" + std::to_string(count);
  };
  EXPECT_NE(run_task("3", array(0, 7, 1, 8)).output.find("-shard 3/8 "), std::string::npos);
  EXPECT_NE(run_task("5", array(1, 7, 2, 4)).output.find("-shard 2/4 "), std::string::npos);
  EXPECT_NE(
      run_task("3", array(1, 7, 1, 3) + " SPHERICAL_PARAM_SHARES=8").output.find("-shard 3/8 "),
      std::string::npos);
  for (const std::string& variables :
       {array(1, 7, 1, 3), array(2, 5, 1, 2), array(1, 7, 1, 3) + " SPHERICAL_PARAM_SHARES=3"}) {
    const RunResult result = run_task("3", variables);
    EXPECT_EQ(result.exit_code, 2) << variables;
    EXPECT_EQ(result.output, "") << variables;
    EXPECT_EQ(result.errorLines().size(), 2U) << result.errors;
  }
}

TEST(BatchTool, NamesThatClashAreRefusedBeforeAnyWork) {
  const TemporaryDirectory directory;
  for (const std::string folder : {"a", "b"}) {
    fs::create_directory(directory.file(folder));
    writeFile(directory.file(folder + "/x.xyz"), cloud(100, 1));
    writeFile(directory.file(folder + "/y.obj"), "v 0 0 0\n");
  }
  const auto before = directory.listing();
  const std::vector<std::vector<std::string>> refused = {
      {"a", "b", "-output", "out/{name}.ply"},
      {"a/x.xyz", "a/y.obj", "-output", "out.ply"},
      {"a/x.xyz", "a/x.xyz", "-output", "{name}.ply"},
      {"a/x.xyz", "a/../b/../a/x.xyz", "-output", "{dir}/{name}.ply"},
      {"a", "-output", "{name}.ply", "-sphere", "{name}.ply"},
      {"a/y.obj", "-output", "{dir}/{name}.{ext}"},
      {"a/x.xyz", "-output", "{dir}/{name}.{ext}"},
      {"a", "-output", "out/{name}.ply", "-jsonl", "a/x.xyz"},
      {"a", "-output", "out/{name}.ply", "-jsonl", "out/x.ply"},
      {"a", "-output", "out/{nmae}.ply"},
      {"a", "-output", "out/{name}.pcd"},
      {"a", "-output", "out/{name}.ply", "-json", "-"},
      {"a", "-output", "out/{name}.ply", "-resume"},
      {"a", "-output", "out/{name}.ply", "-memory", "much"},
      {"a", "-output", "out/{name}.ply", "-jobs", "-1"},
      {"a", "-output", "out/{name}.ply", "-shard", "2/2"},
      {"a", "-output", "out/{name}.ply", "-k", "1"},
      {"-output", "out/{name}.ply"},
      {"a/x.xyz", "out.ply", "-jobs", "2"},
      {"a/x.xyz", "b/x.xyz", "out.ply"},
      {"a", "-output", "out/{name}.ply", "-report", "out/{name}.pdf"},
      {"a", "-output", "out/{name}.ply", "-report", ""},
  };
  for (const std::vector<std::string>& arguments : refused) {
    const RunResult result = runTool(directory, arguments);
    const std::string line = testing::PrintToString(arguments);
    EXPECT_EQ(result.exit_code, 2) << line << result.errors;
    EXPECT_EQ(result.errorLines().size(), 2U) << line << result.errors;
    EXPECT_EQ(result.output, "") << line;
    EXPECT_EQ(directory.listing(), before) << line;
  }
}

TEST(BatchTool, AnOutputThatCannotBeWrittenIsAFailureOfItsInput) {
  const TemporaryDirectory directory;
  writeClouds(directory, 3, 100);
  fs::create_directories(directory.file("out/c01.ply"));
  const RunResult result = runTool(directory, {"in", "-output", "out/{name}.ply"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("2 done, 1 failed"), std::string::npos) << result.output;
  EXPECT_TRUE(fs::exists(directory.file("out/c02.ply")));

  writeFile(directory.file("file"), "");
  const RunResult none = runTool(directory, {"in", "-output", "file/{name}.ply", "-quiet"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_EQ(none.output, "");
  EXPECT_EQ(none.errorLines().size(), 8U) << none.errors;  // two of each, two of all

  const RunResult log =
      runTool(directory, {"in", "-output", "new/{name}.ply", "-jsonl", "missing/r.jsonl"});
  EXPECT_EQ(log.exit_code, 1);
  EXPECT_EQ(log.errorLines().size(), 2U);
  EXPECT_FALSE(fs::exists(directory.file("new")));

  RunOptions full;
  full.file_size_limit = 2000;
  const RunResult small = runTool(directory, {"in", "-output", "small/{name}.ply"}, full);
  EXPECT_EQ(small.exit_code, 1);
  EXPECT_NE(small.output.find("3 failed"), std::string::npos) << small.output;
  EXPECT_TRUE(temporaryFiles(directory).empty());
}

TEST(BatchTool, TwoHundredTinyFiles) {
  const TemporaryDirectory directory;
  const int count = is_sanitized ? 40 : 200;
  std::string list;
  fs::create_directory(directory.file("in"));
  for (int i = 0; i < count; ++i) {
    const std::string name = "in/tiny" + std::to_string(i) + ".xyz";
    writeFile(directory.file(name), i % 20 == 7 ? "0 0 0\n" : cloud(4 + i % 9, i));
    list += name + "\n";
  }
  writeFile(directory.file("list"), list);
  RunOptions options;
  options.standard_input = directory.file("list");
  const RunResult result = runTool(
      directory, {"-inputs", "-", "-output", "out/{index:3}_{name}.off", "-jsonl", "-"}, options);
  EXPECT_EQ(result.exit_code, 1);
  std::size_t lines = 0;
  std::set<int> places;
  std::istringstream output(result.output);
  for (std::string line; std::getline(output, line); ++lines) {
    const json record = json::parse(line);
    places.insert(record["index"].get<int>());
    EXPECT_EQ(record["status"] == "done", record["index"].get<int>() % 20 != 8) << line;
  }
  EXPECT_EQ(lines, static_cast<std::size_t>(count));
  EXPECT_EQ(places.size(), static_cast<std::size_t>(count));
  std::size_t meshes = 0;
  for (const auto& file : directory.listing()) {
    meshes += file.first.rfind("out/", 0) == 0 ? 1 : 0;
  }
  EXPECT_EQ(meshes, static_cast<std::size_t>(count - count / 20));
  EXPECT_TRUE(fs::exists(directory.file("out/040_tiny39.off")));
}

TEST(BatchTool, SharesTogetherAreTheWhole) {
  const TemporaryDirectory directory;
  writeClouds(directory, 5, 100);
  for (const std::string share : {"0/3", "1/3", "2/3"}) {
    EXPECT_EQ(runTool(directory, {"in", "-output", "out/{index}_{name}.ply", "-jsonl", "r.jsonl",
                                  "-shard", share})
                  .exit_code,
              0);
  }
  const auto found = recordsByInput(directory.file("r.jsonl"));
  EXPECT_EQ(found.size(), 5U);
  EXPECT_EQ(records(directory.file("r.jsonl")).size(), 5U);
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(fs::exists(
        directory.file("out/" + std::to_string(i + 1) + "_c0" + std::to_string(i) + ".ply")));
  }
  // A share may be empty.
  EXPECT_EQ(
      runTool(directory, {"in/c00.xyz", "-output", "out/{name}.ply", "-shard", "1/2"}).exit_code,
      0);
}

TEST(BatchTool, OutputsBesideTheirInputsAreNoInputsOfTheNextRun) {
  const TemporaryDirectory directory;
  writeClouds(directory, 2, 100);
  const std::vector<std::string> arguments = {"in",     "-output", "{dir}/{name}_mesh.ply",
                                              "-jsonl", "r.jsonl", "-resume"};
  EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
  const auto first = directory.listing();
  EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
  EXPECT_EQ(directory.listing(), first);
}

TEST(BatchTool, AScanThatIsNamedLikeAnOutputIsNotOverwritten) {
  const TemporaryDirectory directory;
  writeClouds(directory, 2, 100);
  writeFile(directory.file("in/c00_mesh.ply"), singleMesh(directory, "in/c00.xyz"));
  const auto before = directory.listing();
  std::vector<std::string> arguments = {"in", "-output", "in/{name}_mesh.ply"};
  EXPECT_EQ(runTool(directory, arguments).exit_code, 2);
  arguments.insert(arguments.end(), {"-jsonl", "r.jsonl"});
  EXPECT_EQ(runTool(directory, arguments).exit_code, 2);
  EXPECT_EQ(directory.listing(), before);

  // Nor is an output that was changed since.
  fs::remove(directory.file("in/c00_mesh.ply"));
  EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
  const RunResult again = runTool(directory, arguments);
  EXPECT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_NE(again.output.find("2 files that runs before made"), std::string::npos) << again.output;
  writeFile(directory.file("in/c00_mesh.ply"), singleMesh(directory, "in/c01.xyz"));
  EXPECT_EQ(runTool(directory, arguments).exit_code, 2);
}

TEST(BatchTool, StrictInputsWithWarningsFailAndTheirMeshesAreThere) {
  const TemporaryDirectory directory;
  writeClouds(directory, 2, 120);
  // A point twice is a warning.
  writeFile(directory.file("in/c01.xyz"),
            readFile(directory.file("in/c01.xyz")) + readFile(directory.file("in/c01.xyz")));
  const std::vector<std::string> words = {
      "in", "-output", "in/{name}_mesh.ply", "-strict", "-jsonl", "r.jsonl", "-resume"};
  const RunResult result = runTool(directory, words);
  EXPECT_EQ(result.exit_code, 1);
  auto found = recordsByInput(directory.file("r.jsonl"));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found["in/c00.xyz"]["status"], "done");
  const json& failed = found["in/c01.xyz"];
  EXPECT_EQ(failed["status"], "failed");
  EXPECT_EQ(failed["exit_code"], 1);
  EXPECT_EQ(failed["vertices"], 120);
  EXPECT_EQ(failed["warnings"].size(), 1U);
  EXPECT_NE(failed["cause"].get<std::string>().find("120 points repeat"), std::string::npos);
  EXPECT_EQ(failed["files"][0]["bytes"], fs::file_size(directory.file("in/c01_mesh.ply")));
  // The next run takes neither mesh for a scan, and tries again what failed.
  EXPECT_EQ(runTool(directory, words).exit_code, 1);
  std::vector<std::string> again;
  for (const json& record : records(directory.file("r.jsonl"))) {
    again.push_back(record["input"].get<std::string>());
  }
  EXPECT_EQ(std::count(again.begin(), again.end(), "in/c00.xyz"), 1);
  EXPECT_EQ(std::count(again.begin(), again.end(), "in/c01.xyz"), 2);
  EXPECT_EQ(again.size(), 3U);
}

TEST(BatchTool, NumberedOutputsBesideTheirInputsAreNoInputsOfTheNextRun) {
  const TemporaryDirectory directory;
  writeClouds(directory, 2, 100);
  const auto before = directory.listing();
  std::vector<std::string> arguments = {"in", "-output", "in/{index}_{name}.ply"};
  const RunResult refused = runTool(directory, arguments);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.errorLines().size(), 2U) << refused.errors;
  EXPECT_EQ(directory.listing(), before);

  arguments.insert(arguments.end(), {"-jsonl", "r.jsonl", "-resume"});
  EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
  const auto first = directory.listing();
  EXPECT_EQ(first.size(), before.size() + 3);
  EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
  EXPECT_EQ(directory.listing(), first);
  // By themselves there is nothing to be done.
  fs::remove(directory.file("in/c00.xyz"));
  fs::remove(directory.file("in/c01.xyz"));
  EXPECT_EQ(runTool(directory, arguments).exit_code, 2);
}

TEST(BatchTool, ResumeKnowsNamesThatAreNotUtf8) {
  const TemporaryDirectory directory;
  fs::create_directory(directory.file("in"));
  writeFile(directory.file("in/caf\xe9.xyz"), cloud(100, 1));
  for (const std::string output : {"out/{name}.ply", "in/{name}_mesh.ply"}) {
    const std::vector<std::string> arguments = {"in",     "-output", output,
                                                "-jsonl", "r.jsonl", "-resume"};
    EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
    const RunResult again = runTool(directory, arguments);
    EXPECT_EQ(again.exit_code, 0) << again.errors;
    EXPECT_NE(again.output.find("1 up to date"), std::string::npos) << again.output;
  }
  EXPECT_EQ(records(directory.file("r.jsonl")).size(), 2U);
}

}  // namespace
