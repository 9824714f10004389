#include "local_intersections.h"

#include <utility>

namespace spherical_param::internal {

void LocalIntersections::begin(std::size_t triangles, Indexed<Face> faces) {
  for (const Face& face : faces_)
    places_[face.triangle] = -1;
  places_.resize(triangles, -1);
  faces_ = std::move(faces);
  is_in_.assign(faces_.size(), 1);
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
    is_in_.push_back(1);
  }
  faces_[place] = face;
  is_in_[place] = 1;
  boxes_.set(place, boxOf(face.corners).cast<float>());
}

void LocalIntersections::remove(Index triangle) {
  const Index place = places_[triangle];
  is_in_[place] = 0;
  boxes_.set(place, FloatBox());
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
