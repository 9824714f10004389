// Lists of the inputs of a batch.

#include "common/batch_inputs.h"
#include "common/errors.h"
#include "fuzz_file.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace spherical_param::tools;
  static torture::FuzzFile file(".txt");
  file.fill(bytes, size);
  try {
    for (const BatchInput& input : collectInputs({}, file.path())) {
      torture::require(!input.path.empty(), "an input has a name");
    }
  } catch (const ToolError& error) {
    torture::require(!error.remedy().empty(), "a refusal has its remedy");
  }
  return 0;
}
