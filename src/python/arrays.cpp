#include "python/arrays.h"

#include "spherical_param/errors.h"

#include <algorithm>
#include <string>

namespace spherical_param::python {
namespace {

namespace py = pybind11;

template <typename Matrix, typename Array>
Matrix toMatrix(const Array& array) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw InvalidInput("an array does not have three columns; give one of shape (n, 3)");
  return Eigen::Map<const Matrix>(array.data(), 3, array.shape(0));
}

template <typename Scalar>
py::array_t<Scalar, py::array::c_style> rows(const Scalar* data, std::size_t count,
                                             std::size_t columns) {
  py::array_t<Scalar, py::array::c_style> array(std::vector<std::size_t>{count, columns});
  std::copy(data, data + count * columns, array.mutable_data());
  return array;
}

template <typename Matrix>
auto rowsOf(const Matrix& matrix) {
  return rows(matrix.data(), static_cast<std::size_t>(matrix.cols()),
              static_cast<std::size_t>(matrix.rows()));
}

template <typename Scalar>
py::array_t<Scalar, py::array::c_style> column(const std::vector<Scalar>& values) {
  py::array_t<Scalar, py::array::c_style> array(std::vector<std::size_t>{values.size()});
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

/// The first columns of rows in another type.
template <typename Scalar, std::size_t Columns, typename Row>
py::array_t<Scalar, py::array::c_style> firstColumns(const std::vector<Row>& values) {
  py::array_t<Scalar, py::array::c_style> array(std::vector<std::size_t>{values.size(), Columns});
  Scalar* place = array.mutable_data();
  for (const Row& row : values)
    place = std::copy_n(row.begin(), Columns, place);
  return array;
}

}  // namespace

Positions toPositions(const DoubleArray& array) {
  return toMatrix<Positions>(array);
}

Triangles toTriangles(const IndexArray& array) {
  return toMatrix<Triangles>(array);
}

CloudInfo toCloudInfo(const std::optional<DoubleArray>& normals,
                      const std::optional<std::array<double, 3>>& viewpoint,
                      const std::optional<IndexArray>& unused) {
  CloudInfo info;
  if (normals)
    info.normals = toPositions(*normals);
  if (viewpoint)
    info.viewpoint = Eigen::Map<const Eigen::Vector3d>(viewpoint->data());
  if (unused)
    info.unused.assign(unused->data(), unused->data() + unused->size());
  return info;
}

DoubleArray toArray(const Positions& positions) {
  return rowsOf(positions);
}

DoubleArray toArray(const Eigen::Matrix<double, 2, Eigen::Dynamic>& m) {
  return rowsOf(m);
}

IndexArray toArray(const Triangles& triangles) {
  return rowsOf(triangles);
}

IndexArray toArray(const std::vector<std::array<Index, 2>>& pairs) {
  return firstColumns<Index, 2>(pairs);
}

IndexArray toArray(const std::vector<std::array<Index, 3>>& triples) {
  return firstColumns<Index, 3>(triples);
}

DoubleArray toArray(const std::vector<std::array<double, 3>>& rows) {
  return firstColumns<double, 3>(rows);
}

DoubleArray toArray(const std::vector<std::array<float, 3>>& rows) {
  return firstColumns<double, 3>(rows);
}

ByteArray toArray(const std::vector<std::array<std::uint8_t, 4>>& rows) {
  return firstColumns<std::uint8_t, 3>(rows);
}

IndexArray toArray(const std::vector<Index>& values) {
  return column(values);
}

DoubleArray toArray(const std::vector<double>& values) {
  return column(values);
}

ByteArray toArray(const std::vector<std::uint8_t>& values) {
  return column(values);
}

DoubleArray toArray(const Eigen::Vector3d& vector) {
  DoubleArray array(std::vector<std::size_t>{3});
  std::copy(vector.data(), vector.data() + 3, array.mutable_data());
  return array;
}

DoubleArray toArray(const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix3d transposed = matrix.transpose();
  return rows(transposed.data(), 3, 3);
}

}  // namespace spherical_param::python
