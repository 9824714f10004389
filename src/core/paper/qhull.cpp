#include "qhull.h"

#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"

#include <libqhull_r/libqhull_r.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// The working memory of one run of reentrant qhull.
class Qhull {
public:
  Qhull() : messages_(std::fopen("/dev/null", "w")) {
    if (messages_ == nullptr)
      messages_ = std::tmpfile();
    // Without a file qhull would print its messages.
    if (messages_ == nullptr)
      throw ComputeError("qhull: no file can be opened; close some");
    qh_zero(&state_, messages_);
  }
  ~Qhull() {
    qh_freeqhull(&state_, !qh_ALL);
    // qhull itself does not free these tables if there was no memory for both.
    if (state_.qhmem.LASTsize == 0) {
      std::free(state_.qhmem.freelists);
      std::free(state_.qhmem.sizetable);
    }
    int current = 0;
    int total = 0;
    qh_memfreeshort(&state_, &current, &total);
    std::fclose(messages_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  /// Runs on 3 x n points, which must outlive this; returns qhull's exit code.
  int run(const Positions& points) {
    // Qt: triangles only. Pp: no precision warnings.
    std::string command = "qhull Qt Pp";
    return qh_new_qhull(&state_, 3, static_cast<int>(points.cols()),
                        const_cast<coordT*>(points.data()), False, command.data(), messages_,
                        messages_);
  }

  /// The facets as triangles, oriented as qhull has them.
  Triangles triangles() {
    std::vector<Index> corners;
    for (const facetT* facet = state_.facet_list; facet != nullptr && facet->next != nullptr;
         facet = facet->next) {
      if (qh_setsize(&state_, facet->vertices) != 3)
        return {};
      for (int k = 0; k < 3; ++k) {
        const auto* vertex = static_cast<const vertexT*>(facet->vertices->e[k].p);
        corners.push_back(static_cast<Index>(qh_pointid(&state_, vertex->point)));
      }
      if ((facet->toporient ? 1 : 0) != qh_ORIENTclock)
        std::swap(corners[corners.size() - 1], corners[corners.size() - 2]);
    }
    return Eigen::Map<Triangles>(corners.data(), 3, static_cast<Eigen::Index>(corners.size() / 3));
  }

private:
  qhT state_{};
  std::FILE* messages_;  ///< qhull insists on writing its messages somewhere
};

}  // namespace

Triangles hullByQhull(const Positions& points) {
  auto qhull = std::make_unique<Qhull>();  // large
  const int exit_code = qhull->run(points);
  if (exit_code == qh_ERRmem)
    throw ComputeError("qhull: out of memory; use fewer points");
  if (exit_code != qh_ERRnone)
    return {};
  Triangles triangles = qhull->triangles();
  if (signedVolume(points, triangles) < 0.0)
    flipOrientation(triangles);
  const MeshTopology topology = checkTopology(triangles, static_cast<std::size_t>(points.cols()));
  return topology.isSphere() ? triangles : Triangles();
}

}  // namespace spherical_param::internal
