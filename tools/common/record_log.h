#pragma once

#include "common/json_report.h"

#include <string>
#include <vector>

namespace spherical_param::tools {

/// A file of JSON lines: an object on each, added at the end.
///
/// Each line is written at once, and several programs may add to one file. A line that was cut off,
/// because its writer was killed, is ended first, so that it harms no other.
class RecordLog {
public:
  /// \param path "-" for the standard output, empty: nothing is kept. Makes the file if there is
  /// none. \throw Failure
  explicit RecordLog(const std::string& path);
  ~RecordLog();
  RecordLog(const RecordLog&) = delete;
  RecordLog& operator=(const RecordLog&) = delete;

  /// \throw Failure
  void append(const Json& record) const;

private:
  std::string path_;
  int descriptor_ = -1;
};

/// A text as it is read again from a record: what is no UTF-8, as names of files may be, is
/// replaced there.
std::string asRecorded(const std::string& text);

/// The objects of a file of JSON lines, in its order; lines that are none are left out. A file that
/// is not there has none. \throw Failure
std::vector<Json> readRecords(const std::string& path);

}  // namespace spherical_param::tools
