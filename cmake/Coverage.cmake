# The target "coverage": what the tests of the core reach, as a table of its files, and an error where
# that is too little. There if SPHERICAL_PARAM_COVERAGE; preset coverage. Clang's source-based
# coverage: a branch is an outcome, true or false, of a condition, also of one within && and ||.
set(SPHERICAL_PARAM_COVERAGE_LINES 95 CACHE STRING "Least share of lines [%] for coverage")
set(SPHERICAL_PARAM_COVERAGE_BRANCHES 85 CACHE STRING "Least share of branches [%] for coverage")
set(SPHERICAL_PARAM_COVERAGE_HTML "" CACHE PATH "Folder for the sources with their counts, or none")
if(SPHERICAL_PARAM_COVERAGE)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "SPHERICAL_PARAM_COVERAGE needs clang: use the preset coverage")
  endif()
  if(NOT BUILD_SHARED_LIBS)
    message(FATAL_ERROR "SPHERICAL_PARAM_COVERAGE needs BUILD_SHARED_LIBS")
  endif()
endif()

# Counts what runs of a library. To be called for it by src.
function(spherical_param_count_coverage target)
  if(NOT SPHERICAL_PARAM_COVERAGE)
    return()
  endif()
  # Counts are not atomic, which would take most of the time: check_coverage.py runs each program on
  # one processor, where an addition to memory is not divided. Eigen counts, too, because functions
  # that do not would not be inlined. Of inline functions, the copies of the library must run and not
  # those of the tests, which count nothing.
  target_compile_options(${target} PRIVATE -fprofile-instr-generate -fcoverage-mapping)
  target_link_options(${target} PRIVATE -fprofile-instr-generate -Wl,-Bsymbolic-functions)
endfunction()

# After the tests' own targets.
function(spherical_param_add_coverage_target)
  if(NOT SPHERICAL_PARAM_COVERAGE)
    return()
  endif()
  if(NOT TARGET test_core)
    message(FATAL_ERROR "SPHERICAL_PARAM_COVERAGE needs SPHERICAL_PARAM_BUILD_TESTS")
  endif()
  find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter)
  # Those of the compiler's own version: the format of the counts is not fixed.
  string(REGEX MATCH "^[0-9]+" version "${CMAKE_CXX_COMPILER_VERSION}")
  get_filename_component(compiler "${CMAKE_CXX_COMPILER}" REALPATH)
  get_filename_component(folder "${compiler}" DIRECTORY)
  foreach(tool profdata cov)
    string(TOUPPER LLVM_${tool} variable)
    find_program(${variable} NAMES llvm-${tool} llvm-${tool}-${version} HINTS ${folder} REQUIRED)
  endforeach()
  set(html "")
  if(SPHERICAL_PARAM_COVERAGE_HTML)
    set(html --html ${SPHERICAL_PARAM_COVERAGE_HTML})
  endif()
  add_custom_target(coverage
    COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/cmake/check_coverage.py
            --source ${PROJECT_SOURCE_DIR} --work ${PROJECT_BINARY_DIR}/coverage
            --profdata ${LLVM_PROFDATA} --cov ${LLVM_COV}
            --library $<TARGET_FILE:spherical_param_core>
            --lines ${SPHERICAL_PARAM_COVERAGE_LINES}
            --branches ${SPHERICAL_PARAM_COVERAGE_BRANCHES} ${html}
            $<TARGET_FILE:test_core> $<TARGET_FILE:test_concurrency>
    COMMENT "Coverage of the core by its tests"
    USES_TERMINAL VERBATIM)
endfunction()
