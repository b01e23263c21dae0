// SPDX-License-Identifier: Apache-2.0
#include "subvol/streamlines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/option.h"

// Streamlines of the limit: dx/dt = U(x), by Dormand and Prince's method, whose seven stages
//
//      k_s = U(x + h Σ a_sr k_r)        x' = x + h Σ b_s k_s        the error: h Σ (b_s − b̂_s) k_s
//
// share the last one with the next step. The equation could be solved for the parameters of a cell, du/dt = J⁻¹ U. But the
// parameters of two cells that meet at an extraordinary edge do not continue each other smoothly: a step across their face
// would be of the first order, and a search for the face within the step would be needed there. U as a function of the place is
// as smooth as the limit is. So steps are of places, and each place of a stage is found from the last one by Newton's method,
// from cell to cell (`LimitProbe::near`): one or two evaluations of the limit, with the exact Jacobian.
//
// All lines take their steps together, so that the places of a stage are found in one call. A line whose step leaves the volume
// halves it, until a step that is as short as the end of a line may be off leaves it too.
namespace subvol {
namespace {

constexpr std::size_t kStages = 7;
constexpr double kA[kStages][kStages] = {{},
                                         {1.0 / 5},
                                         {3.0 / 40, 9.0 / 40},
                                         {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                         {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                         {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                         {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr double kError[kStages] = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

constexpr double kEnd = 1e-6;           // of the diagonal: how far before the boundary a line may end
constexpr double kStill = 1e-6;         // of the largest speed: what is slower does not move
constexpr double kMostTurn = 0.968;     // the cosine of the most that a step turns, 14.5 degrees
constexpr double kLeastTurning = 1e-4;  // of the diagonal: a shorter step may turn by more
constexpr double kUsualLength = 2;      // diagonals
constexpr std::size_t kMostSteps = 20'000;

/// One side of a streamline.
///
/// sign: 1 along the field, -1 against it
/// gone:  the way from the seed
/// lost:  the step has left the volume
/// waits: steps that do not grow yet
struct Side {
    std::size_t seed = 0;
    double sign = 1;
    Vec3 x{0.0};
    LimitQuery at{}, stage_at{};
    std::array<Vec3, kStages> k{};
    double t = 0, h = 0, gone = 0;
    bool lost = false;
    int waits = 0;
    std::optional<StreamEnd> end{};
    std::vector<Vec3> points{};
    std::vector<double> times{};
    std::vector<std::vector<double>> values{};  // of each field
    std::vector<std::vector<Vec3>> gradients{};

    void keep(const ProbeResult& found, std::size_t place) {
        points.push_back(x);
        times.push_back(sign * t);
        values.resize(found.fields.size());
        gradients.resize(found.fields.size());
        for (std::size_t f = 0; f < found.fields.size(); ++f) {
            const ProbedField& field = found.fields[f];
            for (std::size_t c = 0; c < field.channels; ++c) {
                values[f].push_back(field.values[place * field.channels + c]);
                gradients[f].push_back(field.gradients[place * field.channels + c]);
            }
        }
    }
};

class Tracer {
public:
    Tracer(const LimitProbe& probe, std::size_t field, const StreamlineOptions& options)
        : probe_(probe), field_(field), options_(options) {
        const HexMesh& mesh = probe.mesh();
        diagonal_ = bounds(mesh).diagonal();
        most_length_ = options.length_world.value_or(kUsualLength * diagonal_);
        const std::vector<double>& values = mesh.attributes[field].values;
        for (std::size_t p = 0; 3 * p < values.size(); ++p) {
            fastest_ = std::max(fastest_, glm::length(Vec3(values[3 * p], values[3 * p + 1], values[3 * p + 2])));
        }
    }

    /// Follows all sides to their ends.
    void run(std::vector<Side>& sides) const {
        for (std::size_t step = 0; step < kMostSteps; ++step) {
            std::vector<Side*> moving;
            for (Side& side : sides) {
                if (!side.end) moving.push_back(&side);
            }
            if (moving.empty()) return;
            report_progress(options_.progress, "streamlines", sides.size() - moving.size(), sides.size());
            detail::parallel_each(moving.size(), [&](std::size_t i) { begin(*moving[i]); });
            std::erase_if(moving, [](const Side* side) { return side->end.has_value(); });
            attempt(moving);
        }
        for (Side& side : sides) {
            if (!side.end) side.end = StreamEnd::Steps;
        }
    }

    /// The field at a place that was found.
    [[nodiscard]] Vec3 vector_at(const ProbeResult& found, std::size_t place) const {
        const std::vector<double>& values = found.fields[field_].values;
        return {values[3 * place], values[3 * place + 1], values[3 * place + 2]};
    }

private:
    /// The length of the next step, or the end of the line.
    void begin(Side& side) const {
        const double speed = glm::length(side.k[0]), longest = options_.longest_step * diagonal_;
        side.lost = false;
        if (!(speed > kStill * fastest_)) {
            side.end = StreamEnd::Still;
            return;
        }
        const double length_left = most_length_ - side.gone;
        const double time_left = options_.duration.value_or(std::numeric_limits<double>::infinity()) - side.t;
        if (length_left <= kEnd * diagonal_) {
            side.end = StreamEnd::Length;
        } else if (time_left * speed <= kEnd * diagonal_) {
            side.end = StreamEnd::Time;
        } else {
            if (side.h == 0) side.h = longest / speed;
            side.h = std::min({side.h, longest / speed, length_left / speed, time_left});
        }
    }

    /// One step of each side, which is taken or made shorter.
    void attempt(std::span<Side* const> moving) const {
        std::vector<Vec3> places;
        std::vector<LimitQuery> starts;
        ProbeResult found;
        std::vector<Side*> inside(moving.begin(), moving.end());
        for (Side* side : inside) side->stage_at = side->at;
        for (std::size_t s = 1; s < kStages && !inside.empty(); ++s) {
            places.clear();
            starts.clear();
            for (const Side* side : inside) {
                Vec3 sum(0.0);
                for (std::size_t r = 0; r < s; ++r) sum += kA[s][r] * side->k[r];
                places.push_back(side->x + side->h * sum);
                starts.push_back(side->stage_at);
            }
            found = probe_.near(places, starts);
            std::size_t left = 0;
            for (std::size_t i = 0; i < inside.size(); ++i) {
                Side& side = *inside[i];
                if (!found.inside(i)) {
                    side.lost = true;
                    continue;
                }
                side.stage_at = {found.cells[i], found.parameters[i]};
                side.k[s] = side.sign * vector_at(found, i);
                if (s + 1 == kStages) finish(side, places[i], found, i);
                inside[left++] = &side;
            }
            inside.resize(left);
        }
        for (Side* side : moving) {
            if (!side->lost) continue;
            if (side->h * glm::length(side->k[0]) <= kEnd * diagonal_) side->end = StreamEnd::Boundary;
            side->h /= 2;
            side->waits = 2;
        }
    }

    /// Takes the step if its error is small enough, and decides on the next one's length.
    void finish(Side& side, const Vec3& to, const ProbeResult& found, std::size_t place) const {
        Vec3 sum(0.0);
        for (std::size_t s = 0; s < kStages; ++s) sum += kError[s] * side.k[s];
        const double error = glm::length(side.h * sum) / (options_.tolerance * diagonal_);
        const double factor = std::clamp(0.9 * std::pow(std::max(error, 1e-12), -0.2), 0.2, 5.0);
        const double first = glm::length(side.k[0]), last = glm::length(side.k[kStages - 1]);
        const bool turns =
            glm::dot(side.k[0], side.k[kStages - 1]) < kMostTurn * first * last && first * side.h > kLeastTurning * diagonal_;
        if (error > 1 || turns) {
            side.h *= error > 1 ? std::min(factor, 0.9) : 0.5;
            side.waits = 1;
            return;
        }
        side.gone += glm::distance(side.x, to);
        side.t += side.h;
        side.x = to;
        side.at = side.stage_at;
        side.k[0] = side.k[kStages - 1];
        side.keep(found, place);
        if (side.waits == 0 || factor < 1) side.h *= factor;
        side.waits = std::max(0, side.waits - 1);
    }

    const LimitProbe& probe_;
    std::size_t field_;
    const StreamlineOptions& options_;
    double diagonal_ = 0, most_length_ = 0, fastest_ = 0;
};

/// Appends a point of a side to the lines.
void append(Streamlines& lines, const Side& side, std::size_t point) {
    lines.points.push_back(side.points[point]);
    lines.times.push_back(side.times[point]);
    for (std::size_t f = 0; f < lines.fields.size(); ++f) {
        ProbedField& field = lines.fields[f];
        for (std::size_t c = 0; c < field.channels; ++c) {
            field.values.push_back(side.values[f][point * field.channels + c]);
            field.gradients.push_back(side.gradients[f][point * field.channels + c]);
        }
    }
}

}  // namespace

double Streamlines::length() const {
    double sum = 0;
    for (std::size_t i = 0; i < count(); ++i) {
        for (std::size_t p = firsts[i] + 1; p < firsts[i + 1]; ++p) sum += glm::distance(points[p - 1], points[p]);
    }
    return sum;
}

std::size_t Streamlines::ends_by(StreamEnd reason) const {
    std::size_t sum = 0;
    for (const auto& [first, last] : ends) sum += (first == reason ? 1U : 0U) + (last == reason ? 1U : 0U);
    return sum;
}

Facts facts_of(const Streamlines& lines) {
    Facts facts;
    Facts& said = facts.group("streamlines");
    said["count"] = lines.count();
    said["points"] = lines.points.size();
    said["length"] = lines.length();
    said["outside"] = lines.outside.size();
    Facts& ends = said.group("ends");
    for (const auto& row : NameTable<StreamEnd>::rows) {
        if (const std::size_t count = lines.ends_by(row.value); count > 0 && row.value != StreamEnd::Seed)
            ends[row.name] = count;
    }
    if (!lines.outside.empty()) {
        const std::size_t all = lines.outside.size() + lines.count();
        facts.warn(std::to_string(lines.outside.size()) + " of " + std::to_string(all) + (all == 1 ? " seed" : " seeds") +
                   (lines.outside.size() == 1 ? " lies outside the volume and has" : " lie outside the volume and have") +
                   " no streamline");
    }
    return facts;
}

Streamlines trace_streamlines(const HexMesh& mesh, std::string_view field, std::span<const Vec3> seeds,
                              const StreamlineOptions& options) {
    check_options(options);
    const auto named = std::ranges::find(mesh.attributes, field, &Attribute::name);
    if (named == mesh.attributes.end() || named->channels != 3) {
        throw Error(ErrorCode::InvalidInput,
                    "'" + std::string(field) + "' is " +
                        (named == mesh.attributes.end() ? "no field" : "a field of another kind than a vector"),
                    "streamlines", "a field with three components");
    }
    const LimitProbe probe(mesh, {.limit = options.limit});
    const auto number = static_cast<std::size_t>(named - mesh.attributes.begin());
    const Tracer tracer(probe, number, options);
    const ProbeResult found = probe.at(seeds, options.progress);
    Streamlines lines;
    std::vector<Side> sides;
    for (std::size_t s = 0; s < seeds.size(); ++s) {
        if (!found.inside(s)) {
            lines.outside.push_back(s);
            continue;
        }
        for (const double sign : {-1.0, 1.0}) {
            Side& side = sides.emplace_back();
            side.seed = s;
            side.sign = sign;
            side.x = seeds[s];
            side.at = {found.cells[s], found.parameters[s]};
            side.k[0] = sign * tracer.vector_at(found, s);
            side.keep(found, s);
            const StreamDirection other = sign > 0 ? StreamDirection::Backward : StreamDirection::Forward;
            if (options.direction == other) side.end = StreamEnd::Seed;
        }
    }
    tracer.run(sides);
    for (const ProbedField& one : found.fields) lines.fields.push_back({one.name, one.channels, {}, {}});
    for (std::size_t i = 0; i < sides.size(); i += 2) {
        const Side &before = sides[i], &after = sides[i + 1];
        for (std::size_t p = before.points.size(); p-- > 1;) append(lines, before, p);
        for (std::size_t p = 0; p < after.points.size(); ++p) append(lines, after, p);
        lines.firsts.push_back(lines.points.size());
        lines.seeds.push_back(after.seed);
        lines.ends.push_back({*before.end, *after.end});
    }
    return lines;
}

std::vector<Option> options_of(StreamlineOptions& options) {
    return {Option("stream-direction", options.direction).help("NAME", "follow the field both ways, forward or backward"),
            Option("stream-length", options.length_world)
                .positive()
                .help("D", "no streamline is longer to either side of its seed (default: two diagonals of the body)"),
            Option("stream-time", options.duration).positive().help("T", "nor does it take longer"),
            Option("stream-tolerance", options.tolerance)
                .between(1e-10, 1e-2)
                .help("E", "the error of a step along a streamline, as a part of the diagonal"),
            Option("stream-step", options.longest_step)
                .between(1e-5, 0.5)
                .help("L", "no step along a streamline is longer, as a part of the diagonal")};
}

}  // namespace subvol
