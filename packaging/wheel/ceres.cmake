# SPDX-License-Identifier: Apache-2.0
# What scripts/wheel includes after `project`: Ceres without the solvers that Debian's has and this library never asks for (CHOLMOD,
# CXSparse, LAPACK). They and what they need would be 15 libraries and 7 MB of the wheel, and CHOLMOD is under the GPL.
find_package(Ceres CONFIG REQUIRED)
add_library(subvol_unused_solvers STATIC ${CMAKE_CURRENT_LIST_DIR}/unused_solvers.cpp)
set_target_properties(subvol_unused_solvers PROPERTIES POSITION_INDEPENDENT_CODE ON)
get_target_property(needed Ceres::ceres INTERFACE_LINK_LIBRARIES)
list(FILTER needed EXCLUDE REGEX "SuiteSparse|CXSparse|lapack|blas|atlas")
set_target_properties(Ceres::ceres PROPERTIES INTERFACE_LINK_LIBRARIES "${needed};subvol_unused_solvers")
