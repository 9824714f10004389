#pragma once

#include "spherical_param/types.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

/// Between NumPy's arrays and the matrices of the core. Rows of an (n, 3) array in C order lie in
/// memory as the columns of a 3 x n matrix do. What Python gets owns its memory.
namespace spherical_param::python {

template <typename Scalar>
using Array = pybind11::array_t<Scalar, pybind11::array::c_style>;

/// A copy of values, as an array of a shape.
template <typename Scalar>
Array<Scalar> copied(const Scalar* values, std::vector<std::size_t> shape) {
  Array<Scalar> array(std::move(shape));
  std::copy_n(values, array.size(), array.mutable_data());
  return array;
}

/// The first columns of rows, in another type: (n, Columns).
template <typename Scalar, std::size_t Columns, typename Row>
Array<Scalar> firstColumns(const std::vector<Row>& rows) {
  Array<Scalar> array(std::vector<std::size_t>{rows.size(), Columns});
  Scalar* place = array.mutable_data();
  for (const Row& row : rows)
    place = std::copy_n(row.begin(), Columns, place);
  return array;
}

/// (n, Rows)
template <typename Scalar, int Rows>
Array<Scalar> toArray(const Eigen::Matrix<Scalar, Rows, Eigen::Dynamic>& columns) {
  return copied(columns.data(), {static_cast<std::size_t>(columns.cols()), std::size_t{Rows}});
}
/// (n, Columns)
template <typename Scalar, std::size_t Columns>
Array<Scalar> toArray(const std::vector<std::array<Scalar, Columns>>& rows) {
  return firstColumns<Scalar, Columns>(rows);
}
/// (n,)
template <typename Scalar>
Array<Scalar> toArray(const std::vector<Scalar>& values) {
  return copied(values.data(), {values.size()});
}
/// (3,)
inline Array<double> toArray(const Eigen::Vector3d& vector) {
  return copied(vector.data(), {3});
}
/// (3, 3)
inline Array<double> toArray(const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix3d rows_in_order = matrix.transpose();
  return copied(rows_in_order.data(), {3, 3});
}

}  // namespace spherical_param::python

namespace pybind11::detail {

/// Positions and triangles as arguments: arrays of their type and shape, which the package in
/// Python makes.
template <typename Scalar>
struct type_caster<Eigen::Matrix<Scalar, 3, Eigen::Dynamic>> {
  using Columns = Eigen::Matrix<Scalar, 3, Eigen::Dynamic>;
  PYBIND11_TYPE_CASTER(Columns, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    using Array = spherical_param::python::Array<Scalar>;
    if (!isinstance<Array>(source))
      return false;
    const auto array = reinterpret_borrow<Array>(source);
    if (array.ndim() != 2 || array.shape(1) != 3)
      return false;
    value = Eigen::Map<const Columns>(array.data(), 3, array.shape(0));
    return true;
  }
};

}  // namespace pybind11::detail
