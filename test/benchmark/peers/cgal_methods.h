#pragma once

#include "peer.h"

namespace spherical_param::benchmark {

// One source for each, because each takes long to compile.

PeerResult cgalAdvancingFront(const Points& points);
PeerResult cgalAdvancingFrontFilled(const Points& points);
PeerResult cgalPoisson(const Points& points);
PeerResult cgalAlphaWrap(const Points& points);

}  // namespace spherical_param::benchmark
