#include "common/json_report.h"

#include <cstdint>
#include <fstream>

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
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) {
      return kibibytes * 1024;
    }
  }
  return nullptr;
}

std::string textOf(const Json& report) {
  // File names need not be UTF-8, JSON must be.
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace spherical_param::tools
