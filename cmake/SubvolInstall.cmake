# SPDX-License-Identifier: Apache-2.0
include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/subvol)
get_property(SUBVOL_COMPONENTS GLOBAL PROPERTY SUBVOL_COMPONENTS)
configure_package_config_file(cmake/subvolConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/subvolConfig.cmake
  INSTALL_DESTINATION ${config_dir} NO_SET_AND_CHECK_MACRO)
# Until 1.0 a new minor version may break programs written for the previous one.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/subvolConfigVersion.cmake COMPATIBILITY SameMinorVersion)
foreach(component IN LISTS SUBVOL_COMPONENTS) # one file per component: a user of one does not need the libraries of the others
  install(EXPORT subvolTargets-${component} NAMESPACE subvol:: DESTINATION ${config_dir} COMPONENT development)
endforeach()
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/subvolConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/subvolConfigVersion.cmake
  cmake/SubvolDependencies.cmake DESTINATION ${config_dir} COMPONENT development)

# What Debian asks of each package: its licence, its changelog. The date of the latter is that of the changelog of this project.
set(CPACK_PACKAGE_CONTACT "OpenSubVol maintainers <maintainers@opensubvol.example>")
file(STRINGS CHANGELOG.md SUBVOL_DATE REGEX "^## \\[${PROJECT_VERSION}\\]")
string(REGEX MATCH "20[0-9-]+$" SUBVOL_DATE "${SUBVOL_DATE}")
execute_process(COMMAND date --rfc-email --utc --date=${SUBVOL_DATE} OUTPUT_VARIABLE SUBVOL_DATE OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
configure_file(packaging/debian/changelog.in ${CMAKE_CURRENT_BINARY_DIR}/packaging/changelog @ONLY)
execute_process(COMMAND gzip -9nkf ${CMAKE_CURRENT_BINARY_DIR}/packaging/changelog)
set(packages command:subvol development:libsubvol-dev)
if(SUBVOL_PYTHON_FOUND)
  list(APPEND packages python:python3-subvol)
endif()
foreach(package IN LISTS packages)
  string(REPLACE ":" ";" package ${package})
  list(POP_FRONT package component)
  install(FILES packaging/debian/copyright ${CMAKE_CURRENT_BINARY_DIR}/packaging/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component} OPTIONAL)
endforeach()
