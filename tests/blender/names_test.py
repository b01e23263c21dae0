# SPDX-License-Identifier: Apache-2.0
"""Where the Blender add-on puts its grids and what its material shows, without Blender: its module is replaced by one that only
remembers objects and nodes."""

import ctypes
import json
import math
import os
import sys
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "integrations/blender"))
from command import COMMAND, subvol  # noqa: E402


class Object(dict):
    """An object of Blender: attributes, and properties by name."""

    def __init__(self, name, data):
        super().__init__()
        self.name, self.data, self.type = name, data, "VOLUME"


class Objects(list):
    def new(self, name, data=None):
        if data is None:
            return types.SimpleNamespace(name=name, materials=[])
        self.append(Object(name, data))
        return self[-1]


def fake_blender(saved_as, tempdir):
    bpy = mock.MagicMock()
    bpy.types.Operator, bpy.types.AddonPreferences = type("Operator", (), {}), type("AddonPreferences", (), {})
    bpy.data.objects, bpy.data.volumes = Objects(), Objects()
    bpy.data.filepath, bpy.app.tempdir = saved_as, tempdir
    bpy.path.abspath = lambda path: path
    bpy.context.preferences.addons = {}
    extras = types.ModuleType("bpy_extras")
    extras.io_utils = types.SimpleNamespace(ImportHelper=type("ImportHelper", (), {}))
    return {"bpy": bpy, "bpy.props": bpy.props, "bpy_extras": extras, "bpy_extras.io_utils": extras.io_utils}


def float32(number):
    return ctypes.c_float(number).value


class Slot:
    """An input of a node: a number, or the output of another one."""

    def __init__(self):
        self.default_value = self.source = None


class Ramp:
    """A ColorRamp, linear between its stops."""

    class Stop:
        def __init__(self, position):
            self.position, self.color = position, (0, 0, 0, 1)

    class Stops(list):
        def new(self, position):
            self.append(Ramp.Stop(position))
            return self[-1]

    def __init__(self):
        self.elements = Ramp.Stops([Ramp.Stop(0.0), Ramp.Stop(1.0)])

    def at(self, place):
        stops = sorted(self.elements, key=lambda stop: stop.position)
        if place <= stops[0].position:
            return stops[0].color[0]
        for a, b in zip(stops, stops[1:]):
            if place < b.position:
                return a.color[0] + (place - a.position) / (b.position - a.position) * (b.color[0] - a.color[0])
        return stops[-1].color[0]


class Node:
    """A node that can be evaluated where the attributes have given values: what Blender's manual says of it, in 32 bits."""

    def __init__(self, kind):
        self.kind, self.color_ramp, self.operation, self.attribute_name = kind, Ramp(), None, None
        self.by_name, self.by_number = {}, [Slot(), Slot(), Slot()]
        self.inputs, self.outputs = self, Outputs(self)

    def __getitem__(self, key):
        return self.by_number[key] if isinstance(key, int) else self.by_name.setdefault(key, Slot())

    def __iter__(self):
        return iter(self.by_number)

    def value(self, slot, attributes):
        return slot.source.value(attributes) if slot.source else float32(slot.default_value)

    def __call__(self, attributes):
        if self.kind == "ShaderNodeAttribute":
            return float32(attributes[self.attribute_name])
        if self.kind == "ShaderNodeMapRange":
            low, high, v = (self.value(self[key], attributes) for key in ("From Min", "From Max", "Value"))
            return min(1, max(0, (v - low) / (high - low))) if high != low else 0
        if self.kind == "ShaderNodeValToRGB":
            return self.color_ramp.at(self.value(self["Fac"], attributes))
        a, b = (self.value(self[k], attributes) for k in range(2))
        return {"SUBTRACT": lambda: a - b, "MINIMUM": lambda: min(a, b), "MULTIPLY": lambda: a * b,
                "LOGARITHM": lambda: math.log(a) / math.log(b)}[self.operation]()


class Output:
    is_output = True

    def __init__(self, node):
        self.node = node

    def value(self, attributes):
        return self.node(attributes)


class Outputs:
    def __init__(self, node):
        self.node = node

    def __getitem__(self, _):
        return Output(self.node)


class Nodes(list):
    def new(self, kind):
        self.append(Node(kind))
        return self[-1]


class WhatIsSeen(unittest.TestCase):
    """The extinction that the nodes of a material compute, against that of `subvol render`."""

    def opacity(self, value, low, high, **more):
        sys.modules.pop("subvol_import", None)
        nodes = Nodes()
        links = types.SimpleNamespace(new=lambda source, slot: setattr(slot, "source", source))
        with mock.patch.dict(sys.modules, fake_blender("", "")):
            import subvol_import
            sys.modules["bpy"].data.materials.new = lambda name: types.SimpleNamespace(
                name=name, node_tree=types.SimpleNamespace(nodes=nodes, links=links))
            subvol_import.make_material("m", "density", low, high, unit=0.25, **more)
        sys.modules.pop("subvol_import", None)
        absorb = next(node for node in nodes if node.kind == "ShaderNodeVolumeAbsorption")
        extinction = absorb["Density"].source.value({"density": value, "coverage": 1})
        return 1 - math.exp(-0.25 * extinction)

    def test_a_constant_has_the_middle_of_the_opacities(self):
        # `subvol render` spreads 0 to .5 over a range with the constant in the middle; 32 bits have 7 digits
        for constant in (1, 0, -3, 1e-6, 101325, 5e8, -2e15):
            self.assertAlmostEqual(self.opacity(constant, constant, constant), 0.25, places=5, msg=constant)

    def test_a_range_that_32_bits_cannot_divide_counts_as_a_constant(self):
        for low, high in ((101325, 101325 + 1e-3), (1, 1 + 1e-9), (-1e9, -1e9 + 10)):
            self.assertAlmostEqual(self.opacity(low, low, high), 0.25, places=2, msg=low)

    def test_a_field_goes_from_nothing_to_a_half(self):
        for low, high in ((0, 1), (293, 913), (-2, -1)):
            for part in (0, 0.25, 0.5, 1):
                self.assertAlmostEqual(self.opacity(low + part * (high - low), low, high), part / 2, places=4)

    def test_a_map_of_one_value_can_be_divided(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "one.json").write_text(json.dumps([{"RGBPoints": [7, 1, 0, 0], "Points": [7, 0.6, 0.5, 0]}]))
            self.assertAlmostEqual(self.opacity(7, 0, 9, transfer_function=f"{folder}/one.json"), 0.6, places=5)


class WhereGridsAre(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        for name, size in (("a", 4), ("b", 3)):
            (self.folder / name).mkdir()
            done = subvol("model", "ball", "--resolution", size, "-o", f"{name}/part.vtu", folder=self.folder)
            self.assertEqual(done.code, 0, done.err)

    def add_on(self, saved_as=""):
        sys.modules.pop("subvol_import", None)
        modules = mock.patch.dict(sys.modules, fake_blender(saved_as, str(self.folder / "passing")))
        modules.start()
        self.addCleanup(modules.stop)
        import subvol_import
        self.addCleanup(sys.modules.pop, "subvol_import", None)
        subvol_import.make_material = lambda *_: "material"
        return subvol_import

    def bring(self, add_on, path, said=None, **more):
        return add_on.import_mesh(str(path), resolution=12, command=COMMAND, warn=(said if said is not None else []).append, **more)

    def voxels(self, made):
        return subvol("info", made.data.filepath, "--json").json()["grids"][0]["active_voxels"]

    def test_meshes_of_one_name_have_their_own(self):
        add_on = self.add_on(str(self.folder / "scene.blend"))
        first = self.bring(add_on, self.folder / "a/part.vtu")
        file, hash_before = first.data.filepath, Path(first.data.filepath).read_bytes()
        second = self.bring(add_on, self.folder / "b/part.vtu", density_scale=2)
        self.assertIsNot(first, second)
        self.assertNotEqual(file, second.data.filepath)
        self.assertEqual(Path(file).read_bytes(), hash_before, "the second mesh has not touched the grids of the first")
        self.assertTrue(file.startswith(str(self.folder / "volumes")))
        self.assertEqual(Path(file).name, "part.vdb")

    def test_a_mesh_that_is_imported_again_updates_its_object(self):
        add_on = self.add_on(str(self.folder / "scene.blend"))
        first = self.bring(add_on, self.folder / "a/part.vtu")
        coarse = self.voxels(first)
        os.chdir(self.folder)
        for name in (self.folder / "a/part.vtu", "a/part.vtu", self.folder / "b/../a/part.vtu"):
            again = add_on.import_mesh(str(name), resolution=20, command=COMMAND)
            self.assertIs(again, first)
        self.assertGreater(self.voxels(first), coarse)
        self.assertEqual(len(list((self.folder / "volumes").iterdir())), 1)

    def test_grids_that_will_be_deleted_are_told(self):
        said = []
        made = self.bring(self.add_on(), self.folder / "a/part.vtu", said)
        self.assertTrue(made.data.filepath.startswith(str(self.folder / "passing")))
        self.assertEqual(len(said), 1)
        self.assertIn("deletes when it ends", said[0])
        for add_on, more in ((self.add_on(), {"folder": str(self.folder / "mine")}), (self.add_on(str(self.folder / "s.blend")), {})):
            said = []
            self.bring(add_on, self.folder / "a/part.vtu", said, **more)
            self.assertEqual(said, [])


if __name__ == "__main__":
    unittest.main()
