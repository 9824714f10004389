#include "common/console.h"

#include "common/errors.h"
#include "common/system.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>

namespace spherical_param::tools {
namespace {

/// A run that is shorter needs no bar.
constexpr std::chrono::milliseconds quiet_start{500};
constexpr std::chrono::milliseconds redraw_interval{50};

std::string padded(const std::string& label, std::size_t width = 20) {
  return label + std::string(label.size() < width ? width - label.size() : 1, ' ');
}

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Console::Console(Detail detail)
    : detail_(detail), shows_bar_(detail != Detail::Nothing && isTerminal()) {}

Console::~Console() {
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
    print(padded(label, 10) + oneLine(value) + "\n");
  };
  std::string files;
  for (const std::string& file : summary.written) {
    files += (files.empty() ? "" : ", ") + file;
  }
  line("read", summary.read);
  line("verdict", summary.verdict);
  line("made", summary.made);
  line("time", formatted(secondsSince(start_), 3) + " s");
  line("left out", summary.left_out);
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
  stage_ = stage;
  begin_ = Clock::now();
  drawn_ = {};
  update(0.0);
}

void Console::beginPart(const std::string& part) {
  heading("\n" + part);
  part_ = part + ", ";
}

void Console::remark(const std::string& text) {
  if (remarks_.insert(text).second) {
    clearBar();
    print(padded("cloud", 10) + text + "\n");
    std::fflush(stdout);
  }
}

void Console::update(double fraction, double of_run) {
  constexpr double bar_width = 24.0;
  constexpr double min_of_run = 0.05;  // with less, the time that is left is not known
  const Clock::time_point now = Clock::now();
  if (!shows_bar_ || now - start_ < quiet_start || now - drawn_ < redraw_interval) {
    return;
  }
  drawn_ = now;
  is_bar_drawn_ = true;
  fraction = std::clamp(fraction, 0.0, 1.0);
  std::string bar(static_cast<std::size_t>(fraction * bar_width), '#');
  bar.resize(static_cast<std::size_t>(bar_width), '.');
  const double seconds = secondsSince(start_);
  std::array<char, 64> numbers;
  std::snprintf(numbers.data(), numbers.size(),
                of_run < min_of_run ? "] %3d %%  %.0f s" : "] %3d %%  %.0f s, about %.0f s left",
                static_cast<int>(fraction * 100.0), std::floor(seconds),
                std::ceil(seconds * (1.0 - of_run) / std::max(of_run, min_of_run)));
  // \033[K clears the rest of the line, left over from a longer one.
  print("\r  " + padded(part_ + stage_) + "[" + bar + numbers.data() + "\033[K");
  std::fflush(stdout);
}

FileProgress Console::updates(double from, double to) {
  return [=](double fraction) { update(from + (to - from) * fraction); };
}

std::function<bool(const Progress&)> Console::progress(double to) {
  return [=](const Progress& progress) {
    update(to * progress.fraction);
    return true;
  };
}

void Console::clearBar() {
  if (is_bar_drawn_) {
    print("\r\033[K");
    is_bar_drawn_ = false;
  }
}

StageTime Console::end(const std::string& detail) {
  StageTime stage{stage_, secondsSince(begin_)};
  std::array<char, 32> time;
  std::snprintf(time.data(), time.size(), "%8.3f s", stage.seconds);
  clearBar();
  entry(stage.name, time.data() + (detail.empty() ? "" : "  " + detail));
  std::fflush(stdout);
  return stage;
}

void Console::flush() {
  if (detail_ != Detail::Nothing) {
    printAll("");
  }
}

void printAll(const std::string& text) {
  errno = 0;
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw Failure("cannot write to the standard output: " + systemMessage(errno != 0 ? errno : EIO),
                  "direct the standard output to a place that takes it");
  }
}

}  // namespace spherical_param::tools
