// The parts of a batch, by themselves: names, order of jobs, records, sizes.

#include "common/batch_inputs.h"
#include "common/child_process.h"
#include "common/errors.h"
#include "common/job_scheduler.h"
#include "common/memory_need.h"
#include "common/name_pattern.h"
#include "common/output_file.h"
#include "common/record_log.h"
#include "tool_runner.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace {

using namespace spherical_param::tools;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;

std::string expand(const std::string& pattern, const std::string& input, std::size_t place = 1) {
  return NamePattern("output", pattern).expand(input, place);
}

TEST(NamePattern, PlaceholdersStandForPartsOfTheInput) {
  EXPECT_EQ(expand("out/{name}.ply", "scans/day 1/a.b.pcd"), "out/a.b.ply");
  EXPECT_EQ(expand("{dir}/{name}_mesh.{ext}", "scans/a.obj"), "scans/a_mesh.obj");
  EXPECT_EQ(expand("{dir}/{name}.stl", "a.obj"), "./a.stl");
  EXPECT_EQ(expand("{dir}/{name}.stl", "/a.obj"), "//a.stl");
  EXPECT_EQ(expand("m{index}.ply", "a.obj", 12), "m12.ply");
  EXPECT_EQ(expand("m{index:4}.ply", "a.obj", 12), "m0012.ply");
  EXPECT_EQ(expand("m{index:1}.ply", "a.obj", 12), "m12.ply");
  EXPECT_EQ(expand("{name}{ext}|", "noextension"), "noextension|");
  EXPECT_EQ(expand("plain.ply", "a.obj"), "plain.ply");
}

TEST(NamePattern, WhatIsPutInIsNotExpandedAgain) {
  EXPECT_EQ(expand("{name}.ply", "{index}.pcd"), "{index}.ply");
  EXPECT_EQ(expand("{{name}.ply", "a.pcd"), "{name}.ply");
}

TEST(NamePattern, UnknownPlaceholdersAreRefused) {
  for (const std::string pattern : {"", "{nam}.ply", "{}.ply", "{name", "a{", "{index:0}.ply",
                                    "{index:10}.ply", "{index:x}.ply", "{NAME}.ply"}) {
    EXPECT_THROW(NamePattern("output", pattern), UsageError) << pattern;
  }
}

JobScheduler makeScheduler(const JobLimits& limits, const std::vector<std::uint64_t>& needs) {
  return {limits, needs.size(), [needs](std::size_t job) { return needs.at(job); }};
}

/// Runs all jobs, ending in a random order; what runs at a time is checked all along.
std::vector<std::size_t> runAll(const JobLimits& limits, const std::vector<std::uint64_t>& needs,
                                unsigned seed) {
  JobScheduler scheduler = makeScheduler(limits, needs);
  std::mt19937 random(seed);
  std::vector<std::size_t> order;
  std::vector<std::size_t> running;
  for (;;) {
    while (const auto start = scheduler.next()) {
      order.push_back(start->job);
      running.push_back(start->job);
      EXPECT_GE(start->threads, 1U);
      EXPECT_LE(start->threads, limits.processors);
      const std::uint64_t together = std::accumulate(
          running.begin(), running.end(), std::uint64_t{0},
          [&needs](std::uint64_t sum, std::size_t job) { return sum + needs[job]; });
      EXPECT_EQ(together, scheduler.memoryInUse());
      EXPECT_TRUE(together <= limits.memory || running.size() == 1) << together;
      EXPECT_LE(running.size(), limits.jobs);
      EXPECT_EQ(running.size(), scheduler.running());
    }
    if (running.empty()) {
      break;
    }
    const std::size_t which = random() % running.size();
    scheduler.finished(running[which]);
    running.erase(running.begin() + static_cast<std::ptrdiff_t>(which));
  }
  EXPECT_EQ(scheduler.waiting(), 0U);
  EXPECT_EQ(std::set<std::size_t>(order.begin(), order.end()).size(), needs.size());
  EXPECT_EQ(order.size(), needs.size());
  return order;
}

TEST(JobScheduler, MemoryOfRunningJobsIsNeverAboveTheBudget) {
  std::mt19937 random(1);
  for (unsigned seed = 0; seed < 200; ++seed) {
    const JobLimits limits = {1 + random() % 8, 1 + random() % 16, 1000};
    std::vector<std::uint64_t> needs;
    for (int i = 0; i < 60; ++i) {
      needs.push_back(random() % 10 == 0 ? random() % 1500 : random() % 300);
    }
    runAll(limits, needs, seed);
  }
}

TEST(JobScheduler, JobsThatFitStartInTheirOrder) {
  const std::vector<std::size_t> order = runAll({3, 3, 1000}, {10, 20, 30, 40, 50, 60}, 5);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(JobScheduler, SmallJobsDoNotKeepALargeOneWaitingForLong) {
  // 0 runs; 1 does not fit beside it, so others pass: as many as run at a time, no more.
  std::vector<std::uint64_t> needs(40, 10);
  needs[1] = 995;
  const std::vector<std::size_t> order = runAll({4, 4, 1000}, needs, 3);
  const auto place = std::find(order.begin(), order.end(), std::size_t{1}) - order.begin();
  EXPECT_GT(place, 1);
  EXPECT_LE(place, 5);
}

TEST(JobScheduler, AJobThatIsPutBackIsTheNextAgain) {
  JobScheduler scheduler = makeScheduler({4, 4, 1000}, {10, 20, 30});
  EXPECT_EQ(scheduler.next()->job, 0U);
  EXPECT_EQ(scheduler.next()->job, 1U);
  scheduler.putBack(1);
  EXPECT_EQ(scheduler.running(), 1U);
  EXPECT_EQ(scheduler.memoryInUse(), 10U);
  EXPECT_EQ(scheduler.waiting(), 2U);
  EXPECT_EQ(scheduler.next()->job, 1U);
  EXPECT_EQ(scheduler.next()->job, 2U);
}

TEST(JobScheduler, AJobAboveTheBudgetRunsAlone) {
  JobScheduler scheduler = makeScheduler({4, 8, 100}, {10, 500, 10});
  EXPECT_EQ(scheduler.next()->job, 0U);
  EXPECT_EQ(scheduler.next()->job, 2U);
  EXPECT_FALSE(scheduler.next());
  scheduler.finished(0);
  EXPECT_FALSE(scheduler.next());
  scheduler.finished(2);
  const auto large = scheduler.next();
  ASSERT_TRUE(large);
  EXPECT_EQ(large->job, 1U);
  EXPECT_EQ(large->threads, 8U);
  EXPECT_FALSE(scheduler.next());
}

TEST(JobScheduler, NeedsAreAskedOnceAndNotLongBeforeAJobMayStart) {
  std::vector<int> asked(1000, 0);
  JobScheduler scheduler({2, 2, 1000}, asked.size(), [&asked](std::size_t job) {
    ++asked[job];
    return std::uint64_t{600};
  });
  for (std::size_t job = 0; job < asked.size(); ++job) {
    ASSERT_EQ(scheduler.next()->job, job);
    ASSERT_FALSE(scheduler.next());
    ASSERT_LE(std::accumulate(asked.begin(), asked.end(), std::size_t{0}), job + 4);
    scheduler.finished(job);
  }
  EXPECT_EQ(asked, std::vector<int>(1000, 1));
}

TEST(JobScheduler, ProcessorsAreSharedOut) {
  // Two jobs for four processors; one that takes three quarters of the memory has three of them.
  JobScheduler even = makeScheduler({4, 4, 1000}, {10, 10});
  EXPECT_EQ(even.next()->threads, 2U);
  EXPECT_EQ(even.next()->threads, 2U);
  JobScheduler large = makeScheduler({4, 4, 1000}, {750, 10, 10, 10, 10, 10, 10, 10});
  EXPECT_EQ(large.next()->threads, 3U);
  EXPECT_EQ(large.next()->threads, 1U);
}

TEST(RecordLog, ALineThatWasCutOffHarmsNoOther) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("r.jsonl");
  writeFile(path, "{\"a\":1}\n\n[1]\n{\"a\":2}\n{\"a\":3,\"b\":\"cut");
  RecordLog(path).append({{"a", 4}});
  RecordLog(path).append({{"a", 5}});
  std::vector<int> found;
  for (const Json& record : readRecords(path)) {
    found.push_back(record["a"].get<int>());
  }
  EXPECT_EQ(found, (std::vector<int>{1, 2, 4, 5}));
}

TEST(RecordLog, ProgramsThatAreStartedDoNotHoldIt) {
  const auto open_files = [] {
    ChildProcesses children;
    children.start({"/bin/sh", "-c", "ls /proc/self/fd | wc -l"});
    return children.wait(-1, 30.0).value_or(ChildResult()).output;
  };
  const std::string before = open_files();
  const RecordLog log("-");
  EXPECT_EQ(open_files(), before);
}

TEST(RecordLog, AFileThatIsNotThereHasNoRecords) {
  EXPECT_TRUE(readRecords("/nonexistent/r.jsonl").empty());
  EXPECT_THROW(RecordLog("/nonexistent/r.jsonl"), Failure);
}

TEST(MemoryNeed, SizesAreReadAsPeopleWriteThem) {
  EXPECT_EQ(parseBytes("memory", "2000000"), 2000000U);
  EXPECT_EQ(parseBytes("memory", "800M"), 800U << 20);
  EXPECT_EQ(parseBytes("memory", "4g"), std::uint64_t{4} << 30);
  EXPECT_EQ(parseBytes("memory", "1.5GiB"), std::uint64_t{3} << 29);
  EXPECT_EQ(parseBytes("memory", "2GB"), std::uint64_t{2} << 30);
  for (const std::string text : {"", "G", "0", "-1G", "4X", "nan", "1e30", "4 GG"}) {
    EXPECT_THROW(parseBytes("memory", text), UsageError) << text;
  }
}

TEST(MemoryNeed, PointsAreCountedWithoutReadingThem) {
  const TemporaryDirectory directory;
  writeFile(directory.file("a.xyz"), "0 0 0\n1 0 0\n0 1 0\n");
  writeFile(directory.file("a.obj"), "# v\nv 0 0 0\nvn 0 0 1\nv 1 0 0\n");
  writeFile(directory.file("a.pcd"), "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
                                     "COUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n"
                                     "0 0 0\n1 1 1\n");
  writeFile(directory.file("bad.ply"), "nothing");
  EXPECT_EQ(pointCountOf(directory.file("a.xyz")), std::optional<std::uint64_t>(3));
  EXPECT_EQ(pointCountOf(directory.file("a.obj")), std::optional<std::uint64_t>(2));
  EXPECT_EQ(pointCountOf(directory.file("a.pcd")), std::optional<std::uint64_t>(2));
  EXPECT_FALSE(pointCountOf(directory.file("bad.ply")));
  EXPECT_FALSE(pointCountOf(directory.file("missing.pcd")));
}

TEST(MemoryNeed, CountingKeepsNoLines) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("zeros.xyz");
  writeFile(path, "");
  std::filesystem::resize_file(path, std::uintmax_t{300} << 20);
  const auto peak = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const long before = peak();
  EXPECT_EQ(pointCountOf(path), std::optional<std::uint64_t>(1));
  EXPECT_LT(peak() - before, 100L << 10);  // [KiB]
  // Blocks end anywhere in a line.
  std::string lines;
  for (int i = 0; i < 400000; ++i) {
    lines += i % 3 == 0 ? "vn 0 0 1\n" : "v 0 0 0\n";
  }
  writeFile(directory.file("a.obj"), lines + "v ");
  EXPECT_EQ(pointCountOf(directory.file("a.obj")), std::optional<std::uint64_t>(266667));
  writeFile(directory.file("a.xyz"), lines + "\n\nv");
  EXPECT_EQ(pointCountOf(directory.file("a.xyz")), std::optional<std::uint64_t>(400003));
}

TEST(BatchInputs, FilesDirectoriesAndListsAreTaken) {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory.file("d"));
  for (const std::string name : {"d/b.ply", "d/a.PCD", "d/.hidden.ply", "d/notes.md", "d/m.stl"}) {
    writeFile(directory.file(name), "x");
  }
  writeFile(directory.file("list"), "# scans\n\none.ply\r\n" + directory.file("d") + "\n  two.ply");
  std::vector<std::string> found;
  for (const BatchInput& input : collectInputs({"zero.ply"}, directory.file("list"))) {
    found.push_back(input.path);
    EXPECT_EQ(input.from_directory, input.path.rfind(directory.file("d"), 0) == 0);
  }
  EXPECT_EQ(found, (std::vector<std::string>{"zero.ply", "one.ply", directory.file("d/a.PCD"),
                                             directory.file("d/b.ply"), "  two.ply"}));
  EXPECT_THROW(collectInputs({}, directory.file("missing")), Failure);
  EXPECT_THROW(collectInputs({}, directory.path()), Failure);
  EXPECT_THROW(collectInputs({}, ""), UsageError);
}

TEST(ChildProcesses, EndsSignalsAndOutputsAreTold) {
  ChildProcesses children;
  const pid_t good = children.start({"/bin/sh", "-c", "echo out; echo err >&2; exit 3"});
  const pid_t killed = children.start({"/bin/sh", "-c", "kill -SEGV $$"});
  const pid_t missing = children.start({"/nonexistent/program"});
  for (int i = 0; i < 3; ++i) {
    const std::optional<ChildResult> result = children.wait(-1, 30.0);
    ASSERT_TRUE(result);
    if (result->process == good) {
      EXPECT_EQ(result->exit_code, 3);
      EXPECT_EQ(result->output, "out\n");
      EXPECT_EQ(result->errors, "err\n");
      EXPECT_GT(result->peak_memory, 0U);
    } else if (result->process == killed) {
      EXPECT_EQ(result->signal, SIGSEGV);
    } else {
      EXPECT_EQ(result->process, missing);
      EXPECT_EQ(result->exit_code, 127);
    }
  }
  EXPECT_EQ(children.count(), 0U);
  EXPECT_NE(signalName(SIGSEGV).find("SIGSEGV"), std::string::npos);
}

TEST(ChildProcesses, OutputsAreReadWhereTheStandardStreamsAreClosed) {
  const auto run_without_streams = [](std::vector<int> closed) {
    const pid_t process = fork();
    if (process == 0) {
      for (const int stream : closed) {
        close(stream);
      }
      ChildProcesses children;
      children.start({"/bin/sh", "-c", "echo out; echo err >&2"});
      const ChildResult result = children.wait(-1, 30.0).value_or(ChildResult());
      _exit(result.exit_code == 0 && result.output == "out\n" && result.errors == "err\n" ? 0 : 1);
    }
    int status = -1;
    waitpid(process, &status, 0);
    return status;
  };
  EXPECT_EQ(run_without_streams({STDIN_FILENO, STDOUT_FILENO}), 0);
  EXPECT_EQ(run_without_streams({STDOUT_FILENO, STDERR_FILENO}), 0);
  EXPECT_EQ(run_without_streams({STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}), 0);
}

TEST(ChildProcesses, LongOutputsDoNotBlock) {
  ChildProcesses children;
  children.start({"/bin/sh", "-c", "head -c 3000000 /dev/zero; head -c 3000000 /dev/zero >&2"});
  const std::optional<ChildResult> result = children.wait(-1, 30.0);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->output.size(), 3000000U);
  EXPECT_EQ(result->errors.size(), 65536U);  // the end
}

TEST(OutputFile, WhatAKilledProgramLeftIsRemovedAndNothingElse) {
  const TemporaryDirectory directory;
  writeFile(directory.file(temporaryPrefix(4242) + "abcdef"), "half");
  writeFile(directory.file(temporaryPrefix(424) + "abcdef"), "of another");
  writeFile(directory.file("mesh.ply"), "whole");
  removeTemporaryFilesOf(4242, directory.file("mesh.ply"));
  const auto listing = directory.listing();
  EXPECT_EQ(listing.size(), 2U);
  EXPECT_EQ(listing.count("mesh.ply"), 1U);
}

}  // namespace
