#include "loop_search.h"

namespace spherical_param::internal {

void Wave::start(Index source) {
  reached.clear();
  reached.insert(source);
  steps[source] = 0;
  from[source] = source;
  label[source] = 0;
  queue.assign(1, source);
}

std::vector<Index> Wave::wayTo(Index v) const {
  std::vector<Index> way{v};
  while (steps[v] > 0)
    way.push_back(v = from[v]);
  return way;
}

std::vector<Index> closedWalk(std::vector<Index> first, std::vector<Index> second) {
  while (first.size() > 1 && second.size() > 1 &&
         first[first.size() - 2] == second[second.size() - 2]) {
    first.pop_back();
    second.pop_back();
  }
  std::vector<Index> walk(first.rbegin(), first.rend());
  walk.insert(walk.end(), second.begin(), second.end() - 1);
  return walk;
}

}  // namespace spherical_param::internal
