// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Bytes, text and containers of files, whatever they mean. All of it is in subvol/detail: nothing is promised to users.
///
/// - `OutputFile`: a file that appears whole or not at all.
/// - `TextScanner`: words and numbers of a text, with the line for errors.
/// - `read_file`, `inflate`: bytes within bounds, so that no allocation is sized by a number that nobody has checked.
/// - HDF5 and netCDF, loaded when a file needs them; tables of `.ply`; `refuse_surface.h`: which names are those of surfaces.
///
/// Rooms: `files`, and `vtk_files` for VTK's XML and HDF containers.
///
///     path ──► bytes ──► text, arrays, trees of names ──► readers of meshes in subvol::io, of points in the wing kernels
///     values ──► bytes ──► OutputFile ──► path
