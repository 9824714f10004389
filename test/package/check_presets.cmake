# Every preset can be expanded, and sets only options that the project has.
#   cmake -DSOURCE_DIR=<checkout> -DWORK_DIR=<scratch> -P check_presets.cmake
cmake_minimum_required(VERSION 3.21)

file(GLOB_RECURSE scripts ${SOURCE_DIR}/cmake/*.cmake)
set(options "")
foreach(script ${SOURCE_DIR}/CMakeLists.txt ${scripts})
  file(READ ${script} content)
  string(REGEX MATCHALL "(option\\(|set\\()SPHERICAL_PARAM_[A-Z_]+" found "${content}")
  list(APPEND options ${found})
endforeach()
list(TRANSFORM options REPLACE "^[a-z]+\\(" "")

# Expanded without the project: nothing is configured.
file(REMOVE_RECURSE ${WORK_DIR})
file(COPY ${SOURCE_DIR}/CMakePresets.json DESTINATION ${WORK_DIR})
file(READ ${SOURCE_DIR}/CMakePresets.json presets)
string(JSON last LENGTH "${presets}" configurePresets)
math(EXPR last "${last} - 1")
foreach(i RANGE 1 ${last})  # the first is hidden
  string(JSON name GET "${presets}" configurePresets ${i} name)
  execute_process(COMMAND ${CMAKE_COMMAND} -N --preset ${name} WORKING_DIRECTORY ${WORK_DIR}
    RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "preset ${name}: ${output}")
  endif()
  string(REGEX MATCHALL "SPHERICAL_PARAM_[A-Z_]+" used "${output}")
  foreach(option IN LISTS used)
    if(NOT option IN_LIST options)
      message(FATAL_ERROR "preset ${name} sets ${option}, which is no option of the project")
    endif()
  endforeach()
endforeach()
file(REMOVE_RECURSE ${WORK_DIR})
