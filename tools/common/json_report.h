#pragma once

#include "spherical_param/reconstruct.h"

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace spherical_param::tools {

/// Keeps the order in which its members were added.
using Json = nlohmann::ordered_json;

Json toJson(const Eigen::Vector3d& vector);
Json toJson(const std::vector<StageTime>& stages);

/// Largest resident memory of this program so far [bytes]; null where the system does not report
/// it.
///
/// Unlike ru_maxrss of getrusage(), it does not begin with the memory of the process that started
/// this one.
Json peakMemoryToJson();

/// The text of a report, as it is written.
std::string textOf(const Json& report);

}  // namespace spherical_param::tools
