#include "local_intersections.h"

#include <limits>
#include <utility>

namespace spherical_param::internal {

void LocalIntersections::begin(std::size_t triangles, std::vector<Face> faces) {
  for (const Face& face : faces_)
    places_[at(face.triangle)] = -1;
  places_.resize(triangles, -1);
  faces_ = std::move(faces);
  counts_.assign(faces_.size(), kUnknown);
  has_counts_ = false;
  std::vector<BoxGroup> groups((faces_.size() + BoxGroup::kSize - 1) / BoxGroup::kSize);
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    places_[at(faces_[i].triangle)] = static_cast<Index>(i);
    groups[i / BoxGroup::kSize].set(i % BoxGroup::kSize, FloatBox(boxOf(faces_[i].corners)));
  }
  boxes_ = BoxTree(std::move(groups), 1);
}

void LocalIntersections::set(const Face& face) {
  Index& place = places_[at(face.triangle)];
  if (place >= 0) {
    addToCounts(faces_[at(place)], -1);
  } else {
    place = static_cast<Index>(faces_.size());
    faces_.push_back(face);
    counts_.push_back(kUnknown);
  }
  faces_[at(place)] = face;
  boxes_.set(at(place), FloatBox(boxOf(face.corners)));
  counts_[at(place)] = addToCounts(face, 1);
}

void LocalIntersections::remove(Index triangle) {
  Index& place = places_[at(triangle)];
  addToCounts(faces_[at(place)], -1);
  const std::size_t last = faces_.size() - 1;
  faces_[at(place)] = faces_[last];
  counts_[at(place)] = counts_[last];
  boxes_.set(at(place), boxes_.at(last));
  places_[at(faces_[last].triangle)] = place;
  place = -1;
  faces_.pop_back();
  counts_.pop_back();
  boxes_.set(last, FloatBox());
}

int LocalIntersections::addToCounts(const Face& face, int change) {
  if (!has_counts_)
    return kUnknown;
  int found = 0;
  forEachIntersecting(face, face.triangle, [&](const Face& other) {
    ++found;
    int& count = counts_[at(places_[at(other.triangle)])];
    count += count == kUnknown ? 0 : change;
    return true;
  });
  return found;
}

int LocalIntersections::countOf(Index triangle) {
  int& known = counts_[at(places_[at(triangle)])];
  if (known == kUnknown)
    known = count(face(triangle), triangle, std::numeric_limits<int>::max());
  has_counts_ = true;
  return known;
}

void LocalIntersections::appendIntersecting(const Face& face, std::vector<Index>& triangles) const {
  forEachIntersecting(face, face.triangle, [&](const Face& other) {
    triangles.push_back(other.triangle);
    return true;
  });
}

int LocalIntersections::count(const Face& face, Index without, int most) const {
  int found = 0;
  forEachIntersecting(face, without, [&](const Face&) { return ++found <= most; });
  return found;
}

}  // namespace spherical_param::internal
