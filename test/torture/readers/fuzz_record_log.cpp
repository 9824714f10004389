// Records of batches that were broken off, which -resume reads.

#include "common/errors.h"
#include "common/record_log.h"
#include "fuzz_file.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace spherical_param::tools;
  static torture::FuzzFile file(".jsonl");
  file.fill(bytes, size);
  try {
    std::vector<Json> records = readRecords(file.path());
    for (const Json& record : records) {
      torture::require(record.is_object(), "a record is an object");
      const Json output = record.value("output", Json());
      if (output.is_string()) {
        const std::string text = asRecorded(output.get<std::string>());
        torture::require(asRecorded(text) == text, "what was recorded stays as it is");
      }
    }
    // Whatever the file ends with, a record that is added is found again, and harms no other.
    RecordLog(file.path()).append({{"output", "added"}});
    const std::string content = file.content();
    const std::vector<Json> more = readRecords(file.path());
    torture::require(content.size() > size && content.back() == '\n', "a record is a line");
    torture::require(more.size() == records.size() + 1 && more.back()["output"] == "added",
                     "the added record is read");
    torture::require(std::equal(records.begin(), records.end(), more.begin()),
                     "the other records stay");
  } catch (const ToolError& error) {
    torture::require(!error.remedy().empty(), "a refusal has its remedy");
  }
  return 0;
}
