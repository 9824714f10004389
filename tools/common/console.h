#pragma once

#include <chrono>
#include <string>

namespace spherical_param::tools {

/// What a tool says on the standard output: pairs of label and value, and stages of work with
/// their time. A stage is a progress bar on a terminal, else one line at its end.
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
  void update(double fraction, const std::string& detail);
  /// Ends the stage. \return its time [s].
  double end(const std::string& detail);

  /// Makes sure that everything is printed. \throw Failure if the output cannot be written.
  void flush();

private:
  using Clock = std::chrono::steady_clock;

  void print(const std::string& text);

  bool enabled_;
  bool terminal_;
  bool bar_drawn_ = false;
  std::string stage_;
  Clock::time_point begin_;
  Clock::time_point drawn_;
};

/// Prints text on the standard output and makes sure that it got there. \throw Failure.
void printAll(const std::string& text);

/// A number with the given number of significant digits.
std::string formatted(double value, int digits);

}  // namespace spherical_param::tools
