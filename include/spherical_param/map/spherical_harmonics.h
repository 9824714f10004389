#pragma once

#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/types.h"

#include <cstddef>

namespace spherical_param {

/// \addtogroup harmonics
/// @{

/// A surface as a series of real spherical harmonics, one for each coordinate (SPHARM:
/// Brechbuehler, Gerig and Kuebler 1995): x(u) = sum over l <= degree, |m| <= l of c_lm Y_lm(u).
struct SphericalHarmonics {
  int degree = 0;  ///< largest l
  /// 3 x (degree + 1)^2, column l^2 + l + m = c_lm of x, y and z [unit of the input]. Y_lm are
  /// orthonormal on the unit sphere: integral of Y_lm Y_l'm' = 1 if both are the same, else 0;
  /// m > 0 with cos(m phi), m < 0 with sin(|m| phi), without the phase (-1)^m.
  Positions coefficients;
  double rms_residual = 0.0;  ///< over the sphere, of the surface [unit of the input]
};

/// Values of all Y_lm up to a degree at a direction.
///
/// \param direction of any length but zero.
/// \param degree    largest l.
/// \return (degree + 1)^2 entries, Y_lm at l^2 + l + m.
/// \throw InvalidInput for a degree outside [0, 512], or a zero direction.
Eigen::VectorXd sphericalHarmonicsAt(const Eigen::Vector3d& direction, int degree);

/// Coefficients of a surface, by quadrature on the sphere: Gauss-Legendre in z, equal steps in phi,
/// enough of them to be exact for the product of two series of this degree and more.
///
/// \param surface with its map.
/// \param degree largest l; [0, 512].
/// \param threads 0: one for each processor; [0, 1024]
/// \return the coefficients, and what the series leaves.
/// \throw InvalidInput for a degree outside [0, 512].
SphericalHarmonics computeSphericalHarmonics(const SphereSurface& surface, int degree,
                                             int threads = 0);

/// The series at directions.
///
/// \param harmonics  coefficients up to harmonics.degree.
/// \param directions 3 x n, not zero.
/// \param threads    0: one for each processor; [0, 1024]
/// \return 3 x n, positions [unit of the input].
Positions evaluateSphericalHarmonics(const SphericalHarmonics& harmonics,
                                     const Positions& directions, int threads = 0);

/// @}

}  // namespace spherical_param
