# Debian packages by CPack:
#
#   cmake --preset package && cmake --build --preset package
#   cpack --config build/package/CPackConfig.cmake
#
# They are named and split as Debian names and splits libraries: a program that uses the core needs
# neither PCL nor headers. Each component of the installation belongs to one package.
option(SPHERICAL_PARAM_PACKAGES "Make Debian packages; set by the preset package" OFF)
if(NOT SPHERICAL_PARAM_PACKAGES)
  return()
endif()

# Manual pages, from what the tools print with -h expert.
find_program(HELP2MAN help2man)
if(NOT HELP2MAN)
  message(FATAL_ERROR "help2man was not found, which makes the manual pages: install help2man")
endif()
set(pages "")
foreach(tool morph reconstruction remesh scan texture)
  set(name pcl_spherical_param_${tool})
  set(page ${PROJECT_BINARY_DIR}/man/${name}.1)
  add_custom_command(OUTPUT ${page}.gz
    COMMAND ${HELP2MAN} --no-info --help-option "-h expert" --name "meshing by spherical parameterisation"
            --output ${page} $<TARGET_FILE:${name}>
    COMMAND gzip -9nf ${page}
    DEPENDS ${name} COMMENT "Manual page of ${name}" VERBATIM)
  list(APPEND pages ${page}.gz)
endforeach()
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/man)
add_custom_target(man_pages ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pcl-spherical-param)
set(CPACK_PACKAGE_VENDOR "")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
file(READ ${PROJECT_SOURCE_DIR}/package.xml package_xml)
if(NOT package_xml MATCHES "<maintainer email=\"([^\"]+)\">([^<]+)</maintainer>")
  message(FATAL_ERROR "package.xml names no maintainer")
endif()
set(CPACK_PACKAGE_CONTACT "${CMAKE_MATCH_2} <${CMAKE_MATCH_1}>")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Older than -1, the revision that a package of Debian's own would begin with.
set(CPACK_DEBIAN_PACKAGE_RELEASE 0upstream1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS
  ${PROJECT_BINARY_DIR}/src ${PROJECT_BINARY_DIR}/src/core ${PROJECT_BINARY_DIR}/src/map)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

file(WRITE ${PROJECT_BINARY_DIR}/triggers "activate-noawait ldconfig\n")
set(packaged license)  # the copyright file of each package has its text
# debian_package(<name> SECTION <section> COMPONENT <component> ABOUT <text>
#                [SAME_VERSION <package of ours>...] [DEPENDS <package>...])
macro(debian_package name)
  cmake_parse_arguments(arg "" "SECTION;COMPONENT;ABOUT" "SAME_VERSION;DEPENDS" ${ARGN})
  # The name of a group becomes part of names of variables.
  string(MAKE_C_IDENTIFIER ${name} group)
  string(TOUPPER ${group} upper)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${group}_doc EXCLUDE_FROM_ALL)
  foreach(component ${arg_COMPONENT} ${group}_doc)
    string(TOUPPER ${component} upper_component)
    set(CPACK_COMPONENT_${upper_component}_GROUP ${group})
    list(APPEND CPACK_COMPONENTS_ALL ${component})
    list(APPEND packaged ${component})
  endforeach()
  set(depends ${arg_DEPENDS})
  foreach(package IN LISTS arg_SAME_VERSION)
    list(APPEND depends "${package} (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
  endforeach()
  list(JOIN depends ", " CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${arg_SECTION})
  if("${arg_SECTION}" STREQUAL "libs")
    set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/triggers)
  endif()
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "meshing by spherical parameterisation - ${arg_ABOUT}
Point clouds of objects, and of what one sensor saw from one place, become
triangle meshes through their points, with the parts, openings and handles that
they show (after M. Zwicker and C. Gotsman, 2004).")
endmacro()

set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(core libspherical-param-core${abi})
set(pcl libpcl-spherical-param${abi})
debian_package(${core} SECTION libs COMPONENT core ABOUT "core and map libraries")
debian_package(libspherical-param-core-dev SECTION libdevel COMPONENT core_dev
  ABOUT "core and map, development files" SAME_VERSION ${core} DEPENDS libeigen3-dev)
debian_package(${pcl} SECTION libs COMPONENT pcl ABOUT "classes for PCL" SAME_VERSION ${core})
# FLANN's headers, which those of PCL use, need lz4.
debian_package(libpcl-spherical-param-dev SECTION libdevel COMPONENT pcl_dev
  ABOUT "classes for PCL, development files"
  SAME_VERSION ${pcl} libspherical-param-core-dev DEPENDS libpcl-dev liblz4-dev)
debian_package(pcl-spherical-param-tools SECTION science COMPONENT tools
  ABOUT "command line tools" SAME_VERSION ${pcl} ${core})
if(SPHERICAL_PARAM_BUILD_PYTHON_MODULE)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  debian_package(python3-spherical-param SECTION python COMPONENT python ABOUT "Python module"
    SAME_VERSION ${core}
    DEPENDS "python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR})"
            "python3 (<< ${Python3_VERSION_MAJOR}.${next_minor})" python3-numpy)
endif()

# Files of a component that no package has would be left out silently.
get_cmake_property(left_out COMPONENTS)
list(REMOVE_ITEM left_out ${packaged})
if(left_out)
  message(FATAL_ERROR "no Debian package has the install component '${left_out}'")
endif()
include(CPack)
