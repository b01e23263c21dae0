# SPDX-License-Identifier: Apache-2.0
# The target `docs`: the API reference, by Doxygen if it is installed. A warning is an error.
find_package(Doxygen QUIET)
if(DOXYGEN_FOUND)
  file(GLOB SUBVOL_DOORS ${PROJECT_SOURCE_DIR}/*/*/include) # the public headers of every room
  list(JOIN SUBVOL_DOORS " " SUBVOL_DOORS)
  configure_file(${PROJECT_SOURCE_DIR}/docs/Doxyfile.in ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile @ONLY)
  add_custom_target(docs COMMAND Doxygen::doxygen ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile VERBATIM
    COMMENT "API reference in ${CMAKE_CURRENT_BINARY_DIR}/docs/html")
  if(SUBVOL_TESTS)
    add_test(NAME docs COMMAND Doxygen::doxygen ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile)
    set_tests_properties(docs PROPERTIES LABELS docs)
  endif()
endif()
