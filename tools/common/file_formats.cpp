#include "common/file_formats.h"

#include "common/errors.h"
#include "common/text.h"

#include <filesystem>

namespace spherical_param::tools {
namespace {

bool isUsable(const FormatRow& row, FileUse use) {
  switch (use) {
  case FileUse::ReadCloud:
    return row.read_cloud != nullptr;
  case FileUse::WriteCloud:
    return row.write_cloud != nullptr;
  case FileUse::WriteMesh:
    return row.write_mesh != nullptr;
  }
  return false;
}

std::string purposeOf(FileUse use) {
  return use == FileUse::ReadCloud    ? "points are read from"
         : use == FileUse::WriteCloud ? "points are written to"
                                      : "meshes are written to";
}

}  // namespace

FileFormat formatOf(const std::string& path) {
  const std::string extension = lowerCase(std::filesystem::path(path).extension().string());
  for (const FormatRow& row : format_table) {
    if (row.extension == extension) {
      return &row;
    }
  }
  return nullptr;
}

std::string extensionsFor(FileUse use) {
  std::string text;
  for (const FormatRow& row : format_table) {
    if (isUsable(row, use)) {
      text += (text.empty() ? "" : " ") + std::string(row.extension);
    }
  }
  return text;
}

FileFormat requireFormat(const std::string& path, FileUse use, const std::string& others) {
  const FileFormat format = formatOf(path);
  if (format != nullptr && isUsable(*format, use)) {
    return format;
  }
  throw UsageError(inQuotes(path) + " has an extension that no " + purposeOf(use),
                   format != nullptr && format->extension == ".vtk"
                       ? "convert it to .pcd with PCL's tool: pcl_vtk2pcd in.vtk out.pcd"
                       : "use one of " + extensionsFor(use) + others);
}

}  // namespace spherical_param::tools
