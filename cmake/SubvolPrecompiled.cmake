# SPDX-License-Identifier: Apache-2.0
# Precompiled headers, one for each set of libraries and not for each room. Half of the time of a build is the parsing of headers.
#
# subvol_precompiled(NAME HEADERS header… LIBRARIES target… OPTIONS option…) makes such a set; a set has the standard headers besides
# its own, and serves code that is compiled with optimisation, or with the -O0 of its own options.
# subvol_use_precompiled(TARGET NAME) uses it in a target, before all else that is included. Sources include what they need all
# the same: builds without SUBVOL_PRECOMPILED (clang's, the fuzzers') show that they do.
option(SUBVOL_PRECOMPILED "Precompile the headers of libraries (GCC, single-configuration generators)" ON)
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR CMAKE_CONFIGURATION_TYPES)
  set(SUBVOL_PRECOMPILED OFF)
endif()

set(SUBVOL_STANDARD_HEADERS <algorithm> <array> <atomic> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional> <limits>
  <map> <memory> <mutex> <numeric> <optional> <set> <span> <sstream> <string> <string_view> <utility> <vector>
  <glm/geometric.hpp> <glm/mat3x3.hpp> <glm/vec2.hpp> <glm/vec3.hpp>
  <tbb/blocked_range.h> <tbb/parallel_for.h> <tbb/parallel_reduce.h>)

function(subvol_precompiled name)
  if(NOT SUBVOL_PRECOMPILED)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBRARIES;OPTIONS" ${ARGN})
  set(target subvol_precompiled_${name})
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp CONTENT "")
  add_library(${target} OBJECT ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE ${ARG_OPTIONS})
  target_link_libraries(${target} PRIVATE glm::glm TBB::tbb ${ARG_LIBRARIES})
  target_precompile_headers(${target} PRIVATE ${SUBVOL_STANDARD_HEADERS} ${ARG_HEADERS})
  set_property(GLOBAL PROPERTY SUBVOL_PRECOMPILED_${name} ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/cmake_pch.hxx)
endfunction()

function(subvol_use_precompiled target name)
  get_property(header GLOBAL PROPERTY SUBVOL_PRECOMPILED_${name})
  if(NOT header)
    return()
  endif()
  add_dependencies(${target} subvol_precompiled_${name})
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources EXCLUDE REGEX "[$]<")
  list(LENGTH sources most)
  foreach(batch RANGE ${most}) # the sources of unity builds; what is not there does no harm
    list(APPEND sources ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${batch}_cxx.cxx)
  endforeach()
  set_property(SOURCE ${sources} APPEND PROPERTY OBJECT_DEPENDS ${header}.gch) # objects of two targets have no order else
  # GCC 12 takes an empty string for one of 2⁶³ bytes (PR 105329), and where a header was precompiled it says so.
  target_compile_options(${target} PRIVATE "SHELL:-Winvalid-pch -include ${header}" -Wno-stringop-overflow -Wno-array-bounds)
endfunction()
