#include "common/console.h"

#include "common/errors.h"
#include "common/text.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

namespace spherical_param::tools {
namespace {

constexpr std::size_t label_width = 20;
constexpr std::size_t bar_width = 24;
constexpr std::chrono::milliseconds redraw_interval{50};

std::string padded(const std::string& label) {
  return label + std::string(label.size() < label_width ? label_width - label.size() : 1, ' ');
}

void flushStandardOutput() {
  errno = 0;
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw Failure("cannot write to the standard output: " + systemMessage(errno != 0 ? errno : EIO),
                  "direct the standard output to a place that takes it");
  }
}

}  // namespace

Console::Console(bool enabled) : enabled_(enabled), terminal_(isatty(STDOUT_FILENO) == 1) {}

Console::~Console() {
  if (bar_drawn_) {
    // An error message shall begin on a line of its own.
    print("\n");
    std::fflush(stdout);
  }
}

void Console::print(const std::string& text) {
  if (enabled_) {
    std::fwrite(text.data(), 1, text.size(), stdout);
  }
}

void Console::heading(const std::string& text) {
  print(text + "\n");
}

void Console::entry(const std::string& label, const std::string& value) {
  print("  " + padded(label) + value + "\n");
}

void Console::begin(const std::string& stage) {
  stage_ = stage;
  begin_ = Clock::now();
  drawn_ = begin_ - 2 * redraw_interval;
  update(0.0, "");
}

void Console::update(double fraction, const std::string& detail) {
  const Clock::time_point now = Clock::now();
  if (!enabled_ || !terminal_ || now - drawn_ < redraw_interval) {
    return;
  }
  drawn_ = now;
  bar_drawn_ = true;
  const double share = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(bar_width));
  const std::string percent = std::to_string(static_cast<int>(share * 100.0));
  // \033[K clears the rest of the line, left over from a longer one.
  print("\r  " + padded(stage_) + "[" + std::string(filled, '#') +
        std::string(bar_width - filled, '.') + "] " + std::string(3 - percent.size(), ' ') +
        percent + " %  " + detail + "\033[K");
  std::fflush(stdout);
}

double Console::end(const std::string& detail) {
  const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  std::array<char, 32> time;
  std::snprintf(time.data(), time.size(), "%8.3f s", seconds);
  print((bar_drawn_ ? "\r  " : "  ") + padded(stage_) + time.data() +
        (detail.empty() ? "" : "  " + detail) + (bar_drawn_ ? "\033[K\n" : "\n"));
  bar_drawn_ = false;
  std::fflush(stdout);
  return seconds;
}

void Console::flush() {
  if (enabled_) {
    flushStandardOutput();
  }
}

void printAll(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  flushStandardOutput();
}

std::string formatted(double value, int digits) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return text.data();
}

}  // namespace spherical_param::tools
