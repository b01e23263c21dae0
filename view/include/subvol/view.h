// SPDX-License-Identifier: Apache-2.0
#pragma once

/// All of subvol::view: sessions that show a mesh, the thread that draws them, and web pages that draw a volume.

#include "subvol/draw_worker.h"
#include "subvol/edit_mesh.h"
#include "subvol/page.h"
#include "subvol/picture_drawer.h"
#include "subvol/view_session.h"
#include "subvol/view_state.h"
#include "subvol/view_window.h"
