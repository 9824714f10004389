#include "page_data.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>

namespace tool_test {
namespace {

using nlohmann::json;

const std::string base64_digits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string decodedBase64(const std::string& text) {
  std::string bytes;
  std::uint32_t bits = 0;
  unsigned count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const auto digit = base64_digits.find(c);
    EXPECT_NE(digit, std::string::npos);
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>((bits >> count) & 0xffU);
    }
  }
  return bytes;
}

std::string inflated(const std::string& packed) {
  std::string bytes(std::max<std::size_t>(1 << 20, 40 * packed.size()), '\0');
  auto length = static_cast<uLongf>(bytes.size());
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                       reinterpret_cast<const Bytef*>(packed.data()),
                       static_cast<uLong>(packed.size())),
            Z_OK);
  bytes.resize(length);
  return bytes;
}

/// Each number is the difference from that of the row before.
Array decodedArray(const json& about, const std::string& bytes) {
  const Eigen::Index components = about.at("components");
  const std::size_t size = about.at("bits").get<std::size_t>() / 8;
  const auto largest = static_cast<std::uint32_t>((std::uint64_t{1} << (8 * size)) - 1);
  Array array;
  array.integers.resize(components, static_cast<Eigen::Index>(bytes.size() / size) / components);
  array.values.resizeLike(array.integers);
  for (Eigen::Index i = 0; i < array.integers.size(); ++i) {
    std::uint32_t value = i < components ? 0 : array.integers(i - components);
    for (std::size_t b = 0; b < size; ++b)
      value +=
          std::uint32_t{static_cast<unsigned char>(bytes[static_cast<std::size_t>(i) * size + b])}
          << (8 * b);
    array.integers(i) = value & largest;
    const auto c = static_cast<std::size_t>(i % components);
    const double min = about.contains("min") ? about["min"][c].get<double>() : 0.0;
    const double max = about.contains("max") ? about["max"][c].get<double>() : largest;
    array.values(i) = min + array.integers(i) / static_cast<double>(largest) * (max - min);
  }
  return array;
}

}  // namespace

/// An element ends at the first "</script>".
Page decodedPage(const std::string& html) {
  const auto element = [&](const std::string& id) {
    const std::string start = "<script type=\"text/plain\" id=\"" + id + "\">";
    const std::size_t begin = html.find(start);
    EXPECT_NE(begin, std::string::npos) << id;
    return html.substr(begin + start.size(), html.find("</script>", begin) - begin - start.size());
  };
  Page page;
  page.data = json::parse(inflated(decodedBase64(element("data"))));
  for (const auto& [name, about] : page.data.at("arrays").items()) {
    page.texts[name] = element("array-" + name);
    page.arrays[name] = decodedArray(about, inflated(decodedBase64(page.texts[name])));
  }
  return page;
}

}  // namespace tool_test
