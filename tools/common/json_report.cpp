#include "common/json_report.h"

#include "common/peak_memory.h"

#include <cstdint>
#include <optional>

namespace spherical_param::tools {

Json toJson(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Json toJson(const std::vector<StageTime>& stages) {
  Json json = Json::array();
  for (const StageTime& stage : stages) {
    json.push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  }
  return json;
}

Json peakMemoryToJson() {
  const std::optional<std::uint64_t> peak_memory = peakMemory();
  return peak_memory ? Json(*peak_memory) : Json(nullptr);
}

std::string textOf(const Json& report) {
  // File names need not be UTF-8, JSON must be.
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace spherical_param::tools
