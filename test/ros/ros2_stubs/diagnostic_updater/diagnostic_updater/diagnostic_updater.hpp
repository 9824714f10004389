#pragma once

#include "diagnostic_msgs/msg/diagnostic_status.hpp"

#include <functional>
#include <string>

namespace diagnostic_updater {

class DiagnosticStatusWrapper : public diagnostic_msgs::msg::DiagnosticStatus {
public:
  void summary(unsigned char lvl, const std::string s);
  void summary(const diagnostic_msgs::msg::DiagnosticStatus& src);
  template <class T>
  void add(const std::string& key, const T& val);
};

using TaskFunction = std::function<void(DiagnosticStatusWrapper&)>;

class DiagnosticTaskVector {
public:
  void add(const std::string& name, TaskFunction f);
  template <class T>
  void add(const std::string name, T* c, void (T::*f)(DiagnosticStatusWrapper&)) {}
};

class Updater : public DiagnosticTaskVector {
public:
  template <class NodeT>
  explicit Updater(NodeT node, double period = 1.0) {}
  void setHardwareID(const std::string& hwid);
};

}  // namespace diagnostic_updater
