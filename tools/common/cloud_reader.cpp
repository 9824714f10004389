#include "common/cloud_reader.h"

#include "common/file_formats.h"
#include "common/header_checks.h"
#include "common/input_file.h"
#include "common/record_reader.h"
#include "common/text_clouds.h"

#include <cstdint>

namespace spherical_param::tools {

PointData readCloud(const std::string& path, const FileProgress& progress) {
  const FileFormat format = requireFormat(path, FileUse::ReadCloud);
  const std::uint64_t file_size = checkInputFile(path);
  switch (format) {
  case FileFormat::Pcd:
    return readRecords(path, checkPcdHeader(path, file_size), progress);
  case FileFormat::Ply:
    return readRecords(path, checkPlyHeader(path, file_size), progress);
  case FileFormat::Obj:
    return readObj(path, progress);
  default:
    return readXyz(path, progress);
  }
}

}  // namespace spherical_param::tools
