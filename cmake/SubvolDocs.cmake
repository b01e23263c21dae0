# SPDX-License-Identifier: Apache-2.0
# The target `docs`: the API reference, by Doxygen if it is installed. A warning is an error.
find_program(SUBVOL_DOXYGEN doxygen)
set(failed ON)
if(SUBVOL_DOXYGEN)
  execute_process(COMMAND ${SUBVOL_DOXYGEN} --version OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE failed)
endif()
if(NOT failed)
  file(GLOB SUBVOL_DOORS ${PROJECT_SOURCE_DIR}/*/*/include) # the public headers of every room
  list(JOIN SUBVOL_DOORS " " SUBVOL_DOORS)
  configure_file(${PROJECT_SOURCE_DIR}/docs/Doxyfile.in ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile @ONLY)
  add_custom_target(docs COMMAND ${SUBVOL_DOXYGEN} ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile VERBATIM
    COMMENT "API reference in ${CMAKE_CURRENT_BINARY_DIR}/docs/html")
  if(SUBVOL_TESTS)
    add_test(NAME docs COMMAND ${SUBVOL_DOXYGEN} ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile)
    set_tests_properties(docs PROPERTIES LABELS docs)
  endif()
endif()
