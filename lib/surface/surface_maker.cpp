// SPDX-License-Identifier: Apache-2.0
#include "surface_maker.h"

#include <algorithm>
#include <cmath>

#include "limit_place.h"
#include "splitmix.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

constexpr int kFirstLevel = 1;
constexpr std::size_t kPointsAtOnce = std::size_t{1} << 20;  // points whose fields are evaluated at a time
constexpr std::size_t kMostLookedAt = 2048;  // cells that decide the level: their 100,000 edges stand for those of all

/// About so many of the cells, one at random of each of as many runs of them.
std::vector<Index> some_of(const std::vector<Index>& cells) {
    const std::size_t run = (cells.size() + kMostLookedAt - 1) / kMostLookedAt;
    std::vector<Index> some;
    for (std::size_t first = 0; first + run <= cells.size(); first += run) some.push_back(cells[first + mixed(first) % run]);
    return some;
}

}  // namespace

HexMesh with_field_only(const HexMesh& mesh, std::optional<std::size_t> field) {
    HexMesh scalar{mesh.points, mesh.cells, {}, mesh.creases, mesh.sharp_faces};
    if (field) scalar.attributes.push_back(mesh.attributes[*field]);
    return scalar;
}

std::optional<std::size_t> number_of_field(const HexMesh& mesh, std::string_view name, const SurfaceOptions& options) {
    if (options.isos.empty()) return std::nullopt;
    return static_cast<std::size_t>(&scalar_field(mesh, name) - mesh.attributes.data());
}

std::vector<Cut> cuts_of(const SurfaceOptions& options) {
    std::vector<Cut> cuts;
    for (const double iso : options.isos) cuts.push_back({iso, options.cap});
    if (options.boundary) cuts.push_back({{}, true});
    return cuts;
}

double tolerance_world(const SurfaceOptions& options, const LimitExtent& whole) {
    const Vec3 size = whole.box.size();
    return options.tolerance * std::max({size.x, size.y, size.z, 1e-300});
}

SurfaceMaker::SurfaceMaker(const HexMesh& mesh, std::span<const std::uint8_t> owned, const LimitExtent& whole,
                           std::string_view field, const SurfaceOptions& options)
    : mesh_(mesh),
      options_(options),
      whole_(whole),
      field_(number_of_field(mesh, field, options)),
      topology_(build_topology(mesh)),
      scalar_(with_field_only(mesh, field_)),
      cutter_(scalar_, topology_, owned, options.scheme, options.progress),
      settler_(scalar_, topology_, extent_of_field(), options.scheme, options.progress),
      tolerance_world_(tolerance_world(options, whole)) {
}

LimitExtent SurfaceMaker::extent_of_field() const {
    LimitExtent extent{.box = whole_.box};
    if (field_) extent.ranges.push_back(whole_.ranges[*field_]);
    return extent;
}

/// The level to go on with, as far as options allow; the same one if there is none.
///
/// triangles: of the whole surface at this level
int SurfaceMaker::next_level(int level, double deviation, double triangles) const {
    const double more = std::log2(std::max(deviation / tolerance_world_, 1e-9)) / 2;
    const int wanted = level + std::max(0, static_cast<int>(std::ceil(more - 0.05)));
    int next = std::min(wanted, options_.max_level);
    while (next > level && triangles * std::pow(4.0, next - level) > static_cast<double>(options_.max_triangles)) --next;
    return next;
}

/// A surface that passes few cells is cut as a whole at each level; of others some cells are looked at until the level is
/// known.
std::optional<SettledCut> SurfaceMaker::make(const Cut& cut, const Share& share) const {
    SettledCut made{.level = std::min(kFirstLevel, options_.max_level), .soup = {}, .settled = {}};
    const int first_level = made.level;
    SurfaceSoup first = cutter_.cut(cut, first_level, cutter_.candidates(cut));
    if (first.leads_out) return {};
    const std::vector<Index> active = first.cells;
    const bool few = active.size() <= kMostLookedAt;
    const std::vector<Index> some = few ? std::vector<Index>() : some_of(active);
    made.soup = few ? std::move(first) : cutter_.cut(cut, first_level, some, {.follow = false});
    const double part = few ? 1 : static_cast<double>(some.size()) / static_cast<double>(active.size());
    for (;;) {
        made.settled = settler_.settle(made.soup, cut, made.level);
        made.deviation_world = settler_.deviation(made.soup, made.settled, made.level);
        const int next = next_level(made.level, made.deviation_world, static_cast<double>(made.soup.triangles.size()) / part);
        if (next == made.level) break;
        made.level = next;
        made.soup = cutter_.cut(cut, made.level, few ? made.soup.cells : some, {.follow = few});
        if (made.soup.leads_out) return {};
    }
    made.converged = made.deviation_world <= 1.1 * tolerance_world_;
    const std::vector<Index> all = few ? made.soup.cells : active;
    const auto [begin, end] = share.range(all.size());
    made.range = {begin, end, all.size()};
    if (few && share.whole()) return made;
    if (!few && share.whole() && made.level == first_level) {
        made.soup = std::move(first);
    } else {
        made.soup = cutter_.cut(cut, made.level, {all.begin() + std::ptrdiff_t(begin), all.begin() + std::ptrdiff_t(end)},
                                {.not_into = all});
        if (made.soup.leads_out) return {};
    }
    made.settled = settler_.settle(made.soup, cut, made.level);
    return made;
}

std::vector<ProbedField> SurfaceMaker::fields_at(std::span<const LimitQuery> places) const {
    std::vector<ProbedField> fields;
    for (const Attribute& attribute : mesh_.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        fields.push_back({attribute.name, channels, std::vector<double>(places.size() * channels),
                          std::vector<Vec3>(places.size() * channels)});
    }
    if (fields.empty()) return fields;
    report_progress(options_.progress, "fields", 0);
    const LimitEvaluator limit(mesh_, {.scheme = options_.scheme}, whole_);
    for (std::size_t begin = 0; begin < places.size(); begin += kPointsAtOnce) {
        const auto some = places.subspan(begin, std::min(kPointsAtOnce, places.size() - begin));
        const LimitSamples samples = limit.at(some);
        for (std::size_t f = 0; f < fields.size(); ++f) {
            const std::size_t channels = fields[f].channels;
            parallel_each(some.size() * channels, [&](std::size_t i) {
                fields[f].values[begin * channels + i] = samples.attributes[f].values[i];
                fields[f].gradients[begin * channels + i] =
                    world_gradient(samples.jacobians[i / channels], samples.attributes[f].derivatives[i]);
            });
        }
    }
    return fields;
}

}  // namespace subvol::detail
