#include "common/cloud_reader.h"

#include "common/file_formats.h"
#include "common/header_checks.h"
#include "common/input_file.h"
#include "common/record_reader.h"

namespace spherical_param::tools {

PointData readPcd(const std::string& path, const FileProgress& progress) {
  return readRecords(path, checkPcdHeader(path, checkInputFile(path)), progress);
}

PointData readPly(const std::string& path, const FileProgress& progress) {
  return readRecords(path, checkPlyHeader(path, checkInputFile(path)), progress);
}

PointData readCloud(const std::string& path, const FileProgress& progress) {
  const FileFormat format = requireFormat(path, FileUse::ReadCloud);
  checkInputFile(path);
  return format->read_cloud(path, progress);
}

}  // namespace spherical_param::tools
