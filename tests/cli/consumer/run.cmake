# SPDX-License-Identifier: Apache-2.0
# Installs the build into an empty folder, then configures, builds and runs the project here against it. Then requests the package in
# right and wrong ways.
file(REMOVE_RECURSE ${WORK})

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(project_options -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_CXX_FLAGS=${FLAGS})

# request("find_package's arguments" CODE TEXT): configuring ends with the exit code and prints TEXT.
function(request arguments code text)
  execute_process(COMMAND ${CMAKE_COMMAND} ${project_options} -S ${SOURCE}/request -B ${WORK}/request "-DREQUEST=${arguments}"
    RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
  string(REGEX REPLACE "[ \n]+" " " said "${said}") # CMake wraps lines
  string(FIND "${said}" "${text}" found)
  if(NOT result EQUAL code OR found EQUAL -1)
    message(FATAL_ERROR "find_package(subvol ${arguments}): ${result} instead of ${code}, or '${text}' missing:\n${said}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} ${project_options} -S ${SOURCE} -B ${WORK}/build)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
run(${WORK}/prefix/bin/subvol --version)

request("REQUIRED" 0 "has: lib io vdb render compare view.")
request("${VERSION};REQUIRED;COMPONENTS;lib" 0 "subvol ${VERSION} has: lib io.")
request("REQUIRED;COMPONENTS;render" 0 "has: lib io render.")
request("REQUIRED;COMPONENTS;lib;OPTIONAL_COMPONENTS;viewer" 0 "has: lib io.")
request("COMPONENTS;viewer" 0 "has: .")
request("REQUIRED;COMPONENTS;viewer" 1 "'viewer' is not a component of subvol; the components are lib, io, vdb, render, compare, view")
request("99;REQUIRED" 1 "version: ${VERSION}")

# An installation that looks as if it had been built without OpenVDB.
file(GLOB_RECURSE config ${WORK}/prefix/*/subvolConfig.cmake)
file(READ ${config} text)
string(REPLACE "set(subvol_built lib;io;vdb;render;compare;view)" "set(subvol_built lib;io;render;compare;view)" text "${text}")
file(WRITE ${config} "${text}")
request("REQUIRED" 0 "has: lib io render compare view.")
request("REQUIRED;COMPONENTS;vdb" 1 "it was built without the component 'vdb'; it has lib, io, render, compare, view")
