#include "common/cloud_reconstruction.h"

#include "common/cloud_reader.h"
#include "common/errors.h"
#include "common/text.h"
#include "spherical_param/mesh_measures.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace spherical_param::tools {
namespace {

CloudInfo infoOf(const PointData& data) {
  CloudInfo info;
  if (!data.normals.empty()) {
    info.normals =
        Eigen::Map<const Eigen::Matrix3Xf>(data.normals.front().data(), 3,
                                           static_cast<Eigen::Index>(data.normals.size()))
            .cast<double>();
  }
  if (data.viewpoint) {
    info.viewpoint = Eigen::Map<const Eigen::Vector3d>(data.viewpoint->data());
  }
  info.unused = data.unused;
  return info;
}

/// The points with the normals of their meshes.
std::shared_ptr<const PointData> withNormals(PointData data, const JoinedMesh& mesh) {
  data.normals.assign(data.points.size(), Normal{});
  const Positions normals = areaWeightedNormals(mesh.points, mesh.triangles);
  for (std::size_t v = 0; v < mesh.is_added.size(); ++v) {
    if (mesh.is_added[v] == 0) {
      const Eigen::Vector3d normal = normals.col(static_cast<Eigen::Index>(v)).stableNormalized();
      data.normals[static_cast<std::size_t>(mesh.input_of_vertex[v])] =
          toFloat({normal.x(), normal.y(), normal.z()});
    }
  }
  return std::make_shared<PointData>(std::move(data));
}

}  // namespace

void reconstructCloud(const std::string& path, const ReconstructionSettings& settings,
                      Console& console, CloudReconstruction& cloud) {
  console.begin("read");
  cloud.data = std::make_shared<PointData>(readCloud(path, console.updates(), settings.columns));
  const std::string& contents = cloud.data->contents;
  cloud.stages = {console.end(std::to_string(cloud.data->points.size()) + " points" +
                              (contents.empty() ? "" : "; " + contents))};
  std::string stage;
  std::size_t part = 0;  // from 1
  // Each stage begins when the one before ends.
  const auto show = [&](const Progress& progress) {
    if (!progress.remark.empty()) {
      console.remark(std::string(progress.remark));
    }
    const bool is_new_part = progress.parts > 1 && part != progress.part + 1;
    if (is_new_part || stage != progress.stage) {
      if (!stage.empty()) {
        console.end();
      }
      if (is_new_part) {
        part = progress.part + 1;
        console.beginPart("part " + std::to_string(part) + " of " + std::to_string(progress.parts));
      }
      stage = progress.stage;
      console.begin(stage);
    }
    console.update(progress.fraction, progress.done);
    return true;
  };
  Options options = settings.options;
  options.progress = std::cref(show);
  runLibrary("cannot mesh " + inQuotes(path), "check that the file is the right cloud", [&] {
    cloud.result = reconstruct(positionsOf(*cloud.data), options, {}, infoOf(*cloud.data));
  });
  if (!stage.empty()) {
    console.end();
  }
  if (cloud.data->has_null_normals) {
    cloud.data = withNormals(*cloud.data, joined(cloud.result));
  }
  cloud.stages.insert(cloud.stages.end(), cloud.result.stages.begin(), cloud.result.stages.end());
}

void requireMap(const std::string& name, const Surface& surface) {
  const std::string problem = name + " has no map to one sphere: ";
  if (surface.has_certain_triangles_only) {
    throw Failure(problem + "it is a tangle", "give -topology sphere, which maps it as it is");
  }
  if (surface.topology.components > 1) {
    throw Failure(problem + "its mesh is in " + counted(surface.topology.components, "piece"),
                  "give -topology sphere, which joins them");
  }
  if (surface.genus() > 0) {
    throw Failure(problem + "its mesh has " + counted(surface.genus(), "handle"),
                  "give -handles none, which cuts them");
  }
}

void requireSpheres(const std::string& path, const CloudReconstruction& cloud, bool of_all) {
  const std::vector<Surface>& surfaces = cloud.result.surfaces;
  for (std::size_t i = 0; i < (of_all ? surfaces.size() : 1); ++i) {
    if (surfaces[i].added_vertices > 0) {
      throw Failure(inQuotes(path) + " has no map to one sphere: vertices were added",
                    "give -fill flat, which adds none");
    }
    if (surfaces[i].sphere.cols() == 0) {
      const std::string part = surfaces.size() > 1 ? "part " + std::to_string(i + 1) + " of " : "";
      requireMap(part + inQuotes(path), surfaces[i]);
    }
  }
}

std::string leftOut(const CloudReconstruction& cloud) {
  std::size_t duplicates = 0;
  std::size_t merged = 0;
  for (const Surface& surface : cloud.result.surfaces) {
    duplicates += surface.duplicates();
    merged += surface.consolidation ? surface.consolidation->merged : 0;
  }
  std::string text;
  const auto add = [&text](const std::string& more) {
    text += (text.empty() || more.empty() ? "" : ", ") + more;
  };
  if (duplicates > 0) {
    add(counted(duplicates, "duplicate"));
  }
  if (merged > 0) {
    add(counted(merged, "point merged into another", "points merged into others"));
  }
  add(cloud.result.left_out.text());
  return text.empty() ? "nothing" : text;
}

Summary summaryOf(const std::string& path, const CloudReconstruction& cloud) {
  return {path + ", " + counted(cloud.data->points.size(), "point"),
          cloud.result.verdict,
          "",
          leftOut(cloud),
          {}};
}

std::string meshSize(std::size_t vertices, Eigen::Index triangles) {
  return counted(vertices, "vertex", "vertices") + ", " +
         counted(static_cast<std::size_t>(triangles), "triangle");
}

MeshView meshOf(const CloudReconstruction& cloud, const Surface& surface) {
  MeshView mesh(*cloud.data, surface.input_of_vertex, surface.triangles);
  mesh.moveTo(surface.points);
  if (surface.added_vertices > 0) {
    std::vector<std::uint8_t> added(surface.vertexCount() - surface.added_vertices, 0);
    added.resize(surface.vertexCount(), 1);
    mesh.markAdded(std::move(added));
  }
  return mesh;
}

MeshView meshOf(const CloudReconstruction& cloud, const JoinedMesh& joined) {
  MeshView mesh(*cloud.data, joined.input_of_vertex, joined.triangles);
  mesh.moveTo(joined.points);
  if (std::count(joined.is_added.begin(), joined.is_added.end(), 1) > 0) {
    mesh.markAdded(joined.is_added);
  }
  return mesh;
}

MeshView sphereOf(const CloudReconstruction& cloud, const std::vector<Index>& input_of_vertex,
                  const Triangles& triangles, const Positions& sphere) {
  MeshView view(*cloud.data, input_of_vertex, triangles);
  view.leaveOutNormals();
  view.moveTo(sphere);
  return view;
}

}  // namespace spherical_param::tools
