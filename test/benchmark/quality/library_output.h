#pragma once

namespace spherical_param::benchmark {

/// Keeps what libraries print away from the user while it lives, on both standard streams: a
/// program that fails says so in two lines, and JSON on the standard output must stay JSON.
class LibraryOutputSilencer {
public:
  LibraryOutputSilencer();
  ~LibraryOutputSilencer();
  LibraryOutputSilencer(const LibraryOutputSilencer&) = delete;
  LibraryOutputSilencer& operator=(const LibraryOutputSilencer&) = delete;

private:
  int standard_output_;
  int standard_error_;
};

}  // namespace spherical_param::benchmark
