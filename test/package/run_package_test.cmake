# Installs a build into a prefix, moves the prefix, and builds and runs foreign projects against it.
#   cmake -DBUILD_DIR= -DSOURCE_DIR= -DWORK_DIR= -DGENERATOR= -DCXX= -DLIBDIR= -DVERSION=
#         -DCOMPONENTS="core;core_dev;license" or more [-DPKG_CONFIG=] [-DPREFIX=]
#         -P run_package_test.cmake
# With PREFIX, an installation that exists already.
cmake_minimum_required(VERSION 3.21)

# run(<what> <command>...): fails the test with the command's output if the command fails.
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${what} failed (${code}):\n${out}")
  endif()
  message(STATUS "${what}: done")
  set(output "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
set(wanted include/spherical_param/version.h share/pcl_spherical_param/package.xml)
if(PREFIX)
  set(prefix ${PREFIX})
else()
  set(prefix ${WORK_DIR}/moved)
  foreach(component IN LISTS COMPONENTS)
    run("installation of ${component}" ${CMAKE_COMMAND} --install ${BUILD_DIR}
        --prefix ${WORK_DIR}/installed --component ${component})
  endforeach()
  # An installation that is packed or copied must work.
  file(RENAME ${WORK_DIR}/installed ${prefix})
  list(APPEND wanted share/doc/pcl_spherical_param/LICENSE)
endif()

foreach(file IN LISTS wanted)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
file(GLOB_RECURSE texts ${prefix}/*.cmake ${prefix}/*.pc ${prefix}/*.h ${prefix}/*.hpp)
foreach(text IN LISTS texts)
  file(READ ${text} content)
  foreach(path ${SOURCE_DIR} ${BUILD_DIR} ${WORK_DIR})
    string(FIND "${content}" "${path}" position)
    if(NOT position EQUAL -1)
      message(FATAL_ERROR "${text} holds a path of this machine: ${path}")
    endif()
  endforeach()
endforeach()

# The core must be found and work without PCL.
set(settings -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Debug
             -DCMAKE_PREFIX_PATH=${prefix})
set(parts core)
if("pcl" IN_LIST COMPONENTS)
  list(APPEND parts pcl)
endif()
set(settings_of_core -DCMAKE_DISABLE_FIND_PACKAGE_PCL=ON)
foreach(part IN LISTS parts)
  run("configuration against ${part}" ${CMAKE_COMMAND} ${settings} ${settings_of_${part}}
      -S ${SOURCE_DIR}/test/package/consumer_${part} -B ${WORK_DIR}/${part})
  run("build against ${part}" ${CMAKE_COMMAND} --build ${WORK_DIR}/${part})
  run("program that uses ${part}" ${CMAKE_COMMAND} -E chdir ${WORK_DIR} ${part}/consumer)
endforeach()

# The next major version is found but rejected. A component that does not exist is reported.
string(REGEX MATCH "^[0-9]+" major "${VERSION}")
math(EXPR next_major "${major} + 1")
file(WRITE ${WORK_DIR}/versions/CMakeLists.txt "
cmake_minimum_required(VERSION 3.21)
project(versions LANGUAGES CXX)
find_package(pcl_spherical_param ${next_major}.0 QUIET COMPONENTS core)
if(pcl_spherical_param_FOUND OR NOT pcl_spherical_param_CONSIDERED_VERSIONS STREQUAL ${VERSION})
  message(FATAL_ERROR \"seen: '\${pcl_spherical_param_CONSIDERED_VERSIONS}'\")
endif()
find_package(pcl_spherical_param QUIET COMPONENTS absent)
if(NOT pcl_spherical_param_NOT_FOUND_MESSAGE MATCHES \"there is no component 'absent'\")
  message(FATAL_ERROR \"an absent component: '\${pcl_spherical_param_NOT_FOUND_MESSAGE}'\")
endif()
")
run("refusal of other versions and components" ${CMAKE_COMMAND} ${settings}
    -S ${WORK_DIR}/versions -B ${WORK_DIR}/versions/build)

if(PKG_CONFIG)
  set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
  set(ENV{LD_LIBRARY_PATH} ${prefix}/${LIBDIR})
  set(name_of_core spherical_param_core)
  set(name_of_pcl pcl_spherical_param)
  # The line of doc/guide.md: reading files takes PCL's own library for it.
  set(packages_of_pcl pcl_io)
  set(definitions_of_pcl -DFILES)
  foreach(part IN LISTS parts)
    set(name ${name_of_${part}})
    run("pkg-config ${name}" ${PKG_CONFIG} --cflags --libs ${name} ${packages_of_${part}})
    separate_arguments(flags UNIX_COMMAND "${output}")
    run("compilation with pkg-config ${name}" ${CXX} -std=c++17
        ${SOURCE_DIR}/test/package/consumer_${part}/main.cpp -o ${WORK_DIR}/${name}
        ${definitions_of_${part}} ${flags})
    run("program compiled with pkg-config ${name}" ${CMAKE_COMMAND} -E chdir ${WORK_DIR} ./${name})
    run("version of ${name}" ${PKG_CONFIG} --modversion ${name})
    if(NOT output STREQUAL "${VERSION}\n")
      message(FATAL_ERROR "pkg-config says that ${name} has version ${output}")
    endif()
  endforeach()
  # --static gives what static libraries leave to the final link, for shared libraries too.
  run("pkg-config --static" ${PKG_CONFIG} --static --libs --cflags spherical_param_core)
  if(NOT output MATCHES "-lspherical_param_map -lspherical_param_core .*-lqhull_r")
    message(FATAL_ERROR "pkg-config --static does not link map, core and qhull: ${output}")
  endif()
  separate_arguments(flags UNIX_COMMAND "${output}")
  run("compilation with pkg-config --static" ${CXX} -std=c++17
      ${SOURCE_DIR}/test/package/consumer_core/main.cpp -o ${WORK_DIR}/static_by_pkg_config ${flags})
  run("program compiled with pkg-config --static" ${WORK_DIR}/static_by_pkg_config)
endif()

file(REMOVE_RECURSE ${WORK_DIR})
