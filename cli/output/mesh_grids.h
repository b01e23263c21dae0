// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common_options.h"
#include "refine_arguments.h"
#include "subvol/facts.h"
#include "subvol/limit_level.h"
#include "subvol/rasterize.h"
#include "tet_refinement.h"
#include "vdb_arguments.h"
#include "written_fields.h"

namespace subvol::cli {

/// The limit of a mesh for voxels of a size. The fact "levels" is the finest level, "cells" the number of curved pieces, 27
/// vertices each.
[[nodiscard]] WithFacts<LimitCells> reported_limit(const HexMesh& mesh, const RefineOptions& refinement, double voxel_size);

/// The cells that are rasterized: the mesh itself, or `part`, which becomes a mesh of those alone.
///
/// cells: as of `RasterizeOptions`
[[nodiscard]] const HexMesh& rasterized_cells(const HexMesh& mesh, std::span<const Index> cells, HexMesh& part);

/// The greatest and the mean error of a grid.
struct GridErrorFigures {
    std::size_t grid;  ///< the number of the grid
    double max, rms;
};

/// From a mesh to the grids that the options of `subvol vdb` ask for.
class MeshGrids {
public:
    /// input:  of the command, for the metadata
    /// asked:  referred to
    /// refine: referred to; a scheme of tetrahedra is taken out of it, see `TetRefinement`
    /// throws: Error(InvalidInput) for options that cannot be read; Error(Io) if --like cannot be read
    MeshGrids(std::string input, const VdbArguments& asked, RefineArguments& refine);

    [[nodiscard]] const WrittenFields& fields() const { return fields_; }
    [[nodiscard]] const TetRefinement& tets() const { return tets_; }

    /// Reads a mesh, with the fields that are written, turned and scaled.
    ///
    /// numbers: none: what --only leaves becomes a mesh of its own, whose cells are not refined. Else it stays as
    ///          `part_with_halo` has it, whose numbers these become, for `RasterizeOptions::cells`; all cells: empty
    [[nodiscard]] WithFacts<HexMesh> load(const std::string& input, const CommonOptions& options, Progress* progress,
                                          std::vector<Index>* numbers = nullptr) const;

    /// The options that do not depend on the mesh.
    [[nodiscard]] RasterizeOptions options(Progress* progress) const;

    /// The options for a mesh, which depend on its box and its fields. They refer to the limit of the mesh, which is kept until
    /// the next call.
    ///
    /// cells:  as of the options; referred to
    /// once:   the options are for one call of `make`, which then finds the limit of a mesh of many cells itself
    /// throws: Error(InvalidInput) if the mesh has a field with the name of the level set
    [[nodiscard]] WithFacts<RasterizeOptions> set_up(const HexMesh& mesh, Progress* progress, bool once = false,
                                                     std::span<const Index> cells = {});

    [[nodiscard]] WithFacts<std::vector<VdbGrid>> make(const HexMesh& mesh, const RasterizeOptions& options) const;

    /// Adds a grid of errors for each grid of a scalar field.
    [[nodiscard]] WithFacts<std::vector<GridErrorFigures>> add_errors(const HexMesh& mesh, const RasterizeOptions& options,
                                                                      std::vector<VdbGrid>& grids) const;

private:
    [[nodiscard]] double voxel_size_world(const HexMesh& mesh, const RasterizeOptions& options) const;

    std::string input_;
    const VdbArguments& asked_;
    const RefineArguments& refine_;
    WrittenFields fields_;
    TetRefinement tets_;
    std::vector<VdbGrid> like_grids_;
    LimitCells limit_;
};

}  // namespace subvol::cli
