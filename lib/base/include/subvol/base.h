// SPDX-License-Identifier: Apache-2.0
#pragma once

/// What everything uses. Nothing here knows a mesh or a file.
///
/// - `Error`: what went wrong, where, and what would be right, in one sentence. Everything that fails throws one.
/// - `Option`: one member of an options struct as users know it: its name, what it may be, a sentence about it. The command,
///   Python and studies are made of these; `check_options` is what a call itself checks.
/// - `Facts`: the figures of a result, in the order in which they are said, as a tree of names and values.
/// - `Progress`: listens to long work, and may end it.
/// - `Share`: which of several parts of a work this process does.
/// - `Vec3`, `Box`, `Index`, `Image`, `Raster`, `Voxels`: plain values.
///
///     options struct ── options_of ──► Option ──► flags, keywords, keys of studies, pages of the manual
///     call(options, progress) ───────► result + Facts, or Error
///
/// What other wings share without a promise is in subvol/detail: parallel loops whose sums do not depend on the number of
/// threads (`parallel_sums.h`), sparse rows and conjugate gradients, hashes, text, numbers as text.

#include "subvol/error.h"
#include "subvol/facts.h"
#include "subvol/image.h"
#include "subvol/index.h"
#include "subvol/names.h"
#include "subvol/option.h"
#include "subvol/option_names.h"
#include "subvol/option_needs.h"
#include "subvol/progress.h"
#include "subvol/raster.h"
#include "subvol/share.h"
#include "subvol/vec.h"
#include "subvol/voxels.h"
