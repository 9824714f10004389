# The target "doc": the site of the documentation, in doc/html of the build folder. Not a part of
# "all", and there only where Doxygen is.
if(NOT PROJECT_IS_TOP_LEVEL OR NOT EXISTS ${PROJECT_SOURCE_DIR}/doc/Doxyfile.in)
  return()  # another project may have such a target itself; a source distribution has no doc
endif()
find_package(Doxygen 1.9 QUIET)
find_package(Python3 3.9 QUIET COMPONENTS Interpreter)
if(DOXYGEN_FOUND AND Python3_FOUND)
  set(SPHERICAL_PARAM_DOC_DIR ${PROJECT_BINARY_DIR}/doc)
  configure_file(${PROJECT_SOURCE_DIR}/doc/Doxyfile.in ${SPHERICAL_PARAM_DOC_DIR}/Doxyfile @ONLY)
  add_custom_target(doc
    # Pages that are gone must not stay.
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${SPHERICAL_PARAM_DOC_DIR}/html
    COMMAND ${CMAKE_COMMAND} -E env PYTHONDONTWRITEBYTECODE=1
            ${DOXYGEN_EXECUTABLE} ${SPHERICAL_PARAM_DOC_DIR}/Doxyfile
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Documentation: ${SPHERICAL_PARAM_DOC_DIR}/html/index.html"
    VERBATIM)
else()
  message(STATUS "Doxygen or Python not found: there is no target 'doc'")
endif()
