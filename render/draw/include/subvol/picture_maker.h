// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/boundary_values.h"
#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/facts.h"
#include "subvol/image.h"
#include "subvol/kernel_file.h"
#include "subvol/mesh_kernels.h"
#include "subvol/method.h"
#include "subvol/picture_look.h"
#include "subvol/refine.h"
#include "subvol/render_brick_tets.h"
#include "subvol/render_bricks.h"
#include "subvol/render_projected.h"
#include "subvol/splat.h"
#include "subvol/voxels.h"

namespace subvol {

/// What may change from picture to picture.
struct PictureStyle {
    Method method = Method::Splat;
    LookOptions look{};
    std::optional<int> samples{};  ///< n × n rays or places for each pixel; none: 2 for solids, else 1
    Clip clip{};

    [[nodiscard]] int sample_count() const { return samples.value_or(look.look == Look::Solid ? 2 : 1); }
};

/// All options of pictures, for every method.
struct MethodOptions {
    PictureStyle style{};
    /// How meshes become kernels; its scheme is that of all methods, and so are its levels (none: the limit, for tets and pt
    /// level 1, of more than 300,000 cells level 0).
    KernelOptions kernels{};
    bool drop_invisible = false;  ///< kernels that the colours of the first picture make invisible are dropped from all
    /// How kernels are drawn; method, samples and clip are those of the style, channels those of the body, and light is added
    /// where the look has it.
    SplatOptions splat{};
    ProjectedOrder order = ProjectedOrder::Topological;  ///< for pt
    int kbuffer = 6;                                     ///< for pt
    /// The RMS by which colours may be off; none: 1e-3 for sheets, and the level of dense is chosen by how far it lies from the
    /// limit in the picture.
    std::optional<double> image_tolerance{};
    int max_levels = 6;  ///< for dense
    /// Kernels are merged as long as they are narrower than so many pixels; for pt the fraction of inner faces that is drawn.
    std::optional<double> lod{};
    std::optional<double> seconds{};  ///< the time that a picture may take
    /// For bricks: the memory for kernels or cells of a part of the picture.
    std::uint64_t memory_bytes = std::uint64_t{1} << 30;
    OptionNames names = OptionNames::Flags;  ///< how errors call the options
};

/// What users choose beside the method, the kernels (`KernelOptions`) and how these are drawn (`SplatOptions`).
[[nodiscard]] std::vector<Option> options_of(MethodOptions& options);

/// What users choose of kernels and what is not a member of an options struct: light on surfaces (`SplatOptions::shading`), the
/// field of the colours (`PictureBody`), and sums that are not divided (`SplatOptions::normalized`).
struct PictureChoices {
    bool shade = false;
    bool plain_sums = false;
    std::optional<std::string> color_field{};
};

[[nodiscard]] std::vector<Option> options_of(PictureChoices& choices);

/// All that users choose of a picture of a mesh, but its view and its colours.
struct PictureSettings {
    MethodOptions options{.names = OptionNames::Keywords};
    PictureChoices choices{};
    RefineOptions refinement{};   ///< its scheme is that of all methods
    std::optional<int> levels{};  ///< the level of all methods; none: as `KernelOptions::levels`

    [[nodiscard]] MethodOptions chosen() const;
};

[[nodiscard]] std::vector<Option> options_of(PictureSettings& settings);
/// Those that a method reads from a mesh.
[[nodiscard]] std::vector<Option> options_of(PictureSettings& settings, Method method);

/// throws: Error(InvalidInput) if the method cannot draw the light of the look
void validate(const PictureStyle& style, OptionNames names = OptionNames::Flags);

/// throws: Error(InvalidInput) for values that are out of range or contradict each other
void validate(const MethodOptions& options);

/// What is drawn; one of the pointers is set. All is referred to, not copied.
struct PictureBody {
    /// Its first attribute is shown, its last one gives the colours; a mesh in pieces has one attribute.
    std::optional<MeshSource> mesh{};
    bool tets = false;  ///< the mesh is a level of a scheme of tetrahedra on its limit, in hexahedra
    /// Beside `voxels`: the kernels that were made of the voxels, for the methods that draw kernels.
    const RbfVolume* kernels = nullptr;
    const Voxels* voxels = nullptr;
    KernelFile* file = nullptr;  ///< each view reads what it needs
    /// The channels of the kernels or of the file: the first is shown, the last gives the colours; empty: all.
    std::vector<std::size_t> channels{};
    std::uint64_t shape = 0;  ///< meshes with the same number have the same cells; 0: no other has them
    bool moved = false;       ///< the mesh is being moved, so that tables for its cells are worth while
    /// The mesh is one that a user has: a warning says if what is drawn shows that the field of the colours leaves its range in
    /// the mesh by more than 1 % of it.
    bool of_file = false;

    [[nodiscard]] BodyKind kind() const;
};

struct Picture {
    Image image;
    std::vector<float> depth{};  ///< for each pixel, as of SplatResult; empty: the method finds none
    Facts facts{};
};

/// How a picture is drawn whose rows belong to several processes, or to one after the other: this process draws its rows.
class PictureTeam {
public:
    virtual ~PictureTeam() = default;

    [[nodiscard]] virtual PixelRows rows(int height) const = 0;
    /// Whether this process gets the finished picture.
    [[nodiscard]] virtual bool finishes() const = 0;
    /// Draws the rows of a volume that every process has.
    ///
    /// skin: gives the boundary its colours; without values: the kernels do
    [[nodiscard]] virtual SplatResult splat(const RbfVolume& volume, const SplatOptions& options, const BoundaryValues& skin,
                                            const View& view, const Optics& optics, Progress* progress, Facts& facts) = 0;
    /// Draws the rows of a mesh in pieces, of which every process samples some.
    [[nodiscard]] virtual SplatResult splat(const MeshSource& source, Surface boundary, const BrickSplatOptions& options,
                                            const View& view, const Optics& optics, Facts& facts) = 0;
    /// `measure_tets` of all pieces.
    [[nodiscard]] virtual BrickTets measure(const MeshSource& source, const BrickTetsOptions& options) = 0;
    /// Adds up what all have counted.
    virtual void add_up(std::span<std::size_t> counts) = 0;
    /// Puts the rows of all together, where the picture is finished.
    virtual void gather(Picture& picture) = 0;
};

/// Draws one body as often as cameras, colours and styles change; keeps what pictures share: refined meshes, kernels,
/// splatters, the values on the boundary. The pictures of the command, the window, Python and studies are made here.
///
/// Kernels show the values on the boundary of a solid exactly there, unless an option says what kernels are to be made:
/// then one sees them. Methods that compute no light get that of the boundary afterwards. Not for several threads at once.
class PictureMaker {
public:
    /// team: null: this process draws whole pictures alone
    /// throws: Error(InvalidInput) as `validate`, or if the method cannot draw the body
    PictureMaker(PictureBody body, MethodOptions options, PictureTeam* team = nullptr);
    ~PictureMaker();
    PictureMaker(PictureMaker&&) noexcept;
    PictureMaker& operator=(PictureMaker&&) noexcept;

    /// Another body from the next picture on; tables for its cells are kept if it has the same.
    void set_body(PictureBody body);
    /// throws: Error(InvalidInput) if the method cannot draw the look
    void set_style(const PictureStyle& style);

    /// Makes what does not depend on the view, unless it is there.
    ///
    /// splatter: also what the next picture of all kernels needs
    /// returns:  what was found; empty if everything is there
    Facts prepare(const Optics& optics, Progress* progress = nullptr, bool splatter = true);

    /// stand_in: few kernels that are drawn in place of the body's; null: the body's
    [[nodiscard]] Picture draw(const View& view, const Optics& optics, Progress* progress = nullptr,
                               const RbfVolume* stand_in = nullptr);

    /// Draws a picture of the last view again with four times as many sheets, and says how far its colours are from those:
    /// `image_error`, the RMS over red, green and blue of all pixels, and `image_error_max`. Nothing of pictures that have no
    /// sheets, or whose number was chosen, of meshes in pieces, and of teams.
    [[nodiscard]] Facts measure_error(const Picture& picture, const View& view, const Optics& optics,
                                      Progress* progress = nullptr);

    /// The points that a named view frames; empty: the bounding box.
    [[nodiscard]] std::vector<Vec3> framed_points(const Optics& optics, Progress* progress, Facts& facts);
    /// Whether the colours of the style's pictures are those of the boundary.
    [[nodiscard]] bool paints_boundary() const;
    /// The values on the boundary, made by the first call.
    [[nodiscard]] const BoundaryValues& skin(Progress* progress, Facts& facts);
    /// The boundary of a mesh: that of its kernels where these are drawn, else that of `skin`.
    [[nodiscard]] const Surface& boundary(const Optics& optics, Progress* progress, Facts& facts);
    /// Whether the kernels made before serve these optics, too. If not, the next call with these optics makes others: their
    /// values are relative to the middle of a range that is narrow for 32-bit floats.
    [[nodiscard]] bool keeps_kernels(const Optics& optics) const;
    /// The kernels of a mesh or of points, made by the first call.
    [[nodiscard]] const RbfVolume& kernels(const Optics& optics, Progress* progress, Facts& facts);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol
