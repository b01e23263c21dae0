# SPDX-License-Identifier: Apache-2.0
# The target `docs`: the site with the API reference (scripts/docs, which says what is missing). Where Doxygen is installed a test lets it
# read the public headers; a warning is an error.
file(GLOB SUBVOL_DOORS ${PROJECT_SOURCE_DIR}/*/*/include) # the public headers of every room
list(JOIN SUBVOL_DOORS " " SUBVOL_DOORS)
configure_file(${PROJECT_SOURCE_DIR}/docs/Doxyfile.in ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile @ONLY)
if(TARGET subvol_cli)
  add_custom_target(docs COMMAND ${PROJECT_SOURCE_DIR}/scripts/docs --build ${PROJECT_BINARY_DIR} --out ${PROJECT_BINARY_DIR}/site
    DEPENDS subvol_cli VERBATIM USES_TERMINAL COMMENT "The site in ${PROJECT_BINARY_DIR}/site")
endif()
find_program(SUBVOL_DOXYGEN doxygen)
if(SUBVOL_DOXYGEN AND SUBVOL_TESTS)
  add_test(NAME docs COMMAND ${SUBVOL_DOXYGEN} ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile)
  set_tests_properties(docs PROPERTIES LABELS docs)
endif()
