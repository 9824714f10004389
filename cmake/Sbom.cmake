# A software bill of materials, SPDX 2.3, by cmake/make_sbom.py: of the whole build in
# sbom/<project>.spdx.json, made with all that is built, and of each component when it is installed,
# by then with the checksums of the files as they are installed.
include(${PROJECT_SOURCE_DIR}/cmake/SourceDate.cmake)
find_package(Python3 QUIET COMPONENTS Interpreter)
if(NOT Python3_Interpreter_FOUND)
  message(STATUS "No software bill of materials: it needs Python")
  return()
endif()

# sbom_dependency(<key of make_sbom.py> <relationship> <version> <file that its package has>
#                 <component>...).
set(sbom_dependencies "")
function(sbom_dependency key kind version file)
  list(JOIN ARGN "\", \"" components)
  string(APPEND sbom_dependencies "${sbom_separator}
    {\"key\": \"${key}\", \"kind\": \"${kind}\", \"version\": \"${version}\",
     \"file\": \"${file}\", \"components\": [\"${components}\"]}")
  set(sbom_dependencies "${sbom_dependencies}" PARENT_SCOPE)
  set(sbom_separator "," PARENT_SCOPE)
endfunction()
set(sbom_separator "")

# The files of each component.
set(sbom_components core)
set(sbom_core spherical_param_core)
set(sbom_core_dir ${CMAKE_INSTALL_LIBDIR})
if(TARGET pcl_spherical_param)
  list(APPEND sbom_components pcl)
  set(sbom_pcl pcl_spherical_param)
  set(sbom_pcl_dir ${CMAKE_INSTALL_LIBDIR})
endif()
if(SPHERICAL_PARAM_BUILD_TOOLS)
  list(APPEND sbom_components tools)
  set(sbom_tools "")
  foreach(tool morph reconstruction remesh scan texture)
    list(APPEND sbom_tools pcl_spherical_param_${tool})
  endforeach()
  set(sbom_tools_dir ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET spherical_param_python)
  # Installed by Python's own tools, too, without this.
  set(sbom_python spherical_param_python)
  set(sbom_python_dir python)
endif()
set(sbom_targets "")
set(sbom_files "")
foreach(component ${sbom_components} python)
  if(NOT sbom_${component})
    continue()
  endif()
  set(entries "")
  foreach(target IN LISTS sbom_${component})
    list(APPEND sbom_targets ${target})
    list(APPEND entries "{\"file\": \"$<TARGET_FILE:${target}>\",
      \"installed\": \"${sbom_${component}_dir}/$<TARGET_FILE_NAME:${target}>\"}")
  endforeach()
  list(JOIN entries ",\n     " entries)
  list(APPEND sbom_files "\"${component}\": [${entries}]")
endforeach()
list(JOIN sbom_files ",\n    " sbom_files)

# What is compiled in or builds; what is linked is read from the files. Static libraries of ours
# leave all to the final link, and list nothing.
if(TARGET Eigen3::Eigen)
  find_path(SPHERICAL_PARAM_EIGEN_HEADER Eigen/Core PATHS ${EIGEN3_INCLUDE_DIRS} NO_DEFAULT_PATH)
  mark_as_advanced(SPHERICAL_PARAM_EIGEN_HEADER)
  sbom_dependency(eigen DEPENDS_ON "${Eigen3_VERSION}"
    "${SPHERICAL_PARAM_EIGEN_HEADER}/Eigen/Core" ${sbom_components})
endif()
sbom_dependency(qhull DEPENDS_ON "${SPHERICAL_PARAM_QHULL_VERSION}" "" core)
if(TARGET pcl_spherical_param)
  sbom_dependency(pcl DEPENDS_ON "${PCL_VERSION}" "" pcl)
  sbom_dependency(flann DEPENDS_ON "${SPHERICAL_PARAM_FLANN_VERSION}"
    "${SPHERICAL_PARAM_FLANN_HEADER}" pcl)
endif()
if(SPHERICAL_PARAM_BUILD_TOOLS)
  find_package(nlohmann_json QUIET)
  find_path(SPHERICAL_PARAM_JSON_HEADER nlohmann/json.hpp)
  mark_as_advanced(SPHERICAL_PARAM_JSON_HEADER)
  sbom_dependency(nlohmann_json DEPENDS_ON "${nlohmann_json_VERSION}"
    "${SPHERICAL_PARAM_JSON_HEADER}/nlohmann/json.hpp" tools)
  if(SPHERICAL_PARAM_HAS_REPORT)
    sbom_dependency(three CONTAINS "" "${SPHERICAL_PARAM_THREE_DIR}/three.min.js" tools)
  endif()
endif()
sbom_dependency(cmake BUILD_TOOL_OF "${CMAKE_VERSION}" "${CMAKE_COMMAND}" ${sbom_components})
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(sbom_compiler gcc)
elseif(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  set(sbom_compiler clang)
else()
  set(sbom_compiler ${CMAKE_CXX_COMPILER_ID})
endif()
sbom_dependency(${sbom_compiler} BUILD_TOOL_OF "${CMAKE_CXX_COMPILER_VERSION}"
  "${CMAKE_CXX_COMPILER}" ${sbom_components})

file(READ ${PROJECT_SOURCE_DIR}/package.xml sbom_xml)
string(REGEX MATCH "<maintainer[^>]*>([^<]+)</maintainer>" sbom_supplier "${sbom_xml}")
set(sbom_supplier "${CMAKE_MATCH_1}")
set(sbom_url "")
if(sbom_xml MATCHES "<url( type=\"website\")?>([^<]+)</url>")
  set(sbom_url "${CMAKE_MATCH_2}")
endif()
file(STRINGS ${PROJECT_SOURCE_DIR}/LICENSE sbom_copyright REGEX "^Copyright" LIMIT_COUNT 1)
set(sbom_build ${PROJECT_BINARY_DIR}/sbom/build-$<CONFIG>.json)
file(GENERATE OUTPUT ${sbom_build} CONTENT "{
  \"name\": \"${PROJECT_NAME}\",
  \"version\": \"${PROJECT_VERSION}\",
  \"licence\": \"BSD-3-Clause\",
  \"copyright\": \"${sbom_copyright}\",
  \"supplier\": \"${sbom_supplier}\",
  \"url\": \"${sbom_url}\",
  \"date\": \"${SPHERICAL_PARAM_SOURCE_DATE}\",
  \"components\": {
    ${sbom_files}
  },
  \"dependencies\": [${sbom_dependencies}
  ]
}
")

set(sbom_script ${PROJECT_SOURCE_DIR}/cmake/make_sbom.py)
set(sbom ${PROJECT_BINARY_DIR}/sbom/${PROJECT_NAME}.spdx.json)
add_custom_command(OUTPUT ${sbom}
  COMMAND ${Python3_EXECUTABLE} ${sbom_script} ${sbom_build} ${sbom}
  DEPENDS ${sbom_script} ${sbom_build} ${sbom_targets}
  COMMENT "Software bill of materials"
  VERBATIM)
add_custom_target(sbom ALL DEPENDS ${sbom})

# After the rules that install the files, strip them and set where they look for libraries. The
# libraries of several architectures may be installed at a time, the names of these differ.
set(sbom_architecture ${CMAKE_LIBRARY_ARCHITECTURE})
if(NOT sbom_architecture)
  set(sbom_architecture ${CMAKE_SYSTEM_PROCESSOR})
endif()
foreach(component IN LISTS sbom_components)
  # Static libraries are for those who build.
  set(sbom_component ${component})
  if(NOT BUILD_SHARED_LIBS AND NOT component STREQUAL "tools")
    set(sbom_component ${component}_dev)
  endif()
  install(CODE "
    set(sbom_prefix \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
    set(sbom \"${CMAKE_INSTALL_DOCDIR}/${component}-${sbom_architecture}.spdx.json\")
    message(STATUS \"Installing: \${sbom_prefix}/\${sbom}\")
    execute_process(
      COMMAND \"${Python3_EXECUTABLE}\" \"${sbom_script}\" \"${sbom_build}\"
              \"\${sbom_prefix}/\${sbom}\" --component ${component} --prefix \"\${sbom_prefix}\"
      RESULT_VARIABLE code)
    if(NOT code EQUAL 0)
      message(FATAL_ERROR \"the software bill of materials could not be made\")
    endif()
    list(APPEND CMAKE_INSTALL_MANIFEST_FILES \"\${CMAKE_INSTALL_PREFIX}/\${sbom}\")"
    COMPONENT ${sbom_component})
endforeach()
