# SPDX-License-Identifier: Apache-2.0
# subvol_embed_shader(ROOM FILE): the text of a shader NAME.comp becomes `kShader_NAME_comp` in the generated shader_NAME_comp.h,
# which the room and those that use it can include.
function(subvol_embed_shader room file)
  get_filename_component(name ${file} NAME)
  string(REPLACE "." "_" symbol ${name})
  set(SHADER_SYMBOL kShader_${symbol})
  set(SHADER_NAME ${name})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  file(READ ${CMAKE_CURRENT_SOURCE_DIR}/${file} SHADER_TEXT)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/shaders/${room})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/shader.h.in ${folder}/shader_${symbol}.h @ONLY)
  target_include_directories(${room} PUBLIC ${folder})
endfunction()
