include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/subvol)
configure_package_config_file(cmake/subvolConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/subvolConfig.cmake
  INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/subvolConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT subvolTargets NAMESPACE subvol:: DESTINATION ${config_dir})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/subvolConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/subvolConfigVersion.cmake
  cmake/SubvolDependencies.cmake DESTINATION ${config_dir})
