# SPDX-License-Identifier: Apache-2.0
"""Imports a grid of a .vdb file into Blender, checks its position, and renders one frame.

  blender -b --factory-startup --python blender_import.py -- FILE.vdb -o PICTURE.exr --grid NAME \\
      --camera ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy --range MIN,MAX --opacity-unit D [--bounds x,y,z,x,y,z] [--size WxH] \\
      [--velocity NAME [--velocity-unit SECOND|FRAME] [--fps F] [--shutter FRAMES]]

The picture is linear and should be that of

  subvol render FILE.vdb -o OURS.exr --method grid --field NAME --tf grey --tf-range MIN,MAX --opacity 0%:0,100%:.5 \\
      --opacity-unit D --camera ... --size WxH

as far as Cycles' random steps and its 0 outside the volume allow. --bounds: of the active voxels' centres, as `subvol info`
prints them. Exit status: 0, or 1 with a sentence. Run with Blender 3.4.1 of Debian 12 (apt install --no-install-recommends
blender), on the CPU.
"""
import argparse
import json
import math
import sys

import bpy
from mathutils import Matrix, Vector


def numbers(text):
    return [float(word) for word in text.split(",")]


def arguments():
    parser = argparse.ArgumentParser(prog="blender_import.py")
    parser.add_argument("file")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--grid", required=True)
    parser.add_argument("--camera", type=numbers, required=True)
    parser.add_argument("--range", type=numbers, required=True)
    parser.add_argument("--opacity-unit", type=float, required=True)
    parser.add_argument("--bounds", type=numbers)
    parser.add_argument("--size", default="320x320")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--velocity", help="the grid of velocities: blur what moves")
    parser.add_argument("--velocity-unit", choices=["SECOND", "FRAME"], default="SECOND")
    parser.add_argument("--fps", type=int, default=24)
    parser.add_argument("--shutter", type=float, default=0.5, help="how long it is open, in frames")
    parser.add_argument("--step-rate", type=float, default=0.5, help="a step in voxels")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def import_volume(path):
    """Calls the operator of the menu Add > Volume > Import OpenVDB."""
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    bpy.ops.object.volume_import(filepath=path, align="WORLD", location=(0, 0, 0))
    volume = bpy.context.active_object
    if not volume.data.grids.load():
        raise SystemExit(f"{path}: {volume.data.grids.error_message}")
    return volume


def described(volume):
    corners = [volume.matrix_world @ Vector(corner) for corner in volume.bound_box]
    return {
        "object_matrix": [list(row) for row in volume.matrix_world],
        "box": [[min(c[k] for c in corners) for k in range(3)], [max(c[k] for c in corners) for k in range(3)]],
        "grids": [{"name": g.name, "type": g.data_type, "channels": g.channels, "matrix": [list(row) for row in g.matrix_object]}
                  for g in volume.data.grids],
    }


def check(about, name, bounds):
    """Checks that the grid exists, its voxels are cubes, and the object's box is that of its leaves of 8³ voxels."""
    found = [grid for grid in about["grids"] if grid["name"] == name]
    if not found:
        raise SystemExit(f"no grid {name}: {[grid['name'] for grid in about['grids']]}")
    matrix = found[0]["matrix"]
    sides = [math.hypot(*(matrix[row][column] for row in range(3))) for column in range(3)]
    if max(sides) - min(sides) > 1e-6 * max(sides):
        raise SystemExit(f"voxels are not cubes: {sides}")
    if bounds is None:
        return
    inverse = Matrix(matrix).inverted()
    lower = [8 * (round(i) // 8) for i in inverse @ Vector(bounds[:3])]
    upper = [8 * (round(i) // 8) + 7 for i in inverse @ Vector(bounds[3:])]
    found = [list(inverse @ Vector(corner)) for corner in about["box"]]
    if max(abs(a - b) for a, b in zip(found[0] + found[1], lower + upper)) > 1e-3:
        raise SystemExit(f"the box is {about['box']}, voxels {found}; expected voxels {lower} to {upper}")


def add_camera(camera):
    eye, target, up = Vector(camera[0:3]), Vector(camera[3:6]), Vector(camera[6:9])
    backward = (eye - target).normalized()  # Blender's cameras look along -z
    right = up.cross(backward).normalized()
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(camera[9])
    data.clip_start, data.clip_end = 1e-3 * (eye - target).length, 1e3 * (eye - target).length
    shown = bpy.data.objects.new("camera", data)
    rotation = Matrix((right, backward.cross(right), backward)).transposed()
    shown.matrix_world = Matrix.Translation(eye) @ rotation.to_4x4()
    bpy.context.collection.objects.link(shown)
    bpy.context.scene.camera = shown


def add_material(volume, name, value_range, opacity_unit):
    """Extinction t = -ln(1 - a)/D with a from 0 to 1/2 over the range, and light t times a grey from 0 to 1 in sRGB."""
    material = bpy.data.materials.new("volume")
    material.use_nodes = True
    material.cycles.homogeneous_volume = False
    tree = material.node_tree
    tree.nodes.clear()

    def node(kind, **inputs):
        made = tree.nodes.new(kind)
        for key, value in inputs.items():
            made.inputs[key].default_value = value
        return made

    def math_node(operation, left, right):
        made = tree.nodes.new("ShaderNodeMath")
        made.operation = operation
        for socket, value in zip(made.inputs, (left, right)):
            if isinstance(value, float):
                socket.default_value = value
            else:
                tree.links.new(value, socket)
        return made.outputs[0]

    attribute = tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = name
    share = node("ShaderNodeMapRange", **{"From Min": value_range[0], "From Max": value_range[1]})
    tree.links.new(attribute.outputs["Fac"], share.inputs["Value"])
    clear = math_node("SUBTRACT", 1.0, math_node("MULTIPLY", share.outputs[0], 0.5))
    extinction = math_node("DIVIDE", math_node("LOGARITHM", clear, math.e), -opacity_unit)
    absorb = node("ShaderNodeVolumeAbsorption", Color=(0, 0, 0, 1))
    tree.links.new(extinction, absorb.inputs["Density"])
    shine = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(extinction, shine.inputs["Strength"])
    grey = math_node("DIVIDE", math_node("ADD", share.outputs[0], 0.055), 1.055)  # sRGB; without its straight piece near 0
    tree.links.new(math_node("POWER", grey, 2.4), shine.inputs["Color"])
    both = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(absorb.outputs[0], both.inputs[0])
    tree.links.new(shine.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
    volume.data.materials.append(material)


def blur(volume, asked):
    """Sets what the panels Volume > Render > Velocity and Render > Motion Blur set."""
    if asked.velocity not in [grid.name for grid in volume.data.grids]:
        raise SystemExit(f"no grid {asked.velocity}: {[grid.name for grid in volume.data.grids]}")
    volume.data.velocity_grid = asked.velocity
    volume.data.velocity_unit = asked.velocity_unit
    scene = bpy.context.scene
    scene.render.fps = asked.fps
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = asked.shutter


def render(asked):
    scene = bpy.context.scene
    width, height = (int(side) for side in asked.size.split("x"))
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = asked.samples
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 1.0
    scene.cycles.volume_step_rate = asked.step_rate
    scene.cycles.volume_max_steps = 16384
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = asked.output
    bpy.ops.render.render(write_still=True)


def main():
    asked = arguments()
    volume = import_volume(asked.file)
    about = described(volume)
    print("imported", json.dumps(about), flush=True)
    check(about, asked.grid, asked.bounds)
    add_camera(asked.camera)
    add_material(volume, asked.grid, asked.range, asked.opacity_unit)
    if asked.velocity:
        blur(volume, asked)
    render(asked)


try:
    main()
except SystemExit as stop:
    if stop.code:
        print(f"failed: {stop.code}", flush=True)
        sys.exit(1)
except Exception as error:  # Blender would go on and exit with 0
    print(f"failed: {error}", flush=True)
    sys.exit(1)
