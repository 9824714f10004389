# Proves that check_layering.cmake finds what it is there for: each of these files, alone in a tree,
# must be refused, and a right one accepted.
#   cmake -DSOURCE_DIR=<checkout> -DWORK_DIR=<scratch> -P test_check_layering.cmake
cmake_minimum_required(VERSION 3.21)

# expect(<result> <file> <line>...): result is RIGHT or WRONG.
function(expect result file)
  file(REMOVE_RECURSE "${WORK_DIR}")
  list(JOIN ARGN "\n" content)
  file(WRITE "${WORK_DIR}/${file}" "${content}\n")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${WORK_DIR} -P ${SOURCE_DIR}/cmake/check_layering.cmake
    RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE error)
  file(REMOVE_RECURSE "${WORK_DIR}")
  if((result STREQUAL "RIGHT" AND NOT code EQUAL 0)
     OR (result STREQUAL "WRONG" AND NOT error MATCHES "${file}: "))
    message(FATAL_ERROR "${file} with '${ARGN}' is ${result}, but: '${error}'")
  endif()
endfunction()

expect(RIGHT include/spherical_param/types.h "#include <Eigen/Core>" "#include <vector>")
expect(WRONG include/spherical_param/types.h "#include \"spherical_param/errors.h\"")
expect(WRONG include/spherical_param/types.h "#include <pcl/point_types.h>")
expect(RIGHT include/spherical_param/neighbor_graph.h "#include \"spherical_param/types.h\"")
expect(WRONG include/spherical_param/neighbor_graph.h "  #  include <spherical_param/mesh_topology.h>")
expect(WRONG include/spherical_param/neighbor_graph.h "#include \"core/union_find.h\"")
expect(WRONG include/spherical_param/new_stage.h "#include <vector>")
expect(RIGHT include/spherical_param/reconstruct.h "#include \"spherical_param/sphere_embedding.h\"")
expect(RIGHT src/core/sphere_triangulation.cpp "#include <libqhull_r/qhull_ra.h>")
expect(WRONG src/core/mesh_topology.cpp "#include <libqhull_r/qhull_ra.h>")
expect(WRONG src/core/sphere_embedding.cpp "#include \"spherical_param/neighbor_graph.h\"")
expect(WRONG src/core/sphere_embedding.cpp "#include \"spherical_param/reconstruct.h\"")
expect(WRONG src/core/union_find.h "#include \"spherical_param/mesh_topology.h\"")
expect(RIGHT src/core/reconstruct.cpp "#include \"spherical_param/neighbor_graph.h\"")
expect(WRONG src/core/reconstruct.cpp "#include <pcl/point_cloud.h>")
expect(RIGHT include/pcl/surface/impl/spherical_param_reconstruction.hpp "#include <pcl/search/kdtree.h>")
expect(WRONG include/pcl/surface/spherical_param_reconstruction.h "#include <pcl/io/ply_io.h>")
expect(WRONG src/pcl/spherical_param_reconstruction.cpp "#include \"core/union_find.h\"")
expect(RIGHT src/pcl/spherical_param_kd_tree.cpp "#include <flann/util/matrix.h>")
expect(WRONG src/pcl/spherical_param_reconstruction.cpp "#include <flann/util/matrix.h>")
expect(RIGHT tools/tool.cpp "#include <pcl/io/ply_io.h>" "#include <boost/program_options.hpp>")
expect(WRONG tools/tool.cpp "#include <libqhull_r/qhull_ra.h>")
expect(WRONG tools/tool.cpp "#include <vtkActor.h>")
expect(WRONG test/core/test_smoothing.cpp "#include <pcl/point_types.h>")
