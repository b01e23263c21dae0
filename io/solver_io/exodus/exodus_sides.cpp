// SPDX-License-Identifier: Apache-2.0
#include "exodus_sides.h"

namespace subvol::detail {

const CornersOfSides& exodus_sides(std::string_view type) {
    static const CornersOfSides none;
    static const CornersOfSides hex{{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}};
    static const CornersOfSides tet{{0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 2, 1}};
    static const CornersOfSides wedge{{0, 1, 4, 3}, {1, 2, 5, 4}, {0, 3, 5, 2}, {0, 2, 1}, {3, 4, 5}};
    static const CornersOfSides pyramid{{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {0, 4, 3}, {0, 3, 2, 1}};
    if (type.starts_with("HEX")) return hex;
    if (type.starts_with("TET")) return tet;
    if (type.starts_with("WEDGE")) return wedge;
    return type.starts_with("PYR") ? pyramid : none;
}

}  // namespace subvol::detail
