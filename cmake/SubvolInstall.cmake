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
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT command)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libsubvol-dev RENAME copyright COMPONENT development)
if(SUBVOL_PYTHON_FOUND)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-subvol RENAME copyright COMPONENT python)
endif()
