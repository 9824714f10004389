# The node of ROS 2. ROS 2 finds the package by this file, which is installed without the node, too.
file(WRITE ${PROJECT_BINARY_DIR}/package/ament_index "")
install(FILES ${PROJECT_BINARY_DIR}/package/ament_index
  DESTINATION ${CMAKE_INSTALL_DATADIR}/ament_index/resource_index/packages
  RENAME ${PROJECT_NAME} COMPONENT ros)
if(NOT SPHERICAL_PARAM_BUILD_ROS_NODES)
  return()
endif()

add_executable(spherical_param_node src/ros/ros2/spherical_param_node.cpp)
target_include_directories(spherical_param_node PRIVATE ${PROJECT_SOURCE_DIR}/src/ros)
target_link_libraries(spherical_param_node PRIVATE spherical_param_ros)
foreach(package IN LISTS ros2_packages)
  # Found again: the variables that cmake/Ros.cmake found are local to its function.
  find_package(${package} REQUIRED)
  target_link_libraries(spherical_param_node PRIVATE ${${package}_TARGETS})
  if(NOT ${package}_TARGETS)
    # Older packages give variables only.
    target_include_directories(spherical_param_node SYSTEM PRIVATE ${${package}_INCLUDE_DIRS})
    target_link_libraries(spherical_param_node PRIVATE ${${package}_LIBRARIES})
  endif()
endforeach()
spherical_param_compile_options(spherical_param_node)
file(RELATIVE_PATH libdir_from_node /prefix/lib/${PROJECT_NAME} /prefix/${CMAKE_INSTALL_LIBDIR})
set_target_properties(spherical_param_node PROPERTIES INSTALL_RPATH "$ORIGIN/${libdir_from_node}")
install(TARGETS spherical_param_node
  RUNTIME DESTINATION lib/${PROJECT_NAME} COMPONENT ros)
install(DIRECTORY src/ros/ros2/launch src/ros/ros2/config
  DESTINATION ${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME} COMPONENT ros)
