// A long run of reconstructions with mixed sizes and options: the memory must be flat. A round of
// jobs is made again and again, through the core and the PCL class by turns. Between jobs nothing
// of theirs is alive; what malloc has in use is counted then, and must not grow from round to round
// after the first ones. The resident memory may grow a little by fragmentation.
//
//   torture_soak [--quick] [--seed N]

#include "arguments.h"
#include "mixed_jobs.h"
#include "pcl_calls.h"
#include "torture_row.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <malloc.h>
#include <unistd.h>

namespace {

/// Memory of this process [byte].
struct Memory {
  double in_use = 0.0;    ///< that malloc gave and was not given back
  double resident = 0.0;  ///< that the system keeps for it
};

Memory memory() {
  const struct mallinfo2 info = mallinfo2();
  std::ifstream file("/proc/self/statm");
  double total = 0.0;
  double resident = 0.0;
  file >> total >> resident;
  return {static_cast<double>(info.uordblks + info.hblkhd),
          resident * static_cast<double>(sysconf(_SC_PAGESIZE))};
}

/// Slope of the line of least squares through values at 0, 1, 2, ...
double slope(const std::vector<double>& values) {
  const double count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values)
    mean += value / count;
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - 0.5 * (count - 1.0);
    products += x * (values[i] - mean);
    squares += x * x;
  }
  return products / squares;
}

// Bounds of the slope after the warm-up [byte per reconstruction]. One leaked allocation of any
// kind is 24 bytes or more.
constexpr double kMostInUse = 16.0;
constexpr double kMostResident = 2048.0;

}  // namespace

int main(int argc, char** argv) {
  // What a thread keeps of small blocks that were given back counts as in use, and fills up slowly.
  if (std::getenv("GLIBC_TUNABLES") == nullptr) {
    setenv("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0", 1);
    execv("/proc/self/exe", argv);
  }
  const auto arguments = torture::parse(argc, argv);
  if (!arguments)
    return 2;
  const std::size_t jobs_of_round = arguments->quick ? 16 : 40;
  const std::size_t rounds = arguments->quick ? 6 : 50;
  const std::size_t warm_up = arguments->quick ? 2 : 10;
  torture::JobLimits limits;
  limits.least = 100;
  limits.most = arguments->quick ? 400 : 5000;
  limits.with_invalid = false;

  std::vector<torture::Job> jobs;
  for (std::size_t i = 0; i < jobs_of_round; ++i) {
    jobs.push_back(torture::makeJob(arguments->seed, i, limits));
    jobs.back().options.threads = 2;
  }
  std::vector<std::size_t> hashes(jobs_of_round);
  std::size_t wrong = 0;
  torture::PclObject kept;  // one object for many clouds
  std::vector<double> in_use;
  std::vector<double> resident;
  in_use.reserve(rounds);
  resident.reserve(rounds);
  Memory greatest;
  const Memory start = memory();
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < jobs_of_round; ++i) {
      const torture::Job& job = jobs[i];
      {
        // Brute force is no search for many points.
        const bool through_core = job.points.cols() <= 600 || job.is_spiral;
        const torture::Answer answer = through_core ? torture::answer(job)
                                       : i % 2 == 0 ? kept(job)
                                                    : torture::PclObject()(job);
        const std::size_t hash = std::hash<std::string>()(answer.bytes);
        if (round == 0)
          hashes[i] = hash;
        if (!answer.is_right || hash != hashes[i]) {
          ++wrong;
          std::printf("round %zu, job %zu: %s\n", round, i,
                      answer.is_right ? "other bytes than in the first round"
                                      : "not the right kind of answer");
        }
      }
      const Memory now = memory();
      greatest.in_use = std::max(greatest.in_use, now.in_use);
      greatest.resident = std::max(greatest.resident, now.resident);
    }
    const Memory now = memory();
    std::printf("round %2zu: %.0f bytes in use, %.1f MiB resident\n", round, now.in_use,
                now.resident / 1048576.0);
    if (round >= warm_up) {
      in_use.push_back(now.in_use);
      resident.push_back(now.resident);
    }
  }

  const double per_job = static_cast<double>(jobs_of_round);
  const double in_use_slope = slope(in_use) / per_job;
  const double resident_slope = slope(resident) / per_job;
  std::printf(
      "in use:   start %.0f, after warm-up %.0f, end %.0f, greatest between jobs %.0f bytes; "
      "%.2f bytes a reconstruction (at most %.0f)\n",
      start.in_use, in_use.front(), in_use.back(), greatest.in_use, in_use_slope, kMostInUse);
  std::printf("resident: start %.1f, after warm-up %.1f, end %.1f, greatest between jobs %.1f MiB; "
              "%.0f bytes a reconstruction (at most %.0f)\n",
              start.resident / 1048576.0, resident.front() / 1048576.0, resident.back() / 1048576.0,
              greatest.resident / 1048576.0, resident_slope, kMostResident);
  const bool is_flat = in_use_slope <= kMostInUse && resident_slope <= kMostResident;
  if (!is_flat)
    std::printf("the memory grows\n");

  char load[200];
  std::snprintf(load, sizeof(load),
                "%zu reconstructions of %d to %d points in one process, 2 threads: memory in use "
                "%+.1f bytes each, resident %.1f to %.1f MiB",
                jobs_of_round * rounds, limits.least, limits.most, in_use_slope,
                resident.front() / 1048576.0, resident.back() / 1048576.0);
  torture::Row row;
  row.part = "soak";
  row.load = load;
  row.tried = jobs_of_round * rounds;
  row.found = wrong + (is_flat ? 0 : 1);
  return torture::print(row);
}
