#include "common/geometry_image_file.h"

#include "common/file_formats.h"
#include "common/input_file.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

namespace spherical_param::tools {
namespace {

constexpr int longest_side = 16385;
constexpr std::size_t pixel_size = 3 * sizeof(float);
constexpr std::size_t strip_size = std::size_t{1} << 18;  ///< about; bytes

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

/// The directory of a TIFF file: entries, then those values that have no room in them.
class Directory {
public:
  /// \param offset of the directory in the file; \param entries that it will have.
  Directory(std::uint32_t offset, std::size_t entries)
      : values_offset_(offset + static_cast<std::uint32_t>(2 + 12 * entries + 4)) {
    append(entries_, static_cast<std::uint16_t>(entries));
  }

  template <typename Value>
  void add(Tag tag, Type type, const std::vector<Value>& values) {
    append(entries_, static_cast<std::uint16_t>(tag));
    append(entries_, static_cast<std::uint16_t>(type));
    // A rational is two numbers.
    append(entries_, static_cast<std::uint32_t>(values.size() / (type == Rational ? 2 : 1)));
    std::string bytes;
    for (const Value value : values) {
      append(bytes, value);
    }
    if (bytes.size() <= 4) {
      bytes.resize(4, '\0');
      entries_ += bytes;
      return;
    }
    append(entries_, values_offset_ + static_cast<std::uint32_t>(values_.size()));
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    values_ += bytes;
  }

  std::size_t end() const { return values_offset_ + values_.size(); }

  std::string bytes() const {
    std::string bytes = entries_;
    append(bytes, std::uint32_t{0});  // there is no other directory
    return bytes + values_;
  }

private:
  std::string entries_;
  std::string values_;
  std::uint32_t values_offset_;
};

/// The size of the directory does not depend on the offsets in it.
Directory makeDirectory(std::uint32_t side, std::uint32_t rows_per_strip,
                        std::uint32_t first_strip) {
  constexpr std::uint32_t directory_offset = 8;
  const std::uint32_t row_size = side * static_cast<std::uint32_t>(pixel_size);
  std::vector<std::uint32_t> offsets;
  std::vector<std::uint32_t> sizes;
  for (std::uint32_t row = 0; row < side; row += rows_per_strip) {
    offsets.push_back(first_strip + row * row_size);
    sizes.push_back(std::min(rows_per_strip, side - row) * row_size);
  }
  const std::string_view text = "geometry image: x, y and z of an octahedral map of the sphere";
  std::vector<char> description(text.begin(), text.end());
  description.push_back('\0');

  using Shorts = std::vector<std::uint16_t>;
  using Longs = std::vector<std::uint32_t>;
  Directory directory(directory_offset, 15);
  directory.add(ImageWidth, Long, Longs{side});
  directory.add(ImageLength, Long, Longs{side});
  directory.add(BitsPerSample, Short, Shorts{32, 32, 32});
  directory.add(Compression, Short, Shorts{1});
  directory.add(PhotometricInterpretation, Short, Shorts{2});
  directory.add(ImageDescription, Ascii, description);
  directory.add(StripOffsets, Long, offsets);
  directory.add(SamplesPerPixel, Short, Shorts{3});
  directory.add(RowsPerStrip, Long, Longs{rows_per_strip});
  directory.add(StripByteCounts, Long, sizes);
  directory.add(XResolution, Rational, Longs{1, 1});
  directory.add(YResolution, Rational, Longs{1, 1});
  directory.add(PlanarConfiguration, Short, Shorts{1});
  directory.add(ResolutionUnit, Short, Shorts{1});
  directory.add(SampleFormat, Short, Shorts{3, 3, 3});
  return directory;
}

/// Reads any place of a file.
class RandomReader {
public:
  explicit RandomReader(const std::string& path)
      : path_(path), size_(checkInputFile(path)),
        file_(std::fopen(path.c_str(), "rb"), std::fclose) {
    if (!file_) {
      failReading(path_, systemMessage(errno), "check the rights of the file");
    }
  }

  std::uint64_t size() const { return size_; }

  void read(std::uint64_t offset, std::size_t count, char* bytes) {
    if (offset > size_ || count > size_ - offset) {
      failContent(path_, "it ends too early");
    }
    if (fseeko(file_.get(), static_cast<off_t>(offset), SEEK_SET) != 0 ||
        std::fread(bytes, 1, count, file_.get()) != count) {
      failReading(path_, std::ferror(file_.get()) != 0 ? systemMessage(errno) : "it has changed",
                  "check the disk that holds the file");
    }
  }

private:
  std::string path_;
  std::uint64_t size_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

/// The first directory of a TIFF file.
class TiffReader {
public:
  explicit TiffReader(const std::string& path) : path_(path), file_(path) {
    std::array<char, 8> header{};
    file_.read(0, std::min<std::uint64_t>(header.size(), file_.size()), header.data());
    const std::string_view mark(header.data(), 2);
    swapped_ = mark != byteOrderMark();
    if ((mark != "II" && mark != "MM") || integer(header.data() + 2, 2) != 42) {
      failContent(path_, "it is not a TIFF file");
    }
    const std::uint64_t offset = integer(header.data() + 4, 4);
    std::array<char, 2> count{};
    file_.read(offset, count.size(), count.data());
    std::string entries(12 * integer(count.data(), 2), '\0');
    file_.read(offset + 2, entries.size(), entries.data());
    for (std::size_t i = 0; i < entries.size(); i += 12) {
      entries_.emplace(static_cast<std::uint16_t>(integer(entries.data() + i, 2)),
                       entries.substr(i, 12));
    }
  }

  bool has(Tag tag) const { return entries_.count(tag) > 0; }

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
    std::string bytes(entry + 8, 4);
    if (size * count > bytes.size()) {
      const std::uint64_t offset = integer(entry + 8, 4);
      bytes.resize(size * count);
      file_.read(offset, bytes.size(), bytes.data());
    }
    std::vector<std::uint64_t> values;
    for (std::size_t i = 0; i < count; ++i) {
      values.push_back(integer(bytes.data() + size * i, size));
    }
    return values;
  }

  std::uint64_t value(Tag tag, std::uint64_t otherwise) {
    return values(tag, 1, otherwise).front();
  }

  void readFloats(std::uint64_t offset, std::vector<float>& floats) {
    bytes_.resize(sizeof(float) * floats.size());
    file_.read(offset, bytes_.size(), bytes_.data());
    if (swapped_) {
      for (std::size_t i = 0; i < bytes_.size(); i += sizeof(float)) {
        std::reverse(bytes_.begin() + static_cast<std::ptrdiff_t>(i),
                     bytes_.begin() + static_cast<std::ptrdiff_t>(i + sizeof(float)));
      }
    }
    std::memcpy(floats.data(), bytes_.data(), bytes_.size());
  }

  std::uint64_t size() const { return file_.size(); }

private:
  /// An integer of 2 or 4 bytes in the byte order of the file.
  std::uint64_t integer(const char* bytes, std::size_t size) const {
    const bool little = (byteOrderMark() == "II") != swapped_;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const auto byte = static_cast<unsigned char>(bytes[little ? size - 1 - i : i]);
      value = 256 * value + byte;
    }
    return value;
  }

  std::string path_;
  RandomReader file_;
  bool swapped_ = false;
  std::map<std::uint16_t, std::string> entries_;
  std::string bytes_;
};

/// Refuses what is a TIFF file, but of another kind. \return the side.
std::uint64_t checkKind(TiffReader& tiff, const std::string& path) {
  const auto refuse = [&path](const std::string& reason) {
    failReading(path, "it is not a geometry image: " + reason,
                "give an image of this tool, or three 32-bit floats a pixel without "
                "compression");
  };
  const std::uint64_t width = tiff.value(ImageWidth, 0);
  const std::uint64_t height = tiff.value(ImageLength, 0);
  if (width != height || width % 2 == 0 || width < 3 || width > longest_side) {
    refuse(std::to_string(width) + " x " + std::to_string(height) +
           " pixels are no square of an odd side from 3 to " + std::to_string(longest_side));
  }
  const std::uint64_t samples = tiff.value(SamplesPerPixel, 1);
  if (samples != 3) {
    refuse("it has " + counted(samples, "sample") + " a pixel");
  }
  for (const std::uint64_t bits : tiff.values(BitsPerSample, samples, 1)) {
    if (bits != 32) {
      refuse("it has samples of " + counted(bits, "bit"));
    }
  }
  for (const std::uint64_t format : tiff.values(SampleFormat, samples, 1)) {
    if (format != 3) {
      refuse("its samples are no floating-point numbers");
    }
  }
  if (tiff.value(Compression, 1) != 1) {
    refuse("it is compressed");
  }
  if (tiff.value(PlanarConfiguration, 1) != 1) {
    refuse("its samples are in planes of their own");
  }
  if (tiff.value(Orientation, 1) != 1) {
    refuse("its rows do not begin at the top left");
  }
  if (tiff.has(TileWidth)) {
    refuse("it has tiles");
  }
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
  const std::size_t row_size = pixel_size * side;
  const auto rows_per_strip =
      std::min(side, static_cast<std::uint32_t>(std::max<std::size_t>(strip_size / row_size, 1)));
  const std::size_t first_strip = makeDirectory(side, rows_per_strip, 0).end();
  constexpr std::uint16_t version = 42;
  constexpr std::uint32_t directory_offset = 8;
  std::string bytes(byteOrderMark());
  append(bytes, version);
  append(bytes, directory_offset);
  file.write(bytes);
  file.write(makeDirectory(side, rows_per_strip, static_cast<std::uint32_t>(first_strip)).bytes());
  for (std::uint32_t row = 0; row < side; ++row) {
    bytes.clear();
    for (std::uint32_t column = 0; column < side; ++column) {
      const auto pixel = static_cast<Eigen::Index>(std::size_t{row} * side + column);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        append(bytes, static_cast<float>(image.positions(axis, pixel)));
      }
    }
    file.write(bytes);
    if (progress && row % rows_per_strip == 0) {
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
  std::vector<float> floats;
  for (std::uint64_t strip = 0; strip < strips; ++strip) {
    const std::uint64_t first_row = strip * rows_per_strip;
    const std::uint64_t pixels = std::min(rows_per_strip, side - first_row) * side;
    if (sizes[strip] != pixels * pixel_size) {
      failContent(path, "strip " + std::to_string(strip) + " has " + std::to_string(sizes[strip]) +
                            " instead of " + std::to_string(pixels * pixel_size) + " bytes");
    }
    floats.resize(3 * pixels);
    tiff.readFloats(offsets[strip], floats);
    const auto read = Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>>(
        floats.data(), 3, static_cast<Eigen::Index>(pixels));
    if (!read.allFinite()) {
      failContent(path, "it has positions that are not finite");
    }
    image.positions.middleCols(static_cast<Eigen::Index>(first_row * side),
                               static_cast<Eigen::Index>(pixels)) = read.cast<double>();
    if (progress) {
      progress(static_cast<double>(strip + 1) / static_cast<double>(strips));
    }
  }
  return image;
}

}  // namespace spherical_param::tools
