#include "ros1/parameter_server.h"

#include "spherical_param/errors.h"

#include <dynamic_reconfigure/config_tools.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace spherical_param_ros {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigTools;

/// Integers of ROS 1 have 32 bits.
int narrowed(std::int64_t value) {
  return static_cast<int>(std::clamp<std::int64_t>(value, std::numeric_limits<int>::min(),
                                                   std::numeric_limits<int>::max()));
}

void append(Config& config, const std::string& name, const Value& value) {
  if (const auto* truth = std::get_if<bool>(&value))
    ConfigTools::appendParameter(config, name, *truth);
  else if (const auto* integer = std::get_if<std::int64_t>(&value))
    ConfigTools::appendParameter(config, name, narrowed(*integer));
  else if (const auto* number = std::get_if<double>(&value))
    ConfigTools::appendParameter(config, name, *number);
  else
    ConfigTools::appendParameter(config, name, std::get<std::string>(value));
}

/// Calls for the name and the value of each entry.
template <typename Use>
void forEach(const Config& config, const Use& use) {
  for (const auto& entry : config.bools)
    use(entry.name, entry.value != 0);
  for (const auto& entry : config.ints)
    use(entry.name, entry.value);
  for (const auto& entry : config.doubles)
    use(entry.name, entry.value);
  for (const auto& entry : config.strs)
    use(entry.name, entry.value);
}

/// A limit of a parameter, in its type.
Value limitOf(const Parameter& parameter, double limit, bool is_max) {
  if (std::holds_alternative<bool>(parameter.default_value))
    return is_max;
  if (std::holds_alternative<std::int64_t>(parameter.default_value))
    return static_cast<std::int64_t>(limit);
  if (std::holds_alternative<double>(parameter.default_value))
    return limit;
  return std::string();
}

const char* typeOf(const Value& value) {
  constexpr const char* names[] = {"bool", "int", "double", "str"};
  return names[value.index()];
}

/// The choices of a parameter as rqt_reconfigure reads them; empty if it has none.
std::string editMethodOf(const Parameter& parameter) {
  std::string list;
  for (const std::string& choice : parameter.choices)
    list += (list.empty() ? "" : ", ") + ("{'name': '" + choice + "', 'value': '" + choice) +
            "', 'type': 'str', 'description': ''}";
  return list.empty() ? "" : "{'enum_description': 'names', 'enum': [" + list + "]}";
}

dynamic_reconfigure::ConfigDescription description() {
  dynamic_reconfigure::ConfigDescription all;
  all.groups.resize(1);
  all.groups[0].name = "Default";
  for (const Parameter& parameter : parameters()) {
    dynamic_reconfigure::ParamDescription one;
    one.name = parameter.name;
    one.type = typeOf(parameter.default_value);
    one.description = parameter.description;
    one.edit_method = editMethodOf(parameter);
    all.groups[0].parameters.push_back(one);
    append(all.dflt, parameter.name, parameter.default_value);
    append(all.min, parameter.name, limitOf(parameter, parameter.min, false));
    append(all.max, parameter.name, limitOf(parameter, parameter.max, true));
  }
  return all;
}

Config configOf(const Settings& settings) {
  Config config;
  for (const Parameter& parameter : parameters())
    append(config, parameter.name, parameter.get(settings));
  config.groups.resize(1);
  config.groups[0].name = "Default";
  config.groups[0].state = 1;
  return config;
}

}  // namespace

Settings readSettings(const ros::NodeHandle& node) {
  Settings settings;
  for (const Parameter& parameter : parameters()) {
    XmlRpc::XmlRpcValue value;
    if (!node.getParam(parameter.name, value))
      continue;
    switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      parameter.set(settings, static_cast<bool>(value));
      break;
    case XmlRpc::XmlRpcValue::TypeInt:
      parameter.set(settings, std::int64_t{static_cast<int>(value)});
      break;
    case XmlRpc::XmlRpcValue::TypeDouble:
      parameter.set(settings, static_cast<double>(value));
      break;
    case XmlRpc::XmlRpcValue::TypeString:
      parameter.set(settings, static_cast<std::string>(value));
      break;
    default:
      throw spherical_param::InvalidInput(parameter.name +
                                          " is a list or a structure; use a value " + "such as " +
                                          textOf(parameter.default_value));
    }
  }
  return settings;
}

ParameterServer::ParameterServer(const ros::NodeHandle& node, const Settings& settings,
                                 std::function<void(const Settings&)> apply)
    : node_(node), settings_(settings), apply_(std::move(apply)) {
  // Names and latching are those of dynamic_reconfigure's server.
  description_publisher_ =
      node_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  update_publisher_ = node_.advertise<Config>("parameter_updates", 1, true);
  description_publisher_.publish(description());
  announce();
  service_ = node_.advertiseService("set_parameters", &ParameterServer::onRequest, this);
}

bool ParameterServer::onRequest(dynamic_reconfigure::Reconfigure::Request& request,
                                dynamic_reconfigure::Reconfigure::Response& response) {
  Settings changed = settings_;
  try {
    forEach(request.config, [&](const std::string& name, const auto& value) {
      setParameter(changed, name, value);
    });
    apply_(changed);
    settings_ = changed;
  } catch (const spherical_param::InvalidInput& error) {
    ROS_WARN_STREAM("The parameters stay as they are: " << error.what());
  }
  announce();
  response.config = configOf(settings_);
  return true;
}

void ParameterServer::announce() const {
  const Config config = configOf(settings_);
  forEach(config, [&](const std::string& name, const auto& value) { node_.setParam(name, value); });
  update_publisher_.publish(config);
}

}  // namespace spherical_param_ros
