// SPDX-License-Identifier: Apache-2.0
#pragma once

/// All of subvol::lib, by its eight wings. Each of these headers says what the wing is for and how data goes through it.

#include "subvol/ask.h"
#include "subvol/base.h"
#include "subvol/files.h"
#include "subvol/kernels.h"
#include "subvol/look.h"
#include "subvol/make.h"
#include "subvol/mesh.h"
#include "subvol/subdivision.h"
#include "subvol/version.h"
