# SPDX-License-Identifier: Apache-2.0
# subvol_component(NAME PUBLIC target… PRIVATE target…): a component is one installed library, made of the objects of its rooms.
# include/ has the header that includes all of the component's public headers.
#
# Libraries are static unless BUILD_SHARED_LIBS says otherwise. Symbols keep the default visibility: hiding the private ones would
# take an export macro at each of some three hundred functions, and the tests of private headers would not link.
function(subvol_component name)
  cmake_parse_arguments(ARG "" "" "PUBLIC;PRIVATE" ${ARGN})
  set(target subvol_${name})
  add_library(${target})
  add_library(subvol::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} LINKER_LANGUAGE CXX
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} DEFINE_SYMBOL "")
  if(NOT DEFINED SKBUILD) # a wheel has no links
    set_target_properties(${target} PROPERTIES VERSION ${PROJECT_VERSION})
  endif()
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} TBB::tbb)
  if(NOT BUILD_SHARED_LIBS) # the program that contains the library's code looks for the modules
    target_link_options(${target} INTERFACE
      $<INSTALL_INTERFACE:LINKER:-rpath,$<INSTALL_PREFIX>/${SUBVOL_MODULES_INSTALLED}>)
    if(NOT PROJECT_IS_TOP_LEVEL)
      target_link_options(${target} INTERFACE $<BUILD_INTERFACE:LINKER:-rpath,${SUBVOL_MODULES}>)
    endif()
  endif()
  install(TARGETS ${target} EXPORT subvolTargets-${name}
    ARCHIVE COMPONENT development
    LIBRARY COMPONENT command NAMELINK_COMPONENT development)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
  set_property(GLOBAL APPEND PROPERTY SUBVOL_COMPONENTS ${name})
  set_property(GLOBAL PROPERTY SUBVOL_SEEN_BY_${name} ${ARG_PUBLIC})
endfunction()

# The targets for the names under FOREIGN; cmake/foreign_walls.h has the same names in capitals.
set(SUBVOL_CERES Ceres::ceres)
set(SUBVOL_CLI11 CLI11::CLI11)
set(SUBVOL_EIGEN Eigen3::Eigen)
set(SUBVOL_EMBREE embree)
set(SUBVOL_EPOXY PkgConfig::epoxy)
set(SUBVOL_HIGHWAY hwy::hwy)
set(SUBVOL_JSON nlohmann_json::nlohmann_json)
set(SUBVOL_LZ4 PkgConfig::liblz4)
set(SUBVOL_LZMA LibLZMA::LibLZMA)
set(SUBVOL_MUPARSER PkgConfig::muparser)
set(SUBVOL_NANOVDB "")
set(SUBVOL_OPENVDB OpenVDB::openvdb)
set(SUBVOL_PNG PNG::PNG)
set(SUBVOL_PUGIXML pugixml::pugixml)
set(SUBVOL_ZLIB ZLIB::ZLIB)

# The set of precompiled headers for the libraries of a room.
function(subvol_precompiled_of result)
  set(name base)
  foreach(heavy IN ITEMS OpenVDB CLI11 json)
    if(heavy IN_LIST ARGN)
      set(name ${heavy})
      break()
    endif()
  endforeach()
  set(${result} ${name} PARENT_SCOPE)
endfunction()

# subvol_wing(COMPONENT NAME USES wing…): a wing is a folder of a component that has rooms. Its front door is NAME/include: what
# rooms of other wings, other components and users include. Its rooms see those of the wings that it uses, and nothing else.
function(subvol_wing component name)
  cmake_parse_arguments(ARG "" "" "USES" ${ARGN})
  set(wing subvol_${component}_wing_${name})
  add_library(${wing} INTERFACE)
  target_include_directories(${wing} INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/include)
  list(TRANSFORM ARG_USES PREPEND subvol_${component}_wing_)
  get_property(of_component GLOBAL PROPERTY SUBVOL_SEEN_BY_${component})
  target_link_libraries(${wing} INTERFACE ${ARG_USES} ${of_component})
  target_include_directories(subvol_${component} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
endfunction()

# subvol_room(WHERE NAME SOURCES file… ALONE file… USES room… FOREIGN library… SHADERS file… COLD HOT): a room is a folder and an object library, of
# a component or, as lib/mesh, of a wing. Its include roots are its folder, its public headers in NAME/include, those of the rooms that it
# uses, and the front doors that its wing sees: an include against the arrows does not compile, and neither does one of a third-party library that the room does not list.
# In unity builds several sources of a room are compiled together: names in their unnamed namespaces must be unique within the room.
# ALONE sources are not: Highway includes them once for each instruction set.
function(subvol_room where name)
  cmake_parse_arguments(ARG "COLD;HOT" "" "SOURCES;ALONE;USES;FOREIGN;SHADERS" ${ARGN})
  string(REPLACE "/" ";" where_path ${where})
  list(POP_FRONT where_path component)
  set(room subvol_${component}_${name})
  list(TRANSFORM ARG_SOURCES PREPEND ${name}/)
  list(TRANSFORM ARG_ALONE PREPEND ${name}/)
  list(TRANSFORM ARG_USES PREPEND subvol_${component}_)
  add_library(${room} OBJECT ${ARG_SOURCES} ${ARG_ALONE})
  set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set_target_properties(${room} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${room} PUBLIC cxx_std_20)
  target_include_directories(${room} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/${name})
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/include)
    target_include_directories(${room} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/${name}/include)
    target_include_directories(subvol_${component} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/${name}/include>)
    install(DIRECTORY ${name}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
  endif()
  get_property(of_component GLOBAL PROPERTY SUBVOL_SEEN_BY_${component})
  list(TRANSFORM where_path PREPEND subvol_${component}_wing_)
  target_link_libraries(${room} PUBLIC ${ARG_USES} ${where_path} ${of_component} PRIVATE TBB::tbb)
  if(NOT Highway IN_LIST ARG_FOREIGN) # in functions for other instruction sets GCC takes the options of the precompiled header
    subvol_precompiled_of(precompiled ${ARG_FOREIGN})
    subvol_use_precompiled(${room} ${precompiled})
  endif()
  target_compile_options(${room} PRIVATE "SHELL:-include ${PROJECT_SOURCE_DIR}/cmake/foreign_walls.h")
  foreach(library IN LISTS ARG_FOREIGN)
    string(TOUPPER ${library} upper)
    target_compile_definitions(${room} PRIVATE SUBVOL_FOREIGN_${upper})
    target_link_libraries(${room} PRIVATE ${SUBVOL_${upper}})
  endforeach()
  foreach(shader IN LISTS ARG_SHADERS)
    subvol_embed_shader(${room} ${name}/${shader})
  endforeach()
  if(ARG_COLD)
    target_compile_options(${room} PRIVATE ${SUBVOL_COLD})
  elseif(NOT ARG_HOT)
    target_compile_options(${room} PRIVATE ${SUBVOL_WARM})
  endif()
  subvol_warnings(${room})
  target_sources(subvol_${component} PRIVATE $<TARGET_OBJECTS:${room}>)
  set_property(GLOBAL APPEND PROPERTY SUBVOL_ROOMS_${component} ${CMAKE_CURRENT_SOURCE_DIR}/${name})
  if(where_path)
    set_property(GLOBAL APPEND PROPERTY SUBVOL_ROOMS_${where} ${CMAKE_CURRENT_SOURCE_DIR}/${name})
  endif()
endfunction()

# subvol_module(COMPONENT ROOM NAME SOURCES file… LIBRARIES target…): a part of a room that uses a large library and is loaded when a
# program needs it first (lib/base/include/subvol/detail/module.h). Programs and shared libraries find it by their RUNPATH. What it
# calls of our static libraries is linked into it once more, and its symbols are hidden, so that the copies do not mix.
function(subvol_module component room name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  set(target subvol_${name})
  list(TRANSFORM ARG_SOURCES PREPEND ${room}/)
  add_library(${target} MODULE ${ARG_SOURCES})
  set_target_properties(${target} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${SUBVOL_MODULES}
    INSTALL_RPATH "$<$<BOOL:${BUILD_SHARED_LIBS}>:$ORIGIN/..>" LINKER_LANGUAGE CXX)
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_include_directories(${target} PRIVATE $<TARGET_PROPERTY:subvol_${component}_${room},INCLUDE_DIRECTORIES>)
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES})
  target_link_options(${target} PRIVATE LINKER:--exclude-libs,ALL)
  target_compile_options(${target} PRIVATE ${SUBVOL_COLD})
  subvol_warnings(${target})
  add_dependencies(subvol_${component} ${target})
  install(TARGETS ${target} LIBRARY DESTINATION ${SUBVOL_MODULES_INSTALLED} COMPONENT command)
endfunction()

# subvol_private_roots(TARGET WHERE…): the include roots of all rooms of a component or a wing, for tests and benchmarks of private headers.
function(subvol_private_roots target)
  foreach(where IN LISTS ARGN)
    get_property(rooms GLOBAL PROPERTY SUBVOL_ROOMS_${where})
    target_include_directories(${target} PRIVATE ${rooms})
  endforeach()
endfunction()

# For code that runs once and consists of libraries' templates: with -O3 the compiler would spend most of its time optimising it.
# HOT rooms have the inner loops: they keep the build type's -O3, which takes a quarter longer to compile than -O2.
set(SUBVOL_WARM $<$<CONFIG:Release>:-O2>)
set(SUBVOL_COLD $<$<CONFIG:Release,RelWithDebInfo>:-O1>)
set(SUBVOL_TEST_CODE $<$<CONFIG:Release,RelWithDebInfo>:-O0>) # takes half of the time of -O1

function(subvol_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow $<$<BOOL:${SUBVOL_WERROR}>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict) # GCC 12 reports it for `"text" + std::to_string(n)` (PR 105651)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_UNITY_BUILD) # it takes the sources of a unit for headers
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()
