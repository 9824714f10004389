#include "common/foreign_options.h"

#include "common/errors.h"
#include "common/numbers.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <limits>

namespace spherical_param::tools {
namespace {

struct ForeignOption {
  const char* name;
  const char* tool;
  bool refused;
  const char* text;  ///< why it has no effect; of one that is refused, what to do
};

constexpr std::array<ForeignOption, 12> foreign_options = {{
    {"radius", "pcl_gp3_surface", false,
     "every point finds its neighbours by itself, at any density"},
    {"mu", "pcl_gp3_surface", false, "every point finds its neighbours by itself, at any density"},
    {"depth", "pcl_poisson_reconstruction", false,
     "there is no octree: every point becomes a vertex, so the points are the resolution"},
    {"solver_divide", "pcl_poisson_reconstruction", false, "there is no octree to be divided"},
    {"iso_divide", "pcl_poisson_reconstruction", false, "there is no octree to be divided"},
    {"point_weight", "pcl_poisson_reconstruction", false,
     "the mesh goes through every point, unless -smooth N moves them"},
    {"grid_res", "pcl_marching_cubes_reconstruction", true,
     "leave it out: there is no grid, every point becomes a vertex; pcl_voxel_grid thins the "
     "input"},
    {"iso_level", "pcl_marching_cubes_reconstruction", true,
     "leave it out: the mesh goes through the points; -smooth N moves them"},
    {"hoppe", "pcl_marching_cubes_reconstruction", true,
     "leave it out: no distance function is needed, nor are normals"},
    {"rbf", "pcl_marching_cubes_reconstruction", true,
     "leave it out: no distance function is needed, nor are normals"},
    {"extend", "pcl_marching_cubes_reconstruction", true,
     "leave it out: there is no grid to be extended"},
    {"displacement", "pcl_marching_cubes_reconstruction", true,
     "leave it out: there are no points off the surface"},
}};

}  // namespace

std::vector<OptionInfo> foreignOptions() {
  std::vector<OptionInfo> options;
  options.reserve(foreign_options.size());
  for (const ForeignOption& option : foreign_options) {
    options.push_back({option.name, "X", ""});
  }
  return options;
}

std::vector<std::string> notesOnForeignOptions(const CommandLine& command_line) {
  constexpr double largest = std::numeric_limits<double>::max();
  std::vector<std::string> notes;
  for (const ForeignOption& option : foreign_options) {
    if (!command_line.has(option.name)) {
      continue;
    }
    const std::string origin = "-" + std::string(option.name) + " of " + option.tool;
    if (option.refused) {
      throw UsageError("option " + origin + " asks for what this tool does not do", option.text);
    }
    parseReal(option.name, command_line.value(option.name, ""), {-largest, largest, true});
    notes.push_back(origin + " has no effect: " + option.text);
  }
  return notes;
}

bool isForeignOption(const std::string& name) {
  return std::any_of(foreign_options.begin(), foreign_options.end(),
                     [&name](const ForeignOption& option) { return option.name == name; });
}

}  // namespace spherical_param::tools
