# SPDX-License-Identifier: Apache-2.0
# Writes a header with the commit of the sources, for reports: cmake -DSOURCE=… -DHEADER=… -P SubvolCommit.cmake
# It is written only if it changes, so that a build without a new commit compiles nothing.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "")  # not a checkout, or no git
endif()
set(text "#pragma once\n#define SUBVOL_COMMIT \"${commit}\"\n")
set(before "")
if(EXISTS ${HEADER})
  file(READ ${HEADER} before)
endif()
if(NOT before STREQUAL text)
  file(WRITE ${HEADER} "${text}")
endif()
