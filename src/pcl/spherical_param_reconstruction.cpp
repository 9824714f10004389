#include <pcl/impl/instantiate.hpp>
#include <pcl/surface/impl/spherical_param_reconstruction.hpp>

#include <algorithm>
#include <cctype>
#include <limits>

PCL_INSTANTIATE(SphericalParamReconstruction, PCL_XYZ_POINT_TYPES)

// What does not depend on the type of the points.
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

void checkCloud(std::size_t points, std::size_t width, std::size_t height) {
  if (points == 0)
    throw spherical_param::InvalidInput("the input cloud is empty; at least 4 points are needed");
  // PCL allows both to be 0 for "not organized".
  if ((width != 0 || height != 0) && width * height != points)
    throw spherical_param::InvalidInput("the input cloud has " + std::to_string(points) +
                                        " points, but its width is " + std::to_string(width) +
                                        " and its height " + std::to_string(height) +
                                        "; set width to the number of points and height to 1");
}

void rejectIndex(std::size_t entry, pcl::index_t index, std::size_t points) {
  throw spherical_param::InvalidInput(
      "entry " + std::to_string(entry) + " of the indices is " + std::to_string(index) +
      ", but the cloud has " + std::to_string(points) +
      " points; indices must be from 0 to the number of points less one");
}

pcl::PointCloud<pcl::PointXYZ>::Ptr cloudOfNothing(std::size_t points) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->resize(points);
  std::fill(cloud->begin(), cloud->end(), pcl::PointXYZ(nan, nan, nan));
  return cloud;
}

std::vector<pcl::Vertices> polygonsOf(const spherical_param::Triangles& triangles,
                                      const pcl::Indices& point_of_vertex) {
  const auto point = [&](spherical_param::Index vertex) {
    return point_of_vertex[static_cast<std::size_t>(vertex)];
  };
  std::vector<pcl::Vertices> polygons(static_cast<std::size_t>(triangles.cols()));
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    const auto triangle = triangles.col(static_cast<Eigen::Index>(t));
    polygons[t].vertices = {point(triangle[0]), point(triangle[1]), point(triangle[2])};
  }
  return polygons;
}

}  // namespace detail
}  // namespace pcl
