# Node and nodelet of ROS 1. The build tools expect a catkin package even if the packages that the
# nodes need are missing.
find_package(catkin QUIET)
if(NOT catkin_FOUND)
  return()
endif()
# cmake/Install.cmake makes the CMake and pkg-config packages.
if(NOT SPHERICAL_PARAM_BUILD_ROS_NODES)
  catkin_package(SKIP_CMAKE_CONFIG_GENERATION SKIP_PKG_CONFIG_GENERATION)
  return()
endif()

find_package(catkin REQUIRED COMPONENTS ${ros1_packages})
add_service_files(DIRECTORY src/ros/srv FILES Reconstruct.srv NOINSTALL)
generate_messages(DEPENDENCIES pcl_msgs sensor_msgs std_msgs)
catkin_package(SKIP_CMAKE_CONFIG_GENERATION SKIP_PKG_CONFIG_GENERATION)

add_library(spherical_param_nodelet SHARED
  src/ros/ros1/parameter_server.cpp
  src/ros/ros1/reconstruction_nodelet.cpp
  src/ros/ros1/reconstruction_server.cpp)
target_include_directories(spherical_param_nodelet PUBLIC ${PROJECT_SOURCE_DIR}/src/ros)
target_include_directories(spherical_param_nodelet SYSTEM PUBLIC
  ${CATKIN_DEVEL_PREFIX}/${CATKIN_GLOBAL_INCLUDE_DESTINATION} ${catkin_INCLUDE_DIRS})
target_link_libraries(spherical_param_nodelet PUBLIC spherical_param_ros ${catkin_LIBRARIES})
add_executable(spherical_param_node src/ros/ros1/spherical_param_node.cpp)
target_link_libraries(spherical_param_node PRIVATE spherical_param_nodelet)
foreach(target spherical_param_nodelet spherical_param_node)
  add_dependencies(${target} ${PROJECT_NAME}_generate_messages_cpp)
  spherical_param_compile_options(${target})
endforeach()
set_target_properties(spherical_param_nodelet PROPERTIES
  LIBRARY_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/lib)
file(RELATIVE_PATH libdir_from_node /prefix/${CATKIN_PACKAGE_BIN_DESTINATION}
     /prefix/${CMAKE_INSTALL_LIBDIR})
set_target_properties(spherical_param_node PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}
  INSTALL_RPATH "$ORIGIN/${libdir_from_node}")

install(TARGETS spherical_param_nodelet
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ros)
install(TARGETS spherical_param_node
  RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION} COMPONENT ros)
install(FILES src/ros/ros1/nodelets.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION} COMPONENT ros)
install(DIRECTORY src/ros/ros1/launch src/ros/ros1/config
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION} COMPONENT ros)
install(FILES src/ros/srv/Reconstruct.srv
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/srv COMPONENT ros)
