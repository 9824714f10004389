#include <pcl/console/print.h>
#include <pcl/surface/impl/spherical_param_run_core.hpp>

#include <cctype>
#include <new>

namespace pcl {
namespace detail {
namespace {

/// Carries an exception of the user's progress callback past the handlers that turn exceptions into
/// error messages; therefore not a std::exception.
struct ProgressCallbackFailure {
  std::exception_ptr cause;
};

/// Keeps a message, or a shorter one if there is no memory for it.
void setMessage(std::string& message, const char* text) noexcept {
  try {
    message = text;
  } catch (...) {
    message = "out of memory";
  }
}

/// The core's messages begin with the name of its function; ours have their own.
const char* withoutFunctionName(const char* message) {
  const char* end = message;
  while (std::isalnum(static_cast<unsigned char>(*end)) != 0)
    ++end;
  return end > message && end[0] == ':' && end[1] == ' ' ? end + 2 : message;
}

}  // namespace

std::function<bool(const spherical_param::Progress&)>
guardProgress(const std::function<bool(const spherical_param::Progress&)>& progress) {
  if (!progress)
    return {};
  return [progress](const spherical_param::Progress& state) {
    try {
      return progress(state);
    } catch (...) {
      throw ProgressCallbackFailure{std::current_exception()};
    }
  };
}

std::string failureOf(const std::function<void()>& work, std::exception_ptr& callback_error) {
  std::string failure;
  try {
    work();
  } catch (const ProgressCallbackFailure& error) {
    callback_error = error.cause;
    setMessage(failure, "the progress callback threw an exception");
  } catch (const std::bad_alloc&) {
    setMessage(failure,
               "out of memory; mesh a subset of the points (setIndices) or lower k (setKSearch)");
  } catch (const std::exception& error) {
    setMessage(failure, withoutFunctionName(error.what()));
    if (failure.empty())
      setMessage(failure, "an exception without a message");
  } catch (...) {
    setMessage(failure, "an unknown exception, probably of the search object");
  }
  return failure;
}

bool runCore(const char* function, const spherical_param::Execution& execution,
             unsigned int threads,
             const std::function<void(const spherical_param::Execution&)>& work) {
  std::exception_ptr callback_error;
  const auto guarded_work = [&] {
    spherical_param::Execution guarded = execution;
    guarded.progress = guardProgress(execution.progress);
    if (guarded.threads == 0)
      guarded.threads = static_cast<int>(threads);
    work(guarded);
  };
  const std::string failure = failureOf(std::cref(guarded_work), callback_error);
  if (callback_error)
    std::rethrow_exception(callback_error);
  if (!failure.empty())
    PCL_ERROR("[pcl::%s] %s\n", function, failure.c_str());
  return failure.empty();
}

}  // namespace detail
}  // namespace pcl
