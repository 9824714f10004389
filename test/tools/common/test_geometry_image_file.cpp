#include "common/geometry_image_file.h"

#include "common/errors.h"
#include "common/output_file.h"
#include "temporary_directory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

using tool_test::readFile;
using tool_test::writeFile;

/// An image with exact positions.
GeometryImage makeImage(int side) {
  GeometryImage image;
  image.side = side;
  image.positions.resize(3, side * side);
  for (Eigen::Index i = 0; i < image.positions.cols(); ++i)
    image.positions.col(i) << static_cast<double>(i), -0.5 * static_cast<double>(i), 7.0;
  return image;
}

constexpr std::size_t entries_offset = 10;

/// A TIFF file as TIFF 6.0 describes it, taken apart without the tools.
class Tiff {
public:
  explicit Tiff(std::string bytes) : bytes_(std::move(bytes)) {}

  std::uint32_t integer(std::size_t offset, std::size_t size) const {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < size; ++k)
      value |= std::uint32_t{static_cast<unsigned char>(bytes_.at(offset + k))} << (8 * k);
    return value;
  }
  std::size_t entryOf(std::uint32_t tag) const {
    std::size_t entry = entries_offset;
    while (integer(entry, 2) != tag)
      entry += 12;
    return entry;
  }
  std::vector<std::uint32_t> values(std::uint32_t tag) const {
    const std::size_t entry = entryOf(tag);
    const std::size_t size = integer(entry + 2, 2) == 3 ? 2 : 4;
    const std::size_t count = integer(entry + 4, 4);
    const std::size_t place = size * count > 4 ? integer(entry + 8, 4) : entry + 8;
    std::vector<std::uint32_t> result;
    for (std::size_t k = 0; k < count; ++k)
      result.push_back(integer(place + size * k, size));
    return result;
  }
  /// The same file with another value, of type and number as before.
  std::string with(std::uint32_t tag, std::uint16_t value) const {
    std::string other = bytes_;
    const std::size_t place = entryOf(tag) + 8;
    other.at(place) = static_cast<char>(value % 256);
    other.at(place + 1) = static_cast<char>(value / 256);
    return other;
  }
  const std::string& bytes() const { return bytes_; }

private:
  std::string bytes_;
};

class GeometryImageFile : public testing::Test {
protected:
  Tiff written(const GeometryImage& image) const {
    OutputFile file(path);
    writeGeometryImage(file, image);
    file.commit();
    return Tiff(readFile(path));
  }
  void expectRefused(const std::string& content, const std::string& cause) const {
    writeFile(path, content);
    try {
      readGeometryImage(path);
      ADD_FAILURE() << "was read, in spite of: " << cause;
    } catch (const Failure& failure) {
      EXPECT_NE(std::string(failure.what()).find(cause), std::string::npos) << failure.what();
      EXPECT_FALSE(failure.remedy().empty());
    }
  }

  const tool_test::TemporaryDirectory directory;
  const std::string path = directory.file("image.tif");
};

TEST_F(GeometryImageFile, IsATiffFileOfThreeFloatsAPixel) {
  using Values = std::vector<std::uint32_t>;
  const GeometryImage image = makeImage(33);
  const Tiff tiff = written(image);
  EXPECT_EQ(tiff.bytes().substr(0, 4), std::string("II*\0", 4));
  const std::map<std::uint32_t, Values> entries = {
      {256, {33}}, {257, {33}}, {258, {32, 32, 32}}, {259, {1}},
      {277, {3}},  {284, {1}},  {339, {3, 3, 3}},    {279, {12 * 33 * 33}}};
  for (const auto& [tag, values] : entries)
    EXPECT_EQ(tiff.values(tag), values) << tag;
  for (Eigen::Index i = 0; i < image.positions.size(); ++i) {
    const std::uint32_t bits =
        tiff.integer(tiff.values(273).front() + 4 * static_cast<std::size_t>(i), 4);
    float sample = 0.0F;
    std::memcpy(&sample, &bits, sizeof sample);
    ASSERT_EQ(static_cast<double>(sample), image.positions(i));
  }
}

TEST_F(GeometryImageFile, IsReadAsItWasWrittenAlsoInSeveralStrips) {
  for (const int side : {3, 301}) {  // the larger one has more than one strip
    const GeometryImage image = makeImage(side);
    EXPECT_EQ(written(image).values(273).size() > 1, side == 301);
    std::vector<double> shares;
    const GeometryImage read =
        readGeometryImage(path, [&](double share) { shares.push_back(share); });
    EXPECT_EQ(read.side, side);
    EXPECT_TRUE(read.positions == image.positions);
    EXPECT_EQ(shares.back(), 1.0);
  }
}

TEST_F(GeometryImageFile, FilesOfOtherProgramsAreReadInEitherByteOrder) {
  for (const char* name : {"little", "big", "strips"}) {
    const GeometryImage image =
        readGeometryImage(std::string(FUZZERS_CORPUS) + "/geometry_image/" + name);
    for (Eigen::Index i = 0; i < image.positions.cols(); ++i)
      EXPECT_EQ(image.positions.col(i), static_cast<double>(i) * Eigen::Vector3d(1.0, 0.5, -1.0));
  }
}

TEST_F(GeometryImageFile, WhatIsNoGeometryImageIsRefused) {
  const Tiff tiff = written(makeImage(9));
  const std::string& good = tiff.bytes();
  expectRefused("", "empty");
  expectRefused("no image at all", "not a TIFF file");
  expectRefused(good.substr(0, 100), "ends too early");
  expectRefused(good.substr(0, good.size() - 1), "ends too early");
  expectRefused(tiff.with(256, 8), "8 x 9 pixels");
  expectRefused(tiff.with(258, 60000), "ends too early");
  expectRefused(tiff.with(259, 5), "compressed");
  expectRefused(tiff.with(273, 60000), "ends too early");
  expectRefused(tiff.with(277, 1), "1 sample a pixel");
  expectRefused(tiff.with(278, 0), "no rows");
  expectRefused(tiff.with(278, 3), "1 of 3 strips");
  expectRefused(tiff.with(279, 12), "strip 0 has 12 instead of 972 bytes");
  expectRefused(tiff.with(284, 2), "planes");
  std::string infinite = good;
  const std::uint32_t bits = 0x7f800000;
  std::memcpy(infinite.data() + infinite.size() - 4, &bits, sizeof bits);
  expectRefused(infinite, "not finite");
}

}  // namespace
}  // namespace spherical_param::tools
