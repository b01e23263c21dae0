# SPDX-License-Identifier: Apache-2.0
# `cpack` in the build folder: subvol (the command), libsubvol-dev (headers, static libraries, CMake's files) and python3-subvol for
# Debian.
# scripts/test-package installs both in a bare Debian.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME subvol)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
find_program(SUBVOL_SHLIBDEPS dpkg-shlibdeps)
if(NOT SUBVOL_SHLIBDEPS)
  message(STATUS "subvol: packages would not know the libraries that they need: cpack needs dpkg-shlibdeps (Debian: dpkg-dev)")
endif()
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL command development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)

set(CPACK_COMPONENT_COMMAND_DESCRIPTION "subdivision volumes: the command
Refines hexahedral meshes, draws them as splats, turns them into OpenVDB
grids, and measures how good the result is.")
set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME subvol)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SHLIBDEPS ON)
# OpenGL is loaded when it is needed; plots as .pdf are written in DejaVu Sans; ffmpeg makes the videos of --turntable.
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS "libegl1, libgl1, libgl1-mesa-dri, fonts-dejavu-core")
set(CPACK_DEBIAN_COMMAND_PACKAGE_SUGGESTS "ffmpeg, python3-meshio, python3-vtk9")

set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "subdivision volumes: the library
Headers, static libraries and CMake package of subvol::lib, subvol::io,
subvol::vdb, subvol::render, subvol::compare and subvol::view.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libsubvol-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# The modules, which programs with the static libraries load as well, are in the package of the command.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "subvol (= ${PROJECT_VERSION}), libtbb-dev, libglm-dev, libhwy-dev, nlohmann-json3-dev, libpugixml-dev, libceres-dev, \
zlib1g-dev, liblzma-dev, liblz4-dev, libmuparser-dev, pkg-config")
if(SUBVOL_VDB)
  string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libopenvdb-dev, libboost-iostreams-dev")
endif()
if(SUBVOL_RENDER)
  string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libembree-dev, libepoxy-dev")
endif()
if(SUBVOL_COMPARE)
  string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libpng-dev")
endif()
if(SUBVOL_PYTHON_FOUND)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "subdivision volumes: the Python package
import subvol: meshes, points and pictures as arrays of numpy.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-subvol)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  # An extension is of one version of Python. The modules that it loads are in the package of the command.
  execute_process(COMMAND ${SUBVOL_PYTHON_EXECUTABLE} -c "import sys; print('%d.%d %d.%d' % (3, sys.version_info[1], 3, sys.version_info[1] + 1), end='')"
    OUTPUT_VARIABLE python_versions)
  string(REPLACE " " ";" python_versions "${python_versions}")
  list(GET python_versions 0 python_from)
  list(GET python_versions 1 python_below)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "subvol (= ${PROJECT_VERSION}), python3 (>= ${python_from}), python3 (<< ${python_below}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-tqdm, python3-meshio, python3-vtk9, python3-matplotlib")
endif()
include(CPack)
