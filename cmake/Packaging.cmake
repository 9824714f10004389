# Debian packages by CPack:
#
#   cmake --preset package && cmake --build --preset package
#   cpack --config build/package/CPackConfig.cmake
#
# They are named and split as Debian names and splits libraries: whoever runs programs with the core
# needs neither PCL nor headers. Every component of the installation has to be in one of the lists
# of COMPONENTS below, or among those without a package: cpack refuses to work otherwise, rather
# than leave files out silently.
set(debian_problems "")
set(debian_known license)  # the copyright file of each package says it

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
if(package_xml MATCHES "<url( type=\"website\")?>([^<]+)</url>")
  set(CPACK_PACKAGE_HOMEPAGE_URL "${CMAKE_MATCH_2}")
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SOURCE pcl-spherical-param)
# Older than -1, the revision that a package of Debian's own would begin with.
set(CPACK_DEBIAN_PACKAGE_RELEASE 0upstream1)
set(debian_version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/src)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# What Debian wants in the folder of every package. Not for `cmake --install`.
set(debian_dir ${PROJECT_BINARY_DIR}/debian)
file(MAKE_DIRECTORY ${debian_dir})
include(${PROJECT_SOURCE_DIR}/cmake/SourceDate.cmake)
find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_Interpreter_FOUND)
  execute_process(
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/make_debian_docs.py
            --source ${PROJECT_SOURCE_DIR} --output ${debian_dir} --name ${CPACK_PACKAGE_NAME}
            --version ${PROJECT_VERSION} --revision ${CPACK_DEBIAN_PACKAGE_RELEASE}
            --maintainer ${CPACK_PACKAGE_CONTACT} --date ${SPHERICAL_PARAM_SOURCE_DATE}
    RESULT_VARIABLE code ERROR_VARIABLE error)
  if(NOT code EQUAL 0)
    list(APPEND debian_problems "changelog and copyright could not be made: ${error}")
  endif()
else()
  list(APPEND debian_problems "Python was not found, which makes the manual pages: install python3")
endif()

# debian_package(<name> COMPONENTS <component>... SECTION <section> SUMMARY <text>
#                DESCRIPTION <text> [SAME_VERSION <package>...] [DEPENDS <package>...])
# SAME_VERSION: packages of ours that it depends on.
macro(debian_package name)
  cmake_parse_arguments(arg "" "SECTION;SUMMARY;DESCRIPTION"
    "COMPONENTS;SAME_VERSION;DEPENDS" ${ARGN})
  # The name of a group becomes part of names of variables.
  string(REGEX REPLACE "[^a-z0-9]" "_" group ${name})
  string(TOUPPER ${group} upper)
  install(FILES ${debian_dir}/copyright ${debian_dir}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${group}_doc EXCLUDE_FROM_ALL)
  foreach(component ${arg_COMPONENTS} ${group}_doc)
    string(TOUPPER ${component} upper_component)
    set(CPACK_COMPONENT_${upper_component}_GROUP ${group})
    list(APPEND CPACK_COMPONENTS_ALL ${component})
    list(APPEND debian_known ${component})
  endforeach()
  set(depends ${arg_DEPENDS})
  foreach(package IN LISTS arg_SAME_VERSION)
    list(APPEND depends "${package} (= ${debian_version})")
  endforeach()
  list(JOIN depends ", " CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${arg_SECTION})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${arg_SUMMARY}\n${about}${arg_DESCRIPTION}")
endmacro()

# Wrapped by hand: these lines are shown as they are.
set(about "The library meshes the point cloud of an object without holes through it
into a closed, manifold, genus-0 triangle mesh through every point, by way of
a map to the sphere, after the method of M. Zwicker and C. Gotsman (2004).
.
")
set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
debian_package(libspherical-param-core${abi} SECTION libs
  COMPONENTS core
  SUMMARY "meshing by spherical parameterisation - core library"
  DESCRIPTION "This is its core, which does not need PCL.")
debian_package(libspherical-param-core-dev SECTION libdevel
  COMPONENTS core_dev
  SAME_VERSION libspherical-param-core${abi} DEPENDS libeigen3-dev
  SUMMARY "meshing by spherical parameterisation - core, development files"
  DESCRIPTION "These are headers, CMake package and pkg-config file of its core, which does
not need PCL.")
debian_package(libpcl-spherical-param${abi} SECTION libs
  COMPONENTS pcl
  SAME_VERSION libspherical-param-core${abi}
  SUMMARY "meshing by spherical parameterisation - classes for PCL"
  DESCRIPTION "These are its classes for the Point Cloud Library, beginning with
pcl::SphericalParamReconstruction.")
debian_package(libpcl-spherical-param-dev SECTION libdevel
  COMPONENTS pcl_dev
  SAME_VERSION libpcl-spherical-param${abi} libspherical-param-core-dev
  # FLANN's headers, which those of PCL use, need lz4.
  DEPENDS libpcl-dev liblz4-dev
  SUMMARY "meshing by spherical parameterisation - classes for PCL, development files"
  DESCRIPTION "These are headers, CMake package and pkg-config file of its classes for the
Point Cloud Library.")
debian_package(pcl-spherical-param-tools SECTION science
  COMPONENTS tools
  SAME_VERSION libpcl-spherical-param${abi} libspherical-param-core${abi}
  SUMMARY "meshing by spherical parameterisation - command line tools"
  DESCRIPTION "These are tools that read and write PLY, PCD, OBJ and other formats: for
meshes, for remeshing, textures and morphs by way of the map to the sphere,
and for generated scans.")
if(SPHERICAL_PARAM_BUILD_PYTHON_MODULE)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  set(python_version ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR})
  set(next_python ${Python3_VERSION_MAJOR}.${next_minor})
  debian_package(python3-spherical-param SECTION python
    COMPONENTS python
    SAME_VERSION libspherical-param-core${abi}
    DEPENDS "python3 (>= ${python_version})" "python3 (<< ${next_python})" python3-numpy
    SUMMARY "meshing by spherical parameterisation - Python module"
    DESCRIPTION "This is its module for Python, with arrays of NumPy in and out.")
endif()

# The components that there are; those of subprojects, and files without a component, among them.
get_cmake_property(installed COMPONENTS)
list(REMOVE_ITEM installed ${debian_known})
foreach(component IN LISTS installed)
  list(APPEND debian_problems
    "no package has the install component '${component}': give it one in cmake/Packaging.cmake")
endforeach()
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr" OR NOT SPHERICAL_PARAM_HARDENING
   OR NOT CMAKE_SKIP_INSTALL_RPATH OR NOT BUILD_SHARED_LIBS OR NOT SPHERICAL_PARAM_BUILD_TOOLS)
  list(APPEND debian_problems
    "this build is not one for packages: configure with 'cmake --preset package'")
endif()
set(CPACK_SPHERICAL_PARAM_PROBLEMS ${debian_problems})
set(CPACK_SPHERICAL_PARAM_SOURCE_DATE ${SPHERICAL_PARAM_SOURCE_DATE})
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/package_settings.cmake)
set(CPACK_POST_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/finish_packages.cmake)
include(CPack)
