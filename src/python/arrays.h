#pragma once

#include "spherical_param/reconstruct.h"
#include "spherical_param/types.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

/// Between NumPy's arrays and the matrices of the core. Rows of an (n, 3) array in C order lie in
/// memory as the columns of a 3 x n matrix do. What Python gets owns its memory.
namespace spherical_param::python {

using DoubleArray = pybind11::array_t<double, pybind11::array::c_style>;
using ByteArray = pybind11::array_t<std::uint8_t, pybind11::array::c_style>;
using IndexArray = pybind11::array_t<Index, pybind11::array::c_style>;

/// \throw InvalidInput for another shape than (n, 3): the package in Python has checked it before.
Positions toPositions(const DoubleArray& array);
Triangles toTriangles(const IndexArray& array);
CloudInfo toCloudInfo(const std::optional<DoubleArray>& normals,
                      const std::optional<std::array<double, 3>>& viewpoint,
                      const std::optional<IndexArray>& unused);

DoubleArray toArray(const Positions& positions);                          ///< (n, 3)
DoubleArray toArray(const Eigen::Matrix<double, 2, Eigen::Dynamic>& m);   ///< (n, 2)
IndexArray toArray(const Triangles& triangles);                           ///< (m, 3)
IndexArray toArray(const std::vector<std::array<Index, 2>>& pairs);       ///< (n, 2)
IndexArray toArray(const std::vector<std::array<Index, 3>>& triples);     ///< (n, 3)
DoubleArray toArray(const std::vector<std::array<double, 3>>& rows);      ///< (n, 3)
DoubleArray toArray(const std::vector<std::array<float, 3>>& rows);       ///< (n, 3)
ByteArray toArray(const std::vector<std::array<std::uint8_t, 4>>& rows);  ///< (n, 3): no alpha
IndexArray toArray(const std::vector<Index>& values);                     ///< (n,)
DoubleArray toArray(const std::vector<double>& values);                   ///< (n,)
ByteArray toArray(const std::vector<std::uint8_t>& values);               ///< (n,)
DoubleArray toArray(const Eigen::Vector3d& vector);                       ///< (3,)
DoubleArray toArray(const Eigen::Matrix3d& matrix);                       ///< (3, 3)

}  // namespace spherical_param::python
