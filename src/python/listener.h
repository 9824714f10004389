#pragma once

#include <pybind11/pybind11.h>

#include "spherical_param/errors.h"
#include "spherical_param/execution.h"

#include <chrono>
#include <exception>
#include <optional>
#include <utility>

namespace spherical_param::python {

/// Takes the core's reports of progress to Python: to the caller's function, if there is one, and
/// to the handlers of signals, so that Ctrl-C ends long work. Hidden, as the types of pybind11 are.
class [[gnu::visibility("hidden")]] Listener {
public:
  /// \param callback callable with (stage, fraction), or None.
  explicit Listener(pybind11::object callback) : callback_(std::move(callback)) {}

  /// Called without the interpreter's lock; takes it only where it calls Python.
  /// \return false to end the work: the function said so, or there is an exception.
  bool report(const char* stage, double fraction) {
    // Taking the interpreter's lock may wait for another thread. Without a function to call, only
    // signals need it.
    constexpr std::chrono::milliseconds between_signals(50);
    const auto now = std::chrono::steady_clock::now();
    if (callback_.is_none() && now - last_ < between_signals)
      return true;
    last_ = now;
    const pybind11::gil_scoped_acquire interpreter;
    try {
      if (PyErr_CheckSignals() != 0)
        throw pybind11::error_already_set();
      if (callback_.is_none())
        return true;
      // Only False ends the work, NumPy's too: most functions return None.
      pybind11::detail::make_caster<bool> answer;
      return !answer.load(callback_(stage, fraction), false) || static_cast<bool>(answer);
    } catch (...) {
      error_ = std::current_exception();
      return false;
    }
  }

  /// Threads, and this listener's report as the progress callback.
  Execution execution(int threads, std::optional<double> time_limit = std::nullopt) {
    Execution execution;
    execution.threads = threads;
    execution.time_limit = time_limit;
    execution.progress = [this](const Progress& state) {
      return report(state.stage, state.fraction);
    };
    return execution;
  }

  /// Lets other Python threads run while `work` does. If it was cancelled by an exception in
  /// Python, that exception is rethrown.
  template <typename Work>
  auto run(const Work& work) {
    try {
      const pybind11::gil_scoped_release others_may_run;
      return work();
    } catch (const Cancelled&) {
      if (error_)
        std::rethrow_exception(error_);
      throw;
    }
  }

  /// The same for a step without reports of its own.
  void step(const char* stage, double fraction) {
    if (!report(stage, fraction))
      throw Cancelled("cancelled by the progress callback");
  }

private:
  pybind11::object callback_;
  std::exception_ptr error_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace spherical_param::python
