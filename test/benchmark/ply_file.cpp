#include "ply_file.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace spherical_param::benchmark {
namespace {

/// Takes a number from the start of [at, end).
using Load = double (*)(const char*& at, const char* end);

template <typename Number>
double load(const char*& at, const char* end) {
  if (end - at < static_cast<std::ptrdiff_t>(sizeof(Number)))
    throw std::runtime_error("it ends early");
  Number value;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return static_cast<double>(value);
}

double parse(const char*& at, const char*) {
  char* after = nullptr;
  const double value = std::strtod(at, &after);
  if (after == at)
    throw std::runtime_error("a number is missing");
  at = after;
  return value;
}

const std::map<std::string, Load> kLoads = {
    {"char", load<std::int8_t>},     {"int8", load<std::int8_t>},
    {"uchar", load<std::uint8_t>},   {"uint8", load<std::uint8_t>},
    {"short", load<std::int16_t>},   {"int16", load<std::int16_t>},
    {"ushort", load<std::uint16_t>}, {"uint16", load<std::uint16_t>},
    {"int", load<std::int32_t>},     {"int32", load<std::int32_t>},
    {"uint", load<std::uint32_t>},   {"uint32", load<std::uint32_t>},
    {"float", load<float>},          {"float32", load<float>},
    {"double", load<double>},        {"float64", load<double>}};

struct Property {
  std::string name;
  Load count;  ///< of the entries of a list; null: it is a single number
  Load value;
};

struct Element {
  std::string name;
  Eigen::Index count = 0;
  std::vector<Property> properties;
};

/// Reads the header and moves `at` behind it.
std::vector<Element> readHeader(const char*& at, const char* end) {
  std::vector<Element> elements;
  bool text = false;
  while (at != end) {
    const char* line_end = static_cast<const char*>(std::memchr(at, '\n', end - at));
    if (line_end == nullptr)
      break;
    std::istringstream line(std::string(at, line_end));
    at = line_end + 1;
    std::string word;
    std::string type;
    line >> word >> type;
    if (word == "end_header")
      return elements;
    if (word == "format") {
      text = type == "ascii";
      if (!text && type != "binary_little_endian")
        throw std::runtime_error("its format is " + type);
    } else if (word == "element") {
      elements.push_back({type, 0, {}});
      line >> elements.back().count;
    } else if (word == "property" && !elements.empty()) {
      Property property{"", nullptr, nullptr};
      const auto loadOf = [&](const std::string& name) { return text ? parse : kLoads.at(name); };
      if (type == "list") {
        line >> type;
        property.count = loadOf(type);
        line >> type;
      }
      property.value = loadOf(type);
      line >> property.name;
      elements.back().properties.push_back(property);
    }
  }
  throw std::runtime_error("it has no PLY header");
}

Mesh readFrom(const char* at, const char* end) {
  Mesh mesh;
  std::vector<std::array<Index, 3>> triangles;
  for (const Element& element : readHeader(at, end)) {
    if (element.name == "vertex")
      mesh.points.setConstant(3, element.count, std::nan(""));
    std::vector<Index> corners;
    for (Eigen::Index i = 0; i < element.count; ++i)
      for (const Property& property : element.properties) {
        if (property.count == nullptr) {
          const double value = property.value(at, end);
          if (element.name == "vertex" && property.name.size() == 1 && property.name[0] >= 'x')
            mesh.points(property.name[0] - 'x', i) = value;
          continue;
        }
        corners.clear();
        for (double left = property.count(at, end); left > 0.0; --left)
          corners.push_back(static_cast<Index>(property.value(at, end)));
        if (element.name != "face" || property.name.rfind("vertex_ind", 0) != 0)
          continue;
        for (const Index corner : corners)
          if (corner < 0 || corner >= mesh.points.cols())
            throw std::runtime_error("vertex index " + std::to_string(corner) + " is out of range");
        for (std::size_t k = 2; k < corners.size(); ++k)
          triangles.push_back({corners[0], corners[k - 1], corners[k]});
      }
  }
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      mesh.triangles(k, static_cast<Eigen::Index>(t)) = triangles[t][static_cast<std::size_t>(k)];
  return mesh;
}

}  // namespace

Mesh readPly(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  try {
    return readFrom(bytes.data(), bytes.data() + bytes.size());
  } catch (const std::exception& error) {
    throw std::runtime_error("cannot read '" + path + "': " + error.what());
  }
}

void writePly(const std::string& path, const Mesh& mesh) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.points.cols()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
       << mesh.triangles.cols() << "\nproperty list uchar int vertex_indices\nend_header\n";
  const Eigen::Matrix3Xf points = mesh.points.cast<float>();
  file.write(reinterpret_cast<const char*>(points.data()),
             static_cast<std::streamsize>(sizeof(float)) * points.size());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Matrix<std::int32_t, 3, 1> corners = mesh.triangles.col(t);
    file.put(3).write(reinterpret_cast<const char*>(corners.data()), sizeof corners);
  }
  if (!file.flush())
    throw std::runtime_error("cannot write '" + path + "'");
}

}  // namespace spherical_param::benchmark
