# SPDX-License-Identifier: Apache-2.0
# Finds every dependency once, and works around the defects of Debian's packages.
find_package(Threads REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(glm CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(pugixml CONFIG REQUIRED)
find_package(Ceres CONFIG REQUIRED)
find_package(hwy CONFIG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(LibLZMA REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(muparser REQUIRED IMPORTED_TARGET muparser)
pkg_check_modules(liblz4 REQUIRED IMPORTED_TARGET liblz4)

# Of an installed library the modules are linked already, and no option is AUTO.
if(NOT COMMAND subvol_optional)
  macro(subvol_optional)
  endmacro()
endif()
subvol_optional(SUBVOL_HDF5 hdf5 "VTKHDF, CGNS, XDMF and Exodus II files of HDF5")
if(SUBVOL_HDF5)
  pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5)
endif()

# FindOpenVDB sets BUILD_SHARED_LIBS in its caller, and its folder hides FindTBB. The function contains both effects.
function(subvol_find_openvdb)
  list(APPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)
  find_package(OpenVDB 10 MODULE REQUIRED)
  set_target_properties(OpenVDB::openvdb PROPERTIES IMPORTED_GLOBAL TRUE)
endfunction()
if(SUBVOL_VDB AND NOT TARGET OpenVDB::openvdb) # found once for all folders of a project
  subvol_find_openvdb()
endif()

if(SUBVOL_RENDER)
  find_package(embree CONFIG REQUIRED) # 3.13 or 4: a version here would mean that major version alone
  if(embree_VERSION VERSION_LESS 3.13)
    message(FATAL_ERROR "Embree 3.13 or later is needed; found ${embree_VERSION}")
  endif()
  target_compile_definitions(embree INTERFACE SUBVOL_EMBREE_MAJOR=${embree_VERSION_MAJOR}) # both versions' headers may be there
  pkg_check_modules(epoxy REQUIRED IMPORTED_TARGET epoxy)
endif()

if(SUBVOL_VIEW)
  subvol_optional(SUBVOL_WINDOW window "the window of view")
endif()
if(SUBVOL_VIEW AND SUBVOL_WINDOW)
  pkg_check_modules(imgui QUIET IMPORTED_TARGET imgui)
  find_package(glfw3 3.3 CONFIG QUIET)
  if(NOT imgui_FOUND OR NOT glfw3_FOUND)
    message(FATAL_ERROR "SUBVOL_WINDOW needs GLFW 3.3 and Dear ImGui (Debian: libglfw3-dev libimgui-dev libstb-dev)")
  endif()
endif()

if(SUBVOL_COMPARE)
  find_package(PNG REQUIRED)
endif()
if(SUBVOL_COMPARE AND NOT CMAKE_FIND_PACKAGE_NAME STREQUAL "subvol") # an installed library has its modules linked
  pkg_check_modules(cairo REQUIRED IMPORTED_TARGET cairo-pdf)
  find_package(OpenEXR 3 CONFIG REQUIRED)
  find_package(OpenImageIO CONFIG REQUIRED)
  # Debian's package names an include folder (opencv4) that does not exist.
  get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
  list(FILTER oiio_includes EXCLUDE REGEX opencv)
  set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_includes}")
endif()

if(SUBVOL_CLI)
  find_package(CLI11 CONFIG REQUIRED)
  set(MPI_CXX_SKIP_MPICXX ON) # the interface of C is used
  subvol_optional(SUBVOL_MPI mpi "several processes of MPI")
  if(SUBVOL_MPI)
    find_package(MPI REQUIRED COMPONENTS CXX)
  endif()
endif()
if(SUBVOL_TESTS)
  find_package(GTest CONFIG REQUIRED)
endif()
