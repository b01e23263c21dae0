# subvol_component(NAME SOURCES… PUBLIC target… PRIVATE target…): a component is one library with its own include root.
#
# Libraries are static unless BUILD_SHARED_LIBS says otherwise. Symbols keep the default visibility: hiding the private ones would
# take an export macro at each of some three hundred functions, and the tests of private headers would not link.
function(subvol_component name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target subvol_${name})
  add_library(${target} ${ARG_SOURCES})
  add_library(subvol::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} DEFINE_SYMBOL "")
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  subvol_warnings(${target})
  install(TARGETS ${target} EXPORT subvolTargets-${name}
    ARCHIVE COMPONENT development
    LIBRARY COMPONENT command NAMELINK_COMPONENT development)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
  set_property(GLOBAL APPEND PROPERTY SUBVOL_COMPONENTS ${name})
endfunction()

# For code that runs once and is made of libraries' templates: the compiler spends most of its time on optimising what is thrown away.
set(SUBVOL_COLD $<$<CONFIG:Release,RelWithDebInfo>:-O1>)

function(subvol_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow $<$<BOOL:${SUBVOL_WERROR}>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict) # GCC 12 reports it for `"text" + std::to_string(n)` (PR 105651)
  endif()
endfunction()
