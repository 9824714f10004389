#pragma once

#include "common/input_file.h"
#include "spherical_param/execution.h"
#include "spherical_param/result.h"

#include <chrono>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// How much a tool prints on its standard output.
enum class Detail {
  Nothing,
  Summary,  ///< some lines at the end
  All,      ///< options, stages and tables before these lines
};

/// The result of a run.
struct Summary {
  std::string read;                  ///< the inputs and their size
  std::string verdict;               ///< one sentence
  std::string made;                  ///< the size of the output
  std::string left_out;              ///< of the input
  std::vector<std::string> written;  ///< names of files
};

/// The standard output of a tool: pairs of label and value, and stages of work with their time. On
/// a terminal a stage is a progress bar.
class Console {
public:
  explicit Console(Detail detail);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// Prints the six lines of a run, with its time.
  void summary(const Summary& summary);
  /// Prints a line of its own with Detail::All.
  void heading(const std::string& text);
  /// Prints a label and its value with Detail::All.
  void entry(const std::string& label, const std::string& value);

  /// Begins a stage.
  void begin(const std::string& stage);
  /// Shows the fractions of the stage and of the run that are done, in [0, 1]. `of_run` 0: unknown.
  void update(double fraction, double of_run = 0.0);
  /// Prints a remark on the input, each text once.
  void remark(const std::string& text);
  /// Begins one of several parts of the input.
  void beginPart(const std::string& part);
  /// A function to report progress to: its fractions 0 to 1 become from ... to of the stage.
  FileProgress updates(double from = 0.0, double to = 1.0);
  std::function<bool(const Progress&)> progress(double to = 1.0);
  /// Ends the stage. \return its name and time
  StageTime end(const std::string& detail = "");

  /// Makes sure that everything is printed. \throw Failure if the output cannot be written.
  void flush();

private:
  using Clock = std::chrono::steady_clock;

  void print(const std::string& text);
  void clearBar();

  const Detail detail_;
  const bool shows_bar_;
  const Clock::time_point start_ = Clock::now();
  std::string part_;
  std::set<std::string> remarks_;
  std::string stage_;
  Clock::time_point begin_;
  Clock::time_point drawn_;  ///< of the bar
  bool is_bar_drawn_ = false;
};

/// Prints text on the standard output and makes sure that it got there. \throw Failure.
void printAll(const std::string& text);

}  // namespace spherical_param::tools
