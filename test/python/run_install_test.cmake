# Installs core and Python module into a prefix, moves the prefix, and uses the module from there.
#   cmake -DBUILD_DIR= -DPYTHON= -DWORK_DIR= -P run_install_test.cmake
cmake_minimum_required(VERSION 3.21)

file(REMOVE_RECURSE ${WORK_DIR})
foreach(component core python)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/installed
                          --component ${component}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(RENAME ${WORK_DIR}/installed ${WORK_DIR}/moved)
file(GLOB module ${WORK_DIR}/moved/lib/*/*/spherical_param/__init__.py)
if(NOT module MATCHES "^[^;]*/lib/python3[.0-9]*/(site|dist)-packages/spherical_param/__init__.py$")
  message(FATAL_ERROR "the package is not once in a folder of Python's search path: '${module}'")
endif()
get_filename_component(package ${module} DIRECTORY)
get_filename_component(folder ${package} DIRECTORY)
foreach(file py.typed _core.pyi _reconstruct.pyi)
  if(NOT EXISTS ${package}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
file(WRITE ${WORK_DIR}/use.py [[
import sys
import numpy as np
import spherical_param
assert spherical_param.__file__.startswith(sys.argv[1]), spherical_param.__file__
points = np.random.default_rng(1).normal(size=(200, 3))
points /= np.linalg.norm(points, axis=1, keepdims=True)
assert spherical_param.reconstruct(points).triangles.shape == (396, 3)
libraries = [line.split()[-1] for line in open("/proc/self/maps") if "spherical_param" in line]
assert all(library.startswith(sys.argv[2]) for library in libraries), libraries
]])
set(ENV{PYTHONPATH} ${folder})
set(ENV{PYTHONDONTWRITEBYTECODE} 1)
set(ENV{LD_LIBRARY_PATH})
execute_process(COMMAND ${PYTHON} ${WORK_DIR}/use.py ${folder} ${WORK_DIR}/moved
                WORKING_DIRECTORY / COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE_RECURSE ${WORK_DIR})
