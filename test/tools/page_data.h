#pragma once

#include "spherical_param/types.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <map>
#include <string>

namespace tool_test {

/// An array as the page reads it: rows in columns.
struct Array {
  Eigen::Matrix<std::uint32_t, Eigen::Dynamic, Eigen::Dynamic> integers;
  Eigen::MatrixXd values;  ///< the same by min and max, or the integers
};

struct Page {
  nlohmann::json data;
  std::map<std::string, Array> arrays;
  std::map<std::string, std::string> texts;  ///< of the arrays

  const Eigen::MatrixXd& operator[](const std::string& name) const {
    return arrays.at(name).values;
  }
  spherical_param::Triangles triangles(const std::string& name) const {
    return arrays.at(name).integers.cast<spherical_param::Index>();
  }
};

/// Takes a page of -report apart as a browser does.
Page decodedPage(const std::string& html);

}  // namespace tool_test
