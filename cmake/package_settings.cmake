# Read by cpack before it makes a package.
if(CPACK_GENERATOR STREQUAL "DEB")
  if(CPACK_SPHERICAL_PARAM_PROBLEMS)
    list(JOIN CPACK_SPHERICAL_PARAM_PROBLEMS "\n  " text)
    message(FATAL_ERROR "no Debian packages:\n  ${text}")
  endif()
  # The same source gives the same bytes.
  set(ENV{SOURCE_DATE_EPOCH} ${CPACK_SPHERICAL_PARAM_SOURCE_DATE})
endif()
