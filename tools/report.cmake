# The page of -report: the files of tools/report with Debian's three.js, put into the library
# of files as text. Without three.js the tools are built without -report.
option(SPHERICAL_PARAM_BUILD_REPORT "Build the tools with -report, if three.js is found" ON)
find_path(SPHERICAL_PARAM_THREE_DIR three.min.js
  PATHS /usr/share/javascript/three /usr/local/share/javascript/three)
find_file(SPHERICAL_PARAM_THREE_LICENSE copyright PATHS /usr/share/doc/libjs-three NO_DEFAULT_PATH)
mark_as_advanced(SPHERICAL_PARAM_THREE_DIR SPHERICAL_PARAM_THREE_LICENSE)

# The source of a script in a Content-Security-Policy: its SHA-256 in base64.
function(spherical_param_script_hash script result)
  string(SHA256 hex "${script}")
  set(digits ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/)
  set(base64 "")
  foreach(at RANGE 0 60 6)
    string(SUBSTRING "${hex}00" ${at} 6 bytes)
    foreach(shift 18 12 6 0)
      math(EXPR digit "(0x${bytes} >> ${shift}) & 63")
      string(SUBSTRING ${digits} ${digit} 1 digit)
      string(APPEND base64 ${digit})
    endforeach()
  endforeach()
  string(REGEX REPLACE "A$" "=" base64 ${base64}) # the byte that fills the last group
  set(${result} "'sha256-${base64}'" PARENT_SCOPE)
endfunction()

set(report_folder ${CMAKE_CURRENT_LIST_DIR}/report)
set(report_scripts text.js first_view.js views.js still.js main.js)
list(TRANSFORM report_scripts PREPEND ${report_folder}/)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${report_scripts}
  ${report_folder}/page.html ${report_folder}/style.css ${report_folder}/loader.js)

set(report_page "")
set(report_program "")
if(NOT SPHERICAL_PARAM_BUILD_REPORT)
  message(STATUS "The tools are built without -report: SPHERICAL_PARAM_BUILD_REPORT is off")
elseif(NOT EXISTS "${SPHERICAL_PARAM_THREE_DIR}/examples/js/controls/OrbitControls.js" OR
       NOT SPHERICAL_PARAM_THREE_LICENSE)
  message(STATUS "The tools are built without -report: three.js (libjs-three) was not found")
else()
  foreach(script ${SPHERICAL_PARAM_THREE_DIR}/three.min.js
                 ${SPHERICAL_PARAM_THREE_DIR}/examples/js/controls/OrbitControls.js ${report_scripts})
    file(READ ${script} text)
    string(APPEND report_program "${text}\n")
  endforeach()
  file(READ ${report_folder}/loader.js LOADER)
  file(READ ${report_folder}/style.css STYLE)
  file(READ ${SPHERICAL_PARAM_THREE_LICENSE} THREE_LICENSE)
  string(REPLACE "&" "&amp;" THREE_LICENSE "${THREE_LICENSE}")
  string(REPLACE "<" "&lt;" THREE_LICENSE "${THREE_LICENSE}")
  spherical_param_script_hash("${LOADER}" LOADER_HASH)
  spherical_param_script_hash("${report_program}" PROGRAM_HASH)
  file(READ ${report_folder}/page.html report_page)
  string(CONFIGURE "${report_page}" report_page @ONLY)
  install(FILES ${SPHERICAL_PARAM_THREE_LICENSE} RENAME third-party.txt
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
endif()
configure_file(${report_folder}/report_page.cpp.in report/report_page.cpp @ONLY)
target_sources(spherical_param_files PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/report/report_page.cpp)
