#include "local_intersections.h"

namespace spherical_param::internal {

void LocalIntersections::begin(std::size_t triangles) {
  for (const Face& face : faces_)
    places_[static_cast<std::size_t>(face.triangle)] = -1;
  faces_.clear();
  boxes_.clear();
  places_.resize(triangles, -1);
}

void LocalIntersections::set(const Face& face) {
  Index& place = places_[static_cast<std::size_t>(face.triangle)];
  if (place < 0) {
    place = static_cast<Index>(faces_.size());
    faces_.push_back(face);
    if (boxes_.size() * kGroupSize < faces_.size())
      boxes_.emplace_back();
  }
  const auto i = static_cast<std::size_t>(place);
  faces_[i] = face;
  boxes_[i / kGroupSize].set(i % kGroupSize, WideBox(boxOf(face.corners)));
}

std::size_t LocalIntersections::count(const Face& face, Index without, Index and_without) const {
  const WideBox box(boxOf(face.corners));
  const Plane plane(face);
  std::size_t found = 0;
  for (std::size_t group = 0; group < boxes_.size(); ++group)
    for (const std::size_t lane : Overlaps(boxes_[group], box)) {
      const Face& other = faces_[group * kGroupSize + lane];
      if (other.triangle != without && other.triangle != and_without &&
          !evidentlyApart(face, plane, other) && intersectCarefully(face, other))
        ++found;
    }
  return found;
}

}  // namespace spherical_param::internal
