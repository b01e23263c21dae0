// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "subvol/hex_mesh.h"
#include "subvol/sample.h"
#include "subvol/study_run.h"

namespace subvol::cli {

/// The folders of a case.
struct CasePlace {
    std::filesystem::path folder;      ///< the folder of the study; pictures are written to its pictures/
    std::filesystem::path references;  ///< the folder of finished references, ID.exr
};

/// Runs a case in this process.
///
/// throws: Error(InvalidInput) if there is no such method
[[nodiscard]] CaseResult run_case(const StudyCase& item, const CasePlace& place);

/// Run a case of one kind. The case's method must be of that kind.
[[nodiscard]] CaseResult run_picture_case(const StudyCase& item, const CasePlace& place);
[[nodiscard]] CaseResult run_field_case(const StudyCase& item);
[[nodiscard]] CaseResult run_kernel_case(const StudyCase& item, const CasePlace& place);

/// Sets the options of the library that a case has under their keys.
void set_options(const StudyCase& item, const std::vector<Option>& options);

/// The options for sampling a case's mesh into kernels. options: what the case may leave
[[nodiscard]] SampleOptions study_sampling(const StudyCase& item, const HexMesh& mesh, SampleOptions options = {});

/// The methods of pictures, with the options that each reads; for `parse_study`.
[[nodiscard]] std::vector<PictureMethod> study_picture_methods();

/// A kernel by its name or JSON.
[[nodiscard]] Kernel study_kernel(const std::string& text);

/// Draws a reference, which is a case itself (method dense), as references/ID.exr and .png.
[[nodiscard]] CaseResult run_reference(const StudyCase& item, const CasePlace& place);

/// The file of a case in a folder of the study: NAME_ID.ending.
[[nodiscard]] std::string case_file(const StudyCase& item, const std::string& ending);

/// CPU seconds of all threads of this process so far.
[[nodiscard]] double cpu_seconds();

}  // namespace subvol::cli
