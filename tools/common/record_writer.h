#pragma once

#include "common/block_reader.h"
#include "common/mesh_view.h"
#include "common/output_file.h"
#include "common/point_data.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace spherical_param::tools {

enum class ByteOrder { Little, Big };

/// Puts numbers and text of a file together and hands them to the file in blocks.
class RecordWriter {
public:
  /// \param in_double coordinates of points are doubles, not floats.
  /// \param progress  is called with the fraction that is written; may be empty.
  RecordWriter(OutputFile& file, bool in_double, const FileProgress& progress)
      : file_(file), in_double_(in_double), progress_(progress) {
    block_.reserve(block_size + longest_part);
  }

  bool inDouble() const { return in_double_; }
  /// \param records lines, or vertices and triangles, that will be written.
  void expect(std::size_t records) { records_ = records; }

  void text(std::string_view part) {
    block_ += part;
    sendIfFull();
  }
  /// 9 digits distinguish any two floats.
  void number(float value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                   std::chars_format::general, 9);
    block_.append(digits.data(), end.ptr);
  }
  void number(std::int64_t value) {
    std::array<char, 32> digits;
    block_.append(digits.data(),
                  std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  }
  /// The fewest digits that distinguish the value from any other double.
  void number(double value) {
    std::array<char, 32> digits;
    block_.append(digits.data(),
                  std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  }
  void numbers(const FloatTriple& values) {
    number(values[0]);
    block_ += ' ';
    number(values[1]);
    block_ += ' ';
    number(values[2]);
  }
  void numbers(const Point& values) {
    if (!in_double_) {
      numbers(toFloat(values));
      return;
    }
    number(values[0]);
    block_ += ' ';
    number(values[1]);
    block_ += ' ';
    number(values[2]);
  }

  void byte(std::uint8_t value) { block_ += static_cast<char>(value); }
  void word(std::uint32_t value, ByteOrder order) {
    std::array<char, 4> bytes{};
    for (unsigned i = 0; i < 4; ++i) {
      const unsigned shift = order == ByteOrder::Little ? 8 * i : 24 - 8 * i;
      bytes[i] = static_cast<char>(static_cast<std::uint8_t>(value >> shift));
    }
    block_.append(bytes.data(), bytes.size());
  }
  void word(float value, ByteOrder order) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    word(bits, order);
  }
  void word(double value, ByteOrder order) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    const auto low = static_cast<std::uint32_t>(bits);
    const auto high = static_cast<std::uint32_t>(bits >> 32U);
    word(order == ByteOrder::Little ? low : high, order);
    word(order == ByteOrder::Little ? high : low, order);
  }
  void words(const FloatTriple& values, ByteOrder order) {
    for (const float value : values) {
      word(value, order);
    }
  }
  void words(const Point& values, ByteOrder order) {
    if (!in_double_) {
      words(toFloat(values), order);
      return;
    }
    for (const double value : values) {
      word(value, order);
    }
  }
  void words(const Triangle& triangle, ByteOrder order) {
    for (const std::int32_t corner : triangle) {
      word(static_cast<std::uint32_t>(corner), order);
    }
  }

  void endLine() {
    block_ += '\n';
    endRecord();
  }
  void line(std::string_view whole) {
    text(whole);
    endLine();
  }
  /// Ends what counts as a record: a line, or the bytes of a vertex or triangle.
  void endRecord() {
    ++written_;
    sendIfFull();
  }

  /// Writes the rest.
  void finish() {
    file_.write(block_);
    block_.clear();
  }

private:
  static constexpr std::size_t block_size = std::size_t{1} << 20;
  /// Nothing longer is put together before the block is looked at again.
  static constexpr std::size_t longest_part = 4096;

  void sendIfFull() {
    if (block_.size() < block_size) {
      return;
    }
    finish();
    if (progress_ && records_ > 0) {
      progress_(std::min(1.0, static_cast<double>(written_) / static_cast<double>(records_)));
    }
  }

  OutputFile& file_;
  bool in_double_;
  std::size_t records_ = 0;
  std::size_t written_ = 0;
  const FileProgress& progress_;
  std::string block_;
};

}  // namespace spherical_param::tools
