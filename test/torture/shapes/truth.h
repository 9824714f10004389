#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace torture {

/// What is true of points, in exact arithmetic with integers: nothing of the library is used.
class Truth {
public:
  /// \param points 3 x n, kept by reference.
  explicit Truth(const spherical_param::Positions& points);

  /// First point that is not finite or has a coordinate beyond 1e100. Of such points nothing else
  /// is known here.
  std::optional<Eigen::Index> firstBad() const { return first_bad_; }
  /// For each point the first one that has the same coordinates; -0 is 0.
  const std::vector<spherical_param::Index>& firstEqual() const { return first_equal_; }
  /// Number of distinct points.
  std::size_t distinct() const { return distinct_; }
  /// Whether the points span space. In vain for thousands of points that do not, it takes a moment.
  bool spansSpace() const;

  /// What is not true in the reason that InvalidInput gives; empty if it is true.
  ///
  /// \param reason the message.
  std::string faultOf(const std::string& reason) const;

private:
  const spherical_param::Positions& points_;
  std::optional<Eigen::Index> first_bad_;
  std::vector<spherical_param::Index> first_equal_;
  std::size_t distinct_ = 0;
};

}  // namespace torture
