#pragma once

#include "common/input_file.h"
#include "common/mesh_view.h"
#include "common/output_file.h"
#include "common/point_data.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

namespace spherical_param::tools {

/// How put() writes numbers: with blanks between them, or as bytes in an order.
enum class NumberStyle { Text, LittleEndian, BigEndian };

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
  bool isText() const { return style_ == NumberStyle::Text; }
  void useStyle(NumberStyle style) { style_ = style; }
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
  /// The fewest digits that distinguish the value from any other.
  template <typename Number>
  void number(Number value) {
    std::array<char, 32> digits;
    block_.append(digits.data(),
                  std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  }

  template <typename Number>
  void put(Number value) {
    if (isText()) {
      block_ += is_line_begun_ ? " " : "";
      is_line_begun_ = true;
      number(value);
      return;
    }
    std::array<char, sizeof value> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    if (style_ == NumberStyle::BigEndian) {
      std::reverse(bytes.begin(), bytes.end());
    }
    block_.append(bytes.data(), bytes.size());
  }
  /// A number in single precision, if that is enough.
  void put(double value, bool in_double) {
    in_double ? put(value) : put(static_cast<float>(value));
  }
  void put(const Point& values) {
    for (const double value : values) {
      put(value, in_double_);
    }
  }
  template <typename Number>
  void put(const std::array<Number, 3>& values) {
    for (const Number value : values) {
      put(value);
    }
  }
  /// Ends a line of put() in text, else what counts as a record.
  void end() { isText() ? endLine() : endRecord(); }

  void endLine() {
    block_ += '\n';
    is_line_begun_ = false;
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
  NumberStyle style_ = NumberStyle::Text;
  bool is_line_begun_ = false;
  std::size_t records_ = 0;
  std::size_t written_ = 0;
  const FileProgress& progress_;
  std::string block_;
};

}  // namespace spherical_param::tools
