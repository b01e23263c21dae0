// SPDX-License-Identifier: Apache-2.0
// What `info` says of a file, by the kind of what it holds: a class for each.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common_options.h"
#include "input.h"
#include "ranks.h"
#include "report.h"
#include "share.h"
#include "subvol/share.h"
#include "tet_refinement.h"

namespace subvol::cli {

/// What `info` was asked for, besides the figures of the file.
struct InfoRequest {
    const CLI::App& app;                ///< which knows the options that were given
    const CommonOptions& common;        ///< of reading; --field limits what is listed
    std::string input;                  ///< the file
    bool lists_fields = false;          ///< the names of fields alone
    bool ignored = false;               ///< the parts of the file that were not taken alone
    bool folds = false;                 ///< whether the limit folds
    bool limit = false;                 ///< volume and box of the limit
    bool devices = false;               ///< those of OpenGL, too
    std::vector<std::string> places{};  ///< "X,Y,Z", at which grids are read
    TetRefinement tets{};               ///< of which the figures of refined tetrahedra are asked, if any
    std::optional<Share> share{};       ///< one share of the figures is found here
    bool is_part = false;               ///< the share is written for `join`
    Ranks* ranks = nullptr;             ///< the processes that find the others

    /// Whether this is the field that --field names, or the one whose component it names; without --field all are shown.
    [[nodiscard]] bool shows(const std::string& name) const;
};

/// What `info` knows of one kind of file.
class FileInfo {
public:
    /// request: must live as long
    explicit FileInfo(const InfoRequest& request) : request_(request) {}
    virtual ~FileInfo() = default;
    FileInfo(const FileInfo&) = delete;
    FileInfo& operator=(const FileInfo&) = delete;

    [[nodiscard]] virtual std::vector<std::string> field_names(Report& report) = 0;
    /// Puts the figures of the file into the report.
    virtual void describe(Report& report) = 0;

protected:
    [[nodiscard]] const InfoRequest& request() const { return request_; }

private:
    const InfoRequest& request_;
};

/// throws: Error(InvalidInput) if this kind of file cannot have what was asked for
[[nodiscard]] std::unique_ptr<FileInfo> make_file_info(const InfoRequest& request);

[[nodiscard]] std::unique_ptr<FileInfo> make_mesh_info(const InfoRequest& request);
[[nodiscard]] std::unique_ptr<FileInfo> make_bricks_info(const InfoRequest& request);
/// A file with levels of detail is read by its head alone.
[[nodiscard]] std::unique_ptr<FileInfo> make_points_info(const InfoRequest& request);
[[nodiscard]] std::unique_ptr<FileInfo> make_grids_info(const InfoRequest& request);

}  // namespace subvol::cli
