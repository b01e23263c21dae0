// SPDX-License-Identifier: Apache-2.0
// What Python asks of the limit of a mesh: probes, integrals, slices, surfaces, streamlines, folds; and what it fits to data:
// meshes to samples, shapes or surfaces; control meshes of surfaces and labels. Most calls have these steps:
//
//     keywords ─► options     arrays ─► vectors      ─► work on a thread of its own, without the GIL ─► dict of arrays, facts
//                                                         └─► progress, on the thread of the call
//
// Values move into arrays without a copy; numbers of cells become 64-bit integers with −1 outside. Values and gradients of
// probes outside the volume are not a number. Figures of the file's own cells have names with `file_` and stand beside those of
// the limit. An Approximator keeps what it has found from step to step, so that a call that begins while another one runs is
// refused.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind.h"
#include "subvol/approximate.h"
#include "subvol/approximator.h"
#include "subvol/control_mesh.h"
#include "subvol/detail/limit_words.h"
#include "subvol/fit_shape.h"
#include "subvol/flow_surface.h"
#include "subvol/limit_slice.h"
#include "subvol/limit_surface.h"
#include "subvol/measure.h"
#include "subvol/mend_folds.h"
#include "subvol/mixed_probe.h"
#include "subvol/option.h"
#include "subvol/patch_measure.h"
#include "subvol/points_error.h"
#include "subvol/probe.h"
#include "subvol/quantity.h"
#include "subvol/read_surface.h"

namespace subvol::python {
namespace {

struct GivenProbe {
    GivenScheme scheme{};
    ProbeOptions probe{};
};

std::vector<Option> options_of(GivenProbe& given) {
    std::vector<Option> all = options_of(given.scheme);
    all.push_back(subvol::options_of(given.probe).front());
    return all;
}

std::vector<Option> keywords_of(PointsErrorOptions& options) {
    return scheme_and(options.scheme);
}

std::vector<Option> keywords_of(MeasureOptions& options) {
    return scheme_and(options.scheme, options_of(options));
}

std::vector<Option> keywords_of(FoldOptions& options) {
    return scheme_and(options.scheme, options_of(options));
}

std::vector<Option> keywords_of(FoldMotionOptions& options) {
    std::vector<Option> all = keywords_of(options.folds);
    std::ranges::move(options_of(options), std::back_inserter(all));
    return all;
}

std::vector<Option> keywords_of(MendOptions& options) {
    std::vector<Option> all = keywords_of(options.folds);
    std::ranges::move(options_of(options), std::back_inserter(all));
    return all;
}

std::vector<Option> keywords_of(ApproximateOptions& options) {
    return scheme_and(options.scheme, options_of(options));
}

std::vector<Option> keywords_of(FitShapeOptions& options) {
    return scheme_and(options.scheme, options_of(options));
}

struct GivenControlMesh {
    ControlMeshOptions mesh{};
    LabelOptions labels{};
};

std::vector<Option> keywords_of(GivenControlMesh& given) {
    std::vector<Option> all = scheme_and(given.mesh.scheme, options_of(given.mesh));
    std::ranges::move(options_of(given.labels), std::back_inserter(all));
    return all;
}

std::vector<Option> keywords_of(PatchOptions& options) {
    return scheme_and(options.scheme);
}

std::vector<Option> keywords_of(SliceOptions& options) {
    return scheme_and(options.limit.scheme, options_of(options));
}

std::vector<Option> keywords_of(SurfaceOptions& options) {
    return scheme_and(options.scheme, options_of(options));
}

std::vector<Option> series_keywords_of(ApproximateOptions& options) {
    return scheme_and(options.scheme, options_of_series(options));
}

template <class Options>
void describe_call(py::module_& module, const char* call, const std::vector<std::string>& besides = {}) {
    Options options;
    describe(module, call, keywords_of(options), besides);
}

/// Cells as numbers, −1 outside.
py::array cells_of(const std::vector<Index>& cells, std::vector<py::ssize_t> shape) {
    std::vector<std::int64_t> numbers(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) numbers[i] = cells[i] == kNone ? -1 : static_cast<std::int64_t>(cells[i]);
    return owned(std::move(numbers), std::move(shape));
}

/// Values and gradients by the fields' names; not a number where the places are outside.
void put_fields(std::vector<ProbedField> fields, const std::vector<Index>* cells, py::dict& result) {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    py::dict values, gradients;
    for (ProbedField& field : fields) {
        for (std::size_t i = 0; cells != nullptr && i < field.values.size(); ++i) {
            if ((*cells)[i / field.channels] != kNone) continue;
            field.values[i] = kNothing;
            field.gradients[i] = Vec3(kNothing);
        }
        const py::ssize_t count = length(field.values.size() / field.channels), channels = length(field.channels);
        const bool scalar = channels == 1;
        values[py::str(field.name)] = owned(
            std::move(field.values), scalar ? std::vector<py::ssize_t>{count} : std::vector<py::ssize_t>{count, channels});
        py::array rows = owned(std::move(field.gradients));
        gradients[py::str(field.name)] = scalar ? rows : rows.reshape({count, channels, py::ssize_t(3)});
    }
    result["fields"] = values;
    result["gradients"] = gradients;
}

py::dict probe(const HexMesh& mesh, const py::object& at, int levels, const py::object& progress, const py::kwargs& keywords) {
    const std::vector<Vec3> places = vectors(at, "places");
    GivenProbe given;
    set_options(options_of(given), keywords);
    const auto tets = given.scheme.tets();
    ProbeOptions options = given.probe;
    if (!tets) options.limit.scheme = given.scheme.hexes();
    ProbeResult found = result_of(progress, [&](Progress* listener) {
        if (tets) {
            std::vector<Index> cells;
            const MixedMesh fine =
                refined_tets(mesh, *tets, levels, given.scheme.rules.crease_angle_deg, true, listener, &cells);
            return MixedProbe(fine, std::move(cells), options.reach_world, listener).at(places, listener);
        }
        options.limit.progress = listener;
        return LimitProbe(mesh, options).at(places, listener);
    });
    if (tets) found.parameters.assign(places.size(), Vec3(std::numeric_limits<double>::quiet_NaN()));
    py::dict result;
    put_fields(std::move(found.fields), &found.cells, result);
    result["cells"] = cells_of(found.cells, {length(places.size())});
    result["parameters"] = owned(std::move(found.parameters));
    return result;
}

py::tuple error_of_points(const RbfVolume& volume, const HexMesh& mesh, const std::string& field, std::size_t channel,
                          const py::object& progress, const py::kwargs& keywords) {
    PointsErrorOptions options{.channel = channel};
    set_options(keywords_of(options), keywords);
    PointsError error = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return points_error(volume, mesh, field, options);
    });
    const py::ssize_t count = length(error.of_points.size());
    return py::make_tuple(owned(std::move(error.of_points), {count}), error.max, error.rms, error.gaps);
}

/// field: a FieldMeasure or a PatchField
template <class Field>
py::dict figures_of_field(const Field& field) {
    py::dict one;
    one["integral"] = field.integral;
    one["mean"] = field.mean;
    one["min"] = field.min.value;
    one["min_at"] = as_tuple(field.min.place);
    one["max"] = field.max.value;
    one["max_at"] = as_tuple(field.max.place);
    one["extreme_error"] = field.extreme_error;
    one["file_integral"] = field.given.integral;
    one["file_mean"] = field.given.mean;
    one["file_min"] = field.given.min.value;
    one["file_min_at"] = as_tuple(field.given.min.place);
    one["file_max"] = field.given.max.value;
    one["file_max_at"] = as_tuple(field.given.max.place);
    return one;
}

py::dict as_dict(PartMeasure part) {
    py::dict result, fields;
    for (FieldMeasure& field : part.fields) {
        py::dict one = figures_of_field(field);
        const py::ssize_t bins = length(field.histogram.size());
        one["histogram"] = owned(std::move(field.histogram), {bins});
        fields[py::str(field.name)] = one;
    }
    result["cells"] = part.cells;
    result["volume"] = part.volume;
    result["error"] = part.error;
    result["file_volume"] = part.given_volume;
    result["fields"] = fields;
    return result;
}

py::dict measure(const py::object& self, const std::vector<std::string>& only, const py::object& progress,
                 const py::kwargs& keywords) {
    const SpaceAndCells regions = space_and_cells(parse_regions(only));
    const auto& mesh = self.cast<const HexMesh&>();
    const MeshSets sets = sets_of(self);
    std::vector<std::uint8_t> cells;
    if (!regions.cells.empty()) cells = cells_in(mesh, regions.cells, sets);
    MeasureOptions options;
    options.cells = cells;
    options.sets = sets.sets;
    set_options(keywords_of(options), keywords);
    LimitMeasure found = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return regions.space.empty() ? measure_limit(mesh, options) : measure_limit_in(mesh, regions.space, options);
    });
    LimitBody body;
    body.volume = found.whole.volume;
    body.given_volume = found.whole.given_volume;
    std::vector<std::string> warnings{detail::limit_words(body, OptionNames::Keywords)};
    for (const FieldMeasure& field : found.whole.fields)
        warnings.push_back(detail::range_words(field.name, field.given.min.value, field.given.max.value, field.min.value,
                                               field.max.value, OptionNames::Keywords));
    warnings.push_back(detail::fold_words(found.folds.cells, found.folds.first, found.folds.place, OptionNames::Keywords));
    std::erase(warnings, "");
    py::dict result = as_dict(std::move(found.whole)), parts;
    for (PartMeasure& part : found.parts) {
        const py::str name(part.name);
        parts[name] = as_dict(std::move(part));
    }
    result["parts"] = parts;
    result["warnings"] = warnings;
    return result;
}

py::list measure_patches_of(const py::object& self, const std::vector<std::string>& names,
                            const std::optional<std::string>& flux, const py::object& progress, const py::kwargs& keywords) {
    const auto& mesh = self.cast<const HexMesh&>();
    PatchOptions options;
    set_options(keywords_of(options), keywords);
    const std::vector<Patch> patches = chosen_patches(mesh, sets_of(self), names);
    const std::vector<PatchMeasure> found = result_of(progress, [&](Progress* listener) {
        if (flux) options.flux_field = vector_field_of(mesh, *flux, listener);
        options.progress = listener;
        return measure_patches(mesh, patches, options);
    });
    py::list list;
    for (const PatchMeasure& patch : found) {
        py::dict one, fields;
        one["name"] = patch.name;
        one["faces"] = patch.sides;
        one["area"] = patch.area;
        one["error"] = patch.error;
        one["file_area"] = patch.given_area;
        one["normal"] = as_tuple(patch.normal);
        if (patch.flux) {
            one["flux"] = *patch.flux;
            one["throughput"] = *patch.throughput;
            one["file_flux"] = patch.given_flux.value_or(std::nan(""));
            one["file_throughput"] = patch.given_throughput.value_or(std::nan(""));
        }
        for (const PatchField& field : patch.fields) fields[py::str(field.name)] = figures_of_field(field);
        one["fields"] = fields;
        list.append(one);
    }
    return list;
}

py::dict slice(const HexMesh& mesh, const std::string& field, const std::array<double, 3>& point,
               const std::array<double, 3>& normal, const py::object& progress, const py::kwargs& given) {
    SliceOptions options;
    set_options(keywords_of(options), given);
    SliceExtremes file;
    SliceFigures of_limit, of_file;
    LimitSlice found = result_of(progress, [&](Progress* listener) {
        options.progress = options.limit.progress = listener;
        LimitSlice slice = slice_limit(mesh, field, {point[0], point[1], point[2]}, {normal[0], normal[1], normal[2]}, options);
        of_limit = figures_of(mesh, slice, options.limit);
        of_file = given_figures_of(mesh, slice, {}, listener);
        file = find_slice_extremes(mesh, slice, options.limit);
        return slice;
    });
    const std::vector<py::ssize_t> shape{found.height, found.width};
    py::dict result;
    result["field"] = found.field;
    result["area"] = of_limit.area;
    result["mean"] = of_limit.mean;
    result["file_area"] = of_file.area;
    result["file_mean"] = of_file.mean;
    result["values"] = owned(std::move(found.values), shape);
    result["gradients"] = owned(std::move(found.gradients)).reshape({shape[0], shape[1], py::ssize_t(3)});
    result["cells"] = cells_of(found.cells, shape);
    result["origin"] = owned(std::vector{found.origin.x, found.origin.y, found.origin.z}, {3});
    result["right"] = owned(std::vector{found.right.x, found.right.y, found.right.z}, {3});
    result["down"] = owned(std::vector{found.down.x, found.down.y, found.down.z}, {3});
    result["min"] = found.min;
    result["min_at"] = as_tuple(found.min_at);
    result["max"] = found.max;
    result["max_at"] = as_tuple(found.max_at);
    result["file_min"] = file.min.value;
    result["file_min_at"] = as_tuple(file.min.place);
    result["file_max"] = file.max.value;
    result["file_max_at"] = as_tuple(file.max.place);
    return result;
}

struct GivenStreamlines {
    std::size_t seed_count = 30;
    StreamlineOptions lines{};
};

std::vector<Option> keywords_of(GivenStreamlines& given) {
    std::vector<Option> all = scheme_and(given.lines.limit.scheme);
    FlowChoices any;
    const std::vector<Option> of_any = options_of(any);
    all.push_back(Option("seed-count", given.seed_count)
                      .between(1, 100000)
                      .help("N", std::ranges::find(of_any, "seed-count", &Option::name)->sentence));
    std::ranges::move(options_of(given.lines), std::back_inserter(all));
    return all;
}

py::dict streamlines(const HexMesh& mesh, const std::string& vector, const py::object& seeds,
                     const std::optional<std::string>& path, const py::object& progress, const py::kwargs& given) {
    GivenStreamlines chosen;
    set_options(keywords_of(chosen), given);
    HexMesh traced = mesh;
    std::erase_if(traced.attributes, [&](const Attribute& a) { return a.name == vector; });
    const std::vector<Vec3> places = seeds_in(mesh, seeds, chosen.seed_count, chosen.lines.limit);
    Streamlines found = result_of(progress, [&](Progress* listener) {
        traced.attributes.push_back(vector_field_of(mesh, vector, listener));
        chosen.lines.progress = listener;
        Streamlines lines = trace_streamlines(traced, vector, places, chosen.lines);
        if (path) write_streamlines(*path, lines);
        return lines;
    });
    const auto numbers_from = [](const std::vector<std::size_t>& numbers) {
        return owned(std::vector<std::int64_t>(numbers.begin(), numbers.end()), {length(numbers.size())});
    };
    py::dict result;
    result["report"] = dict_of(facts_of(found));
    py::list ends;
    for (const auto& [first, last] : found.ends)
        ends.append(py::make_tuple(std::string(name_of(first)), std::string(name_of(last))));
    const py::ssize_t points = length(found.points.size());
    result["points"] = owned(std::move(found.points));
    result["times"] = owned(std::move(found.times), {points});
    result["offsets"] = numbers_from(found.firsts);
    result["seeds"] = numbers_from(found.seeds);
    result["outside"] = numbers_from(found.outside);
    result["ends"] = ends;
    put_fields(std::move(found.fields), nullptr, result);
    return result;
}

py::dict surface(const HexMesh& mesh, const std::string& field, std::vector<double> isos,
                 const std::optional<std::string>& path, const std::array<double, 3>& origin, const py::object& progress,
                 const py::kwargs& given) {
    const Vec3 place(origin[0], origin[1], origin[2]);
    SurfaceOptions options{.isos = std::move(isos)};
    const std::vector<std::string> besides(options.isos.empty() ? 0 : 1, "iso");
    set_options(keywords_of(options), given, besides);
    LimitSurface found = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        LimitSurface made = limit_surface(mesh, field, options);
        if (path) write_limit_surface(*path, made, {.origin = place});
        return made;
    });
    py::dict result, report;
    report["area"] = found.report.area;
    report["volume"] = found.report.volume;
    report["watertight"] = found.report.watertight;
    report["euler"] = found.report.euler;
    report["components"] = found.report.components;
    report["min_angle"] = found.report.min_angle_deg;
    report["deviation"] = found.report.deviation_world;
    report["converged"] = found.report.converged;
    report["level"] = found.report.level;
    const bool rounds = path && path->ends_with(".stl");
    report["collapsed"] = rounds ? collapsed_by_floats(found.surface, place) : 0;
    result["report"] = report;
    std::vector<std::int64_t> corners;
    corners.reserve(3 * found.surface.triangles.size());
    for (const auto& t : found.surface.triangles) corners.insert(corners.end(), t.begin(), t.end());
    const py::ssize_t triangles = length(found.surface.triangles.size());
    result["triangles"] = owned(std::move(corners), {triangles, 3});
    result["points"] = owned(std::move(found.surface.points));
    result["normals"] = owned(std::move(found.normals));
    put_fields(std::move(found.fields), nullptr, result);
    return result;
}

}  // namespace

std::vector<Vec3> seeds_in(const HexMesh& mesh, const py::object& seeds, std::size_t count, const LimitOptions& limit) {
    if (seeds.is_none()) {
        return result_of(py::none(), [&](Progress* listener) {
            LimitOptions heard = limit;
            heard.progress = listener;
            return middles_of_cells(mesh, count, heard);
        });
    }
    if (py::isinstance<py::str>(seeds)) return parse_seeds(seeds.cast<std::string>(), count);
    const bool is_list = py::isinstance<py::list>(seeds) || py::isinstance<py::tuple>(seeds);
    if (is_list && py::len(seeds) > 0 && py::isinstance<py::str>(py::sequence(seeds)[0])) {
        std::vector<Vec3> places;
        for (const py::handle text : seeds) {
            const std::vector<Vec3> more = parse_seeds(text.cast<std::string>(), count);
            places.insert(places.end(), more.begin(), more.end());
        }
        return places;
    }
    return vectors(seeds, "seeds");
}

py::dict dict_of(FoldCheck found) {
    std::vector<std::uint8_t> verdicts;
    for (const FoldVerdict verdict : found.verdicts) verdicts.push_back(static_cast<std::uint8_t>(verdict));
    std::vector<Vec3> parameters, positions;
    std::vector<std::int64_t> cells;
    std::vector<double> determinants, times;
    for (const FoldPlace& at : found.places) {
        cells.push_back(static_cast<std::int64_t>(at.cell));
        parameters.push_back(at.uvw);
        positions.push_back(at.position);
        determinants.push_back(at.determinant);
        times.push_back(at.time);
    }
    py::array_t<bool> sampled(length(found.places.size()));
    for (std::size_t k = 0; k < found.places.size(); ++k) sampled.mutable_at(length(k)) = found.places[k].sampled;
    py::dict result;
    const py::ssize_t all = length(verdicts.size()), folded = length(cells.size());
    result["verdicts"] = owned(std::move(verdicts), {all});
    result["open"] = owned(std::move(found.open), {all});
    result["cells"] = owned(std::move(cells), {folded});
    result["parameters"] = owned(std::move(parameters));
    result["positions"] = owned(std::move(positions));
    result["determinants"] = owned(std::move(determinants), {folded});
    result["sampled"] = std::move(sampled);
    result["times"] = owned(std::move(times), {folded});
    result["tests"] = found.report.tests;
    result["places"] = found.report.sampled.places;
    result["least"] = found.report.sampled.least;
    return result;
}

py::dict check_folds_of(const HexMesh& mesh, const py::object& progress, const py::kwargs& keywords) {
    FoldOptions options;
    set_options(keywords_of(options), keywords);
    return dict_of(result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return check_folds(mesh, options);
    }));
}

py::dict check_folds_between_of(const HexMesh& before, const HexMesh& after, const py::object& progress,
                                const py::kwargs& keywords) {
    FoldMotionOptions options;
    set_options(keywords_of(options), keywords);
    return dict_of(result_of(progress, [&](Progress* listener) {
        options.folds.progress = listener;
        return check_folds_between(before, after, options);
    }));
}

py::tuple mend_folds_of(const HexMesh& mesh, const py::object& progress, const py::kwargs& keywords) {
    MendOptions options;
    set_options(keywords_of(options), keywords);
    Mended mended = result_of(progress, [&](Progress* listener) {
        options.folds.progress = listener;
        return mend_folds(mesh, options);
    });
    return py::make_tuple(std::move(mended.mesh), dict_of(std::move(mended.check)), dict_of(facts_of(mended.report)));
}

/// points: places, or a mesh, whose points are the places and whose cells go along
HexMesh samples_of(const py::object& points, const py::object& given) {
    HexMesh samples;
    if (py::isinstance<HexMesh>(points)) {
        const auto& mesh = points.cast<const HexMesh&>();
        samples.points = mesh.points;
        samples.cells = mesh.cells;
        samples.creases = mesh.creases;
        samples.sharp_faces = mesh.sharp_faces;
    } else {
        samples.points = vectors(points, "samples");
    }
    for_each_named(given, "fields", [&](const std::string& name, const py::handle& values) {
        samples.attributes.push_back(attribute_of(name, values, samples.points.size()));
    });
    return samples;
}

py::tuple approximate_of(const HexMesh& onto, const py::object& points, const py::object& given, const py::object& progress,
                         const py::kwargs& keywords) {
    ApproximateOptions options;
    set_options(keywords_of(options), keywords);
    const HexMesh samples = samples_of(points, given);
    Approximation made = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return approximate(onto, samples, options);
    });
    return py::make_tuple(std::move(made.mesh), dict_of(facts_of(made.report)));
}

py::tuple map_fields_of(const HexMesh& onto, const HexMesh& data, const py::object& progress) {
    MappedFields mapped = result_of(progress, [&](Progress* listener) { return map_fields(onto, data, listener); });
    return py::make_tuple(std::move(mapped.mesh), dict_of(facts_of(mapped.report)));
}

/// An Approximator keeps what it found for the next step, so that its steps come one after the other: a second thread, or a
/// call from within its own progress, is refused.
class StepFitter {
public:
    StepFitter(const HexMesh& onto, const py::kwargs& keywords)
        : approximator_([&] {
              ApproximateOptions options;
              set_options(series_keywords_of(options), keywords);
              return Approximator(onto, options);
          }()) {}

    [[nodiscard]] py::tuple fit(const py::object& points, const py::object& given, const py::object& progress) {
        const HexMesh samples = samples_of(points, given);
        if (std::exchange(busy_, true)) {  // under the GIL
            throw Error(ErrorCode::InvalidInput, "is fitting a step already", "Approximator", "one step after the other");
        }
        Approximation made = [&] {
            const Done done{busy_};
            return result_of(progress, [&](Progress* listener) { return approximator_.fit(samples, listener); });
        }();
        py::dict report = dict_of(facts_of(made.report));
        report["placements"] = approximator_.placements();
        return py::make_tuple(std::move(made.mesh), report);
    }

private:
    struct Done {
        bool& busy;
        ~Done() { busy = false; }
    };

    Approximator approximator_;
    bool busy_ = false;
};

Surface surface_of(const py::object& points, const py::object& triangles) {
    Surface surface;
    surface.points = vectors(points, "points");
    surface.triangles = index_rows<3>(triangles, surface.points.size(), "triangles");
    return surface;
}

py::tuple fit_shape_of(const HexMesh& mesh, const py::object& points, const py::object& triangles, const py::object& progress,
                       const py::kwargs& keywords) {
    FitShapeOptions options;
    set_options(keywords_of(options), keywords);
    const Surface surface = surface_of(points, triangles);
    ShapedMesh made = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return fit_shape(mesh, surface, options);
    });
    return py::make_tuple(std::move(made.mesh), dict_of(facts_of(made.report)));
}

py::tuple control_mesh(const std::vector<std::tuple<std::string, py::object, py::object>>& surfaces, const py::object& progress,
                       const py::kwargs& keywords) {
    GivenControlMesh given;
    set_options(keywords_of(given), keywords);
    for (const Option& option : options_of(given.labels)) {
        if (keywords.contains(option.key())) {
            throw Error(ErrorCode::InvalidInput, "has no effect on surfaces", option.key(), "an array of labels");
        }
    }
    std::vector<MaterialSurface> materials;
    for (const auto& [name, points, triangles] : surfaces) materials.push_back({name, surface_of(points, triangles)});
    ControlMesh made = result_of(progress, [&](Progress* listener) {
        given.mesh.progress = listener;
        return control_mesh_of(materials, given.mesh);
    });
    return py::make_tuple(with_sets(std::move(made.mesh), std::move(made.sets)), dict_of(facts_of(made.report)));
}

template <class Number>
using Packed = py::array_t<Number, py::array::c_style | py::array::forcecast>;

/// all: labels (nx, ny, nz), the last axis fastest; rows: (4, 4), from their indices to the world; both are checked
py::tuple control_mesh_of_labels(const Packed<std::int64_t>& all, const Packed<double>& rows, const py::object& progress,
                                 const py::kwargs& keywords) {
    GivenControlMesh given;
    set_options(keywords_of(given), keywords);
    // The grid counts the last axis first.
    Mat3 to_world;
    Vec3 origin;
    for (int k = 0; k < 3; ++k) {
        for (int axis = 0; axis < 3; ++axis) to_world[2 - axis][k] = rows.at(k, axis);
        origin[k] = rows.at(k, 3);
    }
    LabelGrid grid(to_world, origin);
    LabelRows voxels(grid, {static_cast<std::size_t>(all.shape(2)), static_cast<std::size_t>(all.shape(1)),
                            static_cast<std::size_t>(all.shape(0))});
    voxels.take({all.data(), static_cast<std::size_t>(all.size())});
    voxels.finish();
    Facts facts;
    ControlMesh made = result_of(progress, [&](Progress* listener) {
        given.mesh.progress = given.labels.progress = listener;
        LabelSurfaces surfaces = label_surfaces(grid, given.labels);
        facts = facts_of(surfaces.report);
        return control_mesh_of(surfaces.materials, given.mesh);
    });
    facts.merge(facts_of(made.report));
    return py::make_tuple(with_sets(std::move(made.mesh), std::move(made.sets)), dict_of(facts));
}

py::tuple read_triangles(const std::string& path) {
    Surface surface = read_surface(path);
    std::vector<std::int64_t> corners;
    corners.reserve(3 * surface.triangles.size());
    for (const auto& t : surface.triangles) corners.insert(corners.end(), t.begin(), t.end());
    const py::ssize_t count = length(surface.triangles.size());
    return py::make_tuple(owned(std::move(surface.points)), owned(std::move(corners), {count, 3}));
}

void bind_measure(py::module_& module) {
    module.def("approximate", &approximate_of, py::arg("onto"), py::arg("points"), py::arg("fields"), py::arg("progress"));
    describe_call<ApproximateOptions>(module, "approximate");
    module.def("map_fields", &map_fields_of, py::arg("onto"), py::arg("data"), py::arg("progress"));
    py::class_<StepFitter>(module, "Approximator")
        .def(py::init<const HexMesh&, const py::kwargs&>(), py::arg("onto"))
        .def("fit", &StepFitter::fit, py::arg("points"), py::arg("fields"), py::arg("progress"));
    ApproximateOptions of_series;
    describe(module, "approximate_series", series_keywords_of(of_series));
    module.def("fit_shape", &fit_shape_of, py::arg("mesh"), py::arg("points"), py::arg("triangles"), py::arg("progress"));
    describe_call<FitShapeOptions>(module, "fit_shape");
    module.def("control_mesh", &control_mesh, py::arg("surfaces"), py::arg("progress"));
    module.def("control_mesh_of_labels", &control_mesh_of_labels, py::arg("labels"), py::arg("transform"), py::arg("progress"));
    describe_call<GivenControlMesh>(module, "control_mesh");
    module.def("read_surface", &read_triangles, py::arg("path"));
    module.def("check_folds", &check_folds_of, py::arg("mesh"), py::arg("progress"));
    describe_call<FoldOptions>(module, "check_folds");
    module.def("check_folds_between", &check_folds_between_of, py::arg("before"), py::arg("after"), py::arg("progress"));
    describe_call<FoldMotionOptions>(module, "check_folds_between");
    module.def("mend_folds", &mend_folds_of, py::arg("mesh"), py::arg("progress"));
    describe_call<MendOptions>(module, "mend_folds");
    module.def("probe", &probe, py::arg("mesh"), py::arg("places"), py::arg("levels"), py::arg("progress"));
    module.def("points_error", &error_of_points, py::arg("volume"), py::arg("mesh"), py::arg("field"), py::arg("channel"),
               py::arg("progress"));
    module.def("measure", &measure, py::arg("mesh"), py::arg("only"), py::arg("progress"));
    module.def("measure_patches", &measure_patches_of, py::arg("mesh"), py::arg("names"), py::arg("flux"), py::arg("progress"));
    module.def("slice", &slice, py::arg("mesh"), py::arg("field"), py::arg("point"), py::arg("normal"), py::arg("progress"));
    module.def("surface", &surface, py::arg("mesh"), py::arg("field"), py::arg("isos"), py::arg("path"), py::arg("origin"),
               py::arg("progress"));
    module.def("streamlines", &streamlines, py::arg("mesh"), py::arg("vector"), py::arg("seeds"), py::arg("path"),
               py::arg("progress"));
    describe_call<GivenStreamlines>(module, "streamlines");
    GivenProbe given;
    describe(module, "probe", options_of(given));
    describe_call<PointsErrorOptions>(module, "points_error");
    describe_call<MeasureOptions>(module, "measure");
    describe_call<SliceOptions>(module, "slice");
    describe_call<SurfaceOptions>(module, "surface", {"iso"});
}

}  // namespace subvol::python
