#include "local_intersections.h"

#include <limits>
#include <utility>

namespace spherical_param::internal {

void LocalIntersections::begin(std::size_t triangles, Indexed<Face> faces) {
  for (const Face& face : faces_)
    places_[face.triangle] = -1;
  places_.resize(triangles, -1);
  faces_ = std::move(faces);
  counts_.assign(faces_.size(), std::nullopt);
  has_counts_ = false;
  for (Index i = 0; i < faces_.count(); ++i)
    places_[faces_[i].triangle] = i;
  boxes_ =
      BoxTree(faces_.size(), 1, {}, [&](Index i) { return FloatBox(boxOf(faces_[i].corners)); });
}

void LocalIntersections::set(const Face& face) {
  Index& place = places_[face.triangle];
  if (place >= 0) {
    addToCounts(faces_[place], -1);
  } else {
    place = faces_.count();
    faces_.push_back(face);
    counts_.emplace_back();
  }
  faces_[place] = face;
  boxes_.set(place, FloatBox(boxOf(face.corners)));
  counts_[place] = addToCounts(face, 1);
}

void LocalIntersections::remove(Index triangle) {
  Index& place = places_[triangle];
  addToCounts(faces_[place], -1);
  const Index last = faces_.count() - 1;
  faces_[place] = faces_[last];
  counts_[place] = counts_[last];
  boxes_.set(place, boxes_.at(last));
  places_[faces_[last].triangle] = place;
  place = -1;
  faces_.pop_back();
  counts_.pop_back();
  boxes_.set(last, FloatBox());
}

std::optional<int> LocalIntersections::addToCounts(const Face& face, int change) {
  if (!has_counts_)
    return std::nullopt;
  int found = 0;
  forEachIntersecting(face, face.triangle, [&](const Face& other) {
    ++found;
    std::optional<int>& count = counts_[places_[other.triangle]];
    if (count)
      *count += change;
    return true;
  });
  return found;
}

int LocalIntersections::countOf(Index triangle) {
  std::optional<int>& known = counts_[places_[triangle]];
  if (!known)
    known = count(face(triangle), triangle, std::numeric_limits<int>::max());
  has_counts_ = true;
  return *known;
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
