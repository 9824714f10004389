# SPHERICAL_PARAM_SOURCE_DATE: the time that generated files bear, in seconds since 1970, so that
# the same source gives the same bytes: SOURCE_DATE_EPOCH if the caller sets it, or the day of the
# release as CHANGELOG.md says, or the last change of CHANGELOG.md.
set(changelog ${PROJECT_SOURCE_DIR}/CHANGELOG.md)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${changelog})
set(SPHERICAL_PARAM_SOURCE_DATE "$ENV{SOURCE_DATE_EPOCH}")
if(NOT SPHERICAL_PARAM_SOURCE_DATE MATCHES "^[0-9]+$")
  string(REPLACE "." "\\." version "${PROJECT_VERSION}")
  file(STRINGS ${changelog} release REGEX "^## \\[?${version}\\]? - [0-9]+-[0-9]+-[0-9]+")
  set(command git -C ${PROJECT_SOURCE_DIR} log -1 --format=%ct -- ${changelog})
  if(release)
    string(REGEX MATCH "[0-9]+-[0-9]+-[0-9]+" day "${release}")
    set(command date -u -d "${day}" +%s)
  endif()
  execute_process(COMMAND ${command} OUTPUT_VARIABLE SPHERICAL_PARAM_SOURCE_DATE
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE code)
endif()
if(NOT SPHERICAL_PARAM_SOURCE_DATE MATCHES "^[0-9]+$")
  file(TIMESTAMP ${changelog} SPHERICAL_PARAM_SOURCE_DATE "%s" UTC)
endif()
