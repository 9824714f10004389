# Gives the target Qhull::qhull_r, from qhull's own CMake package or without it. Also installed:
# static libraries of ours leave qhull to the final link.
find_package(Qhull CONFIG QUIET)
if(NOT TARGET Qhull::qhull_r AND TARGET Qhull::qhullstatic_r)
  add_library(Qhull::qhull_r ALIAS Qhull::qhullstatic_r)
elseif(NOT TARGET Qhull::qhull_r)
  find_path(QHULL_R_INCLUDE_DIR libqhull_r/libqhull_r.h)
  find_library(QHULL_R_LIBRARY qhull_r)
  if(QHULL_R_INCLUDE_DIR AND QHULL_R_LIBRARY)
    add_library(Qhull::qhull_r UNKNOWN IMPORTED)
    set_target_properties(Qhull::qhull_r PROPERTIES
      IMPORTED_LOCATION "${QHULL_R_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${QHULL_R_INCLUDE_DIR}")
  endif()
endif()
