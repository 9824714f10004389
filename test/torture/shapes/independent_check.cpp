#include "independent_check.h"

#include <vtkCellArray.h>
#include <vtkEdgeTable.h>
#include <vtkFeatureEdges.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataConnectivityFilter.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

namespace torture {
namespace {

using spherical_param::Index;
using spherical_param::Positions;

/// Made-up points, far from each other: VTK's filters must not merge what is near.
void fill(const Mesh& mesh, vtkPolyData* data) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (std::size_t v = 0; v < mesh.vertices; ++v) {
    const auto i = static_cast<double>(v);
    points->InsertNextPoint(i, std::fmod(i, 7.0), std::fmod(i, 11.0));
  }
  vtkNew<vtkCellArray> cells;
  for (const auto& triangle : mesh.triangles) {
    cells->InsertNextCell(3);
    for (const Index v : triangle)
      cells->InsertCellPoint(v);
  }
  data->SetPoints(points);
  data->SetPolys(cells);
}

vtkIdType featureEdges(vtkPolyData* data, bool boundary) {
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(data);
  edges->SetBoundaryEdges(boundary);
  edges->SetNonManifoldEdges(!boundary);
  edges->FeatureEdgesOff();
  edges->ManifoldEdgesOff();
  edges->ColoringOff();
  edges->Update();
  return edges->GetOutput()->GetNumberOfCells();
}

/// Whether the triangles around a vertex are one fan, all of them the same way round: what they
/// lead from and to are the same vertices, each once, in one ring.
bool isFan(vtkPolyData* data, vtkIdType v) {
  vtkNew<vtkIdList> cells;
  data->GetPointCells(v, cells);
  std::vector<std::pair<vtkIdType, vtkIdType>> steps;
  vtkNew<vtkIdList> corners;
  for (vtkIdType i = 0; i < cells->GetNumberOfIds(); ++i) {
    data->GetCellPoints(cells->GetId(i), corners);
    for (vtkIdType k = 0; k < 3; ++k)
      if (corners->GetId(k) == v)
        steps.emplace_back(corners->GetId((k + 1) % 3), corners->GetId((k + 2) % 3));
  }
  std::sort(steps.begin(), steps.end());
  if (steps.empty())
    return false;
  const vtkIdType first = steps.front().first;
  vtkIdType here = first;
  std::size_t taken = 0;
  do {
    const auto next = std::lower_bound(steps.begin(), steps.end(), std::pair(here, vtkIdType{-1}));
    if (next == steps.end() || next->first != here ||
        (next + 1 != steps.end() && (next + 1)->first == here))
      return false;
    here = next->second;
    ++taken;
  } while (here != first && taken <= steps.size());
  return taken == steps.size();
}

}  // namespace

std::vector<std::string> topologyFaults(const Mesh& mesh) {
  std::vector<std::string> faults;
  for (const auto& triangle : mesh.triangles) {
    for (const Index v : triangle)
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices)
        return {"index out of range"};
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
      return {"degenerate triangle"};
  }
  if (mesh.triangles.empty())
    return {"no triangle"};
  vtkNew<vtkPolyData> data;
  fill(mesh, data);
  if (featureEdges(data, true) > 0)
    faults.emplace_back("boundary edges");
  if (featureEdges(data, false) > 0)
    faults.emplace_back("non-manifold edges");

  std::set<std::pair<Index, Index>> directed;
  bool is_oriented = true;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      is_oriented = directed.emplace(triangle[k], triangle[(k + 1) % 3]).second && is_oriented;
  if (!is_oriented)
    faults.emplace_back("inconsistent orientation");

  data->BuildLinks();
  bool is_used = true;
  bool is_manifold = true;
  for (vtkIdType v = 0; v < data->GetNumberOfPoints(); ++v) {
    vtkNew<vtkIdList> cells;
    data->GetPointCells(v, cells);
    if (cells->GetNumberOfIds() == 0)
      is_used = false;
    else
      is_manifold = isFan(data, v) && is_manifold;
  }
  if (!is_used)
    faults.emplace_back("unused vertices");
  if (!is_manifold)
    faults.emplace_back("non-manifold vertices");

  vtkNew<vtkEdgeTable> edges;
  edges->InitEdgeInsertion(data->GetNumberOfPoints());
  for (const auto& [from, to] : directed)
    if (edges->IsEdge(from, to) < 0)
      edges->InsertEdge(from, to);
  if (static_cast<long long>(mesh.vertices) - edges->GetNumberOfEdges() +
          static_cast<long long>(mesh.triangles.size()) !=
      2)
    faults.emplace_back("Euler number is not 2");

  vtkNew<vtkPolyDataConnectivityFilter> regions;
  regions->SetInputData(data);
  regions->SetExtractionModeToAllRegions();
  regions->Update();
  if (regions->GetNumberOfExtractedRegions() != 1)
    faults.emplace_back("several pieces");
  return faults;
}

std::size_t unusedVertices(const Mesh& mesh) {
  std::vector<bool> is_used(mesh.vertices, false);
  for (const auto& triangle : mesh.triangles)
    for (const Index v : triangle)
      if (v >= 0 && static_cast<std::size_t>(v) < mesh.vertices)
        is_used[static_cast<std::size_t>(v)] = true;
  return static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), false));
}

bool facesInward(const Positions& points, const Mesh& mesh) {
  using Vector = Eigen::Matrix<long double, 3, 1>;
  // The range of long double is that of double to the 16th power.
  static_assert(std::numeric_limits<long double>::max_exponent > 16000);
  const Vector origin = points.col(0).cast<long double>();
  long double volume = 0.0L;
  long double rounding = 0.0L;
  for (const auto& triangle : mesh.triangles) {
    const Vector a = points.col(triangle[0]).cast<long double>() - origin;
    const Vector b = points.col(triangle[1]).cast<long double>() - origin;
    const Vector c = points.col(triangle[2]).cast<long double>() - origin;
    volume += a.x() * (b.y() * c.z() - b.z() * c.y()) + a.y() * (b.z() * c.x() - b.x() * c.z()) +
              a.z() * (b.x() * c.y() - b.y() * c.x());
    rounding += std::abs(a.x()) * (std::abs(b.y() * c.z()) + std::abs(b.z() * c.y())) +
                std::abs(a.y()) * (std::abs(b.z() * c.x()) + std::abs(b.x() * c.z())) +
                std::abs(a.z()) * (std::abs(b.x() * c.y()) + std::abs(b.y() * c.x()));
  }
  // The library sums in double: what that cannot tell is no fault.
  return volume < -1e-12L * rounding;
}

namespace {

/// An octahedron, each of its triangles split in nine.
Mesh soundMesh(Positions& points) {
  Mesh mesh;
  std::vector<Eigen::Vector3d> places;
  const auto number = [&](const Eigen::Vector3d& p) {
    const auto index = std::find(places.begin(), places.end(), p) - places.begin();
    if (index == static_cast<std::ptrdiff_t>(places.size()))
      places.push_back(p);
    return static_cast<Index>(index);
  };
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        const auto at = [&](int i, int j) {
          return number(Eigen::Vector3d(x * i, y * j, z * (3 - i - j)));
        };
        const auto add = [&](Index a, Index b, Index c) {
          if (x * y * z > 0)
            mesh.triangles.push_back({a, b, c});
          else
            mesh.triangles.push_back({a, c, b});
        };
        for (int i = 0; i < 3; ++i)
          for (int j = 0; i + j < 3; ++j) {
            add(at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + j < 2)
              add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
          }
      }
  mesh.vertices = places.size();
  points.resize(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = places[i];
  return mesh;
}

/// A closed, oriented surface with a hole through it.
Mesh torus() {
  constexpr Index m = 6;
  Mesh mesh;
  mesh.vertices = m * m;
  const auto at = [](Index i, Index j) { return i % m * m + j % m; };
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

struct Planted {
  const char* fault;  ///< as topologyFaults() calls it
  const char* how;
  std::function<void(Mesh&)> plant;
};

const std::vector<Planted>& planted() {
  static const std::vector<Planted> all{
      {"inconsistent orientation", "a flipped triangle",
       [](Mesh& mesh) { std::swap(mesh.triangles[17][0], mesh.triangles[17][1]); }},
      {"boundary edges", "a removed triangle",
       [](Mesh& mesh) { mesh.triangles.erase(mesh.triangles.begin() + 17); }},
      {"non-manifold edges", "a doubled triangle",
       [](Mesh& mesh) { mesh.triangles.push_back(mesh.triangles[17]); }},
      {"unused vertices", "a missing vertex", [](Mesh& mesh) { ++mesh.vertices; }},
      {"non-manifold vertices", "a pinched vertex",
       [](Mesh& mesh) {
         // Two vertices without a common neighbour become one, and the last takes the free number.
         const Index kept = mesh.triangles.front()[0];
         std::set<Index> near;
         for (int ring = 0; ring < 3; ++ring) {
           std::set<Index> next{kept};
           for (const auto& triangle : mesh.triangles)
             if (std::any_of(triangle.begin(), triangle.end(),
                             [&](Index v) { return v == kept || near.count(v) > 0; }))
               next.insert(triangle.begin(), triangle.end());
           near = std::move(next);
         }
         Index gone = 0;
         while (near.count(gone) > 0)
           ++gone;
         const auto last = static_cast<Index>(--mesh.vertices);
         for (auto& triangle : mesh.triangles)
           for (Index& v : triangle)
             v = v == gone ? kept : v == last ? gone : v;
       }},
      {"Euler number is not 2", "a torus", [](Mesh& mesh) { mesh = torus(); }},
      {"several pieces", "two pieces",
       [](Mesh& mesh) {
         const auto count = static_cast<Index>(mesh.vertices);
         const auto once = mesh.triangles;
         for (const auto& triangle : once)
           mesh.triangles.push_back(
               {triangle[0] + count, triangle[1] + count, triangle[2] + count});
         mesh.vertices *= 2;
       }},
      {"index out of range", "an index out of range",
       [](Mesh& mesh) { mesh.triangles[3][1] = static_cast<Index>(mesh.vertices); }},
      {"degenerate triangle", "a degenerate triangle",
       [](Mesh& mesh) { mesh.triangles[3][1] = mesh.triangles[3][0]; }},
  };
  return all;
}

}  // namespace

std::vector<std::string> overlookedFaults() {
  std::vector<std::string> overlooked;
  Positions points;
  const Mesh sound = soundMesh(points);
  if (!topologyFaults(sound).empty() || unusedVertices(sound) != 0 || facesInward(points, sound))
    overlooked.emplace_back("a sound mesh is taken for a faulty one");
  for (const Planted& each : planted()) {
    Mesh mesh = sound;
    each.plant(mesh);
    const std::vector<std::string> faults = topologyFaults(mesh);
    if (std::find(faults.begin(), faults.end(), each.fault) == faults.end())
      overlooked.emplace_back(each.how);
  }
  Mesh inside_out = sound;
  for (auto& triangle : inside_out.triangles)
    std::swap(triangle[0], triangle[1]);
  if (!facesInward(points, inside_out))
    overlooked.emplace_back("a mesh that is inside out");
  Mesh missing = sound;
  ++missing.vertices;
  if (unusedVertices(missing) != 1)
    overlooked.emplace_back("a lost point");
  return overlooked;
}

std::size_t plantedFaults() {
  return planted().size() + 2;
}

}  // namespace torture
