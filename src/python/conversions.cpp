#include "python/conversions.h"

#include "python/arrays.h"
#include "spherical_param/option_table.h"
#include "spherical_param/result_fields.h"

#include <pybind11/stl.h>

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <type_traits>

namespace spherical_param::python {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

/// A value of an option: all that Python accepts as an integer, a number or a text.
OptionValue toValue(const OptionRow& row, const py::handle& value) {
  if (value.is_none())
    return {};
  if (py::isinstance<py::str>(value))
    return value.cast<std::string>();
  try {
    if (row.is_point) {
      const auto point = value.cast<std::array<double, 3>>();
      const auto text = [](double x) { return py::repr(py::float_(x)).cast<std::string>(); };
      return text(point[0]) + ',' + text(point[1]) + ',' + text(point[2]);
    }
    if (PyIndex_Check(value.ptr()) != 0) {
      PyObject* const index = PyNumber_Index(value.ptr());  // null for an array of two numbers
      if (index == nullptr)
        throw py::error_already_set();
      return py::reinterpret_steal<py::int_>(index).cast<std::int64_t>();
    }
    if (!py::isinstance<py::bytes>(value))
      return py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>();
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): no number, or too large
  }
  throw InvalidInput(row.name + " = " + py::repr(value).cast<std::string>() +
                     " cannot be used; use " + rangeOf(row));
}

template <typename Items, typename Convert>
py::list listOf(const Items& items, const Convert& convert) {
  py::list list;
  for (const auto& item : items)
    list.append(convert(item));
  return list;
}

template <typename Value>
constexpr const Value* kOf = nullptr;

using Loops = std::vector<std::vector<Index>>;

/// Turns what belongs to a surface into objects of Python.
struct Converter {
  bool has_volume = false;
  py::module_ classes = py::module_::import("spherical_param._figures");

  template <typename Struct>
  py::dict fieldsOf(const Struct& self) const {
    py::dict dict;
    visitFields(&self, [&](const ResultField& field, auto access) {
      if (field.kind == FieldKind::OfSolid && !has_volume)
        dict[field.name] = py::none();
      else if (field.kind != FieldKind::CppOnly)
        dict[field.name] = object(std::invoke(access, self));
    });
    return dict;
  }

  template <typename Value>
  py::object object(const Value& value) const {
    if constexpr (std::is_pointer_v<Value>)
      return value == nullptr ? py::none() : object(*value);
    else if constexpr (isDescribed(kOf<Value>))
      return classes.attr(describe(kOf<Value>).name)(**fieldsOf(value));
    else if constexpr (isDescribedList(kOf<Value>) || std::is_same_v<Value, Loops>)
      return py::tuple(listOf(value, [this](const auto& item) { return this->object(item); }));
    else if constexpr (std::is_enum_v<Value>)
      return py::str(nameOf(value));
    else if constexpr (std::is_arithmetic_v<Value>)
      return py::cast(value);
    else
      return other(value);
  }

private:
  template <typename Value>
  py::object other(const std::optional<Value>& value) const {
    return value ? object(*value) : py::none();
  }
  static py::object other(const std::string& text) { return py::str(text); }
  template <typename Array>
  static py::object other(const Array& array) {
    return toArray(array);
  }
};

/// What Python calls the type of a field, and the shape of an array.
struct PythonType {
  std::string name;
  std::string shape = {};
};

PythonType optional(PythonType type) {
  type.name = "Optional[" + type.name + "]";
  return type;
}

struct PythonTypes {
  static PythonType of(const bool*) { return {"bool"}; }
  static PythonType of(const double*) { return {"float"}; }
  static PythonType of(const std::string*) { return {"str"}; }
  static PythonType of(const Eigen::Vector3d*) { return {"FloatArray", "(3,)"}; }
  static PythonType of(const Eigen::Matrix3d*) { return {"FloatArray", "(3, 3)"}; }
  static PythonType of(const Positions*) { return {"FloatArray", "(n, 3)"}; }
  static PythonType of(const Triangles*) { return {"IndexArray", "(n, 3)"}; }
  static PythonType of(const std::vector<std::array<Index, 2>>*) {
    return {"IndexArray", "(n, 2)"};
  }
  static PythonType of(const Loops*) { return {"tuple[IndexArray, ...]", "(n,) each:"}; }
  static PythonType of(const std::vector<double>*) { return {"FloatArray", "(n,)"}; }
  static PythonType of(const std::vector<std::uint8_t>*) { return {"ByteArray", "(n,)"}; }
  static PythonType of(const std::vector<Index>*) { return {"IndexArray", "(n,)"}; }

  template <typename Value>
  static PythonType of(const std::optional<Value>*) {
    return optional(of(kOf<Value>));
  }

  template <typename Value>
  static PythonType of(const Value*) {
    if constexpr (isDescribed(kOf<Value>)) {
      return {describe(kOf<Value>).name};
    } else if constexpr (isDescribedList(kOf<Value>)) {
      return {"tuple[" + std::string(describe(kOf<typename Value::value_type>).name) + ", ...]"};
    } else if constexpr (std::is_enum_v<Value>) {
      std::string names;
      for (const char* name : namesOf(Value()))
        names += (names.empty() ? "'" : ", '") + std::string(name) + "'";
      return {"Literal[" + names + "]"};
    } else {
      static_assert(std::is_integral_v<Value>, "a type that Python does not know");
      return {"int"};
    }
  }
};

std::string helpOf(const ResultField& field, const std::string& shape) {
  const char* const units[] = {"",
                               " [unit of the input]",
                               " [squared unit of the input]",
                               " [cubed unit of the input]",
                               " [unit of the input to the fourth]",
                               " [unit of the input to the fifth]"};
  return shape + (shape.empty() ? "" : " ") + field.help + units[field.power];
}

/// Adds a struct and, before it, those that it consists of.
template <typename Struct>
void addRows(const Struct*, py::list& rows, std::set<std::string>& known) {
  const ResultField about = describe(kOf<Struct>);
  if (!known.insert(about.name).second)
    return;
  py::list fields;
  visitFields(kOf<Struct>, [&](const ResultField& field, auto access) {
    if (field.kind == FieldKind::CppOnly)
      return;
    using Got = std::decay_t<std::invoke_result_t<decltype(access), const Struct&>>;
    using Value = std::decay_t<std::remove_pointer_t<Got>>;
    if constexpr (isDescribed(kOf<Value>))
      addRows(kOf<Value>, rows, known);
    else if constexpr (isDescribedList(kOf<Value>))
      addRows(kOf<typename Value::value_type>, rows, known);
    PythonType type = PythonTypes::of(kOf<Value>);
    if (std::is_pointer_v<Got> || field.kind == FieldKind::OfSolid)
      type = optional(type);
    fields.append(py::dict("name"_a = field.name, "type"_a = type.name,
                           "help"_a = helpOf(field, type.shape)));
  });
  rows.append(py::dict("name"_a = about.name, "help"_a = about.help, "fields"_a = fields));
}

py::dict statisticsOf(const DistortionStatistics& statistics) {
  return py::dict("mean"_a = statistics.mean, "p95"_a = statistics.p95, "max"_a = statistics.max);
}

}  // namespace

py::list optionRows() {
  py::list rows;
  for (const OptionRow& row : optionTable())
    rows.append(py::dict("name"_a = row.name, "help"_a = row.help, "range"_a = rangeOf(row),
                         "choices"_a = row.choices, "is_number"_a = row.is_number,
                         "is_integer"_a = row.is_integer, "is_point"_a = row.is_point,
                         "optional"_a = row.optional, "default"_a = row.get({})));
  return rows;
}

Options toOptions(const py::dict& values, Listener& listener) {
  Options options;
  for (const auto& [name, value] : values) {
    const OptionRow& row = findOption(name.cast<std::string>());
    setOption(options, row.name, toValue(row, value));
  }
  static_cast<Execution&>(options) = listener.execution(options.threads, options.time_limit);
  return options;
}

CloudInfo toCloudInfo(const py::dict& info) {
  CloudInfo result;
  if (const py::object normals = info["normals"]; !normals.is_none())
    result.normals = normals.cast<Positions>();
  if (const py::object viewpoint = info["viewpoint"]; !viewpoint.is_none())
    result.viewpoint =
        Eigen::Map<const Eigen::Vector3d>(viewpoint.cast<std::array<double, 3>>().data());
  if (const py::object unused = info["unused"]; !unused.is_none()) {
    const auto rows = unused.cast<Array<Index>>();
    result.unused.assign(rows.data(), rows.data() + rows.size());
  }
  return result;
}

py::dict toDict(const Result& result) {
  py::list surfaces;
  for (const Surface& surface : result.surfaces)
    surfaces.append(Converter{surface.hasVolume()}.fieldsOf(surface));
  py::dict stages;
  for (const StageTime& stage : result.stages)
    stages[py::str(stage.name)] = stage.seconds;
  const Converter converter;
  const JoinedMesh mesh = joined(result);
  return py::dict("surfaces"_a = surfaces, "vertices"_a = toArray(mesh.points),
                  "triangles"_a = toArray(mesh.triangles),
                  "input_of_vertex"_a = toArray(mesh.input_of_vertex),
                  "_is_added"_a = toArray(mesh.is_added), "view"_a = converter.object(result.view),
                  "left_out"_a = converter.object(result.left_out), "stages"_a = stages,
                  "verdict"_a = result.verdict, "findings"_a = converter.object(result.findings),
                  "failures"_a = py::tuple(py::cast(result.failures)));
}

py::list resultTable() {
  py::list rows;
  std::set<std::string> known;
  addRows(kOf<Surface>, rows, known);
  addRows(kOf<View>, rows, known);
  addRows(kOf<LeftOut>, rows, known);
  return rows;
}

py::dict toDict(const MapDistortion& distortion) {
  return py::dict("flipped_triangles"_a = distortion.flipped_triangles,
                  "degenerate_triangles"_a = distortion.degenerate_triangles,
                  "angle"_a = statisticsOf(distortion.angle),
                  "area"_a = statisticsOf(distortion.area),
                  "mean_angle_difference"_a = distortion.mean_angle_difference,
                  "stretch_efficiency"_a = distortion.stretch_efficiency);
}

py::dict toDict(const SphereMap& map) {
  return py::dict("sphere"_a = toArray(map.sphere), "caps"_a = toArray(map.caps),
                  "distortion"_a = toDict(map.distortion), "before"_a = toDict(map.before),
                  "levels"_a = listOf(map.levels, [](const SphereMapLevel& level) {
                    return py::dict("vertices"_a = level.vertices, "sweeps"_a = level.sweeps,
                                    "energy"_a = level.energy);
                  }));
}

}  // namespace spherical_param::python
