#include "common/file_formats.h"

#include "common/errors.h"
#include "common/input_file.h"
#include "common/text.h"

#include <array>
#include <filesystem>
#include <system_error>

namespace spherical_param::tools {
namespace {

bool isUsable(const FormatRow& row, FileUse use) {
  return use == FileUse::ReadCloud    ? row.read_cloud != nullptr
         : use == FileUse::WriteCloud ? row.write_cloud != nullptr
                                      : row.write_mesh != nullptr;
}

/// A format that is not read, by its extension and perhaps how its files begin.
struct ForeignFormat {
  std::string_view extension;
  std::string_view beginning;
  const char* name;
  const char* remedy;
};

constexpr std::array foreign_formats = {
    ForeignFormat{".las", "LASF", "LAS", "pdal translate in.las out.ply"},
    ForeignFormat{".laz", "", "LAZ", "pdal translate in.laz out.ply"},
    ForeignFormat{".e57", "ASTM-E57", "E57",
                  "CloudCompare -SILENT -C_EXPORT_FMT PLY -O in.e57 -SAVE_CLOUDS"},
    ForeignFormat{".ptx", "", "PTX",
                  "CloudCompare -SILENT -C_EXPORT_FMT PLY -O in.ptx -SAVE_CLOUDS"},
    ForeignFormat{".glb", "glTF", "glTF, a mesh", "assimp export in.glb out.ply"},
    ForeignFormat{".gltf", "", "glTF, a mesh", "assimp export in.gltf out.ply"},
    ForeignFormat{".gii", "", "GIfTI, a mesh", "mris_convert in.gii out.stl"},
    ForeignFormat{".vtk", "# vtk DataFile", "VTK", "pcl_vtk2pcd in.vtk out.pcd"},
    ForeignFormat{".gz", "\x1f\x8b", "compressed by gzip", "gunzip in.ply.gz"},
    ForeignFormat{".zip", "PK\x03\x04", "a ZIP archive", "unzip in.zip"},
    ForeignFormat{".bag", "#ROSBAG", "a bag of ROS",
                  "rosrun pcl_ros bag_to_pcd in.bag /points out"},
    ForeignFormat{".db3", "SQLite format 3", "a bag of ROS 2",
                  "ros2 bag play in.db3 & ros2 run pcl_ros pointcloud_to_pcd"},
    ForeignFormat{".mcap", "\x89MCAP", "a bag of ROS 2",
                  "ros2 bag play in.mcap & ros2 run pcl_ros pointcloud_to_pcd"}};

[[noreturn]] void failForeign(const std::string& path, const ForeignFormat& format) {
  throw UsageError(inQuotes(path) + " is " + format.name + ", which no points are read from",
                   std::string("convert it: ") + format.remedy);
}

/// The extension that belongs to the content of a file; empty if it is not known.
std::string extensionOfContent(const std::string& path) {
  constexpr std::size_t max_bytes = 4096;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) ||
      std::filesystem::file_size(path, error) == 0) {
    return "";
  }
  InputFile file(path);
  const std::string_view content = file.peek(max_bytes);
  const auto begins = [&](std::string_view text) {
    return !text.empty() && content.compare(0, text.size(), text) == 0;
  };
  for (const ForeignFormat& format : foreign_formats) {
    if (begins(format.beginning)) {
      failForeign(path, format);
    }
  }
  if (begins("ply\n") || begins("ply\r")) {
    return ".ply";
  }
  if (begins("solid ")) {
    return ".stl";
  }
  if (lowerCase(content.substr(0, 5)) == "ncols") {
    return ".agr";
  }
  const std::string_view word = content.substr(0, content.find_first_of(" \r\n"));
  if (word.size() >= 3 && word.size() < 8 && word.find("OFF") == word.size() - 3) {
    return ".off";
  }
  if (content.find("FIELDS ") != std::string::npos && content.find("DATA ") != std::string::npos) {
    return ".pcd";
  }
  if (begins("v ") || content.find("\nv ") != std::string::npos) {
    return ".obj";
  }
  const bool is_text = content.find('\0') == std::string::npos;
  return is_text && content.find_first_of("0123456789") != std::string::npos ? ".txt" : "";
}

}  // namespace

std::string extensionOf(const std::string& path) {
  return lowerCase(std::filesystem::path(path).extension().string());
}

FileFormat formatOf(const std::string& path) {
  const std::string extension = extensionOf(path);
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

FileFormat requireFormat(const std::string& path, FileUse use) {
  FileFormat format = formatOf(path);
  if (use == FileUse::ReadCloud &&
      (format == nullptr || !isUsable(*format, use) || format->read_cloud == readText)) {
    const std::string extension = extensionOf(path);
    for (const ForeignFormat& foreign : foreign_formats) {
      if (extension == foreign.extension) {
        failForeign(path, foreign);
      }
    }
    const FileFormat content = formatOf("a" + extensionOfContent(path));
    format = content != nullptr ? content : format;
  }
  if (format != nullptr && isUsable(*format, use)) {
    return format;
  }
  throw UsageError(
      inQuotes(path) +
          (extensionOf(path).empty() ? " has no extension that " : " has an extension that no ") +
          (use == FileUse::ReadCloud    ? "points are read from"
           : use == FileUse::WriteCloud ? "points are written to"
                                        : "meshes are written to"),
      "use one of " + extensionsFor(use));
}

}  // namespace spherical_param::tools
