# Tests of tools/report/make_page.cmake with an npm and a node of our own, so without a network:
#   cmake -DSOURCE_DIR=<checkout> -DWORK_DIR=<scratch> -P test_make_page.cmake
cmake_minimum_required(VERSION 3.21)

set(page "<html>\\ \"?? ; [ \${x}\n<pre id=\"three-license\">as is</pre>\n<!--DATA-->\nÄ</html>\n")

function(write_program name)
  file(WRITE "${WORK_DIR}/${name}" "#!/bin/sh\n${ARGN}\n")
  file(CHMOD "${WORK_DIR}/${name}" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endfunction()

file(REMOVE_RECURSE "${WORK_DIR}")
file(MAKE_DIRECTORY "${WORK_DIR}")
file(WRITE "${WORK_DIR}/page" "${page}")
file(COPY "${SOURCE_DIR}/tools/report" DESTINATION "${WORK_DIR}")
write_program(failing_npm "echo no network >&2; exit 1")
write_program(npm "echo called >>'${WORK_DIR}/npm-calls'; mkdir -p node_modules; exit 0")
# build.mjs OUT.html LICENCES.txt
write_program(node "cp '${WORK_DIR}/page' \"$2\"; echo as is >\"$3\"")

function(make_page)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -D FOLDER=${WORK_DIR}/report -D BUILD_FOLDER=${WORK_DIR}/build
      -D SOURCE=${WORK_DIR}/build/page.cpp -D STAMP=${WORK_DIR}/build/stamp
      -D NODE=${WORK_DIR}/node ${ARGN} -P ${WORK_DIR}/report/make_page.cmake
    RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  set(code "${code}" PARENT_SCOPE)
  set(out "${out}" PARENT_SCOPE)
endfunction()

function(expect what)
  if(NOT (${ARGN}))
    message(FATAL_ERROR "not so: ${what}\ncode ${code}: ${out}")
  endif()
endfunction()

# The bytes that the source holds.
function(bytes_of_source result)
  file(READ "${WORK_DIR}/build/page.cpp" text)
  string(REGEX MATCHALL "\\\\x[0-9a-f][0-9a-f]" bytes "${text}")
  string(REPLACE "\\x" "" bytes "${bytes}")
  string(REPLACE ";" "" bytes "${bytes}")
  set(${result} "${bytes}" PARENT_SCOPE)
endfunction()
file(READ "${WORK_DIR}/page" page_bytes HEX)

make_page(-D MODE=BUILD -D REQUIRED=AUTO -D NPM=${WORK_DIR}/failing_npm)
bytes_of_source(bytes)
expect("where npm fails, the build goes on without a page" code EQUAL 0 AND NOT bytes)
expect("it is told" out MATCHES "without -report")
expect("the next build tries again" NOT EXISTS "${WORK_DIR}/build/stamp")

make_page(-D MODE=BUILD -D REQUIRED=ON -D NPM=${WORK_DIR}/failing_npm)
expect("a page that is demanded stops the build, with the cause"
  NOT code EQUAL 0 AND out MATCHES "no network")

foreach(run 1 2)
  make_page(-D MODE=BUILD -D REQUIRED=AUTO -D NPM=${WORK_DIR}/npm)
  bytes_of_source(bytes)
  expect("the page is built, byte by byte" code EQUAL 0 AND bytes STREQUAL page_bytes
    AND EXISTS "${WORK_DIR}/build/stamp" AND EXISTS "${WORK_DIR}/build/third-party.txt")
endforeach()
file(STRINGS "${WORK_DIR}/npm-calls" calls)
list(LENGTH calls count)
expect("npm is called once for the same package-lock.json" count EQUAL 1)
file(APPEND "${WORK_DIR}/report/package-lock.json" "\n")
make_page(-D MODE=BUILD -D REQUIRED=AUTO -D NPM=${WORK_DIR}/npm)
file(STRINGS "${WORK_DIR}/npm-calls" calls)
list(LENGTH calls count)
expect("npm is called again for another one" code EQUAL 0 AND count EQUAL 2)
expect("nothing is written beside the sources" NOT EXISTS "${WORK_DIR}/report/node_modules")

file(REMOVE_RECURSE "${WORK_DIR}/build")
make_page(-D MODE=GIVEN -D PAGE=${WORK_DIR}/page)
bytes_of_source(bytes)
file(READ "${WORK_DIR}/build/third-party.txt" licence)
expect("a page that is given is taken as it is, with its licence" code EQUAL 0
  AND bytes STREQUAL page_bytes AND licence MATCHES "as is")
make_page(-D MODE=GIVEN -D PAGE=${SOURCE_DIR}/README.md)
expect("what is no page is refused" NOT code EQUAL 0 AND out MATCHES "no page of -report")

file(REMOVE_RECURSE "${WORK_DIR}")
