# Versions that are too old or too new are refused, with a message that says which are wanted and
# what to install.
#   cmake -DSOURCE_DIR=<checkout> -DWORK_DIR=<scratch> -P check_dependency_versions.cmake
# With -DFOUND=<version> -DBELOW=<version>: only asks for 1.12 of a package.
cmake_minimum_required(VERSION 3.21)
include(${SOURCE_DIR}/cmake/RequireVersion.cmake)
if(DEFINED FOUND)
  spherical_param_require_version(Sample "${FOUND}" 1.12 libsample-dev ${BELOW})
  return()
endif()

function(expect found below result)
  execute_process(COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${SOURCE_DIR} -DFOUND=${found}
    -DBELOW=${below} -P ${CMAKE_CURRENT_LIST_FILE}
    RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(result STREQUAL "good")
    if(NOT code EQUAL 0)
      message(FATAL_ERROR "'${found}' is refused: ${output}")
    endif()
  elseif(code EQUAL 0 OR NOT output MATCHES "Sample ${found} was found, but .*${result}.*libsample-dev")
    message(FATAL_ERROR "'${found}' is not refused as it should be: ${output}")
  endif()
endfunction()
expect(1.9 "" "1[.]12 or newer is needed")
expect(1.12 "" good)
expect(1.15.1 2 good)
expect(2.0 2 "older than 2")
expect("" 2 good)  # unknown

# Versions that headers define.
file(WRITE ${WORK_DIR}/sample.h "#define SAMPLE_TEXT \"1.9.2\"\n#define SAMPLE_MAJOR    3 /* of 9 */
#  define SAMPLE_MINOR 14\n")
spherical_param_version_of_header(text ${WORK_DIR}/sample.h SAMPLE_TEXT)
spherical_param_version_of_header(numbers ${WORK_DIR}/sample.h SAMPLE_MAJOR SAMPLE_MINOR)
spherical_param_version_of_header(none ${WORK_DIR}/absent.h SAMPLE_MAJOR)
if(NOT text STREQUAL "1.9.2" OR NOT numbers STREQUAL "3.14" OR NOT none STREQUAL "")
  message(FATAL_ERROR "versions of headers: '${text}', '${numbers}', '${none}'")
endif()
