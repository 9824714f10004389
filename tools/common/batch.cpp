#include "common/batch.h"

#include "common/batch_inputs.h"
#include "common/child_process.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/foreign_options.h"
#include "common/job_scheduler.h"
#include "common/json_report.h"
#include "common/memory_need.h"
#include "common/name_pattern.h"
#include "common/numbers.h"
#include "common/output_file.h"
#include "common/reconstruction_options.h"
#include "common/record_log.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <tuple>
#include <utility>

namespace spherical_param::tools {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Options whose value is the name of a file: in a batch, a pattern.
constexpr std::array<const char*, 3> file_options = {"sphere", "json", "report"};

/// Options that say how the work is done, not what comes of it.
constexpr std::array<const char*, 8> batch_options = {"output", "inputs", "jobs",  "memory",
                                                      "resume", "jsonl",  "shard", "threads"};

/// What the user asked for.
struct Settings {
  std::string output;
  std::string list;
  std::size_t processors = 1;
  std::size_t threads = 0;  ///< of each job, 0: shared out
  std::size_t jobs = 1;
  std::uint64_t memory = 0;
  bool memory_given = false;
  bool resume = false;
  std::string jsonl;
  std::size_t shard = 0;
  std::size_t shards = 1;
  bool quiet = false;
};

/// A file at a moment.
struct FileState {
  std::uint64_t bytes = 0;
  std::int64_t time = 0;  ///< of its last change [ns]
};

enum class JobState { Waiting, UpToDate, Running, Done, Failed, Cancelled };

/// A file to be made.
struct OutputName {
  std::string option;
  std::string path;
};

/// An input and what came of it.
struct Job {
  std::string input;
  std::size_t place = 0;            ///< in the list of all inputs, from 1
  std::vector<OutputName> outputs;  ///< that of -output first
  std::uint64_t memory_need = 0;
  std::optional<FileState> input_state;
  JobState state = JobState::Waiting;
  std::size_t threads = 0;
  Clock::time_point begin;
  double seconds = 0.0;
  std::uint64_t peak_memory = 0;  ///< 0: unknown
  int exit_code = 0;
  int signal = 0;
  std::string cause;
  std::string remedy;
  bool made = false;  ///< its files are there: it is done, or failed by -strict alone
  Json result;        ///< the members of its report that are kept; null: there is none
};

bool isOneOf(const std::string& option, const char* const* begin, const char* const* end) {
  return std::find(begin, end, option) != end;
}

bool isFileOption(const std::string& option) {
  return isOneOf(option, file_options.data(), file_options.data() + file_options.size());
}

bool isBatchOption(const std::string& option) {
  return isOneOf(option, batch_options.data(), batch_options.data() + batch_options.size());
}

std::optional<FileState> stateOf(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    return std::nullopt;
  }
  return FileState{static_cast<std::uint64_t>(status.st_size),
                   std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec};
}

void parseShard(const std::string& text, Settings& settings) {
  const std::size_t slash = text.find('/');
  const auto number = [&text, slash](bool first) {
    const std::string part = first ? text.substr(0, slash) : text.substr(slash + 1);
    return slash == std::string::npos ? std::nullopt : toInteger(part);
  };
  const std::optional<std::int64_t> share = number(true);
  const std::optional<std::int64_t> shares = number(false);
  if (!share || !shares || *share < 0 || *share >= *shares) {
    throw UsageError("option -shard: " + inQuotes(text) + " is no share",
                     "give -shard I/N, with I from 0 to N - 1, as in -shard 0/4");
  }
  settings.shard = static_cast<std::size_t>(*share);
  settings.shards = static_cast<std::size_t>(*shares);
}

Settings parseSettings(const CommandLine& command_line) {
  Settings settings;
  settings.output = command_line.value("output", "");
  settings.list = command_line.value("inputs", "");
  if (command_line.has("inputs") && settings.list.empty()) {
    throw UsageError("option -inputs: the name of the file is empty",
                     "give a file with a path on each line, or -");
  }
  settings.processors = std::max(1U, std::thread::hardware_concurrency());
  const auto count = [&command_line](const std::string& option, std::size_t fallback) {
    return command_line.has(option) ? static_cast<std::size_t>(parseInteger(
                                          option, command_line.value(option, ""), {0, 4096}))
                                    : fallback;
  };
  settings.threads = count("threads", 0);
  settings.jobs = count("jobs", 0);
  if (settings.jobs == 0) {
    settings.jobs =
        std::max<std::size_t>(1, settings.processors / std::max<std::size_t>(1, settings.threads));
  }
  settings.memory_given = command_line.has("memory");
  settings.memory = settings.memory_given ? parseBytes("memory", command_line.value("memory", ""))
                                          : memoryToSpare().value_or(std::uint64_t{1} << 60);
  settings.resume = command_line.has("resume");
  settings.jsonl = command_line.value("jsonl", "");
  if (command_line.has("jsonl") && settings.jsonl.empty()) {
    throw UsageError("option -jsonl: the name of the file is empty", "give a file, or -");
  }
  if (settings.resume && (settings.jsonl.empty() || settings.jsonl == "-")) {
    throw UsageError("option -resume needs the records of the run before",
                     "give -jsonl FILE, in that run and in this one");
  }
  if (command_line.has("shard")) {
    parseShard(command_line.value("shard", ""), settings);
  }
  if (command_line.value("json", "") == "-") {
    throw UsageError("option -json: the reports of many inputs cannot share the standard output",
                     "give a pattern such as reports/{name}.json, or -jsonl - for a line of each");
  }
  settings.quiet = command_line.has("quiet") || settings.jsonl == "-";
  return settings;
}

/// A name that all paths of one file share, existing or not.
std::string canonicalName(const std::string& path) {
  std::error_code error;
  const fs::path name = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : name.string();
}

using Patterns = std::vector<std::pair<std::string, NamePattern>>;

Patterns patternsOf(const Settings& settings, const CommandLine& command_line) {
  Patterns patterns;
  patterns.emplace_back("output", NamePattern("output", settings.output));
  for (const char* option : file_options) {
    if (command_line.has(option)) {
      patterns.emplace_back(option, NamePattern(option, command_line.value(option, "")));
    }
  }
  return patterns;
}

/// All inputs with the names of their files.
std::vector<Job> makeJobs(const std::vector<BatchInput>& inputs, const Patterns& patterns) {
  std::vector<Job> jobs;
  jobs.reserve(inputs.size());
  for (const BatchInput& input : inputs) {
    Job job;
    job.input = input.path;
    job.place = jobs.size() + 1;
    for (const auto& [option, pattern] : patterns) {
      job.outputs.push_back({option, pattern.expand(input.path, job.place)});
    }
    jobs.push_back(std::move(job));
  }
  return jobs;
}

bool keepsRecords(const Settings& settings) {
  return !settings.jsonl.empty() && settings.jsonl != "-";
}

/// The directory of a file, as all its names have it.
std::string directoryOf(const std::string& path) {
  const std::string parent = fs::path(path).parent_path().string();
  return canonicalName(parent.empty() ? "." : parent);
}

/// Where outputs go to the directory that inputs come from, those of the runs before are there now.
/// Leaves out what the records show to be such, and still to be as it was made: a name alone is not
/// enough, as a scan may have it as well. \return their number. \throw UsageError
std::size_t leaveOutOutputs(std::vector<BatchInput>& inputs, const Patterns& patterns,
                            const Settings& settings) {
  std::set<std::string> input_directories;
  for (const BatchInput& input : inputs) {
    if (input.from_directory) {
      input_directories.insert(directoryOf(input.path));
    }
  }
  std::set<std::string> output_directories;
  for (const BatchInput& input : inputs) {
    for (const auto& [option, pattern] : patterns) {
      const std::string output = pattern.expand(input.path, 1);
      const std::optional<FileFormat> format = formatOf(output);
      const std::string directory = directoryOf(output);
      if (!format || !isUsable(*format, FileUse::ReadCloud) ||
          input_directories.count(directory) == 0) {
        continue;
      }
      output_directories.insert(directory);
      // The names of the next run would be others, so that no clash told of it.
      if (!keepsRecords(settings) && pattern.expand(input.path, 2) != output) {
        throw UsageError("option -" + option + ": " + inQuotes(directory) +
                             " is where inputs are looked for, and the next run would take what "
                             "has an {index} for one",
                         "give files that are made another directory, or -jsonl FILE in all runs");
      }
    }
  }
  std::error_code error;
  // A pipe can be written, but has no records of the run before.
  if (output_directories.empty() || !keepsRecords(settings) ||
      !fs::is_regular_file(settings.jsonl, error)) {
    return 0;
  }
  std::set<std::tuple<std::string, std::uint64_t, std::int64_t>> made;
  for (const Json& record : readRecords(settings.jsonl)) {
    const Json files = record.value("files", Json());
    // Those of what failed have no size, unless they were made all the same.
    if (!files.is_array()) {
      continue;
    }
    for (const Json& file : files) {
      const auto member = [&file](const char* name) {
        return file.is_object() ? file.value(name, Json()) : Json();
      };
      if (member("path").is_string() && member("bytes").is_number() &&
          member("mtime_ns").is_number()) {
        made.emplace(asRecorded(canonicalName(member("path").get<std::string>())),
                     member("bytes").get<std::uint64_t>(), member("mtime_ns").get<std::int64_t>());
      }
    }
  }
  const auto is_output = [&](const BatchInput& input) {
    if (!input.from_directory || output_directories.count(directoryOf(input.path)) == 0) {
      return false;
    }
    const std::optional<FileState> state = stateOf(input.path);
    return state &&
           made.count({asRecorded(canonicalName(input.path)), state->bytes, state->time}) > 0;
  };
  const std::size_t before = inputs.size();
  inputs.erase(std::remove_if(inputs.begin(), inputs.end(), is_output), inputs.end());
  if (inputs.empty()) {
    throw UsageError("there is no input: all files that were found are outputs of runs before",
                     "give the files that they were made from");
  }
  return before - inputs.size();
}

/// \throw UsageError if a file would be written twice, or over an input.
void checkNames(const std::vector<Job>& jobs, const Settings& settings) {
  const std::string remedy = "put {name} into the pattern, and {dir} or {index} where names repeat";
  std::map<std::string, const Job*> taken;
  for (const Job& job : jobs) {
    taken.emplace(canonicalName(job.input), &job);
  }
  if (keepsRecords(settings) && taken.count(canonicalName(settings.jsonl)) > 0) {
    throw UsageError(inQuotes(settings.jsonl) + " is an input", "give -jsonl another name");
  }
  std::map<std::string, const Job*> outputs;
  for (const Job& job : jobs) {
    for (const OutputName& output : job.outputs) {
      const std::string name = canonicalName(output.path);
      if (taken.count(name) > 0) {
        throw UsageError(inQuotes(output.path) + ", made from " + inQuotes(job.input) +
                             ", would overwrite an input",
                         "give files that are made another directory or extension; those of a "
                         "run before are known by the records of -jsonl");
      }
      const auto [other, is_new] = outputs.emplace(name, &job);
      if (!is_new) {
        throw UsageError(inQuotes(other->second->input) + " and " + inQuotes(job.input) +
                             " would both be written to " + inQuotes(output.path),
                         remedy);
      }
    }
  }
  if (!settings.jsonl.empty() && outputs.count(canonicalName(settings.jsonl)) > 0) {
    throw UsageError(inQuotes(settings.jsonl) + " is an output", "give -jsonl another name");
  }
}

/// The options that the result depends on, with their values.
Json optionsOf(const CommandLine& command_line) {
  Json options = Json::object();
  for (const auto& [option, value] : command_line.values()) {
    if (!isBatchOption(option) && !isFileOption(option) && !isForeignOption(option) &&
        option != "quiet") {
      options[option] = value.empty() ? Json(true) : Json(asRecorded(value));
    }
  }
  return options;
}

std::string currentTime() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

std::string nameOf(JobState state) {
  switch (state) {
  case JobState::Waiting:
    return "not started";
  case JobState::UpToDate:
    return "up to date";
  case JobState::Running:
    return "running";
  case JobState::Done:
    return "done";
  case JobState::Failed:
    return "failed";
  case JobState::Cancelled:
    return "cancelled";
  }
  return "";
}

/// A text of at most so many characters: of paths, the end tells more.
std::string shortened(const std::string& text, std::size_t size) {
  return text.size() <= size ? text : "..." + text.substr(text.size() - size + 3);
}

/// What to do about a program that a signal ended.
std::string remedyFor(int signal) {
  switch (signal) {
  case SIGKILL:
    return "the memory probably ran out: give a smaller -memory or -jobs, and -resume";
  case SIGHUP:
  case SIGINT:
  case SIGTERM:
    return "it was told to end from outside: run it again, with -resume";
  case SIGXCPU:
    return "raise the limit of processor time";
  default:
    return "check that other programs can read the file; if they can, please report it";
  }
}

/// What is kept of a report: all of it, of all inputs, would be too much.
Json resultOf(const Json& report) {
  Json result = nullptr;
  if (report.is_object()) {
    for (const char* member : {"points", "vertices", "triangles", "self_intersections",
                               "looks_closed_genus0", "warnings", "peak_memory_bytes"}) {
      result[member] = report.value(member, Json());
    }
    const Json diagnosis = report.value("diagnosis", Json());
    if (diagnosis.is_object()) {
      result["looks_closed_genus0"] = diagnosis.value("looks_closed_genus0", Json());
    }
  }
  return result;
}

/// A pipe from the thread that waits for signals to the one that works.
class SignalPipe {
public:
  SignalPipe() {
    if (pipe2(ends_.data(), O_CLOEXEC | O_NONBLOCK) != 0) {
      throw Failure("cannot make a pipe: " + systemMessage(errno), "end other programs");
    }
  }
  ~SignalPipe() {
    close(ends_[0]);
    close(ends_[1]);
  }
  SignalPipe(const SignalPipe&) = delete;
  SignalPipe& operator=(const SignalPipe&) = delete;

  void tell(int signal) const {
    const auto byte = static_cast<unsigned char>(signal);
    // It is full only if many signals were told already.
    [[maybe_unused]] const ssize_t count = write(ends_[1], &byte, 1);
  }
  /// The next signal that was told, waiting for it a while.
  std::optional<int> next(double seconds) const {
    pollfd polled = {ends_[0], POLLIN, 0};
    unsigned char byte = 0;
    if (poll(&polled, 1, static_cast<int>(seconds * 1e3)) == 1 && read(ends_[0], &byte, 1) == 1) {
      return byte;
    }
    return std::nullopt;
  }
  int descriptor() const { return ends_[0]; }

private:
  std::array<int, 2> ends_{};
};

/// The work on all inputs.
class Batch {
public:
  Batch(const BatchTool& tool, const CommandLine& command_line);

  /// \throw Failure if an input failed.
  void run();

private:
  /// Marks the inputs whose files are there already.
  void findUpToDate();
  void work();
  /// Starts all that may run now.
  void startSome();
  /// \return false if it could not be started beside those that run, but perhaps can after them.
  bool start(std::size_t number, std::size_t threads);
  void ended(std::size_t number, const ChildResult& result);
  void fail(std::size_t number, const std::string& cause, const std::string& remedy);
  /// Keeps the record of a job that has ended, and tells of it.
  void conclude(std::size_t number);
  void interrupt(int signal);
  /// Lets the running jobs end, for whatever reason there is no going on.
  void stopAll();
  std::vector<std::string> wordsFor(const Job& job) const;
  Json recordOf(const Job& job) const;
  void setState(Job& job, JobState state);
  std::size_t count(JobState state) const;
  std::string progress() const;
  void printHead();
  void printTable();
  std::string summary() const;

  BatchTool tool_;
  CommandLine command_line_;
  Settings settings_;
  Json options_;
  std::string program_;
  std::vector<Job> jobs_;
  std::size_t left_out_ = 0;  ///< files that runs before made, among the inputs
  std::map<JobState, std::size_t> counts_;
  std::unique_ptr<RecordLog> log_;
  Console console_;
  bool terminal_;
  Clock::time_point begin_;

  SignalPipe signals_;
  ChildProcesses children_;
  std::map<pid_t, std::size_t> running_;
  std::unique_ptr<JobScheduler> scheduler_;
  std::vector<std::size_t> scheduled_;     ///< the scheduler's jobs, as numbers of ours
  std::map<std::size_t, std::size_t> at_;  ///< of ours, as the scheduler's
  int interrupted_by_ = 0;
};

Batch::Batch(const BatchTool& tool, const CommandLine& command_line)
    : tool_(tool), command_line_(command_line), settings_(parseSettings(command_line)),
      options_(optionsOf(command_line)), program_(pathOfThisProgram()), console_(!settings_.quiet),
      terminal_(isatty(STDOUT_FILENO) == 1), begin_(Clock::now()) {
  std::vector<BatchInput> inputs = collectInputs(command_line.others(), settings_.list);
  const Patterns patterns = patternsOf(settings_, command_line);
  left_out_ = leaveOutOutputs(inputs, patterns, settings_);
  jobs_ = makeJobs(inputs, patterns);
  checkNames(jobs_, settings_);
  for (const Job& job : jobs_) {
    for (const OutputName& output : job.outputs) {
      tool_.check_output(output.option, output.path);
    }
  }
  const auto is_of_others = [this](const Job& job) {
    return (job.place - 1) % settings_.shards != settings_.shard;
  };
  jobs_.erase(std::remove_if(jobs_.begin(), jobs_.end(), is_of_others), jobs_.end());
  counts_[JobState::Waiting] = jobs_.size();
}

void Batch::findUpToDate() {
  std::map<std::string, Json> records;
  for (Json& record : readRecords(settings_.jsonl)) {
    if (record.value("status", Json()) == "done" && record["output"].is_string()) {
      const std::string output = record["output"].get<std::string>();
      records[output] = std::move(record);
    }
  }
  for (Job& job : jobs_) {
    const auto found = records.find(asRecorded(job.outputs.front().path));
    if (found == records.end() || !job.input_state) {
      continue;
    }
    Json& record = found->second;
    bool is_same = record["input"] == asRecorded(job.input) &&
                   record["version"] == SPHERICAL_PARAM_VERSION && record["options"] == options_ &&
                   record["input_bytes"] == job.input_state->bytes &&
                   record["input_mtime_ns"] == job.input_state->time;
    const Json& files = record["files"];
    is_same = is_same && files.is_array() && files.size() == job.outputs.size();
    for (std::size_t f = 0; is_same && f < job.outputs.size(); ++f) {
      const std::optional<FileState> state = stateOf(job.outputs[f].path);
      is_same = state && files[f].is_object() &&
                files[f].value("path", Json()) == asRecorded(job.outputs[f].path) &&
                files[f].value("option", Json()) == job.outputs[f].option &&
                files[f].value("bytes", Json()) == state->bytes &&
                files[f].value("mtime_ns", Json()) == state->time;
    }
    if (is_same) {
      setState(job, JobState::UpToDate);
      job.result = resultOf(record);
    }
  }
}

std::vector<std::string> Batch::wordsFor(const Job& job) const {
  std::vector<std::string> words = {program_, "-quiet", "-threads=" + std::to_string(job.threads)};
  bool has_json = false;
  for (const auto& [option, value] : command_line_.values()) {
    if (!isBatchOption(option) && !isFileOption(option) && !isForeignOption(option) &&
        option != "quiet") {
      words.push_back("-" + option + (value.empty() ? "" : "=" + value));
    }
  }
  for (std::size_t f = 1; f < job.outputs.size(); ++f) {
    words.push_back("-" + job.outputs[f].option + "=" + job.outputs[f].path);
    has_json = has_json || job.outputs[f].option == "json";
  }
  if (!has_json) {
    words.emplace_back("-json=-");
  }
  words.insert(words.end(), {"--", job.input, job.outputs.front().path});
  return words;
}

bool Batch::start(std::size_t number, std::size_t threads) {
  Job& job = jobs_[number];
  job.threads = settings_.threads > 0 ? settings_.threads : threads;
  job.input_state = stateOf(job.input);
  for (const OutputName& output : job.outputs) {
    const fs::path directory = fs::path(output.path).parent_path();
    std::error_code error;
    if (!directory.empty()) {
      fs::create_directories(directory, error);
    }
    if (error) {
      fail(number,
           "cannot make the directory " + inQuotes(directory.string()) + ": " + error.message(),
           "choose a place that exists and that you may write to");
      return true;
    }
  }
  try {
    running_[children_.start(wordsFor(job))] = number;
    setState(job, JobState::Running);
  } catch (const ToolError& error) {
    if (!running_.empty()) {
      return false;
    }
    fail(number, error.what(), error.remedy());
  }
  return true;
}

void Batch::fail(std::size_t number, const std::string& cause, const std::string& remedy) {
  Job& job = jobs_[number];
  setState(job, JobState::Failed);
  job.exit_code = static_cast<int>(ExitCode::Failed);
  job.cause = cause;
  job.remedy = remedy;
  conclude(number);
}

/// The report that a job printed or wrote.
Json reportOf(const Job& job, const std::string& output) {
  for (const OutputName& file : job.outputs) {
    if (file.option == "json") {
      std::ifstream stream(file.path);
      return Json::parse(stream, nullptr, false);
    }
  }
  return Json::parse(output, nullptr, false);
}

/// Takes the two lines of an error message apart.
void readMessage(const std::string& tool, const std::string& errors, Job& job) {
  const std::string remedy_label = "  remedy: ";
  std::string previous;
  for (const std::string_view line : split(errors, "\n")) {
    if (line.substr(0, remedy_label.size()) == remedy_label) {
      job.cause = previous;
      job.remedy = line.substr(remedy_label.size());
    }
    previous = line;
  }
  if (job.cause.empty()) {
    job.cause = "it ended with exit code " + std::to_string(job.exit_code) +
                (previous.empty() ? "" : ", saying: " + previous);
    job.remedy = "check that other programs can read the file; if they can, please report it";
  }
  if (job.cause.rfind(tool + ": ", 0) == 0) {
    job.cause.erase(0, tool.size() + 2);
  }
}

void Batch::ended(std::size_t number, const ChildResult& result) {
  Job& job = jobs_[number];
  job.exit_code = result.exit_code;
  job.signal = result.signal;
  job.peak_memory = result.peak_memory;
  if (result.signal != 0) {
    for (const OutputName& output : job.outputs) {
      removeTemporaryFilesOf(result.process, output.path);
    }
    const bool is_end =
        result.signal == SIGINT || result.signal == SIGTERM || result.signal == SIGHUP;
    // Who ends everything, as a terminal does, may tell this program last.
    const std::optional<int> told =
        is_end && interrupted_by_ == 0 ? signals_.next(0.2) : std::nullopt;
    if (told) {
      interrupt(*told);
    }
    setState(job, interrupted_by_ != 0 ? JobState::Cancelled : JobState::Failed);
    job.cause = "ended by " + signalName(result.signal);
    job.remedy = interrupted_by_ != 0 ? "run it again, with -resume" : remedyFor(result.signal);
  } else if (result.exit_code == exit_code_not_run) {
    setState(job, JobState::Failed);
    job.cause = "the program " + inQuotes(program_) + " could not be run";
    job.remedy = "check that its file was not removed or replaced; then run this again";
  } else if (result.exit_code != 0) {
    setState(job, JobState::Failed);
    readMessage(tool_.name, result.errors, job);
    job.made = job.remedy.compare(0, files_are_made.size(), files_are_made) == 0;
  } else {
    setState(job, JobState::Done);
    job.made = true;
  }
  if (job.made) {
    job.result = resultOf(reportOf(job, result.output));
    const Json peak = job.result.is_object() ? job.result["peak_memory_bytes"] : Json(nullptr);
    if (peak.is_number()) {
      // The system counts what this program had when it started the other one, too.
      job.peak_memory = peak.get<std::uint64_t>();
    }
  }
  conclude(number);
}

Json Batch::recordOf(const Job& job) const {
  Json record;
  record["input"] = job.input;
  record["output"] = job.outputs.front().path;
  record["status"] = nameOf(job.state);
  record["exit_code"] = job.exit_code >= 0 ? Json(job.exit_code) : Json(nullptr);
  record["signal"] = job.signal != 0 ? Json(job.signal) : Json(nullptr);
  record["cause"] = job.cause.empty() ? Json(nullptr) : Json(oneLine(job.cause));
  record["remedy"] = job.remedy.empty() ? Json(nullptr) : Json(oneLine(job.remedy));
  for (const char* member : {"points", "vertices", "triangles", "self_intersections",
                             "looks_closed_genus0", "warnings"}) {
    record[member] = job.result.is_object() ? job.result.at(member) : Json(nullptr);
  }
  record["seconds"] = job.seconds;
  record["threads"] = job.threads;
  record["peak_memory_bytes"] = job.peak_memory != 0 ? Json(job.peak_memory) : Json(nullptr);
  record["memory_need_bytes"] = job.memory_need;
  record["index"] = job.place;
  record["finished"] = currentTime();
  record["version"] = SPHERICAL_PARAM_VERSION;
  record["options"] = options_;
  record["input_bytes"] = job.input_state ? Json(job.input_state->bytes) : Json(nullptr);
  record["input_mtime_ns"] = job.input_state ? Json(job.input_state->time) : Json(nullptr);
  record["files"] = Json::array();
  for (const OutputName& output : job.outputs) {
    const std::optional<FileState> state = job.made ? stateOf(output.path) : std::nullopt;
    record["files"].push_back({{"option", output.option},
                               {"path", output.path},
                               {"bytes", state ? Json(state->bytes) : Json(nullptr)},
                               {"mtime_ns", state ? Json(state->time) : Json(nullptr)}});
  }
  return record;
}

void Batch::setState(Job& job, JobState state) {
  --counts_[job.state];
  ++counts_[state];
  job.state = state;
}

std::size_t Batch::count(JobState state) const {
  const auto found = counts_.find(state);
  return found == counts_.end() ? 0 : found->second;
}

/// E.g. "7 of 12, 1 failed".
std::string Batch::progress() const {
  const std::size_t left = count(JobState::Waiting) + count(JobState::Running);
  return std::to_string(jobs_.size() - left) + " of " + std::to_string(jobs_.size()) + ", " +
         std::to_string(count(JobState::Failed)) + " failed";
}

void Batch::conclude(std::size_t number) {
  Job& job = jobs_[number];
  job.seconds = std::chrono::duration<double>(Clock::now() - job.begin).count();
  scheduler_->finished(at_.at(number));
  log_->append(recordOf(job));
  const std::size_t left = count(JobState::Waiting) + count(JobState::Running);
  console_.update(1.0 - static_cast<double>(left) / static_cast<double>(jobs_.size()), progress());
  if (!terminal_) {
    console_.heading("  [" + progress() + "] " + nameOf(job.state) + "  " + oneLine(job.input) +
                     (job.cause.empty() ? "" : ": " + oneLine(job.cause)));
    std::fflush(stdout);
  }
  if (settings_.quiet && job.state == JobState::Failed) {
    std::fprintf(stderr, "%s: %s: %s\n  remedy: %s\n", tool_.name.c_str(),
                 inQuotes(job.input).c_str(), oneLine(job.cause).c_str(),
                 oneLine(job.remedy).c_str());
  }
}

void Batch::interrupt(int signal) {
  // A second one does not wait for anything to be tidied up.
  children_.signalAll(interrupted_by_ == 0 ? SIGTERM : SIGKILL);
  interrupted_by_ = signal;
}

void Batch::stopAll() {
  children_.signalAll(SIGTERM);
  while (children_.count() > 0) {
    const std::optional<ChildResult> result = children_.wait(-1, 10.0);
    if (!result) {
      children_.signalAll(SIGKILL);
    }
  }
}

void Batch::startSome() {
  for (;;) {
    // Jobs that fail before they run could keep it here for long.
    if (const std::optional<int> signal = signals_.next(0.0)) {
      interrupt(*signal);
    }
    const std::optional<JobScheduler::Start> next =
        interrupted_by_ == 0 ? scheduler_->next() : std::nullopt;
    if (!next) {
      return;
    }
    const std::size_t number = scheduled_[next->job];
    Job& job = jobs_[number];
    job.begin = Clock::now();
    if (settings_.memory_given && job.memory_need > settings_.memory) {
      fail(number,
           "it may need " + inBytes(job.memory_need) + ", more than the " +
               inBytes(settings_.memory) + " of -memory",
           "give a larger -memory, or run it on a larger machine");
    } else if (!start(number, next->threads)) {
      scheduler_->putBack(next->job);
      return;
    }
  }
}

void Batch::work() {
  for (std::size_t j = 0; j < jobs_.size(); ++j) {
    if (jobs_[j].state == JobState::Waiting) {
      at_[j] = scheduled_.size();
      scheduled_.push_back(j);
    }
  }
  scheduler_ = std::make_unique<JobScheduler>(
      JobLimits{settings_.jobs, settings_.processors, settings_.memory}, scheduled_.size(),
      [this](std::size_t scheduled) {
        Job& job = jobs_[scheduled_[scheduled]];
        job.memory_need = tool_.memory_need(job.input);
        return job.memory_need;
      });
  for (;;) {
    startSome();
    if (running_.empty()) {
      return;
    }
    console_.update(0.0, progress() + ", " + std::to_string(running_.size()) + " running");
    const std::optional<ChildResult> result = children_.wait(signals_.descriptor(), -1.0);
    if (result) {
      const auto found = running_.find(result->process);
      const std::size_t number = found->second;
      running_.erase(found);
      ended(number, *result);
    } else if (const std::optional<int> signal = signals_.next(0.0)) {
      interrupt(*signal);
    }
  }
}

void Batch::printHead() {
  console_.heading(tool_.name + " " + SPHERICAL_PARAM_VERSION);
  console_.entry("inputs",
                 std::to_string(jobs_.size()) +
                     (settings_.shards > 1 ? " (share " + std::to_string(settings_.shard) + " of " +
                                                 std::to_string(settings_.shards) + ")"
                                           : ""));
  if (left_out_ > 0) {
    console_.entry("no inputs", counted(left_out_, "file") + " that runs before made of them");
  }
  console_.entry("output", oneLine(settings_.output));
  console_.entry("jobs", std::to_string(settings_.jobs) + " at a time, on " +
                             counted(settings_.processors, "processor"));
  console_.entry("memory", "up to " + inBytes(settings_.memory));
  if (!settings_.jsonl.empty()) {
    console_.entry("records", oneLine(settings_.jsonl));
  }
  if (settings_.resume) {
    console_.entry("up to date", std::to_string(count(JobState::UpToDate)));
  }
  for (const std::string& note : notesOnForeignOptions(command_line_)) {
    console_.entry("note", note);
  }
}

void Batch::printTable() {
  constexpr std::size_t longest_name = 40;
  std::size_t width = std::string("input").size();
  for (const Job& job : jobs_) {
    width = std::max(width, std::min(longest_name, job.input.size()));
  }
  const auto cell = [](const std::string& text, std::size_t size) {
    return text + std::string(size - std::min(size, text.size()), ' ');
  };
  const auto number = [](const Json& value) {
    return value.is_number() ? std::to_string(value.get<std::uint64_t>()) : std::string("-");
  };
  const std::string head =
      cell("input", width) + "     points  triangles  self-int.   seconds   peak MB  result";
  console_.heading("");
  console_.heading("  " + head);
  console_.heading("  " + std::string(head.size(), '-'));
  for (const Job& job : jobs_) {
    const bool has_run = job.state != JobState::Waiting && job.state != JobState::UpToDate;
    const auto of_result = [&](const char* member) {
      return job.result.is_object() ? number(job.result.at(member)) : "-";
    };
    const std::string seconds = has_run ? formatted(job.seconds, 3) : "-";
    const std::string peak =
        has_run && job.peak_memory > 0
            ? formatted(static_cast<double>(job.peak_memory) / (1024.0 * 1024.0), 3)
            : "-";
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), " %10s %10s %10s %9s %9s  ",
                  of_result("points").c_str(), of_result("triangles").c_str(),
                  of_result("self_intersections").c_str(), seconds.c_str(), peak.c_str());
    console_.heading("  " + cell(oneLine(shortened(job.input, longest_name)), width) + line.data() +
                     nameOf(job.state) + (job.cause.empty() ? "" : ": " + oneLine(job.cause)));
    if (job.state == JobState::Failed) {
      console_.heading("  " + cell("", width) + "   remedy: " + oneLine(job.remedy));
    }
  }
  console_.heading("");
  console_.heading("  " + summary());
}

std::string Batch::summary() const {
  std::string text = counted(jobs_.size(), "input") + ": " + std::to_string(count(JobState::Done)) +
                     " done, " + std::to_string(count(JobState::Failed)) + " failed";
  for (const JobState state : {JobState::UpToDate, JobState::Cancelled, JobState::Waiting}) {
    if (count(state) > 0) {
      text += ", " + std::to_string(count(state)) + " " + nameOf(state);
    }
  }
  return text + "; " + formatted(std::chrono::duration<double>(Clock::now() - begin_).count(), 3) +
         " s";
}

void Batch::run() {
  const SignalWatch watch([this](int signal) { signals_.tell(signal); });
  log_ = std::make_unique<RecordLog>(settings_.jsonl);
  for (Job& job : jobs_) {
    job.input_state = stateOf(job.input);
  }
  if (settings_.resume) {
    findUpToDate();
    std::set<std::string> directories;
    for (const Job& job : jobs_) {
      for (const OutputName& output : job.outputs) {
        directories.insert(directoryOf(output.path));
      }
    }
    for (const std::string& directory : directories) {
      removeAbandonedFiles(directory);
    }
  }
  printHead();
  console_.begin("batch");
  try {
    work();
  } catch (...) {
    stopAll();
    throw;
  }
  console_.end(progress());
  printTable();
  console_.flush();
  if (interrupted_by_ != 0) {
    endBySignal(interrupted_by_);
  }
  const std::size_t failed = count(JobState::Failed);
  if (failed > 0) {
    throw Failure(std::to_string(failed) + " of " + counted(jobs_.size(), "input") + " failed",
                  keepsRecords(settings_)
                      ? (settings_.quiet ? "the lines above and " : "the table and ") +
                            inQuotes(settings_.jsonl) +
                            " say why; with -resume, only those run again"
                      : "the lines above say why; with -jsonl FILE and -resume, only "
                        "what failed runs again");
  }
}

}  // namespace

std::vector<OptionInfo> batchOptions() {
  return {
      {"output", "PATTERN", "many inputs: files to make, as in meshes/{name}.ply, see below"},
      {"inputs", "FILE", "many inputs: more of them, a path on each line, - for standard input"},
      {"jobs", "N", "many inputs: at a time, 0: as many as there are processors (0)"},
      {"memory", "SIZE", "many inputs: memory of all at a time, e.g. 4G (4/5 of what is free)"},
      {"jsonl", "FILE", "many inputs: add a line of JSON for each, - for the standard output"},
      {"resume", "", "many inputs: leave out those that the records of -jsonl show to be done"},
      {"shard", "I/N", "many inputs: only each N-th, from the I-th, which begins at 0"},
  };
}

bool isBatch(const CommandLine& command_line) {
  if (command_line.has("output")) {
    return true;
  }
  for (const OptionInfo& option : batchOptions()) {
    if (command_line.has(option.name)) {
      throw UsageError("option -" + option.name + " is for many inputs, and needs -output",
                       "give -output with a pattern such as meshes/{name}.ply, or leave -" +
                           option.name + " out");
    }
  }
  return false;
}

void runBatch(const BatchTool& tool, const CommandLine& command_line) {
  Batch(tool, command_line).run();
}

}  // namespace spherical_param::tools
