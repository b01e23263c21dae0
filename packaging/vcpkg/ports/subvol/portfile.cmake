# SPDX-License-Identifier: Apache-2.0
# The libraries alone: the command and its window are for packages of systems.
vcpkg_download_distfile(archive
  URLS "https://opensubvol.example/releases/subvol-${VERSION}.tar.xz"
  FILENAME "subvol-${VERSION}.tar.xz"
  SHA512 0) # REPLACE_BY_SHA512
vcpkg_extract_source_archive(source ARCHIVE "${archive}")
vcpkg_cmake_configure(SOURCE_PATH "${source}"
  OPTIONS -DSUBVOL_TESTS=OFF -DSUBVOL_CLI=OFF -DSUBVOL_VIEW=OFF -DSUBVOL_PYTHON=OFF -DSUBVOL_HDF5=OFF -DSUBVOL_MPI=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME subvol CONFIG_PATH lib/cmake/subvol)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${source}/LICENSE")
