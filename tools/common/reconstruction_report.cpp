#include "common/reconstruction_report.h"

#include "common/text.h"
#include "spherical_param/result_fields.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

namespace spherical_param::tools {
namespace {

/// Whether values of a kind are left out: they are large, or mean nothing without others.
bool isLeftOut(FieldKind kind) {
  return kind == FieldKind::PerVertex || kind == FieldKind::PerTriangle ||
         kind == FieldKind::PerInput || kind == FieldKind::CppOnly;
}

/// Turns what belongs to a surface into JSON.
class Writer {
public:
  /// \param surface nothing: what is written has no vertices.
  explicit Writer(const Surface* surface = nullptr) : surface_(surface) {}

  template <typename Struct>
  Json fieldsOf(const Struct& self) const {
    Json json = Json::object();
    visitFields(&self, [&](const ResultField& field, auto access) {
      if (isLeftOut(field.kind)) {
        return;
      }
      const auto& value = std::invoke(access, self);
      if constexpr (std::is_same_v<std::decay_t<decltype(value)>, MeshTopology>) {
        json.update(fieldsOf(value));
      } else {
        json[field.name] = toJson(field, value);
      }
    });
    return json;
  }

  template <typename Value>
  Json toJson(const ResultField& field, const Value& value) const {
    constexpr const Value* type = nullptr;
    if (field.kind == FieldKind::OfSolid && !(surface_ != nullptr && surface_->hasVolume())) {
      return nullptr;
    }
    if constexpr (isDescribed(type)) {
      return fieldsOf(value);
    } else if constexpr (std::is_enum_v<Value>) {
      return nameOf(value);
    } else if constexpr (std::is_base_of_v<Eigen::DenseBase<Value>, Value>) {
      return rowsOf(value);
    } else {
      return value;
    }
  }

  template <typename Struct>
  Json toJson(const ResultField& field, const Struct* value) const {
    return value == nullptr ? Json(nullptr) : toJson(field, *value);
  }

  template <typename Value>
  Json toJson(const ResultField& field, const std::optional<Value>& value) const {
    return value ? toJson(field, *value) : Json(nullptr);
  }

  template <typename Item>
  Json toJson(const ResultField& field, const std::vector<Item>& items) const {
    if (field.kind == FieldKind::TriangleList) {
      return items.size();
    }
    Json json = Json::array();
    for (const Item& item : items) {
      json.push_back(toJson(field, item));
    }
    return json;
  }

  Json toJson(const ResultField& field, const Index& index) const {
    const bool is_vertex = field.kind == FieldKind::Vertices ||
                           field.kind == FieldKind::VertexList || field.kind == FieldKind::Loops;
    return is_vertex ? surface_->input_of_vertex[static_cast<std::size_t>(index)] : index;
  }

private:
  /// A vector as a list, a matrix as a list of its rows.
  template <typename Matrix>
  static Json rowsOf(const Matrix& matrix) {
    Json json = Json::array();
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      if constexpr (Matrix::ColsAtCompileTime == 1) {
        json.push_back(matrix[row]);
      } else {
        json.push_back(Json(
            std::vector<typename Matrix::Scalar>(matrix.row(row).begin(), matrix.row(row).end())));
      }
    }
    return json;
  }

  const Surface* surface_;
};

/// A name or value as people read it.
std::string inWords(const Json& value) {
  if (value.is_structured()) {
    std::string text;
    for (const auto& [name, item] : value.items()) {
      if (!item.is_null()) {
        text += text.empty() ? "" : value.is_object() ? ", " : " ";
        text += (value.is_object() ? inWords(name) + " " : "") + inWords(item);
      }
    }
    return text;
  }
  return replaced(value.is_string()         ? value.get<std::string>()
                  : value.is_boolean()      ? (value.get<bool>() ? "yes" : "no")
                  : value.is_number_float() ? formatted(value.get<double>(), 6)
                                            : value.dump(),
                  '_', ' ');
}

/// Prints a list of structs as a table.
void printTable(const Json& rows, Console& console) {
  if (rows.empty()) {
    return;
  }
  std::vector<std::string> lines(rows.size() + 1);
  for (const auto& [name, first] : rows.front().items()) {
    std::vector<std::string> cells = {inWords(name)};
    for (const Json& row : rows) {
      cells.push_back(inWords(row[name]));
    }
    std::size_t width = 0;
    for (const std::string& cell : cells) {
      width = std::max(width, cell.size() + 2);
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      lines[i] += std::string(width - cells[i].size(), ' ') + cells[i];
    }
  }
  console.heading("");
  for (const std::string& line : lines) {
    console.heading(line);
  }
  console.heading("");
}

}  // namespace

Json toJson(const Surface& surface) {
  constexpr std::size_t max_pairs = 1000;
  Json json = Writer(&surface).fieldsOf(surface);
  const auto& pairs = surface.self_intersections;
  const auto count = static_cast<std::ptrdiff_t>(std::min(max_pairs, pairs.size()));
  json["self_intersecting_pairs"] =
      std::vector<std::array<Index, 2>>(pairs.begin(), pairs.begin() + count);
  return json;
}

Json toJson(const std::optional<View>& view) {
  return view ? Writer().fieldsOf(*view) : Json();
}

Json toJson(const LeftOut& left_out) {
  return Writer().fieldsOf(left_out);
}

Json toJson(const std::vector<Finding>& findings) {
  return Writer().toJson({}, findings);
}

void printFigures(const Json& report, Console& console) {
  const std::set<std::string> others = {"version", "input",  "inputs", "output",
                                        "options", "stages", "files",  "findings"};
  for (const auto& [name, value] : report.items()) {
    if (value.contains("stages")) {
      console.heading(name);
      printFigures(value, console);
    } else if (!value.is_null() && others.count(name) == 0) {
      console.entry(inWords(name), inWords(value));
    }
  }
}

void printTables(const Surface& surface, Console& console) {
  const Json json = toJson(surface);
  printTable(json["embedding"]["levels"], console);
  printFigures(json["measures"], console);
}

}  // namespace spherical_param::tools
