#pragma once

#include "spherical_param/finding.h"

#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// The findings of some inputs, or parts of one, and whether they are said. All are printed on the
/// standard error.
class Findings {
public:
  /// \param quiet     nothing is printed.
  /// \param strict    faults end the tool, see requireSoundness().
  /// \param has_page  there is a page that shows faults.
  Findings(bool quiet, bool strict, bool has_page)
      : quiet_(quiet), strict_(strict), has_page_(has_page) {}

  /// Adds those of an input, or of a part of it; `of` names it where there are several.
  void add(const std::string& of, const std::vector<Finding>& findings);
  /// Adds a fault of the input that no option deals with.
  void add(const std::string& text);

  /// Prints a line a finding; those that end the tool are left to that.
  void print() const;
  /// Ends the tool with exit code 3 if more than 1 % of the triangles intersect, and with -strict
  /// with 1 if there is a fault. To be called when all files are written. \throw ToolError
  void requireSoundness(std::size_t intersecting_triangles, std::size_t triangles) const;

private:
  struct Entry {
    std::string of;  ///< the inputs that it is true of; empty: the only one
    Finding finding;
  };

  std::string textOf(const Entry& entry) const;

  std::vector<Entry> entries_;
  bool quiet_;
  bool strict_;
  bool has_page_;
};

}  // namespace spherical_param::tools
