# The page of -report: bundled from tools/report by npm and esbuild, then put into the tools library
# as bytes. Nothing of it is needed when the tools run.
#
#   SPHERICAL_PARAM_BUILD_REPORT  AUTO: if there is npm; what fails leaves the tools without
#                                 -report. ON: what fails stops the build. OFF: without
#   SPHERICAL_PARAM_REPORT_PAGE   a page that was built before: neither npm nor network is needed
#   SPHERICAL_PARAM_NODE_MODULES  folder with three and esbuild, as package-lock.json says
set(SPHERICAL_PARAM_BUILD_REPORT AUTO CACHE STRING "Build the page of -report: AUTO, ON or OFF")
set_property(CACHE SPHERICAL_PARAM_BUILD_REPORT PROPERTY STRINGS AUTO ON OFF)
set(SPHERICAL_PARAM_REPORT_PAGE "" CACHE FILEPATH "Page of -report that was built before")
set(SPHERICAL_PARAM_NODE_MODULES "" CACHE PATH "node_modules for the page of -report")
foreach(given REPORT_PAGE NODE_MODULES)
  if(SPHERICAL_PARAM_${given} AND NOT EXISTS "${SPHERICAL_PARAM_${given}}")
    message(FATAL_ERROR "SPHERICAL_PARAM_${given}: there is no '${SPHERICAL_PARAM_${given}}'")
  endif()
endforeach()

find_program(SPHERICAL_PARAM_NPM npm)
find_program(SPHERICAL_PARAM_NODE NAMES node nodejs)
mark_as_advanced(SPHERICAL_PARAM_NPM SPHERICAL_PARAM_NODE)

set(report_missing "")
if(SPHERICAL_PARAM_REPORT_PAGE)
elseif(NOT SPHERICAL_PARAM_NODE)
  set(report_missing "node was not found")
elseif(NOT SPHERICAL_PARAM_NPM AND NOT SPHERICAL_PARAM_NODE_MODULES)
  set(report_missing "npm was not found")
endif()
if(NOT SPHERICAL_PARAM_BUILD_REPORT)
  set(report_missing "SPHERICAL_PARAM_BUILD_REPORT is off")
elseif(report_missing AND NOT SPHERICAL_PARAM_BUILD_REPORT STREQUAL "AUTO")
  message(FATAL_ERROR "The page of -report cannot be built: ${report_missing}. "
    "Install it, or give SPHERICAL_PARAM_REPORT_PAGE, or set SPHERICAL_PARAM_BUILD_REPORT to AUTO")
endif()

set(report_folder ${CMAKE_CURRENT_LIST_DIR}/report)
set(report_build_folder ${CMAKE_CURRENT_BINARY_DIR}/report)
set(report_source ${report_build_folder}/report_page.cpp)
if(report_missing)
  message(STATUS "The tools are built without -report: ${report_missing}")
  set(report_mode EMPTY)
  set(report_inputs "")
elseif(SPHERICAL_PARAM_REPORT_PAGE)
  set(report_mode GIVEN)
  set(report_inputs ${SPHERICAL_PARAM_REPORT_PAGE})
else()
  set(report_mode BUILD)
  set(report_inputs build.mjs package.json package-lock.json page.html style.css)
  foreach(part charts colors decode dom geometry history loader main modes shaders text views)
    list(APPEND report_inputs src/${part}.js)
  endforeach()
  list(TRANSFORM report_inputs PREPEND ${report_folder}/)
endif()
set(report_stamp ${report_build_folder}/report_page.stamp)
# Where AUTO fails (no network) the stamp is not written: the next build tries again.
add_custom_command(
  OUTPUT ${report_stamp}
  BYPRODUCTS ${report_source}
  COMMAND ${CMAKE_COMMAND}
    -D MODE=${report_mode}
    -D FOLDER=${report_folder}
    -D BUILD_FOLDER=${report_build_folder}
    -D SOURCE=${report_source}
    -D STAMP=${report_stamp}
    -D PAGE=${SPHERICAL_PARAM_REPORT_PAGE}
    -D NODE_MODULES=${SPHERICAL_PARAM_NODE_MODULES}
    -D NPM=${SPHERICAL_PARAM_NPM}
    -D NODE=${SPHERICAL_PARAM_NODE}
    -D REQUIRED=${SPHERICAL_PARAM_BUILD_REPORT}
    -P ${report_folder}/make_page.cmake
  DEPENDS ${report_inputs} ${report_folder}/make_page.cmake
  COMMENT "Page of -report"
  VERBATIM)
add_custom_target(spherical_param_report_page DEPENDS ${report_stamp})
set_source_files_properties(${report_source} PROPERTIES GENERATED ON)
target_sources(spherical_param_tools PRIVATE ${report_source})
add_dependencies(spherical_param_tools spherical_param_report_page)
# The licence of what the page holds of others; there is none without a page.
install(FILES ${report_build_folder}/third-party.txt
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools OPTIONAL)
