# The target "doc": the pages of doc and the reference of the public headers, in doc/html of the build
# folder. It is not part of "all", and exists only where Doxygen is installed.
if(NOT PROJECT_IS_TOP_LEVEL OR NOT EXISTS ${PROJECT_SOURCE_DIR}/doc/Doxyfile.in)
  return()  # another project may have such a target itself; a source distribution has no doc
endif()
find_package(Doxygen 1.9 QUIET)
if(NOT DOXYGEN_FOUND)
  message(STATUS "Doxygen not found: there is no target 'doc'")
  return()
endif()
configure_file(${PROJECT_SOURCE_DIR}/doc/Doxyfile.in ${PROJECT_BINARY_DIR}/doc/Doxyfile @ONLY)
add_custom_target(doc
  # Pages that are gone must not stay.
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${PROJECT_BINARY_DIR}/doc/html
  COMMAND ${DOXYGEN_EXECUTABLE} ${PROJECT_BINARY_DIR}/doc/Doxyfile
  COMMENT "Documentation: ${PROJECT_BINARY_DIR}/doc/html/index.html"
  VERBATIM)
