#pragma once

#include "spherical_param/result.h"

#include <string>
#include <vector>

namespace spherical_param::tools {

/// The findings of some inputs, or parts of one, and whether they are said. All are printed on the
/// standard error.
class Findings {
public:
  /// \param quiet         nothing is printed.
  /// \param strict        faults end the tool, see requireSoundness().
  /// \param suggests_page the tool makes a page that would show faults, and is not asked to.
  Findings(bool quiet, bool strict, bool suggests_page)
      : quiet_(quiet), strict_(strict), suggests_page_(suggests_page) {}

  /// Adds those of an input, or of a part of it; `of` names it where there are several.
  void add(const std::string& of, const std::vector<Finding>& findings);
  /// Adds a failure that is no finding of the library, and counts as a fault.
  void add(const std::string& failure);

  /// Prints a line a finding, except those that end the tool.
  void print() const;
  /// Ends the tool with exit code 3 if a mesh is not usable, and with -strict with 1 if there is a
  /// fault. To be called when all files are written. \throw ToolError
  void requireSoundness(bool is_usable) const;

private:
  struct Entry {
    std::string of;  ///< the inputs that it is true of; empty: the only one
    Finding finding;
    bool is_failure = false;
  };

  std::string textOf(const Entry& entry) const;

  std::vector<Entry> entries_;
  bool quiet_;
  bool strict_;
  bool suggests_page_;
};

}  // namespace spherical_param::tools
