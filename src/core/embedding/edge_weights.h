#pragma once

#include "embedding.h"

#include <cmath>

namespace spherical_param::internal {

/// Minimum edge length, so that sums of weights stay finite.
inline constexpr double kMinLength = 1e-150;

/// Weights of the edges of a graph of points p that is embedded at u,
///
///   w_ij = (f(|p_i - p_j|) |u_i - u_j|)^q,   or f(|p_i - p_j|) for q = 0,
///
/// of an energy of degree q + 2 in the lengths on the sphere. For q > 0 the energy itself keeps the
/// embedding from collapsing; q = 0 needs a barrier. A new kind of weights is one more case of the
/// constructor.
class EdgeWeightLaw {
public:
  /// \param exponent p of the energy of adaptive weights; > 2.
  EdgeWeightLaw(EdgeWeights kind, double exponent) {
    switch (kind) {
    case EdgeWeights::Uniform:
      factor_ = [](double) { return 1.0; };
      break;
    case EdgeWeights::InverseLength:
      factor_ = [](double length) { return 1.0 / length; };
      break;
    case EdgeWeights::Adaptive:
      factor_ = [](double length) { return 1.0 / length; };
      power_ = exponent - 2.0;
      break;
    }
  }

  /// f of the length of an edge in space.
  double factor(double length) const { return factor_(length < kMinLength ? kMinLength : length); }

  /// The weight of an edge with factor f and this length on the sphere.
  double weight(double factor, double length) const {
    if (power_ == 1.0)
      return length * factor;
    if (power_ == 0.0)
      return factor;
    return std::pow(length * factor, power_);
  }

  /// q. The derivative of the weight by the length on the sphere is q * weight / length.
  double power() const { return power_; }

  bool needsBarrier() const { return power_ == 0.0; }

private:
  double (*factor_)(double length) = nullptr;
  double power_ = 0.0;
};

}  // namespace spherical_param::internal
