# SPDX-License-Identifier: Apache-2.0
# Finds what the Python package needs: an interpreter with numpy and the headers of Python and pybind11. Without them it is left out.
#
# The interpreter is Debian's, whose modules Debian's packages are for; SUBVOL_PYTHON_EXECUTABLE names another. CMake's own
# FindPython would find the first one of the PATH, and tests have others.
set(SUBVOL_PYTHON AUTO CACHE STRING "Build the Python package: ON, OFF, or AUTO for ON if pybind11 and numpy are installed")
if(DEFINED SKBUILD) # a wheel is for the interpreter that builds it
  set(SUBVOL_PYTHON_EXECUTABLE ${Python_EXECUTABLE})
endif()
find_program(SUBVOL_PYTHON_EXECUTABLE python3 PATHS /usr/bin NO_DEFAULT_PATH)

set(SUBVOL_PYTHON_FOUND OFF)
if(SUBVOL_PYTHON AND SUBVOL_PYTHON_EXECUTABLE AND SUBVOL_VDB AND SUBVOL_RENDER AND SUBVOL_COMPARE AND SUBVOL_VIEW)
  execute_process(COMMAND ${SUBVOL_PYTHON_EXECUTABLE} -c
      "import numpy, sysconfig; print(sysconfig.get_paths()['include'], sysconfig.get_config_var('EXT_SUFFIX'), sep=';', end='')"
    OUTPUT_VARIABLE about RESULT_VARIABLE failed ERROR_QUIET)
  list(LENGTH about facts)
  if(NOT failed AND facts EQUAL 2)
    list(GET about 0 python_include)
    list(GET about 1 SUBVOL_PYTHON_SUFFIX)
    if(EXISTS ${python_include}/Python.h)
      subvol_works(SUBVOL_PYTHON_FOUND python)
    endif()
  endif()
endif()
if(SUBVOL_PYTHON_FOUND)
  set(PYBIND11_NOPYTHON ON)
  find_package(pybind11 2.10 CONFIG QUIET)
  add_library(subvol_python_headers INTERFACE)
  add_library(subvol::python_headers ALIAS subvol_python_headers)
  get_target_property(pybind11_include pybind11::headers INTERFACE_INCLUDE_DIRECTORIES)
  if(NOT pybind11_include) # Debian's names none: they are where all headers are
    set(pybind11_include "")
  endif()
  target_include_directories(subvol_python_headers SYSTEM INTERFACE ${python_include} ${pybind11_include})
  # A wheel has everything in its own folder; Debian's packages install into dist-packages.
  set(SUBVOL_PYTHON_INSTALLED lib/python3/dist-packages CACHE STRING "Where the Python package is installed, below the prefix")
elseif(SUBVOL_PYTHON AND NOT SUBVOL_PYTHON STREQUAL "AUTO")
  message(FATAL_ERROR "subvol: the Python package needs every component, numpy, Python.h and pybind11 (scripts/setup --python installs them)${SUBVOL_PYTHON_FOUND_NOTE}")
endif()
message(STATUS "subvol: Python package: ${SUBVOL_PYTHON_FOUND} (SUBVOL_PYTHON)${SUBVOL_PYTHON_FOUND_NOTE}")
