#include "common/file_formats.h"
#include "common/point_table.h"
#include "formats/formats.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

constexpr const char* name_columns = "name its columns, e.g. -columns x,y,z,-,red,green,blue";

/// How the cells of a line are separated.
struct TextStyle {
  char separator = ' ';  ///< ',' or ';'; ' ': blanks and tabs
  bool has_decimal_commas = false;
};

/// The line without its comment, which begins with '#', or with "//" or '%' before a word. Empty
/// for a comment alone, and for BEGIN and END around the points.
std::string_view withoutComment(std::string_view line) {
  line = trimmed(withoutRemark(line));
  constexpr std::size_t longest = 5;
  if (line.size() <= longest && (lowerCase(line) == "begin" || lowerCase(line) == "end")) {
    return {};
  }
  // After ';' the first cell may be empty.
  const bool is_empty_cell = line.rfind(';') > 0 && line.find_first_of("; ", 1) != 1;
  if ((line.substr(0, 1) == ";" && !is_empty_cell) || line.substr(0, 4) == "sep=") {
    return {};
  }
  for (std::size_t i = 0; (i = line.find_first_of("%/", i)) != std::string_view::npos; ++i) {
    const bool begins_word = i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t';
    if (begins_word && (line[i] == '%' || line.substr(i, 2) == "//")) {
      return trimmed(line.substr(0, i));
    }
  }
  return line;
}

/// Splits at a separator that is neither in quotes nor in brackets. Parts may be empty; the last
/// one only if `count` are expected.
void splitOutsideQuotes(std::string_view line, char separator, std::size_t count, Words& parts) {
  parts.clear();
  bool is_quoted = false;
  int brackets = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    const char c = i < line.size() ? line[i] : separator;
    is_quoted = is_quoted != (c == '"') && i < line.size();
    brackets += c == '[' || c == '(' ? 1 : c == ']' || c == ')' ? -1 : 0;
    if (i == line.size() || (c == separator && !is_quoted && brackets <= 0)) {
      parts.push_back(trimmed(line.substr(begin, i - begin), " \t\r\""));
      begin = i + 1;
    }
  }
  if (parts.back().empty() && parts.size() != count) {
    parts.pop_back();
  }
}

/// \param count of cells, 0 if it is not known.
void splitCells(std::string_view line, const TextStyle& style, std::size_t count, Words& cells) {
  line = style.separator == ';' ? line : line.substr(0, line.find(';'));  // a comment
  if (style.separator == ' ') {
    split(line, " \t\r", cells);
    return;
  }
  splitOutsideQuotes(line, style.separator, count, cells);
  if (style.separator == ',' && style.has_decimal_commas) {
    for (std::size_t c = 0; 2 * c + 1 < cells.size(); ++c) {
      const char* const begin = cells[2 * c].data();
      const std::string_view& end = cells[2 * c + 1];
      cells[c] = {begin, static_cast<std::size_t>(end.data() + end.size() - begin)};
    }
    cells.resize((cells.size() + 1) / 2);
  }
}

/// The names of a heading: in quotes, with units in brackets.
std::vector<std::string> namesOf(std::string_view line) {
  line = trimmed(line, " \t\r#%/!");
  line.remove_prefix(line.rfind(';') == 0 ? 1 : 0);
  Words names;
  for (const char separator : {';', ',', '\t', ' '}) {
    splitOutsideQuotes(line, separator, 0, names);
    if (names.size() > 1) {
      break;
    }
  }
  std::vector<std::string> result;
  for (const std::string_view name : names) {
    const bool is_unit = !name.empty() && (name[0] == '[' || name[0] == '(');
    if (!is_unit) {  // "X [mm]" between blanks is one name
      result.emplace_back(name);
    }
  }
  if (line.find_first_of(";,\t") == std::string_view::npos) {
    result.erase(std::remove(result.begin(), result.end(), ""), result.end());
  }
  return result;
}

/// The first lines of a file.
struct Beginning {
  Words lines;     ///< those with data, or a heading
  Words comments;  ///< before the first of them
};

Beginning firstLines(InputFile& file) {
  constexpr std::size_t max_bytes = std::size_t{1} << 16;
  Beginning beginning;
  std::string_view rest = withoutByteOrderMark(file.peek(max_bytes));
  if (rest.find('\n') == std::string_view::npos && rest.find('\r') < rest.size() - 1) {
    failReading(file.path(), "its lines do not end in LF",
                "convert it: tr '\\r' '\\n' < in.txt > out.txt");
  }
  if (rest.find('\0') != std::string_view::npos) {
    failReading(file.path(), "it is no text, or text in UTF-16",
                "convert it: iconv -f UTF-16 -t UTF-8 in.txt > out.txt");
  }
  const bool is_whole = file.size() < max_bytes;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos && !is_whole && !beginning.lines.empty()) {
      break;  // it is cut
    }
    const std::string_view line = trimmed(rest.substr(0, end));
    const std::string_view data = withoutComment(line);
    if (!data.empty()) {
      beginning.lines.push_back(data);
    } else if (beginning.lines.empty() && !line.empty()) {
      beginning.comments.push_back(line);
    }
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  return beginning;
}

/// Whether a line names columns: none of its words is a number.
bool isHeading(std::string_view line) {
  const Words words = split(line, " \t\r,;\"");
  return std::none_of(words.begin(), words.end(),
                      [](std::string_view word) { return toValue(word).has_value(); });
}

bool isCount(std::string_view line) {
  return toInteger(line).has_value();
}

/// The text behind the letter of a point, "p x y z"; nothing of lines that begin with d, g or s,
/// which such files have beside them. Other lines stay as they are.
std::string_view behindLetter(std::string_view line) {
  const bool has_letter = line.size() > 1 && (line[1] == ' ' || line[1] == '\t') &&
                          std::string_view("dgps").find(line[0]) != std::string_view::npos;
  return !has_letter ? line : line[0] == 'p' ? trimmed(line.substr(2)) : std::string_view();
}

/// Whether the first line has counts, that of the points first, and the others are numbered from 0
/// or 1 on, as in the .node files of TetGen.
bool areNumbered(const Words& lines) {
  constexpr std::size_t min_lines = 3;
  bool are_numbered = lines.size() >= min_lines;
  std::int64_t start = 0;
  for (std::size_t i = 0; i < lines.size() && are_numbered; ++i) {
    // Commas are decimal where others separate.
    const bool has_blanks = lines[1].find_first_of(" \t;") != std::string_view::npos;
    const Words words = split(lines[i], has_blanks ? " \t\r;" : ",");
    const std::int64_t first = words.empty() ? -1 : toInteger(words.front()).value_or(-1);
    start = i == 1 && first == 1 ? 1 : start;
    are_numbered = i == 0 ? first > 0 && std::all_of(words.begin(), words.end(), isCount)
                          : words.size() > 3 && first == start + static_cast<std::int64_t>(i) - 1;
  }
  return are_numbered;
}

/// \throw Failure if columns are of latitude and longitude instead of x, y and z.
void requireLengths(const InputFile& file, const std::vector<std::string>& names) {
  const auto is_degree = [](const std::string& name) {
    static const std::set<std::string> degrees = {"latitude", "longitude", "lat",
                                                  "lon",      "lng",       "long"};
    return degrees.count(commonName(name)) > 0;
  };
  if (std::count_if(names.begin(), names.end(), is_degree) >= 2 && !areCoordinatesNamed(names)) {
    failReading(file.path(), "its latitude and longitude are degrees, which are not lengths",
                "project them first, e.g. gdaltransform -s_srs EPSG:4326 -t_srs EPSG:32632");
  }
}

/// Removes the last name if it is that of a list, which rows may end with. \return whether it was
bool takeList(std::vector<std::string>& names) {
  const bool is_list = names.size() > 3 && (names.back().find("[]") != std::string::npos ||
                                            names.back().find("...") != std::string::npos);
  names.resize(names.size() - (is_list ? 1 : 0));
  return is_list;
}

/// How lines of data are separated. \param names of the columns, if they are known.
TextStyle styleOf(const InputFile& file, const Words& lines, std::size_t names) {
  const auto all = [&](const auto& is_so) {
    return std::all_of(lines.begin(), lines.end(), is_so);
  };
  const auto has = [](char c) {
    return [c](std::string_view line) { return line.find(c) != std::string_view::npos; };
  };
  const bool has_commas = std::any_of(lines.begin(), lines.end(), has(','));
  const bool has_semicolons = std::any_of(lines.begin(), lines.end(), [](std::string_view line) {
    return line.find(';') != line.rfind(';');
  });
  if (has_semicolons) {
    return {';', has_commas};
  }
  const auto is_in_words = [](std::string_view line) {
    const Words words = split(line, " \t\r");
    return words.size() >= 3 && std::all_of(words.begin(), words.begin() + 3, [](auto word) {
             return word.back() != ',' && toValue(word);
           });
  };
  if (!has_commas || all(is_in_words)) {
    return {' ', has_commas};
  }
  // Commas separate; whole numbers may be the halves of numbers with decimal commas.
  Words cells;
  const auto are_pairs = [&](std::string_view line) {
    splitCells(line, {','}, 0, cells);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string_view signs = c % 2 == 0 ? "+-" : "";
      if (trimmed(cells[c], signs).find_first_not_of("0123456789") != std::string_view::npos) {
        return false;
      }
    }
    return cells.size() >= 6 && cells.size() % 2 == 0 && (names == 0 || cells.size() == 2 * names);
  };
  const bool are_all_pairs = all(are_pairs);
  if (are_all_pairs && names == 0) {
    failReading(file.path(), "its commas separate columns, or they are decimal",
                "if they are decimal, give -columns x,y,z; else -columns x,y,z,-,-,-");
  }
  return {',', are_all_pairs};
}

/// What a text file has.
struct TextLayout {
  TextStyle style;
  std::vector<std::string> names;  ///< of columns; empty: not said
  bool are_given = false;          ///< by the caller
  bool has_heading = false;        ///< before the points
  bool has_counts = false;         ///< of points, before them
  std::int64_t numbered = 0;       ///< points by the first line, if areNumbered(); else 0
  bool has_letters = false;        ///< each line begins with a letter, those of points with p
  bool has_lists = false;          ///< rows go on behind the columns
};

TextLayout layoutOf(InputFile& file, const std::vector<std::string>& given) {
  const Beginning beginning = firstLines(file);
  TextLayout layout;
  layout.names = given;
  layout.are_given = !given.empty();
  Words lines = beginning.lines;
  layout.has_letters =
      !layout.are_given && std::all_of(lines.begin(), lines.end(), [](std::string_view line) {
        return behindLetter(line).size() < line.size();
      });
  if (layout.has_letters) {
    std::transform(lines.begin(), lines.end(), lines.begin(), behindLetter);
    lines.erase(std::remove(lines.begin(), lines.end(), ""), lines.end());
  }
  if (areNumbered(lines)) {
    const Words counts = split(lines.front(), " \t\r,;");
    layout.numbered = toInteger(counts.front()).value_or(0);
    if (!layout.are_given && counts.size() > 1 && counts[1] == "2") {
      failReading(file.path(), "its points have two dimensions, as its first line says",
                  name_columns);
    }
    lines.erase(lines.begin());
  }
  while (!lines.empty() && ((!layout.has_counts && isCount(lines.front())) ||
                            (!layout.has_heading && isHeading(lines.front())))) {
    (isCount(lines.front()) ? layout.has_counts : layout.has_heading) = true;
    if (!isCount(lines.front()) && !layout.are_given) {
      layout.names = namesOf(lines.front());
      layout.has_lists = takeList(layout.names);
    }
    lines.erase(lines.begin());
  }
  requireLengths(file, layout.names);
  if (layout.has_heading && !areCoordinatesNamed(layout.names)) {
    failReading(file.path(), "line 1 neither begins with three numbers nor names x, y and z",
                name_columns);
  }
  if (lines.empty()) {
    failContent(file.path(), "it has no points");
  }
  if (isCount(lines.front())) {
    failReading(file.path(), "it begins with two numbers of points, as PTX files do",
                "convert it to PLY with CloudCompare");
  }
  for (auto comment = beginning.comments.rbegin();
       layout.names.empty() && comment != beginning.comments.rend(); ++comment) {
    std::vector<std::string> names = namesOf(*comment);
    const bool has_lists = takeList(names);
    if (names.size() < 3) {
      continue;
    }
    Words cells;
    splitCells(lines.front(), styleOf(file, lines, names.size()), names.size(), cells);
    if (names.size() == cells.size() || (has_lists && names.size() < cells.size())) {
      requireLengths(file, names);
      // "North, east, elevation" may be prose.
      const bool has_x = std::any_of(names.begin(), names.end(),
                                     [](const auto& name) { return commonName(name) == "x"; });
      if (has_x && areCoordinatesNamed(names)) {
        layout.names = names;
        layout.has_lists = has_lists;
      }
    }
  }
  layout.style = styleOf(file, lines, layout.names.size());
  const std::string extension = extensionOf(file.path());
  Words cells;
  splitCells(lines.front(), layout.style, 0, cells);
  if (layout.names.empty() && cells.size() == 6 && extension == ".xyzn") {
    layout.names = {"x", "y", "z", "nx", "ny", "nz"};
  } else if (layout.names.empty() && cells.size() == 6 && extension == ".xyzrgb") {
    layout.names = {"x", "y", "z", "red", "green", "blue"};
  } else if (layout.names.empty() && layout.numbered > 0) {
    layout.names = {"-", "x", "y", "z"};
    layout.names.resize(std::max(cells.size(), layout.names.size()), "-");
  }
  return layout;
}

/// \throw Failure for what is wrong with the last line that was taken.
[[noreturn]] void failRow(const InputFile& file, const std::string& reason) {
  failReading(file.path(), "line " + std::to_string(file.lineNumber()) + " has " + reason,
              "correct it, or " + std::string(name_columns));
}

/// The columns of a file without their values. Those that are left out have the name "-".
///
/// \param cells of the first row.
std::vector<PointColumn> columnsOf(const std::string& path, const TextLayout& layout,
                                   const Words& cells) {
  const std::vector<std::string>& names = layout.names;
  std::vector<PointColumn> columns(names.empty() ? std::max<std::size_t>(cells.size(), 3)
                                                 : names.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c].name = !names.empty() ? names[c] : c < 3 ? std::string(1, "xyz"[c]) : "";
  }
  const std::vector<PointColumn*> coordinates = findColumns(columns, {"x", "y", "z"});
  for (std::size_t d = 0; d < coordinates.size(); ++d) {
    coordinates[d]->name = "xyz"[d];
  }
  const std::size_t lines = countLines(path, "");
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool is_word = c < cells.size() && !cells[c].empty() && !toValue(cells[c]);
    if (is_word && std::count(coordinates.begin(), coordinates.end(), &columns[c]) == 0) {
      columns[c].name = "-";
    }
    columns[c].values.reserve(columns[c].name == "-" ? 0 : lines);
  }
  return columns;
}

/// Adds a row to the columns. \throw Failure if it has other cells.
void addRow(const InputFile& file, const TextLayout& layout, const Words& cells,
            std::vector<PointColumn>& columns) {
  const bool may_go_on = layout.are_given || layout.has_lists;
  if (cells.size() < columns.size() || (cells.size() > columns.size() && !may_go_on)) {
    failRow(file,
            counted(cells.size(), "column") + " instead of " + std::to_string(columns.size()));
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].name == "-") {
      continue;
    }
    const std::optional<double> value =
        cells[c].empty() ? std::numeric_limits<double>::quiet_NaN() : toValue(cells[c]);
    if (!value) {
      failRow(file, "no number in column " + std::to_string(c + 1) + ", but " + inQuotes(cells[c]));
    }
    columns[c].values.push_back(*value);
  }
}

/// Names of three columns by what is in them: colours are whole numbers of 0 to 255 that are not
/// all 0, normals have length 1, or are all 0. \return empty if they are neither
std::vector<std::string> namesOfThree(const std::vector<PointColumn>& columns, std::size_t first) {
  bool are_normals = true;
  bool are_colors = true;
  for (std::size_t i = 0; i < columns[0].values.size() && (are_normals || are_colors); ++i) {
    std::array<double, 3> values{};
    for (std::size_t d = 0; d < 3; ++d) {
      const std::vector<double>& column = columns[first + d].values;
      values[d] = i < column.size() ? column[i] : -1.0;
      are_colors = are_colors && values[d] >= 0.0 && values[d] <= 255.0 &&
                   values[d] == std::floor(values[d]);
    }
    // Files with 3 digits are common: their normals have unit length to about that.
    const double length = std::hypot(values[0], values[1], values[2]);
    are_normals = are_normals && (std::abs(length - 1.0) < 5e-3 || length == 0.0);
  }
  if (are_normals) {
    return {"nx", "ny", "nz"};
  }
  return are_colors ? std::vector<std::string>{"red", "green", "blue"} : std::vector<std::string>();
}

/// Names the columns behind x, y and z if nothing else does: groups of three are colours or
/// normals. An intensity may stand before, between or behind them, wherever most groups fit.
void nameFurther(std::vector<PointColumn>& columns) {
  const std::size_t end = columns.size();
  std::map<std::size_t, std::string> best;
  for (std::size_t intensity = end % 3 == 1 ? 3 : end; intensity <= end; intensity += 3) {
    std::map<std::size_t, std::string> names;
    for (std::size_t c = 3; c + 3 <= end; c += c == intensity ? 1 : 3) {
      const auto three = c == intensity ? std::vector<std::string>() : namesOfThree(columns, c);
      for (std::size_t d = 0; d < three.size(); ++d) {
        names[c + d] = three[d];
      }
    }
    if (intensity < end && (!names.empty() || end == 4)) {
      names[intensity] = "intensity";
    }
    if (names.size() > best.size()) {
      best = std::move(names);
    }
  }
  for (const auto& [c, name] : best) {
    columns[c].name = name;
    columns[c].is_byte = name == "red" || name == "green" || name == "blue";
  }
}

/// Whether a column counts the lines.
bool isCounter(const std::vector<double>& values) {
  const auto is_other = [](double value, double next) { return next != value + 1.0; };
  return values.size() >= 4 && values[0] == std::floor(values[0]) &&
         std::adjacent_find(values.begin(), values.end(), is_other) == values.end();
}

std::string describe(const std::vector<PointColumn>& columns, const TextLayout& layout) {
  const TextStyle& style = layout.style;
  std::string names;
  for (const PointColumn& column : columns) {
    names += " " + (column.name.empty() ? "-" : commonName(column.name));
  }
  const char c = style.separator;
  return "text, " + counted(columns.size(), "column") + ":" + names + ", separated by " +
         (c == ','   ? "commas"
          : c == ';' ? "semicolons"
                     : "blanks") +
         (style.has_decimal_commas ? ", with decimal commas" : "") +
         (layout.has_lists ? "; the rest of each row is not read" : "") +
         (layout.has_letters ? "; lines without p are not read" : "");
}

}  // namespace

/// Plain text: a line a point, with the columns that a heading, a comment before the points, or the
/// caller names; else x y z, and what nameFurther() finds. Blanks, tabs, commas or semicolons
/// separate; decimal commas are seen. The first line may be the number of points; if it is, and the
/// first column counts them, that is left out. Of lines that all begin with d, g, p or s, those
/// with p are points.
PointData readText(InputFile& file, const std::vector<std::string>& given) {
  const TextLayout layout = layoutOf(file, given);
  std::vector<PointColumn> columns;
  Words cells;
  const bool is_numbered = layout.numbered > 0;
  auto announced = static_cast<double>(layout.numbered);
  double count = 0.0;
  bool is_first = layout.has_heading || is_numbered;  // a heading, or counts
  for (std::string_view line; file.nextLine(line);) {
    line = withoutComment(line);
    line = layout.has_letters ? behindLetter(line) : line;
    if (line.empty()) {
      continue;
    }
    if (layout.has_counts && isCount(line)) {
      announced += static_cast<double>(*toInteger(line));
    } else if (!std::exchange(is_first, false)) {
      splitCells(line, layout.style, columns.empty() ? layout.names.size() : columns.size(), cells);
      if (columns.empty()) {
        columns = columnsOf(file.path(), layout, cells);
      }
      addRow(file, layout, cells, columns);
      count += 1.0;
    }
  }
  if (count < announced || (is_numbered && count > announced)) {
    failContent(file.path(), std::string("it has ") + (count < announced ? "fewer" : "more") +
                                 " points than its first line says");
  }
  if (layout.names.empty()) {
    if (columns.size() > 3 && isCounter(columns[0].values)) {
      failReading(file.path(), "its first column counts the lines, or it is x",
                  "name its columns: -columns -,x,y,z or -columns x,y,z");
    }
    nameFurther(columns);
  }
  for (PointColumn& column : columns) {
    column.name = column.values.empty() ? "" : column.name;
  }
  const std::string contents = describe(columns, layout);
  PointData points = toPoints(std::move(columns));
  points.contents = contents;
  return points;
}

}  // namespace spherical_param::tools
