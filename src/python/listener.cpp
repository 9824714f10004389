#include "python/listener.h"

namespace spherical_param::python {

bool Listener::report(const char* stage, double fraction) {
  namespace py = pybind11;
  // To take the interpreter's lock may mean to wait for another thread's turn to end, and without a
  // function to call it is for signals alone.
  constexpr std::chrono::milliseconds between_signals(50);
  const auto now = std::chrono::steady_clock::now();
  if (callback_.is_none() && now - last_ < between_signals)
    return true;
  last_ = now;
  const py::gil_scoped_acquire interpreter;
  try {
    if (PyErr_CheckSignals() != 0)
      throw py::error_already_set();
    if (callback_.is_none())
      return true;
    return callback_(stage, fraction).ptr() != Py_False;
  } catch (...) {
    error_ = std::current_exception();
    return false;
  }
}

}  // namespace spherical_param::python
