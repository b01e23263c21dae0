# SPDX-License-Identifier: Apache-2.0
"""Blender add-on: File › Import › Hexahedral mesh. The command `subvol` turns the mesh into OpenVDB grids, which become a volume
object with a material that emits and absorbs light as `subvol render` does. For Blender 3.4 and later; docs/blender.md."""

import hashlib
import json
import math
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

bl_info = {
    "name": "Hexahedral meshes as volumes (OpenSubVol)",
    "author": "OpenSubVol",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import > Hexahedral mesh",
    "description": "Limits of hexahedral meshes as volumes, with their transfer function",
    "category": "Import-Export",
}

MESHES = "*.mesh;*.vtk;*.vtu;*.pvd;*.vtm;*.vth;*.vthb;*.vtkhdf;*.hdf;*.inp;*.msh;*.exo;*.e;*.xdmf;*.xmf;*.cgns;*.case;*.frd;*.off"
MOST_STOPS = 32  # of Blender's ColorRamp
VIRIDIS = [(0, .267, .005, .329), (.125, .278, .176, .482), (.25, .231, .322, .545), (.375, .173, .443, .557), (.5, .129, .565, .553),
           (.625, .153, .678, .506), (.75, .361, .784, .388), (.875, .667, .863, .196), (1, .993, .906, .144)]


class SubvolError(Exception):
    """What `subvol` says, or that it is not there."""


def find_command(given=""):
    """The command: as given, of the preferences, of SUBVOL_COMMAND, or in the path."""
    addon = bpy.context.preferences.addons.get(__name__)
    wanted = given or (addon.preferences.command if addon else "") or os.environ.get("SUBVOL_COMMAND", "") or "subvol"
    found = shutil.which(wanted)
    if not found:
        raise SubvolError(f"there is no program {wanted}: its place is in the add-on's preferences")
    return found


def run_subvol(command, *arguments):
    done = subprocess.run([command, *map(str, arguments), "--json"], capture_output=True, text=True)
    if done.returncode != 0:
        raise SubvolError((done.stderr.strip().splitlines() or ["subvol failed"])[-1])
    return json.loads(done.stdout)


def linear(s):
    return s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4


def read_transfer_function(path, low, high):
    """ParaView's JSON, or viridis over the range with opacities from 0 to .5: colours [(value, r, g, b)] in linear light, opacities
    [(value, alpha)], and whether the values are those of the file."""
    if not path:
        colors = [(low + t * (high - low), linear(r), linear(g), linear(b)) for t, r, g, b in VIRIDIS]
        return colors, [(low, 0.0), (high, 0.5)]
    try:
        maps = json.loads(Path(bpy.path.abspath(path)).read_text())
        one = maps[0] if isinstance(maps, list) else maps
        points = one["RGBPoints"]
        colors = [(points[i], *(linear(c) for c in points[i + 1:i + 4])) for i in range(0, len(points), 4)]
        alphas = one.get("Points") or [colors[0][0], 0, .5, 0, colors[-1][0], .5, .5, 0]
        return colors, [(alphas[i], alphas[i + 1]) for i in range(0, len(alphas), 4)]
    except (OSError, ValueError, KeyError, IndexError, TypeError) as error:
        raise SubvolError(f"{path}: is not a colour map of ParaView: {error}") from error


def between(knots, v):
    """The value of a piecewise linear function."""
    if v <= knots[0][0]:
        return knots[0][1:]
    for a, b in zip(knots, knots[1:]):
        if v < b[0]:
            t = (v - a[0]) / (b[0] - a[0])
            return tuple(x + t * (y - x) for x, y in zip(a[1:], b[1:]))
    return knots[-1][1:]


def fill_ramp(ramp, knots, low, high):
    """The stops of a ColorRamp: the knots, or as many places between them as it can have."""
    places = sorted({min(1.0, max(0.0, (knot[0] - low) / (high - low))) for knot in knots} | {0.0, 1.0})
    if len(places) > MOST_STOPS:
        places = [i / (MOST_STOPS - 1) for i in range(MOST_STOPS)]
    while len(ramp.elements) > 1:
        ramp.elements.remove(ramp.elements[-1])
    for i, place in enumerate(places):
        stop = ramp.elements[0] if i == 0 else ramp.elements.new(place)
        stop.position = place
        value = between(knots, low + place * (high - low))
        stop.color = (*value, 1.0) if len(value) == 3 else (value[0],) * 3 + (1.0,)


def range_that_can_be_divided(low, high):
    """The range of a field as `subvol render` spreads colours over it: one of a constant is widened, with the constant in the
    middle. Blender computes with 32 bits, so that is done where these cannot tell the ends apart."""
    magnitude = max(abs(low), abs(high))
    if high - low > 1e-5 * magnitude:
        return low, high
    half = max(0.5, 1e-3 * magnitude)
    return (low + high) / 2 - half, (low + high) / 2 + half


def make_material(name, grid, low, high, transfer_function="", unit=1.0, density_scale=1.0):
    """Emission and absorption of the transfer function: opacities are for a path of the length `unit`."""
    colors, opacities = read_transfer_function(transfer_function, *range_that_can_be_divided(low, high))
    low, high = range_that_can_be_divided(min(colors[0][0], opacities[0][0]), max(colors[-1][0], opacities[-1][0]))
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()

    def node(kind, x, y, label=""):
        made = nodes.new(kind)
        made.location = (x, y)
        made.label = label
        return made

    def math_node(operation, x, y, *values, label=""):
        made = node("ShaderNodeMath", x, y, label)
        made.operation = operation
        for slot, value in zip(made.inputs, values):
            if hasattr(value, "is_output"):
                links.new(value, slot)
            else:
                slot.default_value = value
        return made.outputs[0]

    field = node("ShaderNodeAttribute", -1100, 0, grid)
    field.attribute_name = grid
    place = node("ShaderNodeMapRange", -900, 0, "range")
    place.inputs["From Min"].default_value = low
    place.inputs["From Max"].default_value = high
    links.new(field.outputs["Fac"], place.inputs["Value"])
    color, opacity = node("ShaderNodeValToRGB", -700, 150, "colours"), node("ShaderNodeValToRGB", -700, -150, "opacities")
    for ramp, knots in ((color, colors), (opacity, opacities)):
        fill_ramp(ramp.color_ramp, knots, low, high)
        links.new(place.outputs["Result"], ramp.inputs["Fac"])
    # extinction = -ln(1 - opacity) / unit
    left = math_node("SUBTRACT", -400, -150, 1.0, math_node("MINIMUM", -560, -350, opacity.outputs["Color"], 1 - 1e-6))
    depth = math_node("LOGARITHM", -240, -150, left, math.e)
    extinction = math_node("MULTIPLY", -80, -150, depth, -density_scale / unit, label="density scale")
    # Outside the volume there is nothing, but grids are 0 there, which may be a visible value.
    inside = node("ShaderNodeAttribute", -80, -350, "coverage")
    inside.attribute_name = "coverage"
    extinction = math_node("MULTIPLY", 60, -250, extinction, inside.outputs["Fac"])
    absorb, emit = node("ShaderNodeVolumeAbsorption", 120, -150), node("ShaderNodeEmission", 120, 100)
    absorb.inputs["Color"].default_value = (0, 0, 0, 1)
    links.new(extinction, absorb.inputs["Density"])
    links.new(color.outputs["Color"], emit.inputs["Color"])
    links.new(extinction, emit.inputs["Strength"])
    both, output = node("ShaderNodeAddShader", 320, 0), node("ShaderNodeOutputMaterial", 500, 0)
    links.new(emit.outputs[0], both.inputs[0])
    links.new(absorb.outputs[0], both.inputs[1])
    links.new(both.outputs[0], output.inputs["Volume"])
    return material


def source_of(path):
    """What a mesh is known by: the whole path of its file, however it was given, or "model:NAME"."""
    return path if path.startswith("model:") else os.path.realpath(bpy.path.abspath(path))


def folder_for_grids(given):
    """The folder, and whether Blender deletes it when it ends."""
    if given:
        return Path(bpy.path.abspath(given)), False
    if bpy.data.filepath:
        return Path(bpy.data.filepath).parent / "volumes", False
    return Path(bpy.app.tempdir or tempfile.gettempdir()), True


def import_mesh(path, *, fields="", resolution=200, steps="", velocity=False, transfer_function="", scale=1.0, up="Z",
                density_scale=1.0, folder="", command="", arguments=(), warn=print):
    """Imports a mesh file, or "model:NAME", and returns the object. A second import of the same file replaces the grids of its
    object, and keeps its material and its place. Each mesh has a folder of its own for its grids: files of one name in two places
    are two meshes.

    steps:     of a series: "all", "N" or "A-B"; they become the frames of a sequence
    velocity:  also a grid of velocities, for motion blur
    up:        the axis that is up in the file
    arguments: more options of `subvol vdb`
    warn:      gets a sentence if the grids will not be there when Blender is started again"""
    command = find_command(command)
    name = re.sub(r"[^\w.-]+", "_", path.split(":", 1)[1] if path.startswith("model:") else Path(path).stem)
    source = source_of(path)
    of_all, passing = folder_for_grids(folder)
    to = of_all / f"{name}-{hashlib.sha256(os.fsencode(source)).hexdigest()[:8]}"
    to.mkdir(parents=True, exist_ok=True)
    sequence = steps == "all" or "-" in steps
    output = to / (f"{name}_####.vdb" if sequence else f"{name}.vdb")
    options = ["--resolution", resolution, "--coverage"]
    if fields:
        options += ["--fields", fields]
    if steps:
        options += ["--step", steps]
    if velocity:
        options += ["--velocity"]
    made = run_subvol(command, "vdb", path, "-o", output, *options, *arguments)
    frames = made.get("frames") or [{"frame": None, "output": str(output), "grids": made["grids"]}]

    known = [o for o in bpy.data.objects if o.type == "VOLUME" and source_of(o.get("subvol_source", "model:")) == source]
    obj = known[0] if known else None
    if obj is None:
        volume = bpy.data.volumes.new(name)
        obj = bpy.data.objects.new(name, volume)
        bpy.context.collection.objects.link(obj)
        obj.scale = (scale,) * 3
        obj.rotation_euler = (math.radians(90) if up == "Y" else 0, 0, 0)
        obj["subvol_source"] = source
    volume = obj.data
    volume.filepath = frames[0]["output"]
    volume.is_sequence = sequence
    if sequence:  # files are numbered from the first step; the first one is shown in frame 1
        volume.frame_start = 1
        volume.frame_duration = len(frames)
        volume.frame_offset = frames[0]["frame"] - 1
        volume.sequence_mode = "EXTEND"
        bpy.context.scene.frame_end = max(bpy.context.scene.frame_end, len(frames)) if known else len(frames)
    if velocity:
        volume.grids.load()  # Blender looks for the name
        volume.velocity_grid = "vel"
        volume.velocity_unit = "SECOND"  # of steps: world units for each unit of time
    obj["subvol_grids"] = json.dumps(frames[-1]["grids"])

    scalars = [grid["name"] for grid in frames[0]["grids"] if grid["kind"] == "float" and grid["name"] != "coverage"]
    if scalars and not volume.materials:
        grids = [grid for frame in frames for grid in frame["grids"] if grid["name"] == scalars[0]]
        low, high = min(grid["min"] for grid in grids), max(grid["max"] for grid in grids)
        info = run_subvol(command, "info", path)["bounds"] if not arguments else [[0, 0, 0], [1, 1, 1]]
        diagonal = math.dist(*info)
        volume.materials.append(make_material(name, scalars[0], low, high, transfer_function, diagonal / 100, density_scale))
    if passing:
        warn(f"The grids of {name} are in {to}, which Blender deletes when it ends: save the .blend, then import the mesh again")
    return obj


class ImportHexahedralMesh(bpy.types.Operator, ImportHelper):
    """Import the limit of a hexahedral mesh as a volume"""

    bl_idname = "import_scene.subvol"
    bl_label = "Hexahedral mesh"
    bl_options = {"UNDO"}
    filename_ext = ""
    filter_glob: StringProperty(default=MESHES, options={"HIDDEN"})
    fields: StringProperty(name="Fields", description="Fields to import, separated by commas; the first is drawn. Empty: the first one")
    resolution: IntProperty(name="Resolution", description="Voxels along the longest side", default=200, min=8, max=4096)
    steps: StringProperty(name="Steps", description="Of a series: all, N or A-B. Empty: the last one")
    velocity: BoolProperty(name="Velocity", description="A grid of velocities, for motion blur; needs steps")
    transfer_function: StringProperty(name="Colour map", description="ParaView's .json", subtype="FILE_PATH")
    density_scale: FloatProperty(name="Density scale", default=1.0, min=1e-6)
    scale: FloatProperty(name="Scale", default=1.0, min=1e-9)
    up: EnumProperty(name="Up in the file", items=[("Z", "z", ""), ("Y", "y", "")], default="Z")

    def execute(self, context):
        try:
            obj = import_mesh(self.filepath, fields=self.fields, resolution=self.resolution, steps=self.steps, velocity=self.velocity,
                              transfer_function=self.transfer_function, scale=self.scale, up=self.up,
                              density_scale=self.density_scale, warn=lambda text: self.report({"WARNING"}, text))
        except SubvolError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for other in context.selected_objects:
            other.select_set(False)
        obj.select_set(True)
        context.view_layer.objects.active = obj
        return {"FINISHED"}


class SubvolPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    command: StringProperty(name="The program subvol", subtype="FILE_PATH", default="")

    def draw(self, _context):
        self.layout.prop(self, "command")


def add_to_menu(menu, _context):
    menu.layout.operator(ImportHexahedralMesh.bl_idname, text="Hexahedral mesh (.vtu, .mesh, .exo, …)")


def register():
    for kind in (ImportHexahedralMesh, SubvolPreferences):
        bpy.utils.register_class(kind)
    bpy.types.TOPBAR_MT_file_import.append(add_to_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(add_to_menu)
    for kind in (SubvolPreferences, ImportHexahedralMesh):
        bpy.utils.unregister_class(kind)
