#include "local_intersections.h"

#include <utility>

namespace spherical_param::internal {

void LocalIntersections::begin(std::size_t triangles, Indexed<Face> faces) {
  for (const Face& face : faces_)
    places_[face.triangle] = -1;
  places_.resize(triangles, -1);
  faces_ = std::move(faces);
  for (Index i = 0; i < faces_.count(); ++i)
    places_[faces_[i].triangle] = i;
  boxes_ = BoxTree(faces_.size(), 1, {},
                   [&](Index i) { return boxOf(faces_[i].corners).cast<float>(); });
}

void LocalIntersections::set(const Face& face) {
  Index& place = places_[face.triangle];
  if (place < 0) {
    place = faces_.count();
    faces_.emplace_back();
  }
  faces_[place] = face;
  boxes_.set(place, boxOf(face.corners).cast<float>());
}

void LocalIntersections::remove(Index triangle) {
  Index& place = places_[triangle];
  faces_[place] = faces_.back();
  boxes_.set(place, boxes_.at(faces_.count() - 1));
  places_[faces_.back().triangle] = place;
  place = -1;
  faces_.pop_back();
  boxes_.set(faces_.count(), FloatBox());
}

void LocalIntersections::appendIntersecting(const Face& face, std::vector<Index>& triangles) const {
  std::size_t exact_tests = 0;
  forEachIntersecting(face, face.triangle, exact_tests, [&](const Face& other) {
    triangles.push_back(other.triangle);
    return true;
  });
}

int LocalIntersections::count(const Face& face, Index without, int most) const {
  std::size_t exact_tests = 0;
  return count(face, without, most, exact_tests);
}

int LocalIntersections::count(const Face& face, Index without, int most,
                              std::size_t& exact_tests) const {
  int found = 0;
  forEachIntersecting(face, without, exact_tests, [&](const Face&) { return ++found <= most; });
  return found;
}

}  // namespace spherical_param::internal
