#include "spherical_param/option_table.h"
#include "spherical_param/reconstruct.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace spherical_param {
namespace {

std::string conditionsOf(const OptionRow& row) {
  std::string text;
  for (const auto& [option, values] : row.used_with) {
    text += (text.empty() ? "; with " : " and ") + option;
    for (const std::string& value : values)
      text += (value == values.front() ? " " : " or ") + value;
  }
  return text;
}

/// The table of doc/guide.md: those of experts come last.
std::string optionPage() {
  std::string text = "| option | field of `Options` | meaning | range | default |\n"
                     "|---|---|---|---|---|\n";
  for (const bool expert : {false, true})
    for (const OptionRow& row : optionTable())
      if (row.expert == expert)
        text += "| `" + row.name + "`" + (expert ? " (expert)" : "") + " | `" + row.field + "` | " +
                row.help + conditionsOf(row) + " | " + rangeOf(row) + " | " +
                textOf(row.get(Options())) + " |\n";
  return text;
}

TEST(OptionPage, IsThatOfTheTable) {
  std::ifstream file(OPTION_PAGE);
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find(optionPage()), std::string::npos)
      << "replace the table in doc/guide.md by\n\n"
      << optionPage();
}

}  // namespace
}  // namespace spherical_param
