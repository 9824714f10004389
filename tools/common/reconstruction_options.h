#pragma once

#include "common/command_line.h"
#include "common/console.h"
#include "common/json_report.h"
#include "common/names.h"
#include "common/outlier_removal.h"
#include "spherical_param/reconstruct.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {

extern const Names<GraphMethod> graph_names;
extern const Names<EmbeddingMethod> solver_names;
extern const Names<EdgeWeights> weight_names;
extern const Names<TriangulationMethod> hull_names;
extern const Names<OptimizationMethod> optimization_names;
extern const Names<OutlierMethod> outlier_names;

/// How a cloud is to be meshed.
struct ReconstructionSettings {
  std::optional<double> outlier_sigma;  ///< none: outliers are not looked for
  OutlierMethod outlier_method = OutlierMethod::Paper;
  Options options;      ///< the number of threads is never 0
  bool strict = false;  ///< warnings are a failure, see requireNoWarnings()
};

/// The lines of the options of the reconstruction, from -graph to -threads.
std::vector<OptionInfo> reconstructionOptions();

/// Refuses options that would change nothing as well. \throw UsageError
ReconstructionSettings parseReconstructionOptions(const CommandLine& command_line);

/// Prints what is in force.
void printReconstructionOptions(const ReconstructionSettings& settings, Console& console);

/// What is in force; what has no say with the chosen methods is null.
Json reconstructionOptionsToJson(const ReconstructionSettings& settings);

/// With -strict, ends the tool with exit code 1 if there is a warning. To be called last: whoever
/// asks for a failure still wants to look at what was made. \throw Failure
///
/// \param warnings of each input, which is named with them.
void requireNoWarnings(
    const ReconstructionSettings& settings,
    const std::vector<std::pair<std::string, std::vector<std::string>>>& warnings);

/// Tells whether the solver is the paper's.
bool isIterative(const Options& options);

}  // namespace spherical_param::tools
