# Whether the Python module is built, SPHERICAL_PARAM_BUILD_PYTHON_MODULE, and with which Python.
set(SPHERICAL_PARAM_BUILD_PYTHON_MODULE OFF)
if(SPHERICAL_PARAM_SANITIZE)
  # A Python without sanitizers cannot load it.
  if(NOT SPHERICAL_PARAM_BUILD_PYTHON STREQUAL "AUTO" AND SPHERICAL_PARAM_BUILD_PYTHON)
    message(FATAL_ERROR "the Python module cannot be built with sanitizers: "
                        "set SPHERICAL_PARAM_BUILD_PYTHON to OFF")
  endif()
elseif(SPHERICAL_PARAM_BUILD_PYTHON)
  set(python_required "")
  if(NOT SPHERICAL_PARAM_BUILD_PYTHON STREQUAL "AUTO")
    set(python_required REQUIRED)
  endif()
  find_package(Python3 3.9 ${python_required} COMPONENTS Interpreter Development.Module)
  if(Python3_FOUND)
    find_package(pybind11 2.10 ${python_required} CONFIG)
    # Of the tools' files and page, found here where the module sees them.
    find_package(nlohmann_json 3.6 ${python_required})
    find_package(ZLIB 1.2.3 ${python_required})
  endif()
  if(Python3_FOUND AND pybind11_FOUND AND nlohmann_json_FOUND AND ZLIB_FOUND)
    set(SPHERICAL_PARAM_BUILD_PYTHON_MODULE ON)
    message(STATUS "Python module: for ${Python3_EXECUTABLE} ${Python3_VERSION}")
  else()
    message(STATUS "Python module: not built, as Python's headers, pybind11, nlohmann_json or zlib "
                   "are missing")
  endif()
endif()
