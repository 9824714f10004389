#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// The name of a file made from that of an input.
///
/// {name} stands for the name of the input without directory and extension, {ext} for its extension
/// without the dot, {dir} for its directory ("." if none is given), {index} for its place in the
/// list, from 1, and {index:4} for the same with zeros before it; {{ is a brace.
class NamePattern {
public:
  /// \param option for messages. \throw UsageError for a placeholder that is unknown or not closed.
  NamePattern(const std::string& option, const std::string& pattern);

  /// \param place of the input, from 1.
  std::string expand(const std::string& input, std::size_t place) const;

private:
  enum class Kind { Text, Name, Extension, Directory, Index };
  struct Part {
    Kind kind = Kind::Text;
    std::string text;
    std::size_t digits = 0;
  };

  std::vector<Part> parts_;
};

}  // namespace spherical_param::tools
