# Checks who includes whom: cmake -DSOURCE_DIR=<checkout> -P check_layering.cmake
#
#   types.h, errors.h     nothing of ours
#   a stage's header      types.h, and headers of stages before it
#   a stage's source      its own header, types.h, errors.h, private helpers, and the three headers
#                         that answer questions and change nothing: point_set.h, mesh_topology.h,
#                         self_intersection.h
#   reconstruct           every stage
#   search                types.h, FLANN: the k-d tree of the PCL class and the Python module
#   pcl/surface           reconstruct.h, the stages' headers, PCL without I/O; its k-d tree search
#   python                everything of the core in public, its threads, search, pybind11
#   src/ros               reconstruct.h, the PCL class, PCL's messages; src/ros/ros1 and ros2 alone
#                         know ROS
#   tools                 everything of ours but private helpers, pcl/filters, Boost.Program_options,
#                         zlib; of PCL and VTK what writes files, but nothing that reads them: a
#                         broken file must not end the program
#
# A header of ours that is in none of the lists below is a violation as well: say where it belongs.
cmake_minimum_required(VERSION 3.21)

# In the order of the pipeline.
set(stages point_set outliers neighbor_graph graph_hierarchy sphere_embedding embedding_history
           sphere_triangulation mesh_topology mesh_measures self_intersection mesh_optimization
           surface_diagnosis smoothing sphere_map sphere_surface resampling
           spherical_harmonics texture_atlas morphing)

# Sources of a stage besides the one of its name: part, then stage.
set(ordered_points_stage point_set)
set(graph_building_stage neighbor_graph)
set(local_delaunay_graph_stage neighbor_graph)
foreach(part map_distortion map_hierarchy map_relaxation)
  set(${part}_stage sphere_map)
endforeach()
set(mesh_optimizer_stage mesh_optimization)
foreach(part rotation_search sphere_overlay)
  set(${part}_stage morphing)
endforeach()
set(sphere_cutting_stage texture_atlas)
set(texture_baking_stage texture_atlas)
set(untangling_stage resampling)
foreach(part block_cholesky embedding_energy embedding_newton multigrid multilevel_embedding planar_start)
  set(${part}_stage sphere_embedding)
endforeach()

set(of_eigen_and_std "Eigen/[A-Za-z]+" "[a-z_0-9]+")
set(ours_any "spherical_param/[a-z_]+\\.h" "pcl/surface/(impl/)?spherical_param_[a-z_]+\\.(h|hpp)")

set(violations "")

# Whether `include` matches one of the regular expressions that follow.
function(matches_any result include)
  set(${result} FALSE PARENT_SCOPE)
  foreach(pattern IN LISTS ARGN)
    if(include MATCHES "^(${pattern})$")
      set(${result} TRUE PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# The headers that the file may include, as regular expressions; NOTFOUND if it has no place.
function(allowed_includes result file)
  get_filename_component(stem "${file}" NAME_WE)
  get_filename_component(extension "${file}" LAST_EXT)
  if(file MATCHES "^src/core/" AND DEFINED ${stem}_stage)
    set(stem ${${stem}_stage})
  endif()
  set(allowed NOTFOUND)
  list(FIND stages "${stem}" position)

  if(file MATCHES "^include/spherical_param/(types|errors)\\.h$")
    set(allowed ${of_eigen_and_std})
  elseif(file STREQUAL "include/spherical_param/reconstruct.h")
    set(allowed ${of_eigen_and_std} "spherical_param/types\\.h")
    foreach(stage IN LISTS stages)
      list(APPEND allowed "spherical_param/${stage}\\.h")
    endforeach()
  elseif(file MATCHES "^include/spherical_param/" AND NOT position EQUAL -1)
    set(allowed ${of_eigen_and_std} "spherical_param/types\\.h")
    list(SUBLIST stages 0 ${position} earlier)
    foreach(stage IN LISTS earlier)
      list(APPEND allowed "spherical_param/${stage}\\.h")
    endforeach()
  elseif(file MATCHES "^src/core/reconstruct\\.cpp$")
    set(allowed ${of_eigen_and_std} "omp\\.h" "spherical_param/[a-z_]+\\.h" "core/[a-z_]+\\.h")
  elseif(file MATCHES "^src/core/")
    # A stage's source, or a private helper.
    set(allowed ${of_eigen_and_std} "omp\\.h" "spherical_param/(types|errors)\\.h"
                "core/[a-z_]+\\.h")
    if(NOT position EQUAL -1)
      list(APPEND allowed "spherical_param/(${stem}|point_set|mesh_topology|self_intersection)\\.h")
    endif()
    if(file STREQUAL "src/core/morphing.cpp")
      # The geodesic sphere that a morph may be sampled at is that of resampling.
      list(APPEND allowed "spherical_param/resampling\\.h")
    endif()
    if(file STREQUAL "src/core/sphere_triangulation.cpp")
      list(APPEND allowed "libqhull_r/[a-z_]+\\.h")
    endif()
  elseif(file MATCHES "^(include|src)/pcl/")
    set(allowed ${of_eigen_and_std} "omp\\.h" ${ours_any} "pcl/[A-Za-z0-9_]+\\.h"
                "pcl/(common|console|impl|kdtree|search|surface)/(impl/)?[a-z_]+\\.(h|hpp)")
    if(file STREQUAL "src/pcl/spherical_param_kd_tree.cpp")
      list(APPEND allowed "search/[a-z_]+\\.h")
    endif()
  elseif(file MATCHES "^src/search/")
    set(allowed ${of_eigen_and_std} "spherical_param/types\\.h" "flann/([a-z_]+/)?[a-z_]+\\.h")
  elseif(file MATCHES "^src/python/")
    set(allowed ${of_eigen_and_std} "spherical_param/[a-z_]+\\.h" "python/[a-z_]+\\.h"
                "pybind11/[a-z0-9_]+\\.h")
    if(file STREQUAL "src/python/neighbor_search.cpp")
      list(APPEND allowed "core/parallel\\.h" "search/[a-z_]+\\.h")
    endif()
  elseif(file MATCHES "^(include/spherical_param_ros|src/ros)/")
    set(allowed ${of_eigen_and_std} ${ours_any} "spherical_param_ros/[a-z_]+\\.h"
                "common/outlier_removal\\.h" "pcl/[A-Za-z0-9_]+\\.h")
    if(file MATCHES "^src/ros/ros[12]/")
      # The messages that are generated from our own, and the nodes' helpers.
      list(APPEND allowed "[a-z_]+/[A-Za-z0-9_/]+\\.(h|hpp)" "ros[12]/[a-z_]+\\.h")
    endif()
  elseif(file MATCHES "^tools/")
    set(allowed ${of_eigen_and_std} ${ours_any} "(common/)?[a-z_]+\\.h" "sys/[a-z_]+\\.h"
                "boost/program_options\\.hpp" "boost/program_options/.*" "nlohmann/json\\.hpp"
                "pcl/[A-Za-z0-9_]+\\.h"
                "pcl/(common|console|filters|kdtree|search|surface)/(impl/)?[a-z_]+\\.(h|hpp)")
    if(file MATCHES "^tools/common/")
      list(APPEND allowed "vtk(ImageData|New|Object|PNGWriter|UnsignedCharArray)\\.h")
    endif()
    if(file STREQUAL "tools/common/mesh_writer.cpp")
      # For the header of PCD files.
      list(APPEND allowed "pcl/io/pcd_io\\.h")
    endif()
    if(file STREQUAL "tools/common/packed_array.cpp")
      list(APPEND allowed "zlib\\.h")
    endif()
  elseif(file MATCHES "^test/(core|reference)/")
    # The core's tests, and what they compare it with, must build and run without PCL.
    set(allowed "[^/]+" "core/.*" "reference/.*" "Eigen/.*" "gtest/.*" "gmock/.*" "sys/.*"
                "spherical_param/.*")
  elseif(file MATCHES "^test/")
    set(allowed ".*")
  endif()
  set(${result} "${allowed}" PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE files RELATIVE "${SOURCE_DIR}"
  "${SOURCE_DIR}/include/*.h" "${SOURCE_DIR}/include/*.hpp"
  "${SOURCE_DIR}/src/*.h" "${SOURCE_DIR}/src/*.hpp" "${SOURCE_DIR}/src/*.cpp"
  "${SOURCE_DIR}/tools/*.h" "${SOURCE_DIR}/tools/*.cpp"
  "${SOURCE_DIR}/test/*.h" "${SOURCE_DIR}/test/*.cpp")
if(NOT files)
  message(FATAL_ERROR "no source files below '${SOURCE_DIR}'")
endif()
foreach(file IN LISTS files)
  allowed_includes(allowed "${file}")
  if(NOT allowed)
    list(APPEND violations "${file}: has no place in cmake/check_layering.cmake")
    continue()
  endif()
  file(STRINGS "${SOURCE_DIR}/${file}" lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^[ \t]*#[ \t]*include[ \t]*[<\"]([^>\"]+)[>\"].*$" "\\1" include "${line}")
    matches_any(is_allowed "${include}" ${allowed})
    if(NOT is_allowed)
      list(APPEND violations "${file}: must not include ${include}")
    endif()
  endforeach()
endforeach()

if(violations)
  list(JOIN violations "\n  " text)
  message(FATAL_ERROR "layering:\n  ${text}")
endif()
list(LENGTH files count)
message(STATUS "layering: ${count} files in order")
