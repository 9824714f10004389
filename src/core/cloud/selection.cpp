#include "selection.h"

#include "cloud_surfaces.h"
#include "openings.h"
#include "outliers.h"
#include "power_of_two.h"
#include "progress.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace spherical_param::internal {
namespace {

/// The points that are not among the others; both lists are ascending.
std::vector<Index> without(const std::vector<Index>& points, const std::vector<Index>& others) {
  std::vector<Index> rest;
  std::set_difference(points.begin(), points.end(), others.begin(), others.end(),
                      std::back_inserter(rest));
  return rest;
}

}  // namespace

std::vector<Index> usableInputs(const Positions& points, const CloudInfo& info, LeftOut& left_out) {
  std::vector<Index> inputs;
  left_out.unused = info.unused;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    (points.col(i).allFinite() ? inputs : left_out.not_finite).push_back(static_cast<Index>(i));
  left_out.not_finite = without(left_out.not_finite, info.unused);
  return without(inputs, info.unused);
}

Selection::Selection(const Positions& points, const Options& given,
                     const NeighborSearchFactory& search_of, const CloudInfo& info,
                     StageClock& clock, LeftOut& left_out, std::optional<SearchedNodes> known)
    : points_(points), options_(withTopology(given)), search_of_(search_of), info_(info),
      clock_(clock), left_out_(left_out), known_(std::move(known)) {
  inputs_ = usableInputs(points, info, left_out);
  if (options_.outliers != OutlierMode::None || options_.parts != PartsMode::All)
    findNeighbors(inputs_).findStars(clock.execution());
  if (options_.outliers != OutlierMode::None)
    leaveOutOutliers();
  if (options_.parts == PartsMode::All)
    parts_.push_back(inputs_);
  else
    takeApart(given.parts == PartsMode::AsTopology);
}

Neighborhoods& Selection::findNeighbors(const std::vector<Index>& inputs) {
  if (!cloud_ || !cloud_->areOf(inputs)) {
    clock_.begin("neighbors");
    // The caller's search is made once, among all points.
    cloud_ = std::make_unique<Neighborhoods>(points_, inputs, options_,
                                             cloud_ ? NeighborSearchFactory() : search_of_,
                                             clock_.execution(), std::exchange(known_, {}));
  }
  clock_.begin("graph");
  return *cloud_;
}

void Selection::leaveOutOutliers() {
  clock_.begin("outliers");
  const std::vector<StrayPoint> stray =
      strayPoints(cloud_->points(), cloud_->agreed(), cloud_->stars());
  left_out_.outliers = cloud_->inputsOf(markOutliers(options_.outliers, options_.outlier_sigma,
                                                     cloud_->points(), cloud_->neighbors(),
                                                     cloud_->stars(), stray, clock_.execution()));
  if (left_out_.outliers.empty())
    return;
  inputs_ = without(inputs_, left_out_.outliers);
  findNeighbors(inputs_).findStars(clock_.execution());
}

void Selection::takeApart(bool is_never_empty) {
  clock_.begin("parts");
  const FractionReport report = reportOf(clock_.execution(), "parts");
  const Indexed<Index> part_of = partsOf(cloud_->points(), cloud_->agreed(), cloud_->stars(),
                                         static_cast<std::size_t>(options_.min_points));
  reportFraction(report, 0.5);
  parts_ = cloud_->groupInputs(part_of);
  if (parts_.empty()) {
    // The largest part of a small cloud is the whole cloud.
    const bool are_few = options_.parts == PartsMode::Largest &&
                         inputs_.size() < static_cast<std::size_t>(options_.min_points);
    if (is_never_empty || are_few)
      parts_.push_back(inputs_);
    return;
  }
  if (options_.parts == PartsMode::Largest)
    parts_.resize(1);
  std::vector<Index> meshed;
  for (const std::vector<Index>& part : parts_)
    meshed.insert(meshed.end(), part.begin(), part.end());
  std::sort(meshed.begin(), meshed.end());
  left_out_.other_parts = without(inputs_, meshed);
}

Positions Selection::pointsOf(std::size_t part) const {
  const std::vector<Index>& inputs = parts_[part];
  return static_cast<Eigen::Index>(inputs.size()) == points_.cols()
             ? points_
             : Positions(points_(Eigen::all, inputs));
}

CloudInfo Selection::infoOf(std::size_t part) const {
  CloudInfo info;
  info.viewpoint = info_.viewpoint;
  if (info_.normals.cols() > 0) {
    info.normals = info_.normals(Eigen::all, parts_[part]);
    info.normals = info.normals.array().isFinite().select(info.normals, 0.0).eval();
  }
  return info;
}

Neighborhoods& Selection::neighborhoodsOf(std::size_t part) {
  Neighborhoods& cloud = findNeighbors(parts_[part]);
  if (options_.method == Method::Default)
    cloud.findStars(clock_.execution());
  return cloud;
}

bool Selection::complete(std::size_t part, const OrderedPoints& nodes,
                         const std::vector<Opening>& openings) {
  std::vector<Index> added;
  if (openings.empty())
    return false;
  const auto take = [&](std::vector<Index>& left_out) {
    std::vector<Index> taken;
    for (const Index i : pointsInOpenings(
             nodes.points, openings,
             timesPowerOfTwo(Positions(points_(Eigen::all, left_out)), -nodes.exponent)))
      taken.push_back(left_out[static_cast<std::size_t>(i)]);
    left_out = without(left_out, taken);
    added.insert(added.end(), taken.begin(), taken.end());
  };
  if (options_.outliers == OutlierMode::Auto)
    take(left_out_.outliers);
  if (options_.parts == PartsMode::Each)
    take(left_out_.other_parts);
  std::vector<Index>& inputs = parts_[part];
  inputs.insert(inputs.end(), added.begin(), added.end());
  std::sort(inputs.begin(), inputs.end());
  return !added.empty();
}

}  // namespace spherical_param::internal
