# BUILD_TESTING=OFF, as packagers give it, wins over the project's own switch.
#   cmake -DSOURCE_DIR=<checkout> -DWORK_DIR=<scratch> -DGENERATOR=... -DCXX=...
#         -P check_build_testing.cmake
cmake_minimum_required(VERSION 3.21)

file(REMOVE_RECURSE ${WORK_DIR})
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR} -G ${GENERATOR}
          -DCMAKE_CXX_COMPILER=${CXX} -DSPHERICAL_PARAM_BUILD_PCL=OFF
          -DSPHERICAL_PARAM_BUILD_TOOLS=OFF
          -DSPHERICAL_PARAM_BUILD_PYTHON=OFF -DSPHERICAL_PARAM_BUILD_TESTS=ON -DBUILD_TESTING=OFF
  RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "${output}")
endif()
if(EXISTS ${WORK_DIR}/test)
  message(FATAL_ERROR "tests are configured although BUILD_TESTING is OFF")
endif()
file(REMOVE_RECURSE ${WORK_DIR})
