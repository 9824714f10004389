#include "common/findings.h"

#include "common/errors.h"
#include "common/text.h"

#include <algorithm>
#include <cstdio>

namespace spherical_param::tools {

void Findings::add(const std::string& of, const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    // What is true of several parts is said once.
    const auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return entry.finding.text == finding.text && entry.finding.value == finding.value &&
             entry.finding.is_consequence == finding.is_consequence;
    });
    if (same == entries_.end()) {
      entries_.push_back({of, finding});
    } else {
      same->of += ", " + of;
    }
  }
}

void Findings::add(const std::string& failure) {
  entries_.push_back({"", {failure, "", "", true}, true});
}

std::string Findings::textOf(const Entry& entry) const {
  const auto& [text, option, value, is_fault, is_consequence] = entry.finding;
  std::string line = (entry.of.empty() ? "" : entry.of + ": ") + text;
  if (!option.empty()) {
    std::string flag = option;
    std::replace(flag.begin(), flag.end(), '_', '-');
    line += ": try -" + flag + " " + value;
  } else if (is_fault && suggests_page_ && !entry.is_failure) {
    line += ": try -report report.html to see where";
  }
  return oneLine(line);
}

void Findings::print() const {
  if (quiet_) {
    return;
  }
  std::fflush(stdout);
  constexpr std::size_t most_printed = 12;
  std::size_t count = 0;
  for (const Entry& entry : entries_) {
    if (!entry.finding.is_consequence && (!strict_ || !entry.finding.is_fault) &&
        ++count <= most_printed) {
      std::fprintf(stderr, "warning: %s\n", textOf(entry).c_str());
    }
  }
  if (count > most_printed) {
    std::fprintf(stderr, "warning: %zu more, which -json lists\n", count - most_printed);
  }
}

void Findings::requireSoundness(bool is_usable) const {
  std::string faults;
  for (const Entry& entry : entries_) {
    if (entry.finding.is_fault) {
      faults += (faults.empty() ? "" : "; ") + textOf(entry);
    }
  }
  if (strict_ && !faults.empty()) {
    throw ToolError(is_usable ? ExitCode::Failed : ExitCode::NotUsable, faults,
                    "the files were written; look at them, or leave out -strict");
  }
  if (!is_usable) {
    throw ToolError(
        ExitCode::NotUsable,
        "the mesh was written but is not usable: more than 1 % of its triangles intersect",
        "follow the warnings, or crop the cloud to the object");
  }
}

}  // namespace spherical_param::tools
