# SPDX-License-Identifier: Apache-2.0
"""Where the Blender add-on puts its grids, without Blender: its module is replaced by one that only remembers objects."""

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
