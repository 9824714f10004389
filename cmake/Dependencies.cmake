# What the libraries build against. Tools and tests find what else they need. doc/reference.md lists
# the bounds of their versions.
include(${PROJECT_SOURCE_DIR}/cmake/RequireVersion.cmake)
find_package(Eigen3 QUIET NO_MODULE)
if(NOT TARGET Eigen3::Eigen)
  message(FATAL_ERROR "Eigen was not found: install libeigen3-dev")
endif()
spherical_param_require_version(Eigen "${Eigen3_VERSION}" 3.3 libeigen3-dev 4)
find_package(Threads REQUIRED)
include(${PROJECT_SOURCE_DIR}/cmake/qhull.cmake)
if(NOT TARGET Qhull::qhull_r)
  message(FATAL_ERROR "qhull (libqhull_r) was not found: install libqhull-dev")
endif()
# The first with the reentrant library is 2015.0, alias 7.0. Without its CMake package, the version is unknown.
spherical_param_require_version(qhull "${Qhull_VERSION}" 7.0 libqhull-dev)

# FLANN's headers use lz4 on some systems without saying so.
find_library(LZ4_LIBRARY NAMES lz4 liblz4)
find_path(SPHERICAL_PARAM_LZ4_INCLUDE_DIR lz4.h)
find_path(SPHERICAL_PARAM_FLANN_INCLUDE_DIR flann/algorithms/kdtree_single_index.h)
if(NOT SPHERICAL_PARAM_FLANN_INCLUDE_DIR)
  message(FATAL_ERROR "FLANN was not found: install libflann-dev")
endif()
mark_as_advanced(SPHERICAL_PARAM_LZ4_INCLUDE_DIR SPHERICAL_PARAM_FLANN_INCLUDE_DIR)
spherical_param_version_of_header(lz4_version "${SPHERICAL_PARAM_LZ4_INCLUDE_DIR}/lz4.h"
  LZ4_VERSION_MAJOR LZ4_VERSION_MINOR LZ4_VERSION_RELEASE)
spherical_param_require_version(lz4 "${lz4_version}" 1.8 liblz4-dev)
spherical_param_version_of_header(flann_version
  "${SPHERICAL_PARAM_FLANN_INCLUDE_DIR}/flann/config.h" FLANN_VERSION_)
spherical_param_require_version(FLANN "${flann_version}" 1.9 libflann-dev)

if(NOT SPHERICAL_PARAM_BUILD_PCL)
  return()
endif()
find_package(PCL REQUIRED COMPONENTS common kdtree search)
spherical_param_require_version(PCL "${PCL_VERSION}" 1.12 libpcl-dev 2)

# Older PCL gives plain library targets and variables, newer PCL namespaced targets.
function(spherical_param_link_pcl target visibility)
  foreach(component IN LISTS ARGN)
    if(TARGET PCL::${component})
      target_link_libraries(${target} ${visibility} PCL::${component})
    else()
      target_link_libraries(${target} ${visibility} pcl_${component})
    endif()
  endforeach()
  target_include_directories(${target} SYSTEM ${visibility} "$<BUILD_INTERFACE:${PCL_INCLUDE_DIRS}>")
endfunction()
