# Sets SPHERICAL_PARAM_ROS_VERSION to the ROS that the nodes are built for: 1, 2 or empty.
#
# SPHERICAL_PARAM_BUILD_ROS: AUTO builds the nodes where catkin or colcon build this project as a package of ROS, unless
# packages are missing; ON stops if packages are missing; OFF.
set(SPHERICAL_PARAM_BUILD_ROS AUTO CACHE STRING "Build the nodes of ROS: ON, OFF or AUTO (by catkin and colcon)")
set_property(CACHE SPHERICAL_PARAM_BUILD_ROS PROPERTY STRINGS AUTO ON OFF)
set(SPHERICAL_PARAM_ROS_VERSION "")
# message_generation first: the other packages use its macros.
set(ros1_packages message_generation diagnostic_updater dynamic_reconfigure geometry_msgs nodelet
                  pcl_conversions pcl_msgs pluginlib roscpp sensor_msgs shape_msgs std_msgs
                  visualization_msgs)
set(ros2_packages diagnostic_msgs diagnostic_updater geometry_msgs pcl_conversions pcl_msgs rclcpp
                  rcl_interfaces sensor_msgs shape_msgs std_msgs visualization_msgs)

# The packages in the list that are missing. The function keeps their variables to itself and takes back their compile
# definitions, so that what does not use ROS is compiled as without it.
function(spherical_param_missing_packages result)
  get_directory_property(definitions COMPILE_DEFINITIONS)
  set(missing "")
  foreach(package IN LISTS ARGN)
    find_package(${package} QUIET)
    if(NOT ${package}_FOUND)
      list(APPEND missing ${package})
    endif()
  endforeach()
  set_directory_properties(PROPERTIES COMPILE_DEFINITIONS "${definitions}")
  set(${result} "${missing}" PARENT_SCOPE)
endfunction()

# Inside another package that has fetched this project, no nodes are built. catkin_make builds all packages below one
# top project, which lists them: there this project is a package, too.
set(is_package_of_ros ${PROJECT_IS_TOP_LEVEL})
get_filename_component(own_path ${PROJECT_SOURCE_DIR} REALPATH)
foreach(path IN LISTS CATKIN_ORDERED_PACKAGE_PATHS)
  get_filename_component(path ${path} REALPATH BASE_DIR ${CMAKE_SOURCE_DIR})
  if(path STREQUAL own_path)
    set(is_package_of_ros ON)
  endif()
endforeach()

if(SPHERICAL_PARAM_BUILD_ROS STREQUAL "AUTO" AND is_package_of_ros)
  # catkin_make, catkin_make_isolated and colcon for catkin define one of these. For ament, colcon only
  # sets a variable of the environment.
  if(DEFINED CATKIN_DEVEL_PREFIX OR DEFINED CATKIN_INSTALL_INTO_PREFIX_ROOT)
    set(SPHERICAL_PARAM_ROS_VERSION 1)
  elseif("$ENV{ROS_VERSION}" STREQUAL "2" AND DEFINED ENV{COLCON})
    set(SPHERICAL_PARAM_ROS_VERSION 2)
  endif()
elseif(SPHERICAL_PARAM_BUILD_ROS AND NOT SPHERICAL_PARAM_BUILD_ROS STREQUAL "AUTO")
  if("$ENV{ROS_VERSION}" MATCHES "^[12]$")
    set(SPHERICAL_PARAM_ROS_VERSION $ENV{ROS_VERSION})
  else()
    find_package(rclcpp QUIET)
    if(rclcpp_FOUND)
      set(SPHERICAL_PARAM_ROS_VERSION 2)
    else()
      set(SPHERICAL_PARAM_ROS_VERSION 1)
    endif()
  endif()
endif()

set(SPHERICAL_PARAM_BUILD_ROS_NODES OFF)
if(SPHERICAL_PARAM_ROS_VERSION)
  if(NOT SPHERICAL_PARAM_BUILD_PCL)
    set(missing "PCL (SPHERICAL_PARAM_BUILD_PCL=ON)")
  elseif(SPHERICAL_PARAM_ROS_VERSION EQUAL 1)
    spherical_param_missing_packages(missing catkin ${ros1_packages})
  else()
    spherical_param_missing_packages(missing ${ros2_packages})
  endif()
  list(JOIN missing " " missing)
  if(NOT missing)
    set(SPHERICAL_PARAM_BUILD_ROS_NODES ON)
  elseif(SPHERICAL_PARAM_BUILD_ROS STREQUAL "AUTO")
    message(STATUS "The nodes of ROS ${SPHERICAL_PARAM_ROS_VERSION} are not built; missing: ${missing}")
  else()
    message(FATAL_ERROR "The nodes of ROS ${SPHERICAL_PARAM_ROS_VERSION} need ${missing}: install "
      "what doc/guide.md names, or set SPHERICAL_PARAM_BUILD_ROS to OFF")
  endif()
endif()
