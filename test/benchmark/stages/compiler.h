#pragma once

namespace spherical_param::stages {

/// The compiler that built the benchmark, and with the same settings the library.
#ifdef __clang__
constexpr const char* kCompiler = __VERSION__;
#else
constexpr const char* kCompiler = "gcc " __VERSION__;
#endif

}  // namespace spherical_param::stages
