// What the node uses of ROS 2, with the names, types and overloads that Humble and Jazzy have; here
// and in the other folders, one for each package. Debian has no ROS 2: the node is compiled with
// these declarations. Only functions that take a type local to the node have a body.
#pragma once

#include "rcl_interfaces/msg/parameter_descriptor.hpp"
#include "rcl_interfaces/msg/set_parameters_result.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace rclcpp {

class Context;

class InitOptions {};

enum class SignalHandlerOptions { All, SigInt, SigTerm, None };

void init(int argc, const char* const* argv, const InitOptions& init_options = InitOptions(),
          SignalHandlerOptions signal_handler_options = SignalHandlerOptions::All);
bool shutdown(std::shared_ptr<Context> context = nullptr,
              const std::string& reason = "user called rclcpp::shutdown()");

class Logger {
public:
  const char* get_name() const;
};

Logger get_logger(const std::string& name);

/// In place of rcutils_log(), which the macros call.
[[gnu::format(printf, 2, 3)]] void log(const char* name, const char* format, ...);

#define RCLCPP_WARN(logger, ...)                                                                   \
  do {                                                                                             \
    static_assert(std::is_same_v<std::decay_t<decltype(logger)>, rclcpp::Logger>);                 \
    rclcpp::log((logger).get_name(), __VA_ARGS__);                                                 \
  } while (0)
#define RCLCPP_FATAL RCLCPP_WARN

enum ParameterType : std::uint8_t {
  PARAMETER_NOT_SET,
  PARAMETER_BOOL,
  PARAMETER_INTEGER,
  PARAMETER_DOUBLE,
  PARAMETER_STRING,
  PARAMETER_BYTE_ARRAY  // and arrays of the other types
};

class ParameterValue {
public:
  ParameterValue();
  explicit ParameterValue(bool bool_value);
  explicit ParameterValue(int int_value);
  explicit ParameterValue(std::int64_t int_value);
  explicit ParameterValue(float double_value);
  explicit ParameterValue(double double_value);
  explicit ParameterValue(const std::string& string_value);
  explicit ParameterValue(const char* string_value);

  ParameterType get_type() const;

  template <typename type>
  std::enable_if_t<std::is_same_v<type, bool>, const bool&> get() const;
  template <typename type>
  std::enable_if_t<std::is_integral_v<type> && !std::is_same_v<type, bool>, const std::int64_t&>
  get() const;
  template <typename type>
  std::enable_if_t<std::is_floating_point_v<type>, const double&> get() const;
  template <typename type>
  std::enable_if_t<std::is_convertible_v<type, std::string>, const std::string&> get() const;
};

class Parameter {
public:
  const std::string& get_name() const;
  const ParameterValue& get_parameter_value() const;
};

class QoSInitialization;

class QoS {
public:
  explicit QoS(const QoSInitialization& qos_initialization);
  QoS(std::size_t history_depth);  // NOLINT(google-explicit-constructor): rclcpp's
  QoS& transient_local();
};

class SensorDataQoS : public QoS {
public:
  SensorDataQoS();
};

template <typename AllocatorT>
struct PublisherOptionsWithAllocator {};
template <typename AllocatorT>
struct SubscriptionOptionsWithAllocator {};

template <typename MessageT, typename AllocatorT = std::allocator<void>>
class Publisher {
public:
  using SharedPtr = std::shared_ptr<Publisher>;

  template <typename T>
  std::enable_if_t<std::is_same_v<T, MessageT>> publish(std::unique_ptr<T> msg);
  template <typename T>
  std::enable_if_t<std::is_same_v<T, MessageT>> publish(const T& msg);
};

template <typename MessageT, typename AllocatorT = std::allocator<void>>
class Subscription {
public:
  using SharedPtr = std::shared_ptr<Subscription>;
};

namespace node_interfaces {

class NodeBaseInterface;

struct OnSetParametersCallbackHandle {
  using SharedPtr = std::shared_ptr<OnSetParametersCallbackHandle>;
};

}  // namespace node_interfaces

class NodeOptions {};

class Node : public std::enable_shared_from_this<Node> {
public:
  using SharedPtr = std::shared_ptr<Node>;

  explicit Node(const std::string& node_name, const NodeOptions& options = NodeOptions());
  explicit Node(const std::string& node_name, const std::string& namespace_,
                const NodeOptions& options = NodeOptions());
  virtual ~Node();

  Logger get_logger() const;

  template <typename MessageT, typename AllocatorT = std::allocator<void>,
            typename PublisherT = Publisher<MessageT, AllocatorT>>
  std::shared_ptr<PublisherT>
  create_publisher(const std::string& topic_name, const QoS& qos,
                   const PublisherOptionsWithAllocator<AllocatorT>& options =
                       PublisherOptionsWithAllocator<AllocatorT>());

  /// rclcpp takes other callbacks, too: ours has a message that is shared and not changed.
  template <typename MessageT, typename CallbackT, typename AllocatorT = std::allocator<void>,
            typename SubscriptionT = Subscription<MessageT, AllocatorT>>
  std::enable_if_t<std::is_invocable_v<CallbackT, std::shared_ptr<const MessageT>>,
                   std::shared_ptr<SubscriptionT>>
  create_subscription(const std::string& topic_name, const QoS& qos, CallbackT&& callback,
                      const SubscriptionOptionsWithAllocator<AllocatorT>& options =
                          SubscriptionOptionsWithAllocator<AllocatorT>()) {
    return nullptr;
  }

  const ParameterValue&
  declare_parameter(const std::string& name, const ParameterValue& default_value,
                    const rcl_interfaces::msg::ParameterDescriptor& parameter_descriptor =
                        rcl_interfaces::msg::ParameterDescriptor(),
                    bool ignore_override = false);
  const ParameterValue&
  declare_parameter(const std::string& name, ParameterType type,
                    const rcl_interfaces::msg::ParameterDescriptor& parameter_descriptor =
                        rcl_interfaces::msg::ParameterDescriptor(),
                    bool ignore_override = false);
  /// rclcpp deduces the type of the result.
  template <typename ParameterT>
  ParameterT
  declare_parameter(const std::string& name, const ParameterT& default_value,
                    const rcl_interfaces::msg::ParameterDescriptor& parameter_descriptor =
                        rcl_interfaces::msg::ParameterDescriptor(),
                    bool ignore_override = false);

  [[nodiscard]] node_interfaces::OnSetParametersCallbackHandle::SharedPtr
  add_on_set_parameters_callback(
      std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<Parameter>&)>
          callback);
};

void spin(std::shared_ptr<node_interfaces::NodeBaseInterface> node_ptr);
void spin(Node::SharedPtr node_ptr);

}  // namespace rclcpp
