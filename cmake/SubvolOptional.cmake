# SPDX-License-Identifier: Apache-2.0
# Optional libraries. One that is installed in part, that is damaged or of another version must not stop the configuration; but
# CMake's modules and the libraries' own files end it in such cases, and no call catches that. So each library is found, compiled
# against and linked in a small project first, where an error is the end of that project alone.

# Commands that find each library, targets to link, and a text that calls it. The commands say `absent` where there is nothing of it.
set(subvol_find_mpi [[
set(MPI_CXX_SKIP_MPICXX ON)
find_package(MPI QUIET COMPONENTS CXX)
if(NOT MPI_CXX_FOUND AND NOT MPI_CXX_COMPILER)
  message(FATAL_ERROR absent)
endif()
find_package(MPI REQUIRED COMPONENTS CXX)
]])
set(subvol_link_mpi MPI::MPI_CXX)
set(subvol_text_mpi [[
#include <mpi.h>
int works(int* count, char*** arguments) {
    int level = 0, sum = 0;
    MPI_Init_thread(count, arguments, MPI_THREAD_FUNNELED, &level);
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Waitall(1, &request, MPI_STATUSES_IGNORE);
    return MPI_Finalize();
}
]])

set(subvol_find_pkg_config [[
find_package(PkgConfig REQUIRED)
pkg_check_modules(library IMPORTED_TARGET @module@)
if(NOT library_FOUND)
  execute_process(COMMAND ${PKG_CONFIG_EXECUTABLE} --exists --print-errors @module@ ERROR_VARIABLE why)
  if(NOT why MATCHES "Package @module@ was not found")
    message(FATAL_ERROR "${why}")
  endif()
  message(FATAL_ERROR absent)
endif()
]])
string(REPLACE @module@ hdf5 subvol_find_hdf5 "${subvol_find_pkg_config}")
set(subvol_link_hdf5 PkgConfig::library)
set(subvol_text_hdf5 [[
#include <hdf5.h>
hid_t works(H5L_iterate_t take) {
    const hid_t file = H5Fopen("", H5F_ACC_RDONLY, H5Pcreate(H5P_FILE_ACCESS)), group = H5Gopen2(file, "", H5P_DEFAULT);
    H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, take, nullptr);
    return H5Aopen_by_name(group, "", "", H5P_DEFAULT, H5P_DEFAULT);
}
]])

string(REPLACE @module@ imgui subvol_find_window "${subvol_find_pkg_config}")
string(APPEND subvol_find_window [[
find_package(glfw3 3.3 CONFIG)
if(NOT glfw3_FOUND AND NOT glfw3_CONSIDERED_CONFIGS)
  message(FATAL_ERROR absent)
endif()
list(TRANSFORM library_INCLUDE_DIRS APPEND /backends OUTPUT_VARIABLE backends)
include_directories(${backends})
]])
set(subvol_link_window PkgConfig::library glfw)
set(subvol_text_window [[
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>
bool works(GLFWwindow* window) {
    ImGui::CreateContext();
    return glfwInit() == GLFW_TRUE && ImGui_ImplGlfw_InitForOpenGL(window, true) && ImGui_ImplOpenGL3_Init("#version 150");
}
]])

set(subvol_find_nanovdb [[
find_path(include nanovdb/util/OpenToNanoVDB.h)
if(NOT include)
  message(FATAL_ERROR absent)
endif()
include_directories(${include})
list(APPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)
find_package(OpenVDB 10 MODULE REQUIRED)
]])
set(subvol_link_nanovdb OpenVDB::openvdb)
set(subvol_text_nanovdb [[
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
bool works(const openvdb::FloatGrid& grid) {
    const nanovdb::GridHandle<nanovdb::HostBuffer> handle = nanovdb::openToNanoVDB(grid);
    return handle.size() > 0;
}
]])

set(subvol_find_python [[
set(PYBIND11_NOPYTHON ON)
find_package(pybind11 2.10 CONFIG)
if(NOT pybind11_FOUND AND NOT pybind11_CONSIDERED_CONFIGS)
  message(FATAL_ERROR absent)
endif()
get_target_property(include pybind11::headers INTERFACE_INCLUDE_DIRECTORIES)
include_directories(@python_include@)
if(include)
  include_directories(${include})
endif()
]])
set(subvol_link_python "")
set(subvol_text_python [[
#include <pybind11/numpy.h>
PYBIND11_MODULE(works, module) {
    module.def("works", [](const pybind11::array_t<double>& numbers) { return numbers.size(); });
}
]])

# subvol_works(RESULT NAME): ON if the library is found, and its text compiled and linked. RESULT_NOTE is empty, or says why it is OFF
# although something is installed.
function(subvol_works result name)
  set(folder ${PROJECT_BINARY_DIR}/optional/${name})
  set(log ${PROJECT_BINARY_DIR}/optional/${name}.log)
  set(kind MODULE)
  if(name STREQUAL "nanovdb" OR name STREQUAL "python") # their headers take seconds already; what is linked is known to work
    set(kind OBJECT)
  endif()
  string(CONFIGURE "${subvol_find_${name}}" find @ONLY)
  file(CONFIGURE OUTPUT ${folder}/CMakeLists.txt CONTENT "cmake_minimum_required(VERSION 3.25)
project(subvol_optional LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 20)
${find}
add_library(works ${kind} works.cpp)
target_compile_options(works PRIVATE -fno-sanitize=all) # clang links their libraries into programs only
target_link_options(works PRIVATE -fno-sanitize=all)
target_link_libraries(works PRIVATE ${subvol_link_${name}})
if(NOT ${kind} STREQUAL OBJECT)
  target_link_options(works PRIVATE LINKER:--no-undefined)
endif()
" @ONLY)
  file(CONFIGURE OUTPUT ${folder}/works.cpp CONTENT "${subvol_text_${name}}" @ONLY)

  # What this project knows of places and compilers.
  set(settings "set(CMAKE_PLATFORM_INFO_INITIALIZED 1 CACHE INTERNAL \"\")\n")
  get_cmake_property(known CACHE_VARIABLES)
  list(FILTER known INCLUDE REGEX "^(CMAKE_CXX_FLAGS|MPI_|PKG_CONFIG_|Python|[A-Za-z0-9_]+_(DIR|ROOT|HOME)$)")
  list(FILTER known EXCLUDE REGEX "^CMAKE_HOME|_(BINARY|SOURCE)_DIR$")
  foreach(variable IN ITEMS CMAKE_CXX_COMPILER CMAKE_MAKE_PROGRAM CMAKE_TOOLCHAIN_FILE CMAKE_SYSROOT CMAKE_PREFIX_PATH
      CMAKE_INCLUDE_PATH CMAKE_LIBRARY_PATH CMAKE_PROGRAM_PATH CMAKE_FIND_ROOT_PATH CMAKE_IGNORE_PATH CMAKE_IGNORE_PREFIX_PATH
      CMAKE_MODULE_LINKER_FLAGS ${known})
    if(DEFINED ${variable})
      string(APPEND settings "set(${variable} [==[${${variable}}]==] CACHE STRING \"\")\n")
    endif()
  endforeach()
  file(WRITE ${folder}/settings.cmake "${settings}")
  file(REMOVE ${folder}/build/CMakeCache.txt)
  # The compiler is known: to examine it again takes longer than all the rest.
  file(COPY ${CMAKE_PLATFORM_INFO_DIR}/CMakeCXXCompiler.cmake ${CMAKE_PLATFORM_INFO_DIR}/CMakeSystem.cmake
    DESTINATION ${folder}/build/CMakeFiles/${CMAKE_VERSION})
  execute_process(COMMAND ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -C settings.cmake -S . -B build
    WORKING_DIRECTORY ${folder} OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE failed)
  if(NOT failed)
    execute_process(COMMAND ${CMAKE_COMMAND} --build build
      WORKING_DIRECTORY ${folder} OUTPUT_VARIABLE more ERROR_VARIABLE more RESULT_VARIABLE failed)
    string(APPEND said "${more}")
  endif()
  file(WRITE ${log} "${said}")
  set(${result} ON PARENT_SCOPE)
  set(${result}_NOTE "" PARENT_SCOPE)
  if(failed)
    set(${result} OFF PARENT_SCOPE)
    if(NOT said MATCHES "\n *absent *\n")
      set(${result}_NOTE "; what is installed cannot be used, see ${log}" PARENT_SCOPE)
    endif()
  endif()
endfunction()

# subvol_optional(OPTION NAME WORDS): an option that is AUTO becomes ON or OFF, as `subvol_works` says; a line says so.
macro(subvol_optional option name words)
  if(${option} STREQUAL "AUTO")
    subvol_works(${option} ${name})
    message(STATUS "subvol: ${words}: ${${option}} (${option})${${option}_NOTE}")
  endif()
endmacro()
