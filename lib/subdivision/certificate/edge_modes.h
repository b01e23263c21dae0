// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <optional>

#include "edge_window.h"

namespace subvol::detail {

/// The points of a window as rows of matrices.
class WindowPlan {
public:
    using Row = Eigen::Index;

    explicit WindowPlan(std::size_t cells) : star_{cells, EdgeWindow::kReach} {}

    [[nodiscard]] const Star& star() const { return star_; }
    [[nodiscard]] Row across() const { return static_cast<Row>(star_.points()); }
    [[nodiscard]] Row points() const { return static_cast<Row>(EdgeWindow::kLayers) * across(); }
    [[nodiscard]] Row number(std::size_t s, int i, int j) const { return static_cast<Row>(star_.number(s, i, j)); }

    /// Calls visit(point of the star, s, i, j) for each sector's points; those of spokes more than once.
    template <class Visit>
    void each(const Visit& visit) const {
        for (std::size_t s = 0; s < star_.cells; ++s) {
            for (int i = 0; i <= static_cast<int>(star_.reach); ++i) {
                for (int j = 0; j <= static_cast<int>(star_.reach); ++j) visit(number(s, i, j), s, i, j);
            }
        }
    }

private:
    Star star_;
};

/// A complex vector z of the points of a star that both halves of a segment, constant along the edge, take to `rate` z: the one
/// of the largest eigenvalue of its frequency. A turn by a sector takes it to exp(2πi frequency / m) z, a mirror image about
/// spoke 0 to its conjugate. Its value at (0, 1, 0) is 1.
struct EdgeMode {
    double rate = 0, error = 0;  ///< error: of the rate and of each entry
    Eigen::VectorXcd layer;

    /// Its real and imaginary parts at all points of the window.
    [[nodiscard]] Eigen::MatrixXd values() const;
};

/// Encloses such a vector; nothing if that does not succeed. The rules are as symmetric as those of a scheme.
///
/// frequency: 1 or 2, less than half of the cells
[[nodiscard]] std::optional<EdgeMode> edge_mode(const EdgeRules& rules, const WindowPlan& plan, int frequency);

}  // namespace subvol::detail
