// benchmark_peer_cgal: the surface reconstruction of the Computational Geometry Algorithms Library.

#include "cgal_peer.h"

#include <CGAL/version.h>

int main(int argc, char** argv) {
  using namespace spherical_param::benchmark;
  return runPeer(argc, argv, "CGAL " CGAL_VERSION_STR,
                 {{"advancing_front", cgalAdvancingFront},
                  {"advancing_front_filled", cgalAdvancingFrontFilled},
                  {"poisson", cgalPoisson},
                  {"alpha_wrap", cgalAlphaWrap}});
}
