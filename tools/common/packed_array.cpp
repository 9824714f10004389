#include "common/packed_array.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>

namespace spherical_param::tools {
namespace {

std::uint32_t largestOf(PackedType type) {
  return type == PackedType::U8 ? 0xffU : type == PackedType::U16 ? 0xffffU : 0xffffffffU;
}

std::uint32_t quantizedValue(double value, double min, double max, double largest) {
  if (!(max > min)) {
    return 0;
  }
  const double share = (std::clamp(value, min, max) - min) / (max - min);
  return static_cast<std::uint32_t>(std::lround(share * largest));
}

/// Differences to the row before, their bytes by significance: most of the higher ones are alike.
std::string planesOf(const PackedArray& array) {
  const std::size_t rows = array.rows();
  const auto bytes = static_cast<std::size_t>(array.type);
  std::string planes(rows * array.components * bytes, '\0');
  for (std::size_t c = 0; c < array.components; ++c) {
    std::uint32_t before = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      const std::uint32_t value = array.values[row * array.components + c];
      const std::uint32_t difference = value - before;
      before = value;
      for (std::size_t b = 0; b < bytes; ++b) {
        planes[(c * bytes + b) * rows + row] = static_cast<char>((difference >> (8 * b)) & 0xffU);
      }
    }
  }
  return planes;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  // The best level takes several times as long for a hundredth of the size.
  constexpr int level = 6;
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                level) != Z_OK) {
    throw std::bad_alloc();
  }
  packed.resize(size);
  return packed;
}

}  // namespace

PackedArray quantized(const std::string& name, PackedType type, std::size_t components,
                      const std::vector<double>& values) {
  PackedArray array;
  array.name = name;
  array.type = type;
  array.components = components;
  array.min.assign(components, values.empty() ? 0.0 : std::numeric_limits<double>::infinity());
  array.max.assign(components, values.empty() ? 0.0 : -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < values.size(); ++i) {
    array.min[i % components] = std::min(array.min[i % components], values[i]);
    array.max[i % components] = std::max(array.max[i % components], values[i]);
  }
  array.values.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    array.values[i] = quantizedValue(values[i], array.min[i % components],
                                     array.max[i % components], largestOf(type));
  }
  return array;
}

PackedArray quantized(const std::string& name, PackedType type, const std::vector<double>& values,
                      double min, double max, std::size_t components) {
  PackedArray array;
  array.name = name;
  array.type = type;
  array.components = components;
  array.min.assign(components, min);
  array.max.assign(components, max);
  array.values.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    array.values[i] = quantizedValue(values[i], min, max, largestOf(type));
  }
  return array;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? digits[(bits >> (18 - 6 * k)) & 63U] : '=';
    }
  }
  return text;
}

std::string textOf(const PackedArray& array) {
  return base64(deflated(planesOf(array)));
}

}  // namespace spherical_param::tools
