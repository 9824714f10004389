#include "common/file_formats.h"

#include "common/errors.h"
#include "common/text.h"

#include <array>
#include <filesystem>
#include <string_view>

namespace spherical_param::tools {
namespace {

struct FormatInfo {
  std::string_view extension;
  FileFormat format;
  bool read_cloud;
  bool write_cloud;
  bool write_mesh;
};

constexpr std::array<FormatInfo, 8> format_table = {{
    {".pcd", FileFormat::Pcd, true, true, false},
    {".ply", FileFormat::Ply, true, true, true},
    {".obj", FileFormat::Obj, true, true, true},
    {".vtk", FileFormat::Vtk, false, true, true},
    {".xyz", FileFormat::Xyz, true, true, false},
    {".txt", FileFormat::Xyz, true, true, false},
    {".stl", FileFormat::Stl, false, false, true},
    {".off", FileFormat::Off, false, false, true},
}};

bool isUsable(const FormatInfo& info, FileUse use) {
  switch (use) {
  case FileUse::ReadCloud:
    return info.read_cloud;
  case FileUse::WriteCloud:
    return info.write_cloud;
  case FileUse::WriteMesh:
    return info.write_mesh;
  }
  return false;
}

std::string_view nameOf(FileUse use) {
  switch (use) {
  case FileUse::ReadCloud:
    return "points are read from";
  case FileUse::WriteCloud:
    return "points are written to";
  case FileUse::WriteMesh:
    return "meshes are written to";
  }
  return "";
}

}  // namespace

std::optional<FileFormat> formatOf(const std::string& path) {
  const std::string extension = lowerCase(std::filesystem::path(path).extension().string());
  for (const FormatInfo& info : format_table) {
    if (info.extension == extension) {
      return info.format;
    }
  }
  return std::nullopt;
}

std::string extensionsFor(FileUse use) {
  std::string text;
  for (const FormatInfo& info : format_table) {
    if (isUsable(info, use)) {
      text += (text.empty() ? "" : " ") + std::string(info.extension);
    }
  }
  return text;
}

FileFormat requireFormat(const std::string& path, FileUse use, const std::string& others) {
  const std::optional<FileFormat> format = formatOf(path);
  for (const FormatInfo& info : format_table) {
    if (format == info.format && isUsable(info, use)) {
      return info.format;
    }
  }
  throw UsageError(inQuotes(path) + " has an extension that no " + std::string(nameOf(use)),
                   format == FileFormat::Vtk
                       ? "convert it to .pcd with PCL's tool: pcl_vtk2pcd in.vtk out.pcd"
                       : "use one of " + extensionsFor(use) + others);
}

}  // namespace spherical_param::tools
