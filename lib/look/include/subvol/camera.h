// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "subvol/names.h"
#include "subvol/vec.h"

namespace subvol {

/// The axis of the world that is up.
enum class UpAxis { X, Y, Z };

template <>
struct NameTable<UpAxis> {
    static constexpr Name<UpAxis> rows[] = {{UpAxis::X, "x"}, {UpAxis::Y, "y"}, {UpAxis::Z, "z"}};
};

/// A camera without a lens, in a right-handed world. Rays go through pixel centres; pixel (0,0) is the top left.
struct Camera {
    Vec3 eye{0, 0, 1};
    Vec3 target{0, 0, 0};
    Vec3 up{0, 1, 0};
    double fovy_deg = 40;  ///< vertical field of view, (0,180), of a perspective camera
    /// Height of the picture in world units of an orthographic camera; 0: the camera is a perspective one
    double ortho_height = 0;
};

/// x(z) = origin + z · direction, z the eye depth: |direction| ≥ 1 is the world length of a unit of depth.
struct Ray {
    Vec3 origin;
    Vec3 direction;
    double end = std::numeric_limits<double>::infinity();  ///< the depth at which it ends
};

/// A camera and a picture size: the mapping between pixels, eye space (x right, y up, z = depth along the view) and the world.
class View {
public:
    /// throws: Error(InvalidInput) if eye and target coincide, up is parallel to the view, the field of view is out of range or
    ///         the size is not in 1..65536, or of more than 2^28 pixels
    View(const Camera& camera, int width, int height);

    /// The same camera, and the same ends of rays, for another number of pixels.
    [[nodiscard]] View resized(int width, int height) const;

    /// Ends all rays of a pixel at a depth: where they meet something opaque that others draw. Volumes and shells are drawn up
    /// to there, exactly; the light inside a volume does not change. All methods but footprints.
    ///
    /// depths: eye depths, one for each pixel, rows from the top; infinity: the ray does not end, ≤ 0: it sees nothing
    /// throws: Error(InvalidInput) if there are more or fewer than pixels, or one is NaN
    void end_rays(std::vector<float> depths);
    [[nodiscard]] bool ends_rays() const { return ends_ != nullptr; }
    /// As end_rays was given them, to this view or to that which was resized; empty: no ray ends.
    [[nodiscard]] std::span<const float> ray_ends() const;
    /// The depth at which rays through a point of the picture end.
    [[nodiscard]] double ray_end(double x_px, double y_px) const;

    [[nodiscard]] const Camera& camera() const { return camera_; }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] bool perspective() const { return perspective_; }
    [[nodiscard]] Vec3 to_eye(const Vec3& world) const;

    /// Rows right, up, forward: rotates a world vector into eye space.
    [[nodiscard]] const std::array<Vec3, 3>& axes() const { return axes_; }
    [[nodiscard]] const Vec3& eye() const { return eye_; }

    /// Slopes (perspective) or eye-space offsets (orthographic) of a point of the picture in pixels: eye x,y at depth z are
    /// (a,b)·z in perspective and (a,b) in an orthographic view.
    [[nodiscard]] Vec2 slopes(double x_px, double y_px) const {
        return {(x_px - 0.5 * width_) * pixel_, (0.5 * height_ - y_px) * pixel_};
    }
    /// Size of a pixel in slopes: per unit depth (perspective) or in world units (orthographic).
    [[nodiscard]] double pixel() const { return pixel_; }

    /// Pixel coordinates of an eye-space point (depth > 0 in perspective).
    [[nodiscard]] Vec2 to_pixels(const Vec3& eye_point) const;

    /// The ray through the point (x_px, y_px) of the picture; the centre of pixel (i,j) is (i+.5, j+.5).
    [[nodiscard]] Ray ray(double x_px, double y_px) const;

private:
    struct RayEnds {
        int width, height;
        std::vector<float> depths;
    };

    Camera camera_;
    int width_, height_;
    bool perspective_;
    double pixel_;
    Vec3 eye_;
    std::array<Vec3, 3> axes_;
    std::shared_ptr<const RayEnds> ends_{};  // never changes: copies of a view share it
};

/// A perspective camera that sees a whole box: its eight corners, with a margin of 5 % and the box's centre in the middle. For
/// a view along z, if z is up, y is up in the picture; for another axis that is what `turned_upright` makes of y.
///
/// direction: from the eye to the box, e.g. (0,1,0) for the view `-y`
/// aspect:    the picture's width / height
/// throws:    Error(InvalidInput) if the box is empty or a number is out of range
[[nodiscard]] Camera fit_camera(const Box& box, const Vec3& direction, double fovy_deg = 30, double aspect = 1,
                                UpAxis up = UpAxis::Z);

/// Turns a vector of a world whose z is up into that of a world where another axis is: for y, (x, z, −y), as `vdb --up y`
/// turns meshes; for x, (z, y, −x).
[[nodiscard]] Vec3 turned_upright(const Vec3& v, UpAxis up);

/// The camera, moved along its line of sight until it sees the whole box with a margin of 5 %; an orthographic camera gets the
/// height for that. Direction and field of view do not change. The target becomes the point of the line that is nearest to the
/// box's centre.
///
/// throws: Error(InvalidInput) if the box is empty or the camera is not valid
[[nodiscard]] Camera fit_camera(const Camera& camera, const Box& box, double aspect = 1);

/// An orthographic camera with the direction of another camera, fitted to the box.
[[nodiscard]] Camera orthographic_camera(const Camera& camera, const Box& box, double aspect = 1);

/// Cameras on a circle: the first is `camera`, each of the others is turned by the same angle about the axis along `up` through
/// a centre, counter-clockwise seen from above.
///
/// frames: 1..100000
[[nodiscard]] std::vector<Camera> turntable(const Camera& camera, const Vec3& center, int frames);

/// `fit_camera` for all frames of a turntable about the box's centre: each of them sees the whole box.
[[nodiscard]] Camera fit_turntable(const Camera& camera, const Box& box, int frames, double aspect = 1);

/// Reads a camera from text: the name of a view (±x ±y ±z iso, or front −y, back, left −x, right, top +z, bottom), ten numbers
/// "ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy", of an orthographic camera with its ortho_height as the eleventh, or the name of a JSON
/// file with the keys eye and target, and optionally up (default: as for a view), fovy_deg and ortho_height; or with these
/// under the key camera, as in the report of `subvol render --json`.
///
/// A view is named after the side of the eye: in `-y` the eye is at negative y and looks towards +y; in `iso` it is in the
/// direction (+1,-1,+1) from the centre. Views have a field of view of 30°.
///
/// up:     of named views: if it is not z, iso, front and the other words are the sides `turned_upright`; ±x ±y ±z are the same
///         sides, with that axis up in the picture
/// throws: Error(InvalidInput), Error(Io)
[[nodiscard]] Camera parse_camera(const std::string& text, const Box& box, double aspect = 1, UpAxis up = UpAxis::Z);

}  // namespace subvol
