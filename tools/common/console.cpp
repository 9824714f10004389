#include "common/console.h"

#include "common/errors.h"
#include "common/text.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <utility>

namespace spherical_param::tools {
namespace {

constexpr std::size_t label_width = 20;
constexpr std::size_t line_width = 10;
constexpr std::size_t bar_width = 24;
/// A run that is shorter needs no bar.
constexpr std::chrono::milliseconds quiet_start{500};
constexpr std::chrono::milliseconds redraw_interval{50};
/// A stage without a report for this long is drawn again, with the time that has passed.
constexpr std::chrono::milliseconds longest_silence{1000};

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

Console::Console(Detail detail)
    : detail_(detail), terminal_(isatty(STDOUT_FILENO) == 1), start_(Clock::now()) {}

Console::~Console() {
  if (drawer_.joinable()) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ended_ = true;
    }
    ending_.notify_all();
    drawer_.join();
  }
  // An error message begins on a line of its own.
  clearBar();
  std::fflush(stdout);
}

void Console::print(const std::string& text) {
  if (detail_ != Detail::Nothing) {
    std::fwrite(text.data(), 1, text.size(), stdout);
  }
}

void Console::summary(const Summary& summary) {
  const auto line = [this](const std::string& label, const std::string& value) {
    print(label + std::string(line_width - label.size(), ' ') + oneLine(value) + "\n");
  };
  std::string files;
  for (const std::string& file : summary.written) {
    files += (files.empty() ? "" : ", ") + file;
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  line("read", summary.read);
  line("verdict", summary.verdict);
  line("made", summary.made);
  line("time", formatted(seconds, 3) + " s");
  line("left out", summary.left_out);
  if (!summary.moved.empty()) {
    line("moved", summary.moved);
  }
  line("written", files);
}

void Console::heading(const std::string& text) {
  if (detail_ == Detail::All) {
    print(text + "\n");
  }
}

void Console::entry(const std::string& label, const std::string& value) {
  heading("  " + padded(label) + value);
}

void Console::begin(const std::string& stage) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stage_ = stage;
    in_stage_ = true;
    fraction_ = 0.0;
    begin_ = Clock::now();
    drawn_ = begin_ - 2 * redraw_interval;
  }
  if (detail_ != Detail::Nothing && terminal_ && !drawer_.joinable()) {
    drawer_ = std::thread([this] { keepDrawing(); });
  }
  update(0.0);
}

void Console::update(double fraction) {
  if (detail_ == Detail::Nothing || !terminal_) {
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  fraction_ = std::clamp(fraction, 0.0, 1.0);
  const Clock::time_point now = Clock::now();
  if (now - drawn_ >= redraw_interval && now - start_ >= quiet_start) {
    draw();
  }
}

void Console::draw() {
  const Clock::time_point now = Clock::now();
  drawn_ = now;
  bar_drawn_ = true;
  const std::string percent = std::to_string(static_cast<int>(fraction_ * 100.0));
  const auto filled = static_cast<std::size_t>(fraction_ * static_cast<double>(bar_width));
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - start_).count();
  // \033[K clears the rest of the line, left over from a longer one.
  print("\r  " + padded(stage_) + "[" + std::string(filled, '#') +
        std::string(bar_width - filled, '.') + "] " + std::string(3 - percent.size(), ' ') +
        percent + " %  " + std::to_string(seconds) + " s\033[K");
  std::fflush(stdout);
}

void Console::clearBar() {
  if (bar_drawn_) {
    print("\r\033[K");
    bar_drawn_ = false;
  }
}

void Console::keepDrawing() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ending_.wait_for(lock, longest_silence, [this] { return ended_; })) {
    if (in_stage_ && Clock::now() - drawn_ >= longest_silence / 2) {
      draw();
    }
  }
}

double Console::end(const std::string& detail) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  std::array<char, 32> time;
  std::snprintf(time.data(), time.size(), "%8.3f s", seconds);
  clearBar();
  entry(stage_, time.data() + (detail.empty() ? "" : "  " + detail));
  in_stage_ = false;
  std::fflush(stdout);
  return seconds;
}

void Console::flush() {
  if (detail_ != Detail::Nothing) {
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
