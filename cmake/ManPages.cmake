# Manual pages, made when the tools are built of what they say with -h. Where the tools cannot run,
# or without Python, there are none.
include(${PROJECT_SOURCE_DIR}/cmake/SourceDate.cmake)

function(spherical_param_man_pages)
  find_package(Python3 COMPONENTS Interpreter)
  if(NOT Python3_Interpreter_FOUND OR SPHERICAL_PARAM_SANITIZE
     OR (CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR))
    message(STATUS "No manual pages: they need Python, and tools that run here")
    return()
  endif()
  set(script ${PROJECT_SOURCE_DIR}/cmake/make_man_page.py)
  set(see_also "")
  foreach(tool IN LISTS ARGN)
    list(APPEND see_also --see-also ${tool})
  endforeach()
  set(pages "")
  foreach(tool IN LISTS ARGN)
    set(page ${PROJECT_BINARY_DIR}/man/${tool}.1.gz)
    add_custom_command(OUTPUT ${page}
      COMMAND ${Python3_EXECUTABLE} ${script} $<TARGET_FILE:${tool}> ${page}
              --date ${SPHERICAL_PARAM_SOURCE_DATE} ${see_also}
      DEPENDS ${tool} ${script}
      COMMENT "Manual page of ${tool}"
      VERBATIM)
    list(APPEND pages ${page})
  endforeach()
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/man)
  add_custom_target(spherical_param_man_pages ALL DEPENDS ${pages})
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
endfunction()
