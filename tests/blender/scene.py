# SPDX-License-Identifier: Apache-2.0
"""Runs inside Blender (import_test.py starts it): imports meshes by the add-on, checks what it made, saves a .blend and renders."""

import json
import os
import sys
from pathlib import Path

import bpy

folder = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "integrations/blender"))
import subvol_import  # noqa: E402

subvol_import.register()
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
subvol_import.register() if not hasattr(bpy.types, "IMPORT_SCENE_OT_subvol") else None
files = {"folder": str(folder / "volumes")}
facts = {}


def ramp(material, label):
    return next(node for node in material.node_tree.nodes if node.label == label).color_ramp


# Three meshes side by side, the second with ParaView's colour map, the third with several grids.
places = (("model:ball", -3.2, {"resolution": 48}), ("model:nozzle", 0, {"resolution": 64, "density_scale": 4, "transfer_function": str(folder / "map.json")}),
          (str(folder / "two.vtk"), 2.6, {"resolution": 40, "fields": "Temp,Pres", "scale": 1.5}))
for path, x, options in places:
    made = subvol_import.import_mesh(path, **files, **options)
    made.location.x += x
facts["objects"] = sorted(o.name for o in bpy.data.objects)
two = bpy.data.objects["two"]
two.data.grids.load()
facts["grids"] = sorted(grid.name for grid in two.data.grids)
facts["scale"] = list(two.scale)
nozzle = bpy.data.objects["nozzle"].data.materials[0]
facts["stops"] = len(ramp(nozzle, "colours").elements)
facts["first_color"] = list(ramp(nozzle, "colours").elements[0].color)
facts["opacity"] = ramp(nozzle, "opacities").elements[-1].color[0]

# A second import replaces the grids and keeps what was done to the object and its material.
nozzle["mine"] = 7
again = subvol_import.import_mesh("model:nozzle", **files, resolution=80)
facts["again"] = [len([o for o in bpy.data.objects if o.type == "VOLUME"]), again.data.materials[0].get("mine"), again.name]

# A series becomes a sequence, with its frames and velocities.
steps = subvol_import.import_mesh(str(folder / "run.pvd"), **files, resolution=32, steps="all", velocity=True)
steps.location = (-1, 3.5, 0)
facts["sequence"] = [steps.data.is_sequence, steps.data.frame_duration, steps.data.frame_start, steps.data.velocity_grid,
                     steps.data.velocity_unit, bpy.context.scene.frame_end]
frames = []
for frame in (1, 2, 3):
    bpy.context.scene.frame_set(frame)
    steps.data.grids.load()
    frames.append(Path(steps.data.grids.frame_filepath).name)
facts["frame_files"] = frames

try:
    subvol_import.import_mesh("gone.vtu", **files)
except subvol_import.SubvolError as error:
    facts["error"] = str(error)

scene = bpy.context.scene
scene.frame_set(2)
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
camera.location, camera.rotation_euler, camera.data.lens = (-.3, -9.5, 5), (1.13, 0, 0), 42
scene.camera = camera
scene.world = bpy.data.worlds.new("dark")
scene.world.color = (0.05, 0.05, 0.05)
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
if os.environ.get("SUBVOL_BLENDER_RENDER", "1") == "1":
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 8, False
    scene.cycles.volume_step_rate = 2
    scene.render.resolution_x, scene.render.resolution_y = 320, 200
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = str(folder / "scene.png")
    bpy.ops.render.render(write_still=True)
    picture = bpy.data.images.load(str(folder / "scene.png"))
    lit = [max(picture.pixels[i:i + 3]) for i in range(0, len(picture.pixels), 4)]
    facts["lit"] = sum(v > 0.3 for v in lit) / len(lit)
(folder / "facts.json").write_text(json.dumps(facts))
