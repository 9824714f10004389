# Installation: libraries, headers, CMake package with the components core and pcl, pkg-config
# files, package.xml. The map belongs to the component core. Nothing that is installed holds a path
# of the build machine, except those that PCL's own package puts into its targets.
#
# The components of the installation: core and pcl are what programs need to run, core_dev and
# pcl_dev what is needed to build them. cmake/Packaging.cmake makes packages of them.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pcl_spherical_param)

# One export set and install component for each: a user of core alone must not need PCL.
set(spherical_param_components core)
if(SPHERICAL_PARAM_BUILD_PCL)
  list(APPEND spherical_param_components pcl)
endif()
set(targets_of_core spherical_param_core spherical_param_map)
set(headers_of_core spherical_param)
set(targets_of_pcl pcl_spherical_param)
set(headers_of_pcl pcl)
foreach(component IN LISTS spherical_param_components)
  install(TARGETS ${targets_of_${component}} EXPORT pcl_spherical_param_${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}_dev
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
            NAMELINK_COMPONENT ${component}_dev
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
  install(EXPORT pcl_spherical_param_${component}
    NAMESPACE pcl_spherical_param::
    FILE pcl_spherical_param-${component}-targets.cmake
    DESTINATION ${package_dir}
    COMPONENT ${component}_dev)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/${headers_of_${component}}
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    COMPONENT ${component}_dev
    FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/include/spherical_param/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/spherical_param COMPONENT core_dev)

configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/pcl_spherical_paramConfig.cmake.in
  ${PROJECT_BINARY_DIR}/package/pcl_spherical_paramConfig.cmake
  INSTALL_DESTINATION ${package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/package/pcl_spherical_paramConfigVersion.cmake
  COMPATIBILITY SameMajorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/package/pcl_spherical_paramConfig.cmake
  ${PROJECT_BINARY_DIR}/package/pcl_spherical_paramConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT core_dev)

install(FILES ${PROJECT_SOURCE_DIR}/cmake/qhull.cmake
  DESTINATION ${package_dir} RENAME pcl_spherical_param-qhull.cmake COMPONENT core_dev)

# pkg-config: the prefix is relative to the file, so that the tree may be moved.
foreach(kind LIB INCLUDE)
  if(IS_ABSOLUTE "${CMAKE_INSTALL_${kind}DIR}")
    set(PKGCONFIG_${kind}DIR "${CMAKE_INSTALL_${kind}DIR}")
  else()
    set(PKGCONFIG_${kind}DIR "\${prefix}/${CMAKE_INSTALL_${kind}DIR}")
  endif()
endforeach()
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  set(PKGCONFIG_PREFIX "${CMAKE_INSTALL_PREFIX}")
else()
  file(RELATIVE_PATH up "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")
  string(REGEX REPLACE "/$" "" up "${up}")
  set(PKGCONFIG_PREFIX "\${pcfiledir}/${up}")
endif()
set(standard_library stdc++)
if("c++" IN_LIST CMAKE_CXX_IMPLICIT_LINK_LIBRARIES)
  set(standard_library c++)
endif()
set(PKGCONFIG_CORE_PRIVATE_LIBS "-lqhull_r -l${standard_library} -lm -pthread")
if(LZ4_LIBRARY)
  string(PREPEND PKGCONFIG_CORE_PRIVATE_LIBS "-llz4 ")
endif()
# With static libraries there is no other kind to link, so that --static must not be needed.
if(BUILD_SHARED_LIBS)
  set(PKGCONFIG_CORE_LIBS "")
else()
  set(PKGCONFIG_CORE_LIBS " ${PKGCONFIG_CORE_PRIVATE_LIBS}")
  set(PKGCONFIG_CORE_PRIVATE_LIBS "")
endif()
foreach(component IN LISTS spherical_param_components)
  list(GET targets_of_${component} 0 name)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${name}.pc.in
                 ${PROJECT_BINARY_DIR}/package/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/package/${name}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT ${component}_dev)
endforeach()

install(FILES ${PROJECT_SOURCE_DIR}/package.xml
  DESTINATION ${CMAKE_INSTALL_DATADIR}/pcl_spherical_param COMPONENT core_dev)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT license)
