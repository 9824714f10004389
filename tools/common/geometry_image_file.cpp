#include "common/geometry_image_file.h"

#include "common/file_formats.h"
#include "common/input_file.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <string_view>
#include <vector>

namespace spherical_param::tools {
namespace {

constexpr int longest_side = 16385;
constexpr std::size_t pixel_size = 3 * sizeof(float);
constexpr std::size_t strip_size = std::size_t{1} << 18;  ///< about; bytes
constexpr std::uint32_t directory_offset = 8;

enum Tag : std::uint16_t {
  ImageWidth = 256,
  ImageLength = 257,
  BitsPerSample = 258,
  Compression = 259,
  PhotometricInterpretation = 262,
  ImageDescription = 270,
  StripOffsets = 273,
  Orientation = 274,
  SamplesPerPixel = 277,
  RowsPerStrip = 278,
  StripByteCounts = 279,
  XResolution = 282,
  YResolution = 283,
  PlanarConfiguration = 284,
  ResolutionUnit = 296,
  TileWidth = 322,
  SampleFormat = 339,
};

enum Type : std::uint16_t { Ascii = 2, Short = 3, Long = 4, Rational = 5 };

/// The mark of the byte order of this machine.
std::string_view byteOrderMark() {
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 1 ? "II" : "MM";
}

template <typename Value>
void append(std::string& bytes, Value value) {
  std::array<char, sizeof(Value)> raw{};
  std::memcpy(raw.data(), &value, sizeof(Value));
  bytes.append(raw.data(), raw.size());
}

/// All before the pixels: the header, the entries of the directory, and those values that have no
/// room in them. Its size does not depend on where the first strip is.
std::string headOf(std::uint32_t side, std::uint32_t rows_per_strip, std::uint32_t first_strip) {
  constexpr std::uint16_t version = 42;
  constexpr std::uint16_t entries = 15;
  constexpr std::size_t values_offset = directory_offset + 2 + 12 * entries + 4;
  std::string head(byteOrderMark());
  append(head, version);
  append(head, directory_offset);
  append(head, entries);
  std::string values;
  const auto add = [&](Tag tag, Type type, const auto& of_entry) {
    std::string bytes;
    for (const auto value : of_entry) {
      type == Short ? append(bytes, static_cast<std::uint16_t>(value)) : append(bytes, value);
    }
    append(head, static_cast<std::uint16_t>(tag));
    append(head, static_cast<std::uint16_t>(type));
    // A rational is two numbers.
    append(head, static_cast<std::uint32_t>(of_entry.size() / (type == Rational ? 2 : 1)));
    bytes.resize((bytes.size() + 3) / 4 * 4);
    if (bytes.size() > 4) {
      append(head, static_cast<std::uint32_t>(values_offset + values.size()));
    }
    (bytes.size() > 4 ? values : head) += bytes;
  };
  using Numbers = std::vector<std::uint32_t>;
  const std::uint32_t row_size = side * static_cast<std::uint32_t>(pixel_size);
  Numbers offsets;
  Numbers sizes;
  for (std::uint32_t row = 0; row < side; row += rows_per_strip) {
    offsets.push_back(first_strip + row * row_size);
    sizes.push_back(std::min(rows_per_strip, side - row) * row_size);
  }
  const std::string text = "geometry image: x, y and z of an octahedral map of the sphere";
  add(ImageWidth, Long, Numbers{side});
  add(ImageLength, Long, Numbers{side});
  add(BitsPerSample, Short, Numbers{32, 32, 32});
  add(Compression, Short, Numbers{1});
  add(PhotometricInterpretation, Short, Numbers{2});
  add(ImageDescription, Ascii, text + '\0');
  add(StripOffsets, Long, offsets);
  add(SamplesPerPixel, Short, Numbers{3});
  add(RowsPerStrip, Long, Numbers{rows_per_strip});
  add(StripByteCounts, Long, sizes);
  add(XResolution, Rational, Numbers{1, 1});
  add(YResolution, Rational, Numbers{1, 1});
  add(PlanarConfiguration, Short, Numbers{1});
  add(ResolutionUnit, Short, Numbers{1});
  add(SampleFormat, Short, Numbers{3, 3, 3});
  append(head, std::uint32_t{0});  // there is no other directory
  return head + values;
}

/// The first directory of a TIFF file.
class TiffReader {
public:
  explicit TiffReader(const std::string& path)
      : path_(path), size_(InputFile(path).size()), file_(path, std::ios::binary) {
    const std::string mark = read(0, std::min<std::uint64_t>(8, size_));
    swapped_ = mark.substr(0, 2) != byteOrderMark();
    if (mark.size() < 8 || (mark.substr(0, 2) != "II" && mark.substr(0, 2) != "MM") ||
        integer(&mark[2], 2) != 42) {
      failContent(path_, "it is not a TIFF file");
    }
    const std::uint64_t offset = integer(&mark[4], 4);
    const std::string entries = read(offset + 2, 12 * integer(read(offset, 2).data(), 2));
    for (std::size_t i = 0; i < entries.size(); i += 12) {
      entries_.emplace(integer(&entries[i], 2), entries.substr(i, 12));
    }
  }

  /// The values of an entry, the given one if it is not there. \param most that make sense.
  std::vector<std::uint64_t> values(Tag tag, std::size_t most, std::uint64_t otherwise) {
    const auto found = entries_.find(tag);
    if (found == entries_.end()) {
      return {otherwise};
    }
    const char* const entry = found->second.data();
    const std::uint64_t type = integer(entry + 2, 2);
    const std::uint64_t count = integer(entry + 4, 4);
    if ((type != Short && type != Long) || count < 1 || count > most) {
      failContent(path_, "its entry " + std::to_string(tag) + " makes no sense");
    }
    const std::size_t size = type == Short ? 2 : 4;
    const std::string bytes =
        size * count > 4 ? read(integer(entry + 8, 4), size * count) : std::string(entry + 8, 4);
    std::vector<std::uint64_t> values;
    for (std::size_t i = 0; i < count; ++i) {
      values.push_back(integer(&bytes[size * i], size));
    }
    return values;
  }

  std::uint64_t value(Tag tag, std::uint64_t otherwise) {
    return values(tag, 1, otherwise).front();
  }

  Eigen::Matrix3Xf readPixels(std::uint64_t offset, std::uint64_t count) {
    std::string bytes = read(offset, count * pixel_size);
    for (std::size_t i = 0; swapped_ && i < bytes.size(); i += sizeof(float)) {
      std::reverse(&bytes[i], &bytes[i] + sizeof(float));
    }
    Eigen::Matrix3Xf pixels(3, static_cast<Eigen::Index>(count));
    std::memcpy(pixels.data(), bytes.data(), bytes.size());
    return pixels;
  }

  std::uint64_t size() const { return size_; }

private:
  std::string read(std::uint64_t offset, std::uint64_t count) {
    if (offset > size_ || count > size_ - offset) {
      failContent(path_, "it ends too early");
    }
    std::string bytes(count, '\0');
    file_.seekg(static_cast<std::streamoff>(offset));
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(count))) {
      failReading(path_, "it has changed", "check the disk that holds the file");
    }
    return bytes;
  }

  /// An integer of 2 or 4 bytes in the byte order of the file.
  std::uint64_t integer(const char* bytes, std::size_t size) const {
    const bool little = (byteOrderMark() == "II") != swapped_;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value = 256 * value + static_cast<unsigned char>(bytes[little ? size - 1 - i : i]);
    }
    return value;
  }

  const std::string& path_;
  std::uint64_t size_;
  std::ifstream file_;
  bool swapped_ = false;
  std::map<std::uint64_t, std::string> entries_;
};

/// Refuses what is a TIFF file, but of another kind. \return the side.
std::uint64_t checkKind(TiffReader& tiff, const std::string& path) {
  const auto refuse_if = [&path](bool is_other, const std::string& reason) {
    if (is_other) {
      failReading(path, "it is not a geometry image: " + reason,
                  "give an image of this tool, or three 32-bit floats a pixel without compression");
    }
  };
  const std::uint64_t width = tiff.value(ImageWidth, 0);
  const std::uint64_t height = tiff.value(ImageLength, 0);
  const std::uint64_t samples = tiff.value(SamplesPerPixel, 1);
  refuse_if(width != height || width % 2 == 0 || width < 3 || width > longest_side,
            std::to_string(width) + " x " + std::to_string(height) +
                " pixels are no square of an odd side from 3 to " + std::to_string(longest_side));
  refuse_if(samples != 3, "it has " + counted(samples, "sample") + " a pixel");
  for (const std::uint64_t bits : tiff.values(BitsPerSample, samples, 1)) {
    refuse_if(bits != 32, "it has samples of " + counted(bits, "bit"));
  }
  for (const std::uint64_t format : tiff.values(SampleFormat, samples, 1)) {
    refuse_if(format != 3, "its samples are no floating-point numbers");
  }
  refuse_if(tiff.value(Compression, 1) != 1, "it is compressed");
  refuse_if(tiff.value(PlanarConfiguration, 1) != 1, "its samples are in planes of their own");
  refuse_if(tiff.value(Orientation, 1) != 1, "its rows do not begin at the top left");
  refuse_if(tiff.value(TileWidth, 0) != 0, "it has tiles");
  return width;
}

}  // namespace

bool isGeometryImageFile(const std::string& path) {
  const std::string extension = extensionOf(path);
  return extension == ".tif" || extension == ".tiff";
}

void writeGeometryImage(OutputFile& file, const GeometryImage& image,
                        const FileProgress& progress) {
  const auto side = static_cast<std::uint32_t>(image.side);
  const auto rows_per_strip = std::min(
      side, static_cast<std::uint32_t>(std::max<std::size_t>(strip_size / pixel_size / side, 1)));
  const std::size_t first_strip = headOf(side, rows_per_strip, 0).size();
  file.write(headOf(side, rows_per_strip, static_cast<std::uint32_t>(first_strip)));
  for (std::uint32_t row = 0; row < side; row += rows_per_strip) {
    const Eigen::Matrix3Xf pixels =
        image.positions
            .middleCols(Eigen::Index{row} * side,
                        Eigen::Index{std::min(rows_per_strip, side - row)} * side)
            .cast<float>();
    file.write({reinterpret_cast<const char*>(pixels.data()),
                static_cast<std::size_t>(pixels.size()) * sizeof(float)});
    if (progress) {
      progress(static_cast<double>(row) / side);
    }
  }
}

GeometryImage readGeometryImage(const std::string& path, const FileProgress& progress) {
  TiffReader tiff(path);
  const std::uint64_t side = checkKind(tiff, path);
  const std::uint64_t rows_per_strip = std::min(tiff.value(RowsPerStrip, side), side);
  if (rows_per_strip == 0) {
    failContent(path, "its strips have no rows");
  }
  const std::uint64_t strips = (side + rows_per_strip - 1) / rows_per_strip;
  const std::vector<std::uint64_t> offsets = tiff.values(StripOffsets, strips, 0);
  const std::vector<std::uint64_t> sizes = tiff.values(StripByteCounts, strips, 0);
  if (offsets.size() != strips || sizes.size() != strips) {
    failContent(path, "it has " + std::to_string(offsets.size()) + " of " + std::to_string(strips) +
                          " strips");
  }
  if (tiff.size() < pixel_size * side * side) {
    failContent(path, "it ends too early");
  }

  GeometryImage image;
  image.side = static_cast<int>(side);
  image.positions.resize(3, static_cast<Eigen::Index>(side * side));
  for (std::uint64_t strip = 0; strip < strips; ++strip) {
    const std::uint64_t first_row = strip * rows_per_strip;
    const std::uint64_t pixels = std::min(rows_per_strip, side - first_row) * side;
    if (sizes[strip] != pixels * pixel_size) {
      failContent(path, "strip " + std::to_string(strip) + " has " + std::to_string(sizes[strip]) +
                            " instead of " + std::to_string(pixels * pixel_size) + " bytes");
    }
    const Eigen::Matrix3Xf read = tiff.readPixels(offsets[strip], pixels);
    if (!read.allFinite()) {
      failContent(path, "it has positions that are not finite");
    }
    image.positions.middleCols(static_cast<Eigen::Index>(first_row * side), read.cols()) =
        read.cast<double>();
    if (progress) {
      progress(static_cast<double>(strip + 1) / static_cast<double>(strips));
    }
  }
  return image;
}

}  // namespace spherical_param::tools
