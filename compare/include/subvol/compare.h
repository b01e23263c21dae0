// SPDX-License-Identifier: Apache-2.0
#pragma once

/// All of subvol::compare: metrics of pictures and fields, picture files, studies, reports.

#include "subvol/field.h"
#include "subvol/field_metrics.h"
#include "subvol/field_places.h"
#include "subvol/flip.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "subvol/image_regions.h"
#include "subvol/mesh_field.h"
#include "subvol/oiio_compare.h"
#include "subvol/picture_metrics.h"
#include "subvol/placed_image.h"
#include "subvol/plot.h"
#include "subvol/points_field.h"
#include "subvol/ssim.h"
#include "subvol/study.h"
#include "subvol/study_measures.h"
#include "subvol/study_report.h"
#include "subvol/study_run.h"
#include "subvol/study_table.h"
