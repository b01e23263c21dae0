# SPDX-License-Identifier: Apache-2.0
"""Documents name files, headers, calls and rooms that exist, and their code compiles."""

import json
import os
import re
import shlex
import subprocess
import unittest
from pathlib import Path

from command import InFolder

TOP = Path(__file__).resolve().parents[2]
DOCUMENTS = [*TOP.glob("*.md"), *(TOP / "docs").rglob("*.md")]
WINGS = ["base", "files", "mesh", "subdivision", "look", "kernels", "ask", "make"]
WAYS_IN = {"lib": "subvol.h", "io": "io.h", "vdb": "vdb.h", "render": "render.h", "view": "view.h", "compare": "compare.h"}


def rooms(where):
    """The rooms of a component or of a wing, as lib/mesh, each with those that it uses, by its CMakeLists.txt."""
    text = (TOP / where / "CMakeLists.txt").read_text()
    calls = re.findall(rf"^ *subvol_(?:room\({where} |extension\()(\w+)\n([^)]*)\)", text, re.M)
    uses = {name: re.search(r"USES ([\w ]+)", rest) for name, rest in calls}
    return {name: sorted(found[1].split()) if found else [] for name, found in uses.items()}


def public_headers(component):
    """(room or wing, header), without subvol/detail and the header with which a wing begins."""
    return {(room, header.name) for room in (WINGS if component == "lib" else rooms(component))
            for header in (TOP / component / room / "include/subvol").glob("*.h") if header.stem != room or component != "lib"}


def calls():
    """The rows of the tables in docs/api.md: component, room, header, calls, example."""
    component = None
    for line in (TOP / "docs/api.md").read_text().splitlines():
        if line.startswith("### subvol::"):
            component = line.removeprefix("### subvol::")
        cells = line.strip("| ").split(" | ")
        if component and len(cells) == 4 and cells[1].endswith(".h`"):
            yield component, cells[0], cells[1].strip("`"), re.findall(r"`(\w+)`", cells[2]), cells[3].strip("`")


# Where the gallery's meshes are in the collection of meshes that SUBVOL_DATA names.
COLLECTED = {"disk_out_ref.vtu": "trame_disk_out_ref.vtu", "can.vtu": "vtkdata_can.vtu", "igea_hex_improve.vtk": "hexdom_igea_improve.vtk",
             "bunny_conforming.mesh": "sibl_bunny_conforming.mesh", "Figure_28.14.vtk": "ansys_td28_fig14.vtk", "post.vtk": "vtkdata_post_tet.vtk",
             "smoke.vdb": "arnold_smoke.vdb", "cylinder_Hexa.msh": "sofa_cylinder_hexa.msh",
             "crackInPlane_benchmark.vtu": "geos_crackInPlane_benchmark.vtu"}


def captioned(document):
    """The pictures that a document shows with the command that draws them: (picture, words of the command)."""
    text = (TOP / document).read_text()
    for command in re.findall(r"`(subvol render [^`]*)`", text):
        words = shlex.split(" ".join(command.split()))
        picture = TOP / ("docs" if document == "README.md" else "docs/gallery") / words[words.index("-o") + 1]
        if picture.exists():
            yield picture, words[1:]


WALKS = {"docs/first-hour.md": "docs/first-hour", "docs/subdivision-volumes.md": "docs/subdivision-volumes"}


def walked(document):
    """The commands of a page that shows one after the other, and its pictures, which they draw."""
    text = (TOP / document).read_text()
    blocks = re.findall(r"^```sh\n(.*?)^```", text, re.M | re.S)
    commands = [shlex.split(line) for block in blocks for line in block.splitlines()]
    return commands, [TOP / "docs" / name for name in re.findall(r"!\[[^]]*\]\(([^)]*)\)", text)]


class Captions(InFolder):
    """Pictures are what their captions draw, exactly but for what machines differ in."""

    def check(self, picture, words):
        self.run_ok(*words)
        self.run_ok("compare", picture.name, picture, "--fail-under", "psnr=50")

    def test_of_pages_that_are_walked_through(self):
        for document, folder in WALKS.items():
            commands, pictures = walked(document)
            self.assertGreater(len(commands), 7, document)
            self.assertEqual(set(pictures), set((TOP / folder).glob("*.png")), document)
            for words in commands:
                self.assertEqual(words[0], "subvol", document)
                self.run_ok(*words[1:])
            for picture in pictures:
                self.run_ok("compare", picture.name, picture, "--fail-under", "psnr=50")

    def test_of_the_readme(self):
        pictures = list(captioned("README.md"))
        self.assertEqual({picture.name for picture, _ in pictures},
                         set(re.findall(r"!\[[^]]*\]\(docs/([^)]*)\)", (TOP / "README.md").read_text())))
        for picture, words in pictures:
            self.check(picture, words)

    def test_of_the_gallery(self):
        pictures = list(captioned("docs/gallery.md"))
        self.assertEqual({f"gallery/{picture.name}" for picture, _ in pictures},
                         set(re.findall(r"!\[[^]]*\]\(([^)]*)\)", (TOP / "docs/gallery.md").read_text())))
        data = os.environ.get("SUBVOL_DATA")
        if not data:
            self.skipTest("SUBVOL_DATA names no folder")
        for picture, words in pictures:
            if not words[1].startswith("model:") and not (self.folder / words[1]).exists():  # several pictures may be of one mesh
                os.symlink(Path(data) / COLLECTED[words[1]], self.folder / words[1])
            self.check(picture, words)


class Documents(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for document in DOCUMENTS:
            for target in re.findall(r"\]\(([^)#\s]+)\)", document.read_text()):
                if not target.startswith("http"):
                    self.assertTrue((document.parent / target).exists(), f"{document}: {target}")

    def test_every_page_is_on_the_site(self):
        shown = re.findall(r": ([\w/-]+\.md)$", (TOP / "mkdocs.yml").read_text(), re.M)
        made = {"index.md", "examples.md", "python-examples.md", "options.md", "CONTRIBUTING.md", "CHANGELOG.md"}
        pages = {page.relative_to(TOP / "docs").as_posix() for page in (TOP / "docs").glob("*.md")} | {"adr/README.md"}
        self.assertEqual(set(shown), pages | made)

    def test_recipes_for_packages_can_be_read(self):
        for path in (TOP / "packaging").rglob("*"):
            if path.suffix == ".py":
                compile(path.read_text(), str(path), "exec")
            elif path.suffix == ".json":
                json.loads(path.read_text())

    def test_files_that_are_named_exist(self):
        for document in DOCUMENTS:
            for name in re.findall(r"`([\w.-]+/[\w./-]+\.(?:cpp|h|glsl|comp|py|cmake))`", document.read_text()):
                if not name.startswith("subvol/"):
                    self.assertTrue((TOP / name).exists(), f"{document}: {name}")

    def test_citations_are_in_the_bibliography(self):
        keys = set(re.findall(r"^@\w+\{(\w+),", (TOP / "docs/references.bib").read_text(), re.M))
        for document in DOCUMENTS:
            cited = re.findall(r"(?<=[\[ ])([a-z]+(?:19|20)\d\d)(?=[\],])", document.read_text())
            self.assertLessEqual(set(cited), keys, document)

    def test_every_decision_is_in_the_index(self):
        listed = re.findall(r"\((\d{4}-[^)]*)\)", (TOP / "docs/adr/README.md").read_text())
        self.assertEqual(listed, sorted(path.name for path in (TOP / "docs/adr").glob("0*.md")))

    def test_the_readme_is_one_screen(self):
        self.assertLessEqual(len((TOP / "README.md").read_text().splitlines()), 64)

    def test_pictures_are_small_and_can_be_drawn_anew(self):
        for document, folder in ("README.md", "docs"), ("docs/gallery.md", "docs/gallery"):
            drawn = {picture for picture, _ in captioned(document)}  # what scripts/pictures runs
            self.assertTrue(drawn, document)
            for picture in (TOP / folder).glob("*.png"):
                self.assertLess(picture.stat().st_size, 200_000)
                self.assertIn(picture, drawn)

    def test_examples_are_short(self):
        examples = sorted((TOP / "examples").glob("*.cpp"))
        self.assertEqual([path.name[:2] for path in examples], [f"{i:02}" for i in range(1, len(examples) + 1)])
        for example in examples:
            self.assertLess(len(example.read_text().splitlines()), 100, example.name)


class WaysIn(unittest.TestCase):
    def test_one_header_of_a_component_brings_all_of_its_public_headers(self):
        def included(path):
            return set(re.findall(r'#include "subvol/([\w/]+\.h)"', path.read_text())) - {"version.h"}  # made by the build

        for component, way_in in WAYS_IN.items():
            brought = included(TOP / component / "include/subvol" / way_in)
            if component == "lib":
                self.assertEqual(brought, {f"{wing}.h" for wing in WINGS})
            else:
                self.assertEqual(brought, {header for _, header in public_headers(component)}, way_in)
        for wing in WINGS:
            front = TOP / "lib" / wing / f"include/subvol/{wing}.h"
            self.assertEqual(included(front), {header for room, header in public_headers("lib") if room == wing})
            self.assertLessEqual(len(front.read_text().splitlines()), 120, front)

    def test_the_table_of_calls_names_every_public_header_in_its_room(self):
        for component in WAYS_IN:
            listed = [(room, header) for of, room, header, _, _ in calls() if of == component]
            self.assertEqual(len(listed), len(set(listed)), component)
            self.assertEqual(set(listed), public_headers(component))

    def test_the_calls_of_the_table_are_in_their_headers(self):
        for component, room, header, names, _ in calls():
            text = (TOP / component / room / "include/subvol" / header).read_text()
            for name in names:
                self.assertRegex(text, rf"\b{name}\b", header)

    def test_every_room_is_in_the_table_of_rooms(self):
        rows = re.findall(r"^\| `([\w/]+)` \| .+ \| ?(.*) \|$", (TOP / "CONTRIBUTING.md").read_text(), re.M)
        listed = {room: sorted(uses.split(", ")) if uses else [] for room, uses in rows}
        places = [*(f"lib/{wing}" for wing in WINGS), *(component for component in WAYS_IN if component != "lib"), "cli", "python"]
        here = {f"{where}/{room}": uses for where in places for room, uses in rooms(where).items()}
        for wing in WINGS:  # their rows stand in a table above
            text = (TOP / "lib" / wing / "CMakeLists.txt").read_text()
            here[f"lib/{wing}"] = sorted(re.search(rf"^subvol_wing\(lib {wing}(?: USES ([\w ]+))?\)", text, re.M)[1].split()) if " USES" in text.split("subvol_room")[0] else []
        self.assertEqual(listed, here)
        for room in here:
            self.assertTrue((TOP / room).is_dir(), room)


@unittest.skipUnless("SUBVOL_COMPILER" in os.environ, "no compiler is named by SUBVOL_COMPILER")
class CodeInDocuments(unittest.TestCase):
    def compile(self, statements, parameters=""):
        includes = [f"-I{folder}" for component in WAYS_IN
                    for folder in [TOP / component / "include", *(TOP / component).glob("*/include")]]
        headers = "".join(f"#include <subvol/{way_in}>\n" for way_in in WAYS_IN.values())
        program = f"{headers}#include <cstdio>\nusing namespace subvol;\nvoid all({parameters}) {{\n{statements}\n}}\n"
        done = subprocess.run([os.environ["SUBVOL_COMPILER"], "-std=c++20", "-fsyntax-only", "-x", "c++", "-", *includes,
                               f"-I{os.environ['SUBVOL_BUILD']}/lib/include"],
                              input=program, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_examples_of_the_table_compile(self):
        self.compile("\n".join(f"{{ {example} }}" for *_, example in calls()),
                     "const HexMesh& mesh, const RbfVolume& volume, const View& view, const TransferFunction& function, "
                     "const Optics& optics, Image& image, const VdbGrid& grid, const std::vector<double>& values, "
                     "const Study& study")


if __name__ == "__main__":
    unittest.main()
