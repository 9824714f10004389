#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace spherical_param::tools {

/// The standard output of a tool: pairs of label and value, and stages of work with their time. A
/// stage is a progress bar on a terminal, which is drawn again every second even without a report,
/// else one line at its end.
class Console {
public:
  /// \param enabled false: nothing is printed, times are measured nevertheless.
  explicit Console(bool enabled);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// Prints a line of its own.
  void heading(const std::string& text);
  /// Prints a label and its value.
  void entry(const std::string& label, const std::string& value);

  /// Begins a stage.
  void begin(const std::string& stage);
  /// Draws the bar of the stage; fraction in [0, 1].
  void update(double fraction);
  /// Ends the stage. \return its time [s].
  double end(const std::string& detail);

  /// Makes sure that everything is printed. \throw Failure if the output cannot be written.
  void flush();

private:
  using Clock = std::chrono::steady_clock;

  void print(const std::string& text);
  /// Draws the bar, with the mutex locked.
  void draw();
  /// Draws the bar now and then, until the end.
  void keepDrawing();

  bool enabled_;
  bool terminal_;
  Clock::time_point start_;

  std::mutex mutex_;  ///< of all that follows
  std::condition_variable ending_;
  bool ended_ = false;
  bool in_stage_ = false;
  bool bar_drawn_ = false;
  std::string stage_;
  double fraction_ = 0.0;
  Clock::time_point begin_;
  Clock::time_point drawn_;
  std::thread drawer_;
};

/// Prints text on the standard output and makes sure that it got there. \throw Failure.
void printAll(const std::string& text);

/// A number with the given number of significant digits.
std::string formatted(double value, int digits);

}  // namespace spherical_param::tools
