# Everything that the project builds against. The VTK-free parts of PCL for the library, the rest
# for tools and tests only.
find_package(Eigen3 3.3 REQUIRED NO_MODULE)
find_package(OpenMP COMPONENTS CXX)
include(${PROJECT_SOURCE_DIR}/cmake/qhull.cmake)
if(NOT TARGET Qhull::qhull_r)
  message(FATAL_ERROR "qhull (libqhull_r) was not found: install libqhull-dev")
endif()

# FLANN's headers use lz4 on some systems without saying so.
find_library(LZ4_LIBRARY lz4)

if(NOT SPHERICAL_PARAM_BUILD_PCL)
  return()
endif()
set(spherical_param_pcl_components common kdtree search)
if(SPHERICAL_PARAM_BUILD_TOOLS)
  list(APPEND spherical_param_pcl_components filters io)
endif()
if(SPHERICAL_PARAM_BUILD_TESTS)
  list(APPEND spherical_param_pcl_components octree)
endif()
find_package(PCL 1.12 REQUIRED COMPONENTS ${spherical_param_pcl_components})

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
