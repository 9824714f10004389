#include "spherical_param/option_table.h"

#include "spherical_param/errors.h"

#include <algorithm>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

constexpr double kMaxInt = std::numeric_limits<int>::max();

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};

enum Audience { Everybody, Expert };

template <typename Value>
OptionValue valueOf(const Value& value) {
  if constexpr (IsOptional<Value>::value)
    return value ? valueOf(*value) : OptionValue();
  else if constexpr (std::is_integral_v<Value>)
    return static_cast<std::int64_t>(value);
  else
    return value;
}

template <typename Value>
void assign(Value& field, const OptionValue& value) {
  if constexpr (IsOptional<Value>::value) {
    if (value.index() == 0)
      field.reset();
    else
      assign(field.emplace(), value);
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    field = static_cast<Value>(*integer);
  } else {
    field = static_cast<Value>(std::get<double>(value));
  }
}

/// A member of Options, or of one of its members, as a reference.
template <typename Member>
auto memberOf(Member member) {
  return [member](auto& options) -> decltype(auto) { return (options.*member); };
}
template <typename Group, typename Member>
auto memberOf(Group group, Member member) {
  return [group, member](auto& options) -> decltype(auto) { return (options.*group.*member); };
}

/// A row whose name is the last part of its field's path.
OptionRow rowOf(const std::string& path, const char* help, Audience audience) {
  OptionRow row;
  row.name = path.substr(path.rfind('.') + 1);
  row.field = path;
  row.help = help;
  row.expert = audience == Expert;
  return row;
}

/// The row of a number.
///
/// \param members as of memberOf().
template <typename... Members>
OptionRow number(const char* path, const char* help, Audience audience, double min, double max,
                 Members... members) {
  const auto field = memberOf(members...);
  using Value = std::decay_t<decltype(field(std::declval<Options&>()))>;
  OptionRow row = rowOf(path, help, audience);
  row.optional = IsOptional<Value>::value;
  row.is_number = true;
  row.min = min;
  row.max = max;
  row.is_integer = !std::is_same_v<Value, double> && !std::is_same_v<Value, std::optional<double>>;
  row.get = [field](const Options& options) { return valueOf(field(options)); };
  row.set = [field](Options& options, const OptionValue& value) { assign(field(options), value); };
  return row;
}

/// The row of an enumeration.
template <typename Enum, typename... Members>
OptionRow choice(const char* path, const char* help, Audience audience,
                 const std::vector<std::pair<const char*, Enum>>& names, Members... members) {
  const auto field = memberOf(members...);
  OptionRow row = rowOf(path, help, audience);
  for (const auto& entry : names)
    row.choices.emplace_back(entry.first);
  row.get = [field, names](const Options& options) -> OptionValue {
    const auto found = std::find_if(names.begin(), names.end(), [&](const auto& entry) {
      return entry.second == field(options);
    });
    return found == names.end() ? OptionValue() : OptionValue(std::string(found->first));
  };
  row.set = [field, names](Options& options, const OptionValue& value) {
    for (const auto& entry : names)
      if (entry.first == std::get<std::string>(value))
        field(options) = entry.second;
  };
  return row;
}

OptionRow aboveMin(OptionRow row) {
  row.min_excluded = true;
  return row;
}

OptionRow usedWith(const char* option, std::vector<std::string> values, OptionRow row) {
  row.used_with.emplace_back(option, std::move(values));
  return row;
}

/// The row of an option of Method::Default alone.
OptionRow byDefault(OptionRow row) {
  return usedWith("method", {"default"}, std::move(row));
}

/// The row of outliers: a number is the sigma of OutlierMode::Deviation.
OptionRow outlierRow() {
  const char* const help =
      "outliers to leave out: stray points (auto), or points off the surface by this number of "
      "standard deviations";
  const OptionRow names = choice<OutlierMode>("outliers", help, Everybody,
                                              {{"topology", OutlierMode::AsTopology},
                                               {"none", OutlierMode::None},
                                               {"auto", OutlierMode::Auto}},
                                              &Options::outliers);
  OptionRow row = number("outliers", help, Everybody, 0, 1000, &Options::outlier_sigma);
  row.choices = names.choices;
  row.get = [name_of = names.get](const Options& options) {
    return options.outliers == OutlierMode::Deviation ? options.outlier_sigma : name_of(options);
  };
  row.set = [set_name = names.set](Options& options, const OptionValue& value) {
    if (std::holds_alternative<std::string>(value))
      return set_name(options, value);
    options.outliers = OutlierMode::Deviation;
    assign(options.outlier_sigma, value);
  };
  return row;
}

/// The row of the view: a point is the place of ViewMode::Place.
OptionRow viewRow() {
  OptionRow row = byDefault(choice<ViewMode>(
      "view",
      "where the cloud is seen from as one layer: found (auto), from above (up), or a place",
      Everybody, {{"auto", ViewMode::Auto}, {"none", ViewMode::None}, {"up", ViewMode::Up}},
      &Options::view));
  row.is_point = true;
  row.get = [name_of = row.get](const Options& options) -> OptionValue {
    if (options.view != ViewMode::Place)
      return name_of(options);
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(std::numeric_limits<double>::max_digits10);
    text << options.viewpoint.x() << ',' << options.viewpoint.y() << ',' << options.viewpoint.z();
    return text.str();
  };
  row.set = [set_name = row.set](Options& options, const OptionValue& value) {
    if (const auto place = toPoint(std::get<std::string>(value))) {
      options.view = ViewMode::Place;
      options.viewpoint = *place;
    } else {
      set_name(options, value);
    }
  };
  return row;
}

std::vector<OptionRow> pointRows() {
  return {
      byDefault(choice<TopologyMode>(
          "topology",
          "topology of the mesh: what the cloud shows (parts, openings, handles, without stray "
          "points), or one sphere through every point",
          Everybody, {{"scan", TopologyMode::Scan}, {"sphere", TopologyMode::Sphere}},
          &Options::topology)),
      viewRow(),
      outlierRow(),
      choice<PartsMode>(
          "parts",
          "parts of the cloud to mesh: all as one surface, the largest alone, or each by itself",
          Everybody,
          {{"topology", PartsMode::AsTopology},
           {"all", PartsMode::All},
           {"largest", PartsMode::Largest},
           {"each", PartsMode::Each}},
          &Options::parts),
      usedWith("parts", {"largest", "each"},
               number("min_points",
                      "minimum number of points of a part; smaller parts are left out", Expert, 4,
                      kMaxInt, &Options::min_points)),
      choice<ConsolidationMode>("consolidation",
                                "move points to the sampled surface, and merge them within their "
                                "noise; topology: those of "
                                "noisy parts of a scan",
                                Everybody,
                                {{"topology", ConsolidationMode::AsTopology},
                                 {"none", ConsolidationMode::None},
                                 {"auto", ConsolidationMode::Auto}},
                                &Options::consolidation),
  };
}

std::vector<OptionRow> methodRows() {
  const auto of_paper = [](OptionRow row) { return usedWith("method", {"paper"}, std::move(row)); };
  return {
      choice<Method>("method", "how the cloud is meshed; paper: as published in 2004", Expert,
                     {{"default", Method::Default}, {"paper", Method::Paper}}, &Options::method),
      of_paper(number("paper.k", "nearest neighbours of each point", Expert, 3, kMaxInt,
                      &Options::paper, &PaperOptions::k)),
      of_paper(choice<EdgeWeights>("paper.weights", "weights of the Laplacian", Expert,
                                   {{"adaptive", EdgeWeights::Adaptive},
                                    {"inverse", EdgeWeights::InverseLength},
                                    {"uniform", EdgeWeights::Uniform}},
                                   &Options::paper, &PaperOptions::weights)),
      of_paper(aboveMin(number("paper.damping", "damping of the iteration", Expert, 0, 1,
                               &Options::paper, &PaperOptions::damping))),
      of_paper(number("paper.max_iterations", "maximum number of iterations", Expert, 0, kMaxInt,
                      &Options::paper, &PaperOptions::max_iterations)),
      number("embedding.tolerance",
             "mean tangential Laplacian at convergence; unset: 1e-8 for paper, else none", Expert,
             0, 1, &Options::embedding, &EmbeddingOptions::tolerance),
      number("smoothing", "steps of smoothing; 0: none", Everybody, 0, 10000, &Options::smoothing),
  };
}

std::vector<OptionRow> surfaceRows() {
  return {
      byDefault(choice<SurfaceMode>(
          "surface", "openings are filled, left open, or left open if certain (auto)", Everybody,
          {{"topology", SurfaceMode::AsTopology},
           {"closed", SurfaceMode::Closed},
           {"open", SurfaceMode::Open},
           {"auto", SurfaceMode::Auto}},
          &Options::surface)),
      byDefault(number("fill_holes", "openings of up to this number of edges are filled", Expert, 0,
                       kMaxInt, &Options::fill_holes)),
      byDefault(choice<FillMode>(
          "fill",
          "smooth: vertices are added in filled openings, which go on as the surface around does",
          Everybody, {{"flat", FillMode::Flat}, {"smooth", FillMode::Smooth}}, &Options::fill)),
      byDefault(choice<HandleMode>(
          "handles",
          "handles of the surface that the mesh has: those that are certain (auto), or none",
          Everybody,
          {{"topology", HandleMode::AsTopology},
           {"none", HandleMode::None},
           {"auto", HandleMode::Auto}},
          &Options::handles)),
      byDefault(choice<IntersectionMode>("intersections",
                                         "triangles that intersect are taken apart, if need be "
                                         "by leaving out triangles and points, or kept; a surface "
                                         "without openings stays closed with auto",
                                         Everybody,
                                         {{"topology", IntersectionMode::AsTopology},
                                          {"auto", IntersectionMode::Auto},
                                          {"remove", IntersectionMode::Remove},
                                          {"keep", IntersectionMode::Keep}},
                                         &Options::intersections)),
  };
}

std::vector<OptionRow> runRows() {
  return {
      number("seed", "seed of all random choices", Expert, 0,
             std::numeric_limits<std::uint32_t>::max(), &Options::seed),
      byDefault(number("time_limit",
                       "seconds until the work ends with the best mesh so far; 0: with the first; "
                       "unset: no limit",
                       Everybody, 0, 1e9, &Options::time_limit)),
      number("threads", "threads; 0: one for each processor", Expert, 0, 1024, &Options::threads),
  };
}

[[noreturn]] void refuse(const OptionRow& row, const std::string& what) {
  throw InvalidInput(row.name + " " + what + "; use " + rangeOf(row));
}

void checkValue(const OptionRow& row, const OptionValue& value) {
  const std::string given = "= " + textOf(value);
  if (value.index() == 0) {
    if (!row.optional)
      refuse(row, "has no value");
    return;
  }
  const auto* name = std::get_if<std::string>(&value);
  if (name != nullptr || !row.is_number) {
    const bool is_known = name != nullptr && (std::find(row.choices.begin(), row.choices.end(),
                                                        *name) != row.choices.end() ||
                                              (row.is_point && toPoint(*name)));
    if (!is_known)
      refuse(row, given + (row.choices.empty() ? " is not a number" : " is not known"));
    return;
  }
  double number = 0.0;
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    number = static_cast<double>(*integer);
  else if (const auto* real = std::get_if<double>(&value); real != nullptr && !row.is_integer)
    number = *real;
  else
    refuse(row, given + (row.is_integer ? " is not an integer" : " is not a number"));
  if (!(number >= row.min && number <= row.max) || (row.min_excluded && number == row.min))
    refuse(row, given + " is out of range");
}

}  // namespace

const std::vector<OptionRow>& optionTable() {
  static const std::vector<OptionRow> table = [] {
    std::vector<OptionRow> all;
    for (const auto& rows : {pointRows(), methodRows(), surfaceRows(), runRows()})
      all.insert(all.end(), rows.begin(), rows.end());
    return all;
  }();
  return table;
}

const OptionRow& findOption(const std::string& name) {
  std::string names;
  for (const OptionRow& row : optionTable()) {
    if (row.name == name)
      return row;
    names += (names.empty() ? "" : ", ") + row.name;
  }
  throw InvalidInput("unknown option '" + name + "'; use one of " + names);
}

void setOption(Options& options, const std::string& name, const OptionValue& value) {
  const OptionRow& row = findOption(name);
  checkValue(row, value);
  row.set(options, value);
}

std::string rangeOf(const OptionRow& row) {
  std::vector<std::string> ranges = row.choices;
  if (row.is_number) {
    std::ostringstream text;
    text.precision(10);
    text << (row.is_integer ? "an integer " : "a number ")
         << (row.min_excluded ? "above " : "from ") << row.min;
    if (row.max < kMaxInt)
      text << (row.min_excluded ? " and up to " : " to ") << row.max;
    else if (!row.min_excluded)
      text << " up";
    ranges.push_back(text.str());
  }
  if (row.is_point)
    ranges.emplace_back("x,y,z");
  std::string text;
  for (std::size_t i = 0; i < ranges.size(); ++i)
    text += (i == 0 ? "" : i + 1 < ranges.size() ? ", " : " or ") + ranges[i];
  return text;
}

std::optional<Eigen::Vector3d> toPoint(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  Eigen::Vector3d point;
  for (int k = 0; k < 3; ++k) {
    stream >> point[k];
    if (k < 2 && stream.get() != ',')
      return std::nullopt;
  }
  const bool is_point =
      stream && stream.peek() == std::istringstream::traits_type::eof() && point.allFinite();
  return is_point ? std::optional<Eigen::Vector3d>(point) : std::nullopt;
}

std::string textOf(const OptionValue& value) {
  std::ostringstream text;
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    text << *integer;
  else if (const auto* real = std::get_if<double>(&value))
    text << *real;
  else if (const auto* name = std::get_if<std::string>(&value))
    text << *name;
  else
    text << "unset";
  return text.str();
}

Options withTopology(Options options) {
  const bool is_scan = options.topology == TopologyMode::Scan && options.method == Method::Default;
  const auto resolve = [&](auto& mode, auto of_scan, auto of_sphere) {
    if (mode == decltype(of_scan)::AsTopology)
      mode = is_scan ? of_scan : of_sphere;
  };
  if (!is_scan && (options.view == ViewMode::Auto || options.method == Method::Paper))
    options.view = ViewMode::None;
  // For a scan it stays AsTopology: the noise of each part decides.
  if ((!is_scan || options.smoothing > 0) && options.consolidation == ConsolidationMode::AsTopology)
    options.consolidation = ConsolidationMode::None;
  resolve(options.outliers, OutlierMode::Auto, OutlierMode::None);
  resolve(options.parts, PartsMode::Each, PartsMode::All);
  resolve(options.surface, SurfaceMode::Auto, SurfaceMode::Closed);
  // A surface that is seen from one place has no handles.
  const bool is_seen = options.view == ViewMode::Up || options.view == ViewMode::Place;
  resolve(options.handles, is_seen ? HandleMode::None : HandleMode::Auto, HandleMode::None);
  resolve(options.intersections, IntersectionMode::Auto, IntersectionMode::Keep);
  return options;
}

void checkOptions(const Options& options) {
  for (const OptionRow& row : optionTable())
    checkValue(row, row.get(options));
}

}  // namespace spherical_param
