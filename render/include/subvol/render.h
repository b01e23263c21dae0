#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/camera.h"
#include "subvol/gl_device.h"
#include "subvol/hex_mesh.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"

namespace subvol {

enum class Backend { Auto, Gl, Cpu };

/// How kernels become a picture; the pictures are the same. Kernels: tiles of the picture, batches of sheets. Sheets: one sheet
/// buffer after the other, drawn and composited by OpenGL, software too: the way of the EuroVis 2007 paper, for comparison.
enum class SplatMethod { Kernels, Sheets };

/// Light on the surfaces of equal value: Blinn and Phong's, with one light at the eye and a key light, both from either side.
/// Where the value hardly changes there is no surface, and colours stay what they are.
///
/// ambient, diffuse, specular: parts of the light, ≥ 0
/// key:                        towards the key light, in eye space (right, up, away from the eye)
struct Shading {
    double ambient = 0.3;
    double diffuse = 0.7;
    double specular = 0.25;
    double shininess = 32;
    Vec3 key{-0.5, 0.7, -0.5};
};

/// samples:       n × n places a pixel on a regular grid, of which the mean is taken, 1..16
/// sheets:        planes of constant eye depth over the volume's depth range, 2..65536
/// channel:       which channel of the volume is shown
/// device:        of OpenGL, its number in gl_devices(); none: the first hardware, else software
/// color_channel: takes the colours from another channel than the opacities; not pre-integrated
/// normalized:    whether sums are divided by the sum of weights; if not, kernels add up as they are
struct SplatOptions {
    SplatMethod method = SplatMethod::Kernels;
    Backend backend = Backend::Auto;
    std::optional<int> device{};
    int samples = 1;
    int sheets = 200;
    std::size_t channel = 0;
    std::optional<std::size_t> color_channel{};
    bool normalized = true;
    std::optional<Shading> shading{};
    Progress* progress = nullptr;
};

/// Time that a device spent on a part of the work.
struct StageTime {
    std::string stage;
    double seconds = 0;
};

struct SplatReport {
    std::string backend;  // "gl" or "cpu"
    std::string device;   // GL renderer string, or the number of CPU threads
    std::size_t points = 0;
    std::size_t bin_entries = 0;    // pairs of a tile and a kernel; on a GPU, of a tile, a batch of sheets and a kernel
    std::size_t boundary_hits = 0;  // entries and exits over all pixels
    double seconds_prepare = 0, seconds_draw = 0;
    std::vector<StageTime> stages{};  // of the GPU
};

/// depth: of each pixel, the mean eye depth of what is seen, by opacity; infinity where nothing is
struct SplatResult {
    Image image;
    std::vector<float> depth;
    SplatReport report;
};

/// Draws an RBF volume: kernels summed on image-aligned sheets, clipped per pixel to the boundary's entry and exit depths, the
/// transfer function applied after reconstruction, intervals pre-integrated, composited front to back. Without a boundary the
/// volume ends where the sum of weights falls to half of what it is inside.
///
/// Keeps what does not depend on the view, and its memory, from picture to picture. The volume is referred to, not copied: it
/// has to stay where it is. Pictures are bitwise the same for any number of threads. `Auto` takes a hardware GPU if there is
/// one, else the CPU. One picture at a time.
/// throws: Error(InvalidInput) for options out of range, or sizes, values and extinctions beyond 32-bit floats;
///         Error(InvalidInput) for SplatMethod::Sheets on Backend::Cpu;
///         Error(MissingCapability) if Backend::Gl or SplatMethod::Sheets finds no OpenGL 4.5
/// source: docs/science.md
class Splatter {
public:
    explicit Splatter(const RbfVolume& volume, const SplatOptions& options = {});
    ~Splatter();
    Splatter(Splatter&&) noexcept;
    Splatter& operator=(Splatter&&) noexcept;

    /// progress: who listens to this picture; null: the options' own
    [[nodiscard]] SplatResult draw(const View& view, const Optics& optics, Progress* progress = nullptr);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// One picture of a Splatter.
[[nodiscard]] SplatResult render_splats(const RbfVolume& volume, const View& view, const Optics& optics,
                                        const SplatOptions& options = {});

/// samples: n × n rays a pixel on a regular grid, 1..16
struct TetsOptions {
    int samples = 1;
    Progress* progress = nullptr;
};

struct TetsReport {
    std::size_t tets = 0;
    std::size_t degenerate_tets = 0;  // of zero volume: crossed, never sampled
    std::size_t inverted_tets = 0;
    std::size_t rays = 0;       // that met the volume
    std::size_t segments = 0;   // tetrahedra crossed, over all rays
    std::size_t lost_rays = 0;  // that met the volume and could not be followed to its other side
    std::size_t bytes = 0;      // of points, tetrahedra and boundary, without Embree's tree
    double seconds_build = 0;   // of the renderer, the same in all its pictures
    double seconds_draw = 0;
};

struct TetsResult {
    Image image;
    TetsReport report;
};

/// The reference: rays through the mesh split into tetrahedra, Embree for the entry, then from cell to cell through shared
/// faces, each segment integrated exactly with the value linear in the tetrahedron.
///
/// Keeps the tetrahedra and Embree's tree from picture to picture; mesh and scalar need not stay. Pictures are bitwise the same
/// for any number of threads.
/// source: docs/science.md
class TetsRenderer {
public:
    /// scalar: one value a point of the mesh
    /// throws: Error(InvalidInput) if scalar.size() != mesh.points.size(), or a value at a used point is not finite
    TetsRenderer(const HexMesh& mesh, std::span<const double> scalar, Progress* progress = nullptr);
    ~TetsRenderer();
    TetsRenderer(TetsRenderer&&) noexcept;
    TetsRenderer& operator=(TetsRenderer&&) noexcept;

    /// throws: Error(InvalidInput) if samples is out of range
    [[nodiscard]] TetsResult draw(const View& view, const Optics& optics, const TetsOptions& options = {}) const;
    [[nodiscard]] double seconds_build() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// One picture of a TetsRenderer.
[[nodiscard]] TetsResult render_tets(const HexMesh& mesh, std::span<const double> scalar, const View& view,
                                     const Optics& optics, const TetsOptions& options = {});

}  // namespace subvol
