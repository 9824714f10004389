#include "python/options.h"

#include "python/arrays.h"
#include "spherical_param/errors.h"
#include "spherical_param/option_table.h"

#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <exception>
#include <string>
#include <type_traits>
#include <variant>

namespace spherical_param::python {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

/// A value of an option. Whatever Python takes for an integer or a number is one.
OptionValue toValue(const OptionRow& row, const py::handle& value) {
  if (value.is_none())
    return {};
  if (py::isinstance<py::str>(value))
    return value.cast<std::string>();
  try {
    if (PyIndex_Check(value.ptr()) != 0) {
      PyObject* const index = PyNumber_Index(value.ptr());  // none for an array of two numbers
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

py::object toObject(const OptionValue& value) {
  return std::visit(
      [](const auto& known) -> py::object {
        if constexpr (std::is_same_v<std::decay_t<decltype(known)>, std::monostate>)
          return py::none();
        else
          return py::cast(known);
      },
      value);
}

}  // namespace

py::list optionRows() {
  py::list rows;
  for (const OptionRow& row : optionTable())
    rows.append(py::dict("name"_a = row.name, "help"_a = row.help, "range"_a = rangeOf(row),
                         "choices"_a = row.choices, "is_number"_a = row.is_number,
                         "is_integer"_a = row.is_integer, "optional"_a = row.optional,
                         "default"_a = toObject(row.get({}))));
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

}  // namespace spherical_param::python
