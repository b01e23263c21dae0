// SPDX-License-Identifier: Apache-2.0
// Pictures in Python. The keywords of a call become the options of the command, so that the same rules refuse values and
// combinations. A body is one mesh, one volume of points or one grid of voxels; what is drawn besides lies in the mesh.
//
//     1. streamlines and arrows ─► opaque surfaces, at which the rays of the volume end
//     2. the volume by the chosen method; an empty picture if all of the mesh is translucent parts
//     3. the surfaces of 1 into the picture, by depth
//     4. translucent parts of the solid, each with its opacity
//
// Patches of a mesh are drawn alone, without the steps above. Facts of all steps make the report, in which the seconds of
// stages are summed up. A body keeps the Python objects alive that it refers to.
#include <algorithm>
#include <iterator>
#include <limits>

#include "bind.h"
#include "picture.h"
#include "subvol/boundary_values.h"
#include "subvol/flow_surface.h"
#include "subvol/gl_device.h"
#include "subvol/option.h"
#include "subvol/part_of_limit.h"
#include "subvol/part_opacity.h"
#include "subvol/picture_maker.h"
#include "subvol/shell_scene.h"
#include "subvol/view_options.h"
#include "subvol/voxels.h"

namespace subvol::python {
namespace {

/// What the keywords of render() choose; light and camera have been made of theirs.
struct GivenPicture : PictureSettings {
    LookChoices look{};
    ViewOptions eye{};
    FlowChoices flow{};
};

/// Python has sizes as pairs, and turntables as lists of cameras.
bool of_one_picture(const std::string& option) {
    return option != "size" && option != "turntable";
}

std::vector<Option> options_of(GivenPicture& given) {
    std::vector<Option> all = options_of(static_cast<PictureSettings&>(given));
    all.front() = scheme_and(given.refinement.scheme).front();
    const auto uses = option_uses();
    std::erase_if(all, [&](const Option& option) {
        const auto use = std::ranges::find(uses, option.name, &OptionUse::name);
        return use == uses.end() || use->keyword.empty();
    });
    std::ranges::move(options_of(given.look), std::back_inserter(all));
    std::ranges::copy_if(options_of(given.eye), std::back_inserter(all), &of_one_picture, &Option::name);
    std::ranges::move(options_of(given.flow), std::back_inserter(all));
    return all;
}

MethodOptions method_options(Method method, const PictureLight& light, const py::dict& keywords) {
    GivenPicture given;
    set_options(options_of(given), keywords);
    MethodOptions options = given.chosen();
    options.style.method = method;
    options.style.look = light.options;
    return options;
}

/// What was given for an option of the command, by its keyword.
std::optional<std::string> text_of(const py::dict& given, std::string_view name) {
    const auto uses = option_uses();
    const auto use = std::ranges::find(uses, name, &OptionUse::name);
    const std::string keyword(use->keyword);
    if (keyword.empty() || !given.contains(keyword.c_str())) return std::nullopt;
    return std::string(py::str(given[keyword.c_str()]));
}

/// The facts under the names of the command's JSON; the seconds of all stages together.
py::dict report_of(const Facts& facts) {
    py::dict report = dict_of(facts);
    if (const FactValue* const stages = facts.find("seconds")) {
        double sum = 0;
        for (const Fact& stage : std::get<Facts>(stages->value).all()) sum += std::get<double>(stage.value.value);
        report["seconds"] = sum;
    }
    return report;
}

/// What is drawn, as Python has it: one of them.
///
/// colors:   a mesh whose field gives the colours; null: the one that is shown
/// patches:  shells to which the points of `mesh`, which has no cells, belong; null: a volume is drawn
/// channels: of the points
/// parts:    translucent parts of a solid, of which the mesh is the rest; null: there are none
/// source:   of the mesh, with all of its fields: the whole that patches and parts lie in; null: no streamlines are drawn
/// seeds:    of streamlines, as for `seeds_in`
struct DrawnBody {
    const HexMesh* mesh = nullptr;
    const HexMesh* colors = nullptr;
    const Shells* patches = nullptr;
    const RbfVolume* points = nullptr;
    std::vector<std::size_t> channels{};
    const Voxels* voxels = nullptr;
    const TranslucentParts* parts = nullptr;
    const HexMesh* source = nullptr;
    py::object seeds = py::none();
};

/// What `render` relies on.
DrawnBody checked(DrawnBody body) {
    const auto refuse = [](const char* what, const char* allowed) {
        throw Error(ErrorCode::InvalidInput, what, "DrawnBody", allowed);
    };
    if ((body.mesh != nullptr) + (body.points != nullptr) + (body.voxels != nullptr) != 1) {
        refuse("there is no body, or more than one", "one of mesh, points and voxels");
    }
    const bool of_mesh = body.colors != nullptr || body.patches != nullptr || body.parts != nullptr || body.source != nullptr;
    if (of_mesh && body.mesh == nullptr) refuse("colors, patches, parts and source are of a mesh", "mesh with them");
    if ((body.patches != nullptr || body.parts != nullptr) && body.source == nullptr)
        refuse("patches and parts are sides of a mesh", "source with them");
    if (body.colors != nullptr && body.colors->attributes.empty()) refuse("colors has no field", "a mesh with one");
    for (const std::size_t channel : body.channels) {
        if (body.points != nullptr && channel >= body.points->channels.size()) {
            refuse("there is no such channel", "numbers of channels of the points");
        }
    }
    return body;
}

/// The patches of a mesh, alone. whole: the mesh that they are of
Picture render_patches(const HexMesh& mesh, const Shells& patches, const HexMesh& whole, const View& view,
                       const PictureLight& light, const py::dict& given, const py::object& progress) {
    check_options_of_shells([&](std::string_view name) { return text_of(given, name); }, OptionNames::Keywords);
    GivenPicture chosen;
    set_options(options_of(chosen), given);
    const PictureStyle style{.look = light.options, .samples = chosen.options.style.samples};
    Picture picture{Image(view.width(), view.height())};
    picture.depth.assign(picture.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    run(progress, [&](Progress* listener) {
        RefineOptions refine = chosen.refinement;
        refine.progress = listener;
        make_side_scene(mesh, whole, patches, refine, chosen.levels, light.optics, style.sample_count(),
                        chosen.options.style.clip)
            .draw_into(picture.image, picture.depth, view);
    });
    return picture;
}

/// A picture of nothing, into which surfaces are drawn.
subvol::Picture empty_picture(const View& view) {
    subvol::Picture picture{subvol::Image(view.width(), view.height()), {}};
    picture.depth.assign(picture.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    return picture;
}

/// The field, and the look and opacities of the body, of pictures with streamlines or arrows.
py::tuple flow_defaults(const HexMesh& mesh, const py::dict& given) {
    GivenPicture chosen;
    set_options(options_of(chosen), given);
    if (!chosen.flow.any()) return py::make_tuple(py::none(), py::dict());
    veil_body(chosen.look, chosen.options.style.clip);
    py::dict look;
    if (chosen.look.look) look["look"] = *chosen.look.look;
    if (chosen.look.opacity) look["opacity"] = *chosen.look.opacity;
    return py::make_tuple(chosen.flow.length_of(mesh), look);
}

/// Refuses streamlines and arrows where they are not drawn.
void refuse_flow(const py::dict& given, const std::string& method, bool hexes, bool whole) {
    GivenPicture chosen;
    set_options(options_of(chosen), given);
    check_flow(chosen.flow, named<Method>(method, "method"), hexes ? BodyKind::Mesh : BodyKind::Kernels, whole,
               OptionNames::Keywords);
}

/// The tubes and arrows of a picture; nothing without them.
std::optional<ShellScene> flow_scene(const DrawnBody& drawn, const HexMesh* shown, const PictureLight& light,
                                     const py::dict& keywords, const py::object& progress, Facts& facts) {
    GivenPicture given;
    set_options(options_of(given), keywords);
    if (!given.flow.any()) {
        if (!drawn.seeds.is_none()) throw Error(ErrorCode::InvalidInput, "has no effect without streamlines", "seeds");
        return {};
    }
    const PictureStyle style{.look = light.options, .samples = given.options.style.samples};
    const RefineOptions refine = given.refinement;
    const LimitOptions limit{.scheme = refine.scheme};
    std::vector<Vec3> seeds;
    if (!given.flow.streamlines.empty()) seeds = seeds_in(*shown, drawn.seeds, given.flow.seed_count, limit);
    if (drawn.source == nullptr)
        throw Error(ErrorCode::InvalidInput, "has no mesh of its own", "streamlines", "source with them");
    return result_of(progress, [&](Progress* listener) {
        Flow flow = flow_in(*drawn.source, given.flow, OptionNames::Keywords, listener);
        flow.limit = limit;
        flow.limit.progress = listener;
        flow.seeds = std::move(seeds);
        return make_opaque_scene(*shown, flow_surface(*shown, flow, facts), refine, given.levels, light.optics,
                                 style.sample_count(), given.options.style.clip);
    });
}

Picture render(const DrawnBody& drawn, const std::string& method_name, const View& view, const PictureLight& light,
               const py::dict& given, const py::object& progress) {
    const auto method = named<Method>(method_name, "method");
    HexMesh two_fields;
    PictureBody body{.kernels = drawn.points, .voxels = drawn.voxels, .channels = drawn.channels};
    if (drawn.mesh != nullptr) body.mesh = *drawn.mesh;
    if (drawn.colors != nullptr) {
        two_fields = *drawn.mesh;
        two_fields.attributes.push_back(drawn.colors->attributes.front());
        body.mesh = two_fields;
    }
    if (drawn.patches != nullptr)
        return render_patches(drawn.colors != nullptr ? two_fields : *drawn.mesh, *drawn.patches, *drawn.source, view, light,
                              given, progress);
    check_method(method, body.kind(), OptionNames::Keywords);
    check_options(
        bit(method), body.kind(), [&](std::string_view name) { return text_of(given, name); }, OptionNames::Keywords);
    Facts facts;
    const HexMesh* const shown = drawn.colors != nullptr ? &two_fields : drawn.mesh;
    const auto flow = flow_scene(drawn, shown, light, given, progress, facts);
    const View of_volume = flow ? ended_at(*flow, view) : view;
    const bool empty = drawn.parts != nullptr && drawn.mesh->cells.empty();
    const MethodOptions options = method_options(method, light, given);
    subvol::Picture picture = result_of(progress, [&](Progress* listener) {
        return empty ? empty_picture(view) : PictureMaker(std::move(body), options).draw(of_volume, light.optics, listener);
    });
    if (flow) flow->draw_into(picture.image, picture.depth, view);
    if (drawn.parts != nullptr) {
        GivenPicture chosen;
        set_options(options_of(chosen), given);
        const PictureStyle style{.look = light.options, .samples = chosen.options.style.samples};
        run(progress, [&](Progress* listener) {
            RefineOptions refine = chosen.refinement;
            refine.progress = listener;
            make_side_scene(*drawn.mesh, *drawn.source, drawn.parts->shells, refine, chosen.levels, light.optics,
                            style.sample_count(), chosen.options.style.clip, drawn.parts->opacities)
                .draw_into(picture.image, picture.depth, view);
        });
        picture.facts["opaque_cells"] = drawn.parts->rest.cells.size();
    }
    picture.facts.merge(facts);
    picture.facts["camera"] = facts_of(view.camera());
    return {std::move(picture.image), std::move(picture.depth), report_of(picture.facts), camera_text(view.camera())};
}

/// The boundary of a body that is lit, and the limit's values on it, as the command has them.
BoundaryValues skin(const HexMesh& mesh, const std::string& scheme, double tension, const std::optional<double>& crease_angle,
                    const std::optional<int>& levels) {
    const py::gil_scoped_release without_gil;
    return boundary_values(mesh, refine_options(scheme, picture_levels(mesh, levels), tension, crease_angle));
}

/// ends: (height, width) eye depths at which rays end; None: no ray ends
View view_of(const Camera& camera, const std::pair<int, int>& size, const py::object& ends) {
    View view(camera, size.first, size.second);
    if (ends.is_none()) return view;
    const py::array_t<float> rows = rows_of<float>(ends, view.width(), "ray_ends");
    view.end_rays({rows.data(), rows.data() + rows.size()});
    return view;
}

py::list devices() {
    const std::vector<GlDevice> found = [] {
        const py::gil_scoped_release without_gil;
        return gl_devices();
    }();
    py::list list;
    for (const GlDevice& device : found) {
        py::dict one;
        one["renderer"] = device.renderer;
        one["hardware"] = device.hardware;
        one["version"] = device.version;
        list.append(one);
    }
    return list;
}

}  // namespace

void bind_render(py::module_& module) {
    py::class_<Voxels>(module, "Voxels", "The voxels of a grid, for the renderer.");
    py::class_<BoundaryValues>(module, "BoundaryValues", "A boundary with the limit's values on it.");
    py::class_<DrawnBody>(module, "DrawnBody", "What render() draws.")
        .def(py::init([](const HexMesh* mesh, const HexMesh* colors, const Shells* patches, const RbfVolume* points,
                         const std::vector<std::size_t>& channels, const Voxels* voxels, const TranslucentParts* parts,
                         const HexMesh* source, const py::object& seeds) {
                 return checked({mesh, colors, patches, points, channels, voxels, parts, source, seeds});
             }),
             py::arg("mesh").none(true) = py::none(), py::arg("colors").none(true) = py::none(),
             py::arg("patches").none(true) = py::none(), py::arg("points").none(true) = py::none(),
             py::arg("channels") = std::vector<std::size_t>{}, py::arg("voxels").none(true) = py::none(),
             py::arg("parts").none(true) = py::none(), py::arg("source").none(true) = py::none(), py::arg("seeds") = py::none(),
             py::keep_alive<1, 2>(), py::keep_alive<1, 3>(), py::keep_alive<1, 4>(), py::keep_alive<1, 5>(),
             py::keep_alive<1, 7>(), py::keep_alive<1, 8>(), py::keep_alive<1, 9>());
    py::class_<Shells>(module, "Patches", "Patches of a mesh as faces, each patch with its own points.")
        .def_property_readonly(
            "mesh",
            [](const Shells& shells) {
                HexMesh points;
                points.points = shells.points;
                points.attributes = shells.attributes;
                return points;
            },
            "The points, without cells, with the fields and, last, \"patch\": the number of each.");
    py::class_<TranslucentParts>(module, "TranslucentParts", "Parts of a solid with opacities of their own, and the rest.")
        .def_property_readonly("rest", [](const TranslucentParts& parts) { return parts.rest; })
        .def_property_readonly("points", [](const TranslucentParts& parts) { return read_only(owned(parts.shells.points)); })
        .def_property_readonly("values", [](const TranslucentParts& parts) {
            const std::vector<double>& values = parts.shells.attributes.front().values;
            return read_only(owned(values, {length(values.size())}));
        });
    module.def(
        "only_points",
        [](const py::object& points) {
            HexMesh mesh;
            mesh.points = vectors(points, "points");
            return mesh;
        },
        py::arg("points"));
    module.def(
        "translucent_parts",
        [](const HexMesh& mesh, const py::object& source, const std::vector<std::string>& texts, const py::dict& given) {
            GivenPicture chosen;
            set_options(options_of(chosen), given);
            try {
                std::vector<PartOpacity> asked;
                for (const std::string& text : texts) asked.push_back(parse_part_opacity(text));
                TranslucentParts parts = translucent_parts(mesh, asked, sets_of(source));
                std::string warning;
                if (!parts.rest.cells.empty()) {
                    PartOptions wanted{.scheme = chosen.refinement.scheme};
                    if (chosen.levels) wanted.max_levels = 0;  // those of the cells as they were given
                    PartOfLimit rest = part_of_limit(mesh, parts.cells, wanted);
                    warning = detail::part_warning(rest, OptionNames::Keywords);
                    parts.rest = std::move(rest.mesh);
                }
                return py::make_tuple(std::move(parts), warning);
            } catch (const Error& error) {
                throw Error(error.code(), (error.where().empty() ? "" : error.where() + ": ") + error.message(), "part_opacity",
                            error.allowed());
            }
        },
        py::arg("mesh"), py::arg("source"), py::arg("texts"), py::arg("given") = py::dict(),
        "The parts and the rest, which lies as in the whole, and a warning if it does not.");
    module.def(
        "choose_patches",
        [](const HexMesh& mesh, const std::vector<std::string>& names) {
            return patch_shells(mesh, chosen_patches(mesh, sets_of(mesh), names));
        },
        py::arg("mesh"), py::arg("names"));
    module.def(
        "render",
        [](const DrawnBody& body, const std::string& method, const Camera& camera, const std::pair<int, int>& size,
           const py::object& ray_ends, const PictureLight& light, const py::dict& given, const py::object& progress) {
            return render(body, method, view_of(camera, size, ray_ends), light, given, progress);
        },
        py::arg("body"), py::arg("method"), py::arg("camera"), py::arg("size"), py::arg("ray_ends"), py::arg("light"),
        py::arg("given"), py::arg("progress"));
    module.def("skin", &skin, py::arg("mesh"), py::arg("scheme"), py::arg("tension"), py::arg("crease_angle"),
               py::arg("levels"));
    module.def(
        "draws_kernels", [](const std::string& method) { return draws_kernels(named<Method>(method, "method")); },
        py::arg("method"));
    module.def("check_flow", &refuse_flow, py::arg("given"), py::arg("method"), py::arg("hexes"), py::arg("whole"));
    module.def("flow_defaults", &flow_defaults, py::arg("mesh"), py::arg("given"));
    module.def("gl_devices", &devices);
    GivenPicture given;
    describe(module, "render", options_of(given));
}

}  // namespace subvol::python
