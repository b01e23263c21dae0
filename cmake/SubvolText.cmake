# SPDX-License-Identifier: Apache-2.0
# subvol_embed_texts(ROOM HEADER FILE…): the files' texts, by their names without extension, in the generated header's
# `kTexts`: {name, text} in the order given.
function(subvol_embed_texts target header)
  set(entries "")
  foreach(file ${ARGN})
    get_filename_component(name ${file} NAME_WE)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    file(READ ${CMAKE_CURRENT_SOURCE_DIR}/${file} text)
    string(APPEND entries "    {\"${name}\", R\"subvol(${text})subvol\"},\n")
  endforeach()
  set(TEXT_ENTRIES "${entries}")
  configure_file(${PROJECT_SOURCE_DIR}/cmake/texts.h.in ${CMAKE_CURRENT_BINARY_DIR}/texts/${header} @ONLY)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/texts)
endfunction()
