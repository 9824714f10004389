#include "common/cloud_reader.h"

#include "common/file_formats.h"
#include "common/input_file.h"

namespace spherical_param::tools {

PointData readCloud(const std::string& path, const FileProgress& progress) {
  const FileFormat format = requireFormat(path, FileUse::ReadCloud);
  checkInputFile(path);
  return format->read_cloud(path, progress);
}

}  // namespace spherical_param::tools
