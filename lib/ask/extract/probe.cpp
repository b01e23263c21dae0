// SPDX-License-Identifier: Apache-2.0
// Finds the cell and the parameters uvw at which the limit x(uvw) is at a given place, and the fields there. A tree of the
// parts of space that cells may reach gives each place its candidates; then Newton's method goes on from the first of them,
// with all open places in one evaluation of the limit a round:
//
//     candidates → x, J at uvw → step J⁻¹ (place − x) → next cell, if the step leaves this one → …  until the step is tiny
//
// The last step is not evaluated: values change by it linearly. If the place is then farther than the tolerance and the reach,
// the next candidate is tried; a place without any is outside. Places are sorted in space, in batches, so that near ones share
// what they read. A large mesh is worked on piece by piece, each cut down to the cells that places may lie in and the layers
// that their limit needs; a place that several pieces find belongs to the cell with the least number.
#include "subvol/probe.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <optional>

#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/limit_place.h"
#include "subvol/detail/median_tree.h"
#include "subvol/detail/mesh_pieces.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/piece_tree.h"
#include "subvol/detail/space_order.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

using detail::CellReaches;
using detail::LimitPlace;
using detail::MedianTree;
using detail::NearPlace;
using detail::touch;

namespace {

constexpr std::size_t kPlacesAtOnce = std::size_t{1} << 19;  // places that are open at a time
constexpr int kMostProbeRounds = 24;                         // for all candidates of a place together
// A step this small (in parameters) is the last. What it changes is linear as far as the Jacobian is known, to about 1e-3.
constexpr double kLastStep = 2e-5;

/// A place that has not been found yet.
///
/// first, last: its candidates; the one that is looked at is `first`
struct Open {
    std::size_t place;
    LimitPlace at;
    std::size_t first, last;
    double left = 0;  // how far it was after the last step
    bool done = false;
};

void check(std::span<const Vec3> places) {
    for (std::size_t p = 0; p < places.size(); ++p) {
        if (std::isfinite(places[p].x) && std::isfinite(places[p].y) && std::isfinite(places[p].z)) continue;
        throw Error(ErrorCode::InvalidInput, "the place is not finite", "place " + std::to_string(p));
    }
}

}  // namespace

struct LimitProbe::State {
    State(HexMesh given, const ProbeOptions& wanted)
        : mesh(std::move(given)), options(wanted), topology((check_options(), build_topology(mesh))), steps(mesh, topology) {
        tree.emplace(mesh, options.limit.scheme, options.reach_world, options.limit.progress);
        on_boundary = std::max(options.limit.tolerance, 1e-9) * detail::tolerance_length(mesh);
        LimitOptions quiet = options.limit;
        quiet.progress = nullptr;
        limit.emplace(mesh, quiet);
    }

    void check_options() const {
        validate(mesh);
        subvol::check_options(options);
    }

    [[nodiscard]] ProbeResult empty_result(std::size_t places) const;
    void run(std::span<const Vec3> places, std::span<const std::size_t> to, std::vector<Open> open,
             std::span<const NearPlace> candidates, Progress* progress, ProbeResult& result) const;
    [[nodiscard]] std::vector<Open> find(std::span<const Vec3> places, std::vector<NearPlace>& candidates,
                                         Progress* progress) const;
    void settle(Open& open, std::size_t query, const LimitSamples& samples, const Vec3& place, std::span<const std::size_t> to,
                std::span<const NearPlace> candidates, ProbeResult& result) const;
    void write(const Open& open, std::size_t query, const LimitSamples& samples, const detail::LimitStep& step, double distance,
               std::size_t to, ProbeResult& result) const;

    HexMesh mesh;
    ProbeOptions options;
    Topology topology;
    detail::CellSteps steps;
    std::optional<detail::PieceTree> tree;
    std::optional<LimitEvaluator> limit;
    double on_boundary = 0;  // places this near count as inside (world)
};

LimitProbe::LimitProbe(HexMesh mesh, const ProbeOptions& options) : state_(std::make_unique<State>(std::move(mesh), options)) {
}
LimitProbe::~LimitProbe() = default;
LimitProbe::LimitProbe(LimitProbe&&) noexcept = default;
LimitProbe& LimitProbe::operator=(LimitProbe&&) noexcept = default;

const HexMesh& LimitProbe::mesh() const {
    return state_->mesh;
}

Box LimitProbe::box() const {
    return state_->tree->box();
}

/// The places that have candidates, with the first of these.
std::vector<Open> LimitProbe::State::find(std::span<const Vec3> places, std::vector<NearPlace>& candidates,
                                          Progress* progress) const {
    constexpr std::size_t kPart = 1024;
    struct Part {
        std::vector<NearPlace> candidates;
        std::vector<Open> open;
    };
    std::vector<Part> parts((places.size() + kPart - 1) / kPart);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
        if (progress && progress->cancelled()) return;  // the next report throws
        auto& [all, open] = parts[part];
        std::vector<NearPlace> found;
        for (std::size_t p = part * kPart; p < std::min(places.size(), (part + 1) * kPart); ++p) {
            tree->find(places[p], found);
            if (found.empty()) continue;
            open.push_back({p, found.front().place, all.size(), all.size() + found.size()});
            all.insert(all.end(), found.begin(), found.end());
        }
    });
    std::vector<Open> open;
    for (const Part& part : parts) {
        const std::size_t before = candidates.size();
        for (Open more : part.open) {
            more.first += before;
            more.last += before;
            open.push_back(more);
        }
        candidates.insert(candidates.end(), part.candidates.begin(), part.candidates.end());
    }
    return open;
}

/// to: the numbers of the places in the result; open: those that are searched for
void LimitProbe::State::run(std::span<const Vec3> places, std::span<const std::size_t> to, std::vector<Open> open,
                            std::span<const NearPlace> candidates, Progress* progress, ProbeResult& result) const {
    const std::size_t done = *std::ranges::min_element(to);  // the batches before
    std::vector<LimitQuery> queries;
    std::vector<Vec3> positions;
    for (int round = 0; round < kMostProbeRounds && !open.empty(); ++round) {
        report_progress(progress, "probe", done, result.cells.size());
        queries.clear();
        positions.clear();
        for (const Open& one : open) {
            queries.push_back(one.at);
            positions.push_back(places[one.place]);
        }
        // What a coarse level says helps a place that is far off; a place that is near would not come nearer.
        const LimitSamples samples = round == 0 ? limit->approach(queries, positions) : limit->at(queries);
        detail::parallel_each(open.size(), [&](std::size_t i) {
            open[i].at = queries[i];
            settle(open[i], i, samples, positions[i], to, candidates, result);
        });
        std::erase_if(open, [](const Open& one) { return one.done; });
        result.rounds = std::max(result.rounds, round + 1);
    }
}

/// One step of Newton's method; the last one is written down.
void LimitProbe::State::settle(Open& open, std::size_t query, const LimitSamples& samples, const Vec3& place,
                               std::span<const std::size_t> to, std::span<const NearPlace> candidates,
                               ProbeResult& result) const {
    const Vec3 offset = place - samples.positions[query];
    const detail::LimitStep step = detail::step_towards(offset, samples.jacobians[query], open.at, steps);
    const double size = std::max({std::abs(step.by.x), std::abs(step.by.y), std::abs(step.by.z)});
    const double left = glm::length(step.left);
    LimitPlace next{open.at.cell, open.at.uvw + step.by};
    const bool stays = glm::all(glm::greaterThanEqual(next.uvw, Vec3(-kLastStep))) &&
                       glm::all(glm::lessThanEqual(next.uvw, Vec3(1 + kLastStep)));
    const bool found = left <= on_boundary;
    if (size < kLastStep && stays) {
        if (found || left <= options.reach_world) {
            write(open, query, samples, step, found ? 0 : left, to[open.place], result);
            open.done = true;
            return;
        }
        if (step.held || open.left == left) {  // the nearest place of this candidate is outside
            open.done = ++open.first == open.last;
            if (!open.done) open.at = candidates[open.first].place;
            open.left = 0;
            return;
        }
    }
    open.left = left;
    open.at = next;
    steps.enter(open.at);
}

void LimitProbe::State::write(const Open& open, std::size_t query, const LimitSamples& samples, const detail::LimitStep& step,
                              double distance, std::size_t to, ProbeResult& result) const {
    result.cells[to] = open.at.cell;
    result.parameters[to] = glm::clamp(open.at.uvw + step.by, Vec3(0.0), Vec3(1.0));
    result.distances[to] = distance;
    for (std::size_t f = 0; f < result.fields.size(); ++f) {
        ProbedField& field = result.fields[f];
        const LimitAttribute& from = samples.attributes[f];
        const auto& bounds = mesh.attributes[f].bounds;
        for (std::size_t c = 0; c < field.channels; ++c) {
            const Vec3& derivatives = from.derivatives[query * field.channels + c];
            double value = from.values[query * field.channels + c] + glm::dot(derivatives, step.by);
            if (!bounds.empty()) value = std::min(std::max(value, bounds[c][0]), bounds[c][1]);  // the step may leave them
            field.values[to * field.channels + c] = value;
            field.gradients[to * field.channels + c] = detail::world_gradient(samples.jacobians[query], derivatives);
        }
    }
}

ProbeResult LimitProbe::State::empty_result(std::size_t places) const {
    ProbeResult result;
    result.cells.assign(places, kNone);
    result.parameters.assign(places, Vec3(0.0));
    result.distances.assign(places, 0);
    for (const Attribute& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        result.fields.push_back({attribute.name, channels, std::vector<double>(places * channels),
                                 std::vector<Vec3>(places * channels, Vec3(0.0))});
    }
    return result;
}

ProbeResult LimitProbe::near(std::span<const Vec3> places, std::span<const LimitQuery> starts) const {
    check(places);
    if (starts.size() != places.size()) {
        throw Error(ErrorCode::InvalidInput,
                    "there are " + std::to_string(starts.size()) + " starts for " + std::to_string(places.size()) + " places",
                    "LimitProbe::near");
    }
    ProbeResult result = state_->empty_result(places.size());
    if (places.empty()) return result;
    std::vector<std::size_t> numbers(places.size());
    std::vector<NearPlace> candidates(places.size());
    std::vector<Open> open;
    for (std::size_t p = 0; p < places.size(); ++p) {
        numbers[p] = p;
        candidates[p].place = starts[p];
        open.push_back({p, starts[p], p, p + 1});
    }
    state_->run(places, numbers, std::move(open), candidates, nullptr, result);
    return result;
}

ProbeResult LimitProbe::at(std::span<const Vec3> places, Progress* progress) const {
    check(places);
    ProbeResult result = state_->empty_result(places.size());
    std::vector<Vec3> sorted;  // near ones after each other: they share what they read
    std::vector<std::size_t> numbers;
    for (std::size_t begin = 0; begin < places.size(); begin += kPlacesAtOnce) {
        const auto batch = places.subspan(begin, std::min(kPlacesAtOnce, places.size() - begin));
        sorted.clear();
        numbers.clear();
        for (const Index p : detail::space_order(batch)) {
            sorted.push_back(batch[p]);
            numbers.push_back(begin + p);
        }
        std::vector<NearPlace> candidates;
        std::vector<Open> open = state_->find(sorted, candidates, progress);
        state_->run(sorted, numbers, std::move(open), candidates, progress, result);
    }
    report_progress(progress, "probe", 1);
    return result;
}

namespace {

bool contains(const Box& box, const Vec3& x) {
    return touch(box, {x, x});
}

/// The owned cells of a piece that a place may lie in, with the halo that their limit needs.
MeshPiece about_places(MeshPiece piece, const std::vector<Vec3>& places, int layers) {
    const CellReaches reaches(piece.mesh);
    const MedianTree<Box> tree(places, 16, [&](Index p) { return Box{places[p], places[p]}; });
    const auto has_place = [&](const Box& box) {
        bool found = false;
        tree.visit_leaves([&](const Box& node) { return touch(box, node); },
                          [&](std::size_t first, std::size_t last) {
                              for (; first < last && !found; ++first) found = contains(box, places[tree.item(first)]);
                              return found;
                          });
        return found;
    };
    detail::parallel_each(piece.owned_cells.size(), [&](std::size_t c) {
        auto& wanted = piece.owned_cells[c];
        wanted = wanted && !places.empty() && has_place(reaches(c));
    });
    std::vector<std::uint8_t> kept = piece.owned_cells;
    detail::grow(piece.mesh, kept, layers);
    return detail::subset(piece, kept);
}

/// Takes one place of a result.
void take(const ProbeResult& from, std::size_t i, ProbeResult& to, std::size_t place) {
    to.parameters[place] = from.parameters[i];
    for (std::size_t f = 0; f < to.fields.size(); ++f) {
        const std::size_t channels = to.fields[f].channels;
        for (std::size_t c = 0; c < channels; ++c) {
            to.fields[f].values[place * channels + c] = from.fields[f].values[i * channels + c];
            to.fields[f].gradients[place * channels + c] = from.fields[f].gradients[i * channels + c];
        }
    }
}

/// The fields of a result, without values at the places.
std::vector<ProbedField> empty_fields(const HexMesh& mesh, std::size_t places) {
    std::vector<ProbedField> fields;
    for (const Attribute& field : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(field.channels);
        fields.push_back(
            {field.name, channels, std::vector<double>(places * channels), std::vector<Vec3>(places * channels, Vec3(0.0))});
    }
    return fields;
}

ProbeResult probe_pieces(const MeshSource::Stored& stored, std::span<const Vec3> places, const ProbeOptions& options,
                         Progress* progress) {
    ProbeResult result;
    result.cells.assign(places.size(), kNone);
    result.parameters.resize(places.size());
    result.distances.assign(places.size(), 0);
    for (std::size_t b = 0; b < stored.pieces.size(); ++b) {
        report_progress(progress, "probe", b, stored.pieces.size());
        std::vector<std::size_t> numbers;
        std::vector<Vec3> near;
        for (std::size_t p = 0; p < places.size(); ++p) {
            if (!contains(stored.pieces[b].reach, places[p])) continue;
            numbers.push_back(p);
            near.push_back(places[p]);
        }
        if (near.empty() && !(b == 0 && result.fields.empty())) continue;
        const MeshPiece part = about_places(stored.read(b), near, stored.halo_layers);
        if (result.fields.empty()) result.fields = empty_fields(part.mesh, places.size());
        if (part.mesh.cells.empty()) continue;
        const ProbeResult found = LimitProbe(part.mesh, options).at(near);
        result.rounds = std::max(result.rounds, found.rounds);
        for (std::size_t i = 0; i < near.size(); ++i) {
            if (!found.inside(i) || !part.owned_cells[found.cells[i]]) continue;
            const std::uint64_t cell = part.cell_numbers[found.cells[i]];
            if (cell >= kNone || (result.cells[numbers[i]] != kNone && result.cells[numbers[i]] < cell)) continue;
            result.cells[numbers[i]] = static_cast<Index>(cell);
            take(found, i, result, numbers[i]);
        }
    }
    return result;
}

}  // namespace

ProbeResult probe_limit(const MeshSource& source, std::span<const Vec3> places, const ProbeOptions& options,
                        Progress* progress) {
    const HexMesh* mesh = source.mesh();
    if (mesh != nullptr && (mesh->cells.size() <= kMostCellsOfAProbe || options.reach_world > 0)) {
        return LimitProbe(*mesh, options).at(places, progress);
    }
    if (options.reach_world > 0) throw Error(ErrorCode::InvalidInput, "distances to bricks are not found");
    ProbeOptions quiet = options;
    quiet.limit.progress = nullptr;
    constexpr int kLayersOfLimit = 3;  // of cells, that the limit in a cell depends on
    MeshSource::Stored stored = source.in_pieces();
    if (mesh != nullptr) {
        validate(*mesh);
        check(places);
        stored.halo_layers = kLayersOfLimit;
    }
    return probe_pieces(stored, places, quiet, progress);
}

std::vector<Vec3> places_on_line(const Vec3& from, const Vec3& to, std::size_t count) {
    check(std::array{from, to});
    if (count == 0) throw Error(ErrorCode::InvalidInput, "a line of no places", "places_on_line", "a count of at least 1");
    std::vector<Vec3> places(count, from);
    for (std::size_t i = 1; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count - 1);
        places[i] = (1 - t) * from + t * to;
    }
    return places;
}

std::vector<Option> options_of(ProbeOptions& options) {
    return {Option("reach", options.reach_world)
                .not_negative()
                .help("D", "places outside, at most this far from the boundary, get the values of its nearest point")};
}

}  // namespace subvol
