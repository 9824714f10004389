#include "common/cloud_reader.h"

#include "common/file_formats.h"
#include "common/header_checks.h"
#include "common/input_file.h"
#include "common/library_output.h"
#include "common/record_reader.h"
#include "common/text_clouds.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <vtkDataArray.h>
#include <vtkDataSetReader.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkSmartPointer.h>
#include <vtkStringOutputWindow.h>
#include <vtkUnsignedCharArray.h>

#include <cstring>
#include <exception>
#include <optional>

namespace spherical_param::tools {
namespace {

const pcl::PCLPointField* findField(const pcl::PCLPointCloud2& cloud, const std::string& name) {
  for (const pcl::PCLPointField& field : cloud.fields) {
    if (field.name == name) {
      return &field;
    }
  }
  return nullptr;
}

template <typename Number>
Number load(const std::uint8_t* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Three fields of real numbers of one point.
class RealFields {
public:
  /// None if the cloud has no such fields or they hold no real numbers.
  static std::optional<RealFields> find(const pcl::PCLPointCloud2& cloud,
                                        const std::array<const char*, 3>& names) {
    RealFields fields;
    for (std::size_t d = 0; d < 3; ++d) {
      const pcl::PCLPointField* field = findField(cloud, names[d]);
      if (field == nullptr || (field->datatype != pcl::PCLPointField::FLOAT32 &&
                               field->datatype != pcl::PCLPointField::FLOAT64)) {
        return std::nullopt;
      }
      fields.offsets_[d] = field->offset;
      fields.wide_[d] = field->datatype == pcl::PCLPointField::FLOAT64;
      if (field->offset + (fields.wide_[d] ? 8U : 4U) > cloud.point_step) {
        return std::nullopt;
      }
    }
    return fields;
  }

  std::array<double, 3> of(const std::uint8_t* point) const {
    std::array<double, 3> values{};
    for (std::size_t d = 0; d < 3; ++d) {
      const std::uint8_t* bytes = point + offsets_[d];
      values[d] = wide_[d] ? load<double>(bytes) : static_cast<double>(load<float>(bytes));
    }
    return values;
  }

private:
  std::array<std::size_t, 3> offsets_{};
  std::array<bool, 3> wide_{};
};

PointData fromCloud(const std::string& path, const pcl::PCLPointCloud2& cloud) {
  // Width and height may be wrong: a PLY file gives them once more as the view of a camera.
  const std::size_t count = cloud.point_step == 0 ? 0 : cloud.data.size() / cloud.point_step;
  const auto coordinates = RealFields::find(cloud, {"x", "y", "z"});
  if (count == 0 || !coordinates) {
    failContent(path, "it has no points with x, y and z");
  }
  auto normals = RealFields::find(cloud, {"normal_x", "normal_y", "normal_z"});
  if (!normals) {
    normals = RealFields::find(cloud, {"nx", "ny", "nz"});
  }
  const pcl::PCLPointField* color = findField(cloud, "rgba");
  const bool has_alpha = color != nullptr;
  if (color == nullptr) {
    color = findField(cloud, "rgb");
  }
  if (color != nullptr && color->offset + 4 > cloud.point_step) {
    color = nullptr;
  }

  PointData data;
  data.has_alpha = has_alpha && color != nullptr;
  data.points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* point = cloud.data.data() + i * cloud.point_step;
    data.addPoint(coordinates->of(point));
    if (normals) {
      data.normals.push_back(toPoint(normals->of(point)));
    }
    if (color != nullptr) {
      const auto packed = load<std::uint32_t>(point + color->offset);
      data.colors.push_back({static_cast<std::uint8_t>(packed >> 16U),
                             static_cast<std::uint8_t>(packed >> 8U),
                             static_cast<std::uint8_t>(packed),
                             static_cast<std::uint8_t>(data.has_alpha ? packed >> 24U : 255U)});
    }
  }
  return data;
}

template <typename Reader>
PointData readWithPcl(const std::string& path) {
  pcl::PCLPointCloud2 cloud;
  std::string trouble;
  {
    const LibraryOutputSilencer silencer;
    try {
      if (Reader().read(path, cloud) < 0) {
        trouble = "it is broken or not complete";
      }
    } catch (const std::exception& error) {
      trouble = std::string("it is broken: ") + error.what();
    }
  }
  if (!trouble.empty()) {
    failContent(path, trouble);
  }
  return fromCloud(path, cloud);
}

vtkUnsignedCharArray* findVtkColors(vtkPointData& attributes) {
  vtkDataArray* candidates[] = {attributes.GetScalars(), attributes.GetArray("Colors"),
                                attributes.GetArray("RGB"), attributes.GetArray("RGBA")};
  for (vtkDataArray* candidate : candidates) {
    auto* const colors = vtkUnsignedCharArray::SafeDownCast(candidate);
    if (colors != nullptr &&
        (colors->GetNumberOfComponents() == 3 || colors->GetNumberOfComponents() == 4)) {
      return colors;
    }
  }
  return nullptr;
}

/// Collects VTK's messages while it lives. VTK's readers leave what they could not read
/// uninitialised, and say so nowhere else.
class VtkMessages {
public:
  VtkMessages() : previous_(vtkOutputWindow::GetInstance()) {
    vtkOutputWindow::SetInstance(window_);
    vtkObject::GlobalWarningDisplayOn();
  }
  ~VtkMessages() {
    vtkObject::GlobalWarningDisplayOff();
    vtkOutputWindow::SetInstance(previous_);
  }
  VtkMessages(const VtkMessages&) = delete;
  VtkMessages& operator=(const VtkMessages&) = delete;

  bool any() { return !window_->GetOutput().empty(); }

private:
  vtkSmartPointer<vtkOutputWindow> previous_;
  vtkNew<vtkStringOutputWindow> window_;
};

/// VTK itself reads the file, not PCL's wrapper, which keeps colours of three channels named
/// "Colors" only, and no grids.
PointData readVtk(const std::string& path, std::uint64_t declared_points) {
  vtkNew<vtkDataSetReader> reader;
  vtkPointSet* set = nullptr;
  bool complaints = false;
  {
    const LibraryOutputSilencer silencer;
    VtkMessages messages;
    reader->SetFileName(path.c_str());
    reader->ReadAllColorScalarsOn();
    reader->ReadAllNormalsOn();
    reader->Update();
    set = vtkPointSet::SafeDownCast(reader->GetOutput());
    complaints = messages.any();
  }
  if (set == nullptr || complaints || reader->GetErrorCode() != 0 ||
      static_cast<std::uint64_t>(set->GetNumberOfPoints()) != declared_points) {
    failContent(path, "it is broken or not complete");
  }

  const vtkIdType count = set->GetNumberOfPoints();
  vtkPointData& attributes = *set->GetPointData();
  vtkDataArray* normals = attributes.GetNormals();
  if (normals != nullptr &&
      (normals->GetNumberOfTuples() != count || normals->GetNumberOfComponents() != 3)) {
    normals = nullptr;
  }
  vtkUnsignedCharArray* colors = findVtkColors(attributes);
  if (colors != nullptr && colors->GetNumberOfTuples() != count) {
    colors = nullptr;
  }
  const auto triple = [](const double* values) {
    return std::array<double, 3>{values[0], values[1], values[2]};
  };

  PointData data;
  data.has_alpha = colors != nullptr && colors->GetNumberOfComponents() == 4;
  data.points.reserve(static_cast<std::size_t>(count));
  for (vtkIdType i = 0; i < count; ++i) {
    data.addPoint(triple(set->GetPoint(i)));
    if (normals != nullptr) {
      data.normals.push_back(toPoint(triple(normals->GetTuple3(i))));
    }
    if (colors != nullptr) {
      Color color = {0, 0, 0, 255};
      for (int c = 0; c < colors->GetNumberOfComponents(); ++c) {
        color[static_cast<std::size_t>(c)] = colors->GetTypedComponent(i, c);
      }
      data.colors.push_back(color);
    }
  }
  return data;
}

/// What only PCL knows how to unpack is in memory as a whole: the file, its fields, the points.
template <typename Reader>
PointData readPoints(const std::string& path, const RecordLayout& layout,
                     const FileProgress& progress) {
  return layout.known ? readRecords(path, layout, progress) : readWithPcl<Reader>(path);
}

}  // namespace

PointData readCloud(const std::string& path, const FileProgress& progress) {
  const FileFormat format = requireFormat(path, FileUse::ReadCloud);
  const std::uint64_t file_size = checkInputFile(path);
  switch (format) {
  case FileFormat::Pcd:
    return readPoints<pcl::PCDReader>(path, checkPcdHeader(path, file_size), progress);
  case FileFormat::Ply:
    return readPoints<pcl::PLYReader>(path, checkPlyHeader(path, file_size), progress);
  case FileFormat::Obj:
    return readObj(path, progress);
  case FileFormat::Vtk:
    // VTK has no way to read a part: its arrays and our points are in memory together.
    return readVtk(path, checkVtkHeader(path, file_size));
  default:
    return readXyz(path, progress);
  }
}

}  // namespace spherical_param::tools
