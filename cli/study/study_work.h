// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "subvol/hex_mesh.h"
#include "subvol/sample.h"
#include "subvol/study_run.h"

namespace subvol::cli {

/// What a case needs besides its values.
///
/// folder:     of the study; pictures go into its pictures/
/// references: where finished references are, ID.exr
struct CasePlace {
    std::filesystem::path folder;
    std::filesystem::path references;
};

/// Does the work of a case in this process: all methods of a study.
[[nodiscard]] CaseResult run_case(const StudyCase& of, const CasePlace& place);

/// By kind; the method's name is one of theirs.
[[nodiscard]] CaseResult run_picture_case(const StudyCase& of, const CasePlace& place);
[[nodiscard]] CaseResult run_field_case(const StudyCase& of);
[[nodiscard]] CaseResult run_kernel_case(const StudyCase& of, const CasePlace& place);

/// How a case samples its mesh into kernels.
[[nodiscard]] SampleOptions study_sampling(const StudyCase& of, const HexMesh& mesh);

/// A kernel by its name or JSON.
[[nodiscard]] Kernel study_kernel(const std::string& text);

/// Makes the picture that is case `of` itself (method dense) as references/ID.exr and .png.
[[nodiscard]] CaseResult run_reference(const StudyCase& of, const CasePlace& place);

/// The file of a case in a folder of the study: NAME_ID.ending.
[[nodiscard]] std::string case_file(const StudyCase& of, const std::string& ending);

/// Seconds of all threads of this process so far.
[[nodiscard]] double cpu_seconds();

}  // namespace subvol::cli
