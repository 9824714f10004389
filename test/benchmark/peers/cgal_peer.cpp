// benchmark_peer_cgal: the surface reconstruction of the Computational Geometry Algorithms Library.

#include "cgal_methods.h"

#include <CGAL/version.h>

int main(int argc, char** argv) {
  using namespace spherical_param::benchmark;
  return runPeer(
      argc, argv,
      {"benchmark_peer_cgal",
       "CGAL " CGAL_VERSION_STR,
       {{"advancing_front", "CGAL advancing front", true, cgalAdvancingFront},
        {"advancing_front_filled", "CGAL advancing front, filled", true, cgalAdvancingFrontFilled},
        {"poisson", "CGAL Poisson", false, cgalPoisson},
        {"alpha_wrap", "CGAL alpha wrap", false, cgalAlphaWrap}}});
}
