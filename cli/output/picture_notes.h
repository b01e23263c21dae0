// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "picture_arguments.h"
#include "subvol/legend.h"
#include "subvol/lines_in_volume.h"
#include "subvol/overlay.h"
#include "subvol/picture_maker.h"

namespace subvol {
struct ShellScene;
}

namespace subvol::cli {

/// The colours of the pictures of a run, and the legend that explains them.
struct ShownColors {
    Optics optics;
    LegendOptions legend;
};

/// A place with a text beside it.
struct PictureMark {
    Vec3 place{0.0};
    std::string text{};
};

/// Draws the picture of a view.
using DrawPicture = std::function<Picture(const View&, Progress*)>;

/// Lines in the depth of a volume, and the pictures of rays that end at them.
struct DrawnLines {
    SortedLines lines{};
    std::vector<Image> ended{};
};

/// What is drawn over the pictures of a run: shells and beams, axes, edges of the control mesh, a legend beside them.
struct PictureNotes {
    bool axes = false;
    std::optional<Vec3> scale_at{};     // a scale bar is for lengths at this point
    const HexMesh* edges = nullptr;     // of this mesh
    Clip clip{};                        // that of the pictures, which cuts edges
    bool within = false;                // edges lie in the depth of the body; else the picture has the depths
    const Surface* boundary = nullptr;  // of that body
    std::vector<PictureMark> marks{};
    std::shared_ptr<const ShellScene> shells{};
    std::shared_ptr<const ShellScene> flow{};  // streamlines and arrows
    Vec3 ink{0.0}, paper{1.0};
    bool rim = false;                    // of paper around all notes, as nobody knows the page behind them
    std::vector<std::string> caption{};  // lines above the body
    int caption_px = 0;                  // their rows
    TransferFunction function{};
    std::optional<LegendOptions> legend{};
    LegendStyle legend_style{};
    int legend_px = 0;      // its columns or rows
    int legend_height = 0;  // of the whole picture, by which its letters go with the width in the style

    /// The view of the volume, whose rays end at streamlines, arrows, and shells in a transparent body.
    [[nodiscard]] View view_of_volume(const View& view) const;
    /// Draws streamlines, arrows, shells and beams, which come first.
    void draw_shells(Picture& picture, const View& view) const;
    /// The edges that lie in the depth of a transparent body.
    [[nodiscard]] DrawnLines draw_within(const View& view, const DrawPicture& draw, Progress* progress) const;
    /// Draws edges, marks, axes and the scale bar.
    void draw_over(Picture& picture, const View& view, const DrawnLines& lines) const;
    /// Writes the name of a view into its upper left corner.
    void name_view(Picture& picture, const std::string& name) const;
    /// Makes room above the body for the caption and beside it for the legend, and draws them.
    void add_margins(Picture& picture) const;

private:
    /// Draws notes, with their rim if they have one.
    void draw(Image& image, const std::function<void(Image&)>& notes) const;
};

/// The notes that the arguments ask for. The room for legend and caption is taken off the views that `arguments.make_views`
/// makes from then on.
///
/// mesh:   the control mesh, which the notes refer to; null: there is none
/// facts:  get a warning that names the letters that cannot be drawn
/// throws: Error(InvalidInput) if the mesh is needed for edges or its time for a label, or there is no room
[[nodiscard]] PictureNotes make_notes(PictureArguments& arguments, const ShownColors& colors, const HexMesh* mesh,
                                      Facts& facts);

/// Warns of letters in these texts for which there are boxes in pictures.
void warn_of_boxes(std::span<const std::string> texts, Facts& facts);

}  // namespace subvol::cli
