#include "common/name_pattern.h"

#include "common/errors.h"
#include "common/numbers.h"
#include "common/text.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace spherical_param::tools {
namespace {

constexpr std::string_view index_prefix = "index:";

[[noreturn]] void refuse(const std::string& option, const std::string& placeholder) {
  throw UsageError("option -" + option + ": " + inQuotes(placeholder) + " stands for nothing",
                   "use {name}, {dir}, {ext}, {index} or {index:4}, and {{ for a brace");
}

std::string padded(std::size_t number, std::size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

}  // namespace

NamePattern::NamePattern(const std::string& option, const std::string& pattern) {
  if (pattern.empty()) {
    throw UsageError("option -" + option + ": the pattern is empty",
                     "give names with {name} in them, such as meshes/{name}.ply");
  }
  std::string text;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] != '{') {
      text += pattern[i];
      continue;
    }
    if (pattern.compare(i, 2, "{{") == 0) {
      text += '{';
      ++i;
      continue;
    }
    const std::size_t end = pattern.find('}', i);
    const std::string placeholder = pattern.substr(i, end == std::string::npos ? end : end + 1 - i);
    if (end == std::string::npos) {
      refuse(option, placeholder);
    }
    const std::string name = pattern.substr(i + 1, end - i - 1);
    Part part;
    if (name == "name") {
      part.kind = Kind::Name;
    } else if (name == "ext") {
      part.kind = Kind::Extension;
    } else if (name == "dir") {
      part.kind = Kind::Directory;
    } else if (name == "index") {
      part.kind = Kind::Index;
    } else if (name.compare(0, index_prefix.size(), index_prefix) == 0) {
      const std::optional<std::int64_t> digits =
          toInteger(std::string_view(name).substr(index_prefix.size()));
      if (!digits || *digits < 1 || *digits > 9) {
        refuse(option, placeholder);
      }
      part.kind = Kind::Index;
      part.digits = static_cast<std::size_t>(*digits);
    } else {
      refuse(option, placeholder);
    }
    parts_.push_back({Kind::Text, text, 0});
    parts_.push_back(part);
    text.clear();
    i = end;
  }
  parts_.push_back({Kind::Text, text, 0});
}

std::string NamePattern::expand(const std::string& input, std::size_t place) const {
  const std::filesystem::path path(input);
  std::string name;
  for (const Part& part : parts_) {
    switch (part.kind) {
    case Kind::Text:
      name += part.text;
      break;
    case Kind::Name:
      name += path.stem().string();
      break;
    case Kind::Extension: {
      const std::string extension = path.extension().string();
      name += extension.empty() ? extension : extension.substr(1);
      break;
    }
    case Kind::Directory: {
      const std::string directory = path.parent_path().string();
      name += directory.empty() ? "." : directory;
      break;
    }
    case Kind::Index:
      name += padded(place, part.digits);
      break;
    }
  }
  return name;
}

}  // namespace spherical_param::tools
