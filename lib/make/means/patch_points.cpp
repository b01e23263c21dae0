// SPDX-License-Identifier: Apache-2.0
// Values at points of the boundary from values on faces of patches. A face's value is the field's mean over it, so a point gets
//
//     b = Σ w (b_f + g_f · (x − x_f))      over the faces f at it, w their parts of the area there, x_f their centres,
//                                          g_f gradients along the patch, by the faces around f
//
// which is exact for linear fields; two corrections by what the limit's means over the faces lack follow, and one for the mean
// over each patch, as in fit_means.cpp. Points inside the mesh stay as they are: near a wall whose layer is thinner than a
// cell, no values there could give the cell beside it its mean without waves, as the boundary takes what it can not keep
// (adr/0027).
//
// Patches that meet at a point may have different values: a fluid flows into a channel at full speed beside a wall at which it
// rests. With the wall's value there, the limit would carry a third less through the inlet, so a patch that something flows
// through decides, or the cells where it says nothing; of a vector the wall takes only the component through itself:
//
//     ═════╤═════  wall: v · n = v_wall · n
//     ───> p       inlet: v
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string_view>

#include "mean_stencils.h"
#include "subvol/cell.h"
#include "subvol/cell_means.h"
#include "subvol/detail/flat_array.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/limit.h"

namespace subvol {

namespace {

/// area: its length is the area
struct PatchFace {
    Vec3 area{0.0}, centre{0.0};
    double size = 0;
};

/// A flag for each face: whether the field has values on its patch that are not all the same.
std::vector<std::uint8_t> varying_faces(const ValuesOnPatches& on_patches, const FieldOnPatches& field) {
    const std::vector<Index>& patches = on_patches.patches;
    const auto channels = static_cast<std::size_t>(field.channels);
    std::vector<std::uint8_t> varies(patches.empty() ? 0 : patches.back() + std::size_t{1}, 0), of_faces(patches.size());
    for (std::size_t f = 1; f < patches.size(); ++f) {
        const double* const values = &field.values[f * channels];
        const bool same = std::equal(values, values + channels, values - channels);
        if (patches[f] == patches[f - 1] && std::isfinite(values[0]) && !same) varies[patches[f]] = 1;
    }
    for (std::size_t f = 0; f < patches.size(); ++f) of_faces[f] = varies[patches[f]];
    return of_faces;
}

/// Means of the limit over the faces of the patches on which fields vary.
class FaceMeans {
public:
    FaceMeans(const HexMesh& mesh, const ValuesOnPatches& on_patches)
        : on_patches_(on_patches), extent_(detail::limit_extent(mesh)) {
        std::vector<std::uint8_t> varies(on_patches.patches.size(), 0);
        for (const FieldOnPatches& field : on_patches.fields) {
            const std::vector<std::uint8_t> of_field = varying_faces(on_patches, field);
            for (std::size_t f = 0; f < varies.size(); ++f) varies[f] |= of_field[f];
        }
        std::vector<std::uint8_t> cells(mesh.cells.size(), 0);
        for (std::size_t s = 0; s < on_patches.sides.size(); ++s) {
            if (!varies[on_patches.sides[s].face]) continue;
            sides_.push_back(static_cast<Index>(s));
            cells[on_patches.sides[s].side.cell] = 1;
        }
        if (sides_.empty()) return;
        detail::grow(mesh, cells, detail::kHaloOfLimit);
        part_ = detail::subset(mesh, cells);
        part_.mesh.attributes.clear();
        extent_.ranges.clear();
    }

    /// What the mean of the limit through `values` lacks of that on each face that counts; 0 on others.
    ///
    /// faces, slopes: centres and gradients: of a face's straight mean follows that where the limit's has its centre
    [[nodiscard]] std::vector<double> lacks(const FieldOnPatches& field, const std::vector<double>& values,
                                            std::span<const std::uint8_t> counts, std::span<const PatchFace> faces,
                                            std::span<const Vec3> slopes) {
        const auto channels = static_cast<std::size_t>(field.channels);
        std::vector<double> sums(field.values.size(), 0), areas(on_patches_.patches.size(), 0);
        std::vector<Vec3> shifts(areas.size(), Vec3(0.0));
        Attribute& all = part_.mesh.attributes.emplace_back(Attribute{field.name, field.channels, {}});
        for (const Index p : part_.points) {
            const auto at_point = std::span(values).subspan(p * channels, channels);
            all.values.insert(all.values.end(), at_point.begin(), at_point.end());
        }
        const auto [low, high] = std::ranges::minmax(values);
        extent_.ranges.assign(1, {low, high});
        const LimitEvaluator limit(part_.mesh, {.tolerance = 1e-5}, extent_);
        const double away = std::sqrt(.15);
        const std::array<std::pair<double, double>, 3> gauss{{{.5 - away, 5. / 18}, {.5, 8. / 18}, {.5 + away, 5. / 18}}};
        std::vector<LimitQuery> queries;
        for (const Index s : sides_) {
            const auto& [cell, side] = on_patches_.sides[s].side;
            const auto number = static_cast<Index>(std::ranges::lower_bound(part_.cells, cell) - part_.cells.begin());
            for (const auto& [u, wu] : gauss) {
                for (const auto& [v, wv] : gauss) {
                    const auto at = place_on_side(side, u, v);
                    queries.push_back({number, {at[0], at[1], at[2]}});
                }
            }
        }
        const LimitSamples samples = limit.at(queries);
        for (std::size_t q = 0; q < queries.size(); ++q) {
            const auto& [side, face] = on_patches_.sides[sides_[q / 9]];
            const double weight = gauss[q % 9 / 3].second * gauss[q % 3].second * area_at(samples.jacobians[q], side.side);
            areas[face] += weight;
            shifts[face] += weight * (samples.positions[q] - faces[face].centre);
            for (std::size_t c = 0; c < channels; ++c)
                sums[face * channels + c] += weight * samples.attributes[0].values[q * channels + c];
        }
        part_.mesh.attributes.clear();
        for (std::size_t i = 0; i < sums.size(); ++i) {
            const std::size_t f = i / channels;
            const bool known = areas[f] > 0 && std::isfinite(field.values[i]) && counts[f];
            sums[i] = known ? field.values[i] + (glm::dot(slopes[i], shifts[f]) - sums[i]) / areas[f] : 0;
        }
        return sums;
    }

private:
    static double area_at(const Mat3& jacobian, std::uint8_t side) {
        const auto corner = [&](double s, double t) {
            const auto at = place_on_side(side, s, t);
            return Vec3(at[0], at[1], at[2]);
        };
        return glm::length(glm::cross(jacobian * (corner(1, 0) - corner(0, 0)), jacobian * (corner(0, 1) - corner(0, 0))));
    }

    const ValuesOnPatches& on_patches_;
    detail::LimitExtent extent_;
    detail::MeshSubset part_;
    std::vector<Index> sides_;
};

class PatchPoints {
public:
    PatchPoints(const HexMesh& mesh, const ValuesOnPatches& on_patches, PatchValuesUse use)
        : mesh_(mesh), on_patches_(on_patches), use_(use), means_(mesh, on_patches) {
        measure_faces();
        sort_sides();
    }

    /// The gradients of one field at points, by its means over the cells that the faces belong to.
    ///
    /// centres: of these cells, for each face
    /// means:   `channels` for each face
    [[nodiscard]] GradientsAtPoints gradients(const FieldOnPatches& field, std::span<const Vec3> centres,
                                              std::span<const double> means) {
        field_ = &field;
        channels_ = static_cast<std::size_t>(field.channels);
        find_gradients(field.values);
        GradientsAtPoints found;
        std::vector<Index> faces;
        for (std::size_t k = 0; k < points_.size(); ++k) {
            faces.clear();
            for (const PatchRole role : {PatchRole::Wall, PatchRole::Open, PatchRole::Plane}) {
                if (!faces.empty() && role == PatchRole::Open) break;
                for (const Index s : sides_at_[k]) {
                    const Index f = face_of(s);
                    const Vec3 way = faces_[f].centre - centres[f];
                    const bool lies_behind = std::abs(glm::dot(way, faces_[f].area)) > 1e-6 * glm::length(way) * faces_[f].size;
                    if (role_of(s) == role && is_known(f) && faces_[f].size > 0 && lies_behind) faces.push_back(f);
                }
            }
            if (faces.empty()) continue;
            found.points.push_back(points_[k]);
            add_gradients(faces, centres, means, found.gradients);
        }
        return found;
    }

    /// Sets the values of one field. Returns how many points got one.
    std::size_t meet(const FieldOnPatches& field, Attribute& attribute) {
        field_ = &field;
        channels_ = static_cast<std::size_t>(field.channels);
        find_deciding();
        find_gradients(field.values);
        for (std::size_t k = 0; k < points_.size(); ++k) {
            if (is_decided(k)) start(k, attribute.values);
        }
        if (std::ranges::any_of(counts_, [](std::uint8_t counts) { return counts != 0; })) correct(attribute.values);
        std::size_t met = 0;
        for (std::size_t k = 0; k < points_.size(); ++k) {
            const bool held = channels_ == 3 && hold_normals(k, &attribute.values[points_[k] * 3]);
            if (!is_decided(k) && !held) continue;
            for (std::size_t c = 0; c < attribute.bounds.size(); ++c) {
                double& value = attribute.values[points_[k] * channels_ + c];
                value = std::clamp(value, attribute.bounds[c][0], attribute.bounds[c][1]);
            }
            ++met;
        }
        return met;
    }

private:
    void measure_faces() {
        faces_.resize(on_patches_.patches.size());
        for (const auto& [side, face] : on_patches_.sides) {
            std::array<Vec3, 4> x;
            for (std::size_t k = 0; k < 4; ++k) x[k] = mesh_.points[mesh_.cells[side.cell][kCellFaces[side.side][k]]];
            const Vec3 area = glm::cross(x[2] - x[0], x[3] - x[1]) / 2.0;
            faces_[face].area += area;
            for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {  // of two triangles
                const double triangle = glm::length(glm::cross(x[k] - x[0], x[k + 1] - x[0])) / 2;
                faces_[face].centre += triangle / 3 * (x[0] + x[k] + x[k + 1]);
                faces_[face].size += triangle;
            }
        }
        for (PatchFace& face : faces_) face.centre /= std::max(face.size, 1e-300);
    }

    /// The sides at each point of the boundary, in their order.
    void sort_sides() {
        std::vector<std::pair<Index, Index>> at;  // point, number of the side
        for (std::size_t s = 0; s < on_patches_.sides.size(); ++s) {
            const CellSide& side = on_patches_.sides[s].side;
            for (const std::size_t k : kCellFaces[side.side]) at.emplace_back(mesh_.cells[side.cell][k], static_cast<Index>(s));
        }
        std::ranges::sort(at);
        sides_at_.offsets.clear();
        for (const auto& [point, side] : at) {
            if (points_.empty() || points_.back() != point) {
                points_.push_back(point);
                sides_at_.offsets.push_back(sides_at_.values.size());
            }
            sides_at_.values.push_back(side);
        }
        sides_at_.offsets.push_back(sides_at_.values.size());
    }

    [[nodiscard]] Index face_of(Index side) const { return on_patches_.sides[side].face; }
    [[nodiscard]] PatchRole role_of(Index side) const { return on_patches_.roles[face_of(side)]; }
    [[nodiscard]] bool is_known(Index face) const { return std::isfinite(field_->values[face * channels_]); }
    [[nodiscard]] bool is_open(std::size_t k) const {
        return std::ranges::any_of(sides_at_[k], [&](Index s) { return role_of(s) == PatchRole::Open; });
    }
    [[nodiscard]] bool is_decided(std::size_t k) const { return deciding_.offsets[k] < deciding_.offsets[k + 1]; }

    /// The faces that decide the value of each point, a face for each of its sides there.
    void find_deciding() {
        deciding_ = {};
        for (std::size_t k = 0; k < points_.size(); ++k) {
            const bool open = is_open(k);
            for (const Index s : sides_at_[k]) {
                const bool open_or_first = !open || role_of(s) == PatchRole::Open;
                const bool only_normal = use_ == PatchValuesUse::Normal && channels_ == 3 && role_of(s) == PatchRole::Wall;
                const bool decides = open_or_first && !only_normal && is_known(face_of(s)) && faces_[face_of(s)].size > 0;
                if (decides) deciding_.values.push_back(face_of(s));
            }
            deciding_.offsets.push_back(deciding_.values.size());
        }
        // Faces with a corner that others decide cannot be met.
        counts_ = varying_faces(on_patches_, *field_);
        for (std::size_t k = 0; k < points_.size(); ++k) {
            for (const Index s : sides_at_[k]) {
                if (std::ranges::find(deciding_[k], face_of(s)) == deciding_[k].end()) counts_[face_of(s)] = 0;
            }
        }
    }

    // Least squares over the faces around it of the same patch that are not at an angle, as in mean_stencils.cpp.
    void find_gradients(const std::vector<double>& values) {
        constexpr double kLittleBent = .7;
        if (neighbours_.size() != faces_.size()) find_neighbours();
        gradients_.assign(faces_.size() * channels_, Vec3(0.0));
        std::vector<std::pair<Index, Vec3>> around;
        for (Index f = 0; f < faces_.size(); ++f) {
            if (!is_known(f)) continue;
            Mat3 normal(0.0);
            around.clear();
            for (const Index g : neighbours_[f]) {
                if (!is_known(g) || glm::dot(faces_[f].area, faces_[g].area) < kLittleBent * faces_[f].size * faces_[g].size)
                    continue;
                const Vec3 d = faces_[g].centre - faces_[f].centre;
                const double square = glm::dot(d, d);
                if (!(square > 0)) continue;
                normal += glm::outerProduct(d, d) / square;
                around.emplace_back(g, d / square);
            }
            const double few = 1e-6 * (normal[0][0] + normal[1][1] + normal[2][2]) + 1e-300;
            for (int a = 0; a < 3; ++a) normal[a][a] += few;
            const Mat3 inverse = glm::inverse(normal);
            for (const auto& [g, d] : around) {
                const Vec3 slope = inverse * d;
                if (!std::isfinite(slope.x + slope.y + slope.z)) continue;
                for (std::size_t c = 0; c < channels_; ++c)
                    gradients_[f * channels_ + c] += slope * (values[g * channels_ + c] - values[f * channels_ + c]);
            }
        }
    }

    /// The faces of the same patch with a common point.
    void find_neighbours() {
        constexpr std::size_t kMany = 64;  // on an axis: their neighbours along the edges are enough
        std::vector<std::pair<Index, Index>> pairs;
        for (std::size_t k = 0; k < points_.size(); ++k) {
            const auto sides = sides_at_[k];
            if (sides.size() > kMany) continue;
            for (const Index s : sides) {
                for (const Index t : sides) {
                    const Index f = face_of(s), g = face_of(t);
                    if (f != g && on_patches_.patches[f] == on_patches_.patches[g]) pairs.emplace_back(f, g);
                }
            }
        }
        std::ranges::sort(pairs);
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
        neighbours_ = {};
        std::size_t next = 0;
        for (std::size_t f = 0; f < faces_.size(); ++f) {
            for (; next < pairs.size() && pairs[next].first == f; ++next) neighbours_.values.push_back(pairs[next].second);
            neighbours_.offsets.push_back(neighbours_.values.size());
        }
    }

    /// The mean of values of the faces that decide, and how far their gradients lead beyond it.
    struct AtPoint {
        double mean = 0, beyond = 0;
    };
    [[nodiscard]] AtPoint at_point(std::size_t k, std::size_t c, const std::vector<double>& values) const {
        AtPoint sum;
        double area = 0;
        for (const Index f : deciding_[k]) {
            area += faces_[f].size;
            sum.mean += faces_[f].size * values[f * channels_ + c];
            sum.beyond += faces_[f].size * glm::dot(gradients_[f * channels_ + c], mesh_.points[points_[k]] - faces_[f].centre);
        }
        return {sum.mean / area, sum.beyond / area};
    }

    void start(std::size_t k, std::vector<double>& values) const {
        for (std::size_t c = 0; c < channels_; ++c) {
            const auto [mean, beyond] = at_point(k, c, field_->values);
            const auto [low, high] = limits_at(k, c);
            values[points_[k] * channels_ + c] = std::clamp(mean + beyond, low, high);
        }
    }

    // As in fit_means.cpp: two corrections by what the means lack, then limits; at last one change for the mean over each
    // patch.
    void correct(std::vector<double>& values) {
        constexpr int kTimes = 2;
        constexpr double kNear = 1e-6;
        double range = 0;
        for (const double value : field_->values) range = std::max(range, std::isfinite(value) ? std::abs(value) : 0);
        std::vector<std::array<double, 2>> limits;
        for (std::size_t k = 0; k < points_.size(); ++k) {
            for (std::size_t c = 0; c < channels_; ++c) limits.push_back(is_decided(k) ? limits_at(k, c) : std::array{0., 0.});
        }
        const std::vector<Vec3> slopes = gradients_;
        for (int round = 0; round <= kTimes; ++round) {
            std::vector<double> lacks = means_.lacks(*field_, values, counts_, faces_, slopes);
            const bool met = std::ranges::all_of(lacks, [&](double lack) { return std::abs(lack) <= kNear * range; });
            if (met) return;  // as of walls that turn and move, whose velocity is linear
            if (round == kTimes) spread(lacks);
            find_gradients(lacks);
            for (std::size_t k = 0; k < points_.size(); ++k) {
                if (!is_decided(k)) continue;
                for (std::size_t c = 0; c < channels_; ++c) {
                    const auto [mean, beyond] = at_point(k, c, lacks);
                    double& value = values[points_[k] * channels_ + c];
                    value += mean + beyond;
                    if (round + 1 != kTimes) continue;
                    value = std::clamp(value, limits[k * channels_ + c][0], limits[k * channels_ + c][1]);
                }
            }
        }
    }

    [[nodiscard]] std::array<double, 2> limits_at(std::size_t k, std::size_t c) const {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const Index f : deciding_[k]) {
            low = std::min(low, field_->values[f * channels_ + c]);
            high = std::max(high, field_->values[f * channels_ + c]);
        }
        // Beside a face across which nothing changes, the values on the patch lead no farther.
        const bool level = std::ranges::any_of(sides_at_[k], [&](Index s) { return field_->is_level(face_of(s)); });
        const double more = level ? 0 : 2 * std::abs(at_point(k, c, field_->values).beyond) + (high - low) / 4;
        return {low - more, high + more};
    }

    /// The gradient of a channel at a face.
    [[nodiscard]] Vec3 gradient_at(Index f, std::size_t c, const Vec3& cell_centre, double mean) const {
        const Vec3 n = faces_[f].area / glm::length(faces_[f].area), way = faces_[f].centre - cell_centre;
        const Vec3 along = gradients_[f * channels_ + c] - glm::dot(gradients_[f * channels_ + c], n) * n;
        const double step = field_->values[f * channels_ + c] - mean - glm::dot(along, way);
        return along + step / glm::dot(n, way) * n;
    }

    // The mean of the faces' gradients, changed so that its step across each face is nearly the face's own:
    // the least Σ w (n · (g + c) − n · g_f)² + few |c|². Where walls meet at an edge, the mean alone would have half of each
    // step. Then it is longer than the gradients of the faces, up to √2 times: of the two lengths it gets the geometric mean,
    // so that neither what flows through the walls nor the mean of lengths on them is far off.
    void add_gradients(std::span<const Index> faces, std::span<const Vec3> centres, std::span<const double> means,
                       std::vector<Vec3>& gradients) const {
        constexpr double kFew = .02, kRounding = 1e-6;
        double area = 0, length = 0, square = 0;
        Mat3 normals(0.0);
        for (const Index f : faces) {
            const Vec3 n = faces_[f].area / glm::length(faces_[f].area);
            normals += faces_[f].size * glm::outerProduct(n, n);
            area += faces_[f].size;
            double of_face = 0;
            for (std::size_t c = 0; c < channels_; ++c) {
                const Vec3 g = gradient_at(f, c, centres[f], means[f * channels_ + c]);
                of_face += glm::dot(g, g);
            }
            length += faces_[f].size * std::sqrt(of_face);
        }
        normals /= area;
        for (int a = 0; a < 3; ++a) normals[a][a] += kFew;
        const Mat3 inverse = glm::inverse(normals);
        for (std::size_t c = 0; c < channels_; ++c) {
            Vec3 mean(0.0), lacks(0.0);
            for (const Index f : faces) mean += faces_[f].size / area * gradient_at(f, c, centres[f], means[f * channels_ + c]);
            for (const Index f : faces) {
                const Vec3 n = faces_[f].area / glm::length(faces_[f].area);
                const Vec3 g = gradient_at(f, c, centres[f], means[f * channels_ + c]);
                lacks += faces_[f].size / area * glm::dot(n, g - mean) * n;
            }
            gradients.push_back(mean + inverse * lacks);
            square += glm::dot(gradients.back(), gradients.back());
        }
        length /= area;
        if (!(std::sqrt(square) > length * (1 + kRounding))) return;
        const double factor = std::sqrt(length / std::sqrt(square));
        for (std::size_t c = 0; c < channels_; ++c) gradients[gradients.size() - channels_ + c] *= factor;
    }

    /// Gives all faces of a patch the mean of their values.
    void spread(std::vector<double>& values) const {
        for (std::size_t begin = 0; begin < faces_.size();) {
            const auto end = static_cast<std::size_t>(
                std::ranges::upper_bound(on_patches_.patches, on_patches_.patches[begin]) - on_patches_.patches.begin());
            for (std::size_t c = 0; c < channels_; ++c) {
                double sum = 0, area = 0;
                for (std::size_t f = begin; f < end; ++f) {
                    sum += faces_[f].size * values[f * channels_ + c];
                    area += faces_[f].size;
                }
                for (std::size_t f = begin; f < end; ++f) values[f * channels_ + c] = area > 0 ? sum / area : 0;
            }
            begin = end;
        }
    }

    /// Gives a vector the normal component of walls that did not decide, and none along the normals of planes of symmetry.
    /// Returns whether there are such faces. Faces at right angles need one round.
    bool hold_normals(std::size_t k, double* value) const {
        constexpr int kRounds = 3;
        const bool yields = is_open(k) || !is_decided(k);
        bool held = false;
        Vec3 v(value[0], value[1], value[2]);
        for (int round = 0; round < kRounds; ++round) {
            for (const Index s : sides_at_[k]) {
                const Index f = face_of(s);
                const bool along = field_->along[f] != 0;
                const bool wall = role_of(s) == PatchRole::Wall && is_known(f) && yields;
                if ((!along && !wall) || !(glm::length(faces_[f].area) > 0)) continue;
                const double* const on_face = &field_->values[std::size_t{f} * 3];
                const Vec3 wanted = along ? Vec3(0.0) : Vec3(on_face[0], on_face[1], on_face[2]);
                const Vec3 n = faces_[f].area / glm::length(faces_[f].area);
                v += glm::dot(wanted - v, n) * n;
                held = true;
            }
        }
        for (int a = 0; a < 3; ++a) value[a] = v[a];
        return held;
    }

    const HexMesh& mesh_;
    const ValuesOnPatches& on_patches_;
    PatchValuesUse use_;
    FaceMeans means_;
    std::vector<PatchFace> faces_;
    std::vector<Index> points_;  // of the boundary, ascending
    IndexRows sides_at_, neighbours_, deciding_;
    std::vector<std::uint8_t> counts_;  // of each face: whether its mean is to be met
    const FieldOnPatches* field_ = nullptr;
    std::size_t channels_ = 1;
    std::vector<Vec3> gradients_;
};

/// The centre of the cell of the file behind each face, and a cell of the mesh that is a part of it.
struct CellsBehind {
    std::vector<Vec3> centres;
    std::vector<Index> cells;
};

CellsBehind cells_behind(const HexMesh& mesh, const ValuesOnPatches& on_patches, std::span<const Index> parts) {
    const auto whole = [&](Index cell) { return parts.empty() ? cell : parts[cell]; };
    std::map<Index, std::pair<Vec3, double>> sums;  // moment and volume of the wholes at patches
    for (const auto& [side, face] : on_patches.sides) sums.try_emplace(whole(side.cell), Vec3(0.0), 0.);
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        const auto found = sums.find(whole(c));
        if (found == sums.end()) continue;
        std::array<Vec3, 8> x;
        for (std::size_t k = 0; k < 8; ++k) x[k] = mesh.points[mesh.cells[c][k]];
        const detail::CellIntegrals integrals = detail::integrate(x);
        found->second.first += integrals.moment;
        found->second.second += integrals.volume;
    }
    CellsBehind behind{std::vector<Vec3>(on_patches.patches.size(), Vec3(0.0)),
                       std::vector<Index>(on_patches.patches.size(), 0)};
    for (const auto& [side, face] : on_patches.sides) {
        const auto& [moment, volume] = sums.at(whole(side.cell));
        behind.centres[face] = moment / std::max(volume, 1e-300);
        behind.cells[face] = side.cell;
    }
    return behind;
}

/// Returns for each point an eighth of the volumes of its cells.
std::vector<double> volumes_at(const HexMesh& mesh) {
    std::vector<double> volumes(mesh.points.size(), 0);
    for (const auto& cell : mesh.cells) {
        std::array<Vec3, 8> x;
        for (std::size_t k = 0; k < 8; ++k) x[k] = mesh.points[cell[k]];
        const double volume = std::abs(cell_volume(x));
        for (const Index p : cell) volumes[p] += volume / 8;
    }
    return volumes;
}

}  // namespace

PatchValuesReport meet_patch_values(HexMesh& mesh, const ValuesOnPatches& on_patches, PatchValuesUse use) {
    PatchValuesReport report;
    PatchPoints points(mesh, on_patches, use);
    const std::vector<double> volumes = volumes_at(mesh);
    std::map<std::string_view, Attribute*> known;
    for (Attribute& attribute : mesh.attributes) known.try_emplace(attribute.name, &attribute);
    for (const FieldOnPatches& field : on_patches.fields) {
        const auto found = known.find(field.name);
        if (found == known.end() || found->second->channels != field.channels) continue;
        Attribute* const attribute = found->second;
        const std::vector<double> before = attribute->values;
        const std::size_t met = points.meet(field, *attribute);
        if (met == 0) continue;
        ++report.fields;
        report.points = std::max(report.points, met);
        const auto channels = static_cast<std::size_t>(field.channels);
        for (std::size_t c = 0; c < channels; ++c) {
            double change = 0, size = 0;
            for (std::size_t p = 0; p < volumes.size(); ++p) {
                change += volumes[p] * (attribute->values[p * channels + c] - before[p * channels + c]);
                size += volumes[p] * std::abs(before[p * channels + c]);
            }
            if (!(std::abs(change) > report.most_of_mean * size)) continue;
            report.most_of_mean = std::abs(change) / size;
            report.most_changed = field.name;
        }
    }
    return report;
}

void set_wall_gradients(HexMesh& mesh, const ValuesOnPatches& on_patches, std::span<const Index> cell_parts) {
    PatchPoints points(mesh, on_patches, PatchValuesUse::Meet);
    const CellsBehind behind = cells_behind(mesh, on_patches, cell_parts);
    for (const FieldOnPatches& field : on_patches.fields) {
        const auto found = std::ranges::find(mesh.attributes, field.name, &Attribute::name);
        if (found == mesh.attributes.end() || found->channels != field.channels || !detail::is_at_cells(mesh, *found)) continue;
        const std::vector<double> means = detail::of_cells(found->cells, field.channels, behind.cells);
        found->walls = points.gradients(field, behind.centres, means);
    }
}

}  // namespace subvol
