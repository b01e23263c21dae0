# SPDX-License-Identifier: Apache-2.0
"""A page that draws the volume: what the command writes, and what a browser shows of it (by software, without a GPU)."""

import base64
import json
import os
import re
import struct
import sys
import tempfile
import time
import unittest
from pathlib import Path

from browser import Browser, find_chromium, policy_faults
from command import TWO_FIELDS, InFolder, subvol


def write_tiff(path, width, height, pixels):
    """Linear RGBA as 32-bit floats: `subvol compare` reads it."""
    tags = [(256, 4, [width]), (257, 4, [height]), (258, 3, [32] * 4), (259, 3, [1]), (262, 3, [2]), (273, 4, [0]), (277, 3, [4]),
            (278, 4, [height]), (279, 4, [len(pixels)]), (284, 3, [1]), (338, 3, [1]), (339, 3, [3] * 4)]
    begin = 8 + 2 + 12 * len(tags) + 4
    extra = struct.pack("<4H", *[32] * 4) + struct.pack("<4H", *[3] * 4)
    rows, places = b"", iter((begin, begin + 8))
    for tag, kind, values in tags:
        if len(values) == 4:
            content = struct.pack("<I", next(places))
        elif tag == 273:
            content = struct.pack("<I", begin + len(extra))
        else:
            content = struct.pack("<I" if kind == 4 else "<HH", *values, *([0] if kind == 3 else []))
        rows += struct.pack("<HHI", tag, kind, len(values)) + content
    path.write_bytes(b"II*\0" + struct.pack("<IH", 8, len(tags)) + rows + b"\0\0\0\0" + extra + pixels)


HOSTILE_NAME = "<!--<script>"
HOSTILE_TITLE = "<!-- <script> </script> ]]> <b>&\u2028 {facts}"


class Page(InFolder):
    def test_says_what_it_shows(self):
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        report = self.run_ok("page", self.folder / "two.vtk", "-o", "two.html", "--fields", "Pres,Temp,V", "--unit", "Pa", "--json").json()
        text = (self.folder / "two.html").read_text()
        self.assertEqual(report["bytes"], len(text.encode()))
        self.assertEqual([field["name"] for field in report["fields"]], ["Pres", "Temp", "V"])
        self.assertEqual(report["fields"][1]["range"], [293, 313])
        self.assertEqual(report["kept"], report["points"])
        for field in report["fields"]:  # 16 bits
            self.assertLess(field["max_error"], 1e-3 * (field["range"][1] - field["range"][0]))
        for said in ("two.vtk", "OpenSubVol", "Error of rounding", "% of its range"):
            self.assertIn(said, text)
        self.assertNotRegex(text, r"(src|href)=\"(?!data:)")
        self.assertNotIn(str(self.folder), text)
        self.assertNotIn("http", re.sub(r"<script type=\"text/plain\".*?</script>", "", text, flags=re.S))

    def test_several_steps_share_ranges_and_camera(self):
        for step in (0, 1):
            self.run_ok("model", "ball", "--resolution", 3 + step, "-o", f"ball_{step}.vtu")
        (self.folder / "run.pvd").write_text(
            '<VTKFile type="Collection"><Collection><DataSet timestep="0" file="ball_0.vtu"/>'
            '<DataSet timestep="2.5" file="ball_1.vtu"/></Collection></VTKFile>')
        both = self.run_ok("page", "run.pvd", "-o", "run.html", "--step", "0-1", "--json").json()
        one = self.run_ok("page", "run.pvd", "-o", "one.html", "--step", "0", "--json").json()
        self.assertGreater(both["points"], one["points"])
        text = (self.folder / "run.html").read_text()
        for label in ("0 (t = 0)", "1 (t = 2.5)"):
            self.assertIn(label, text)
        self.assertLessEqual(both["fields"][0]["range"][0], one["fields"][0]["range"][0])

    def test_titles_are_not_html(self):
        self.run_ok("page", "model:ball:4", "-o", "a.html", "--title", "</script><b>&")
        text = (self.folder / "a.html").read_text()
        self.assertIn("&lt;/script&gt;&lt;b&gt;&amp;", text)
        self.assertNotIn("</script><b>", text)

    def test_names_of_a_file_that_someone_sent_stay_names(self):
        (self.folder / "two.vtk").write_text(TWO_FIELDS.replace("Temp", HOSTILE_NAME))
        self.run_ok("page", "two.vtk", "-o", "a.html", "--fields", "all", "--title", HOSTILE_TITLE)
        text = (self.folder / "a.html").read_text()
        data = re.search(r'<script type="application/json" id="head">(.*?)</script>', text, re.S)[1]
        self.assertNotIn("<", data)
        head = json.loads(data)
        self.assertEqual(head["title"], HOSTILE_TITLE)
        self.assertIn(HOSTILE_NAME, [field["name"] for field in head["fields"]])
        self.assertNotIn("<!--", text)
        self.assertEqual(policy_faults(text), [])
        # A title like one of the places that the page fills.
        self.run_ok("page", "model:ball:3", "-o", "b.html", "--title", "{facts}")
        self.assertRegex((self.folder / "b.html").read_text(), r"<h1>\{facts\}</h1>(.|\n)*<dl><dt>File</dt>")

    def test_kernels_are_merged_until_they_fit(self):
        whole = self.run_ok("page", "model:pawn", "-o", "a.html", "--no-reference", "--json").json()
        limit = int(0.8 * whole["bytes"])
        less = self.run_ok("page", "model:pawn", "-o", "b.html", "--no-reference", "--max-bytes", limit, "--json").json()
        self.assertLessEqual((self.folder / "b.html").stat().st_size, limit)
        self.assertLessEqual(less["kept"], less["points"])
        self.assertTrue(less["bits"] < 16)
        fewer = self.run_ok("page", "model:pawn", "-o", "c.html", "--no-reference", "--max-bytes", int(0.55 * whole["bytes"]), "--json").json()
        self.assertLess(fewer["kept"], fewer["points"])
        self.assertIn("merged from", (self.folder / "c.html").read_text())
        self.assertIn("were merged", fewer["warnings"][0])
        self.assertGreater(fewer["fields"][0]["rmse"], less["fields"][0]["rmse"])
        self.assertLess(fewer["fields"][0]["rmse"], 0.02 * 2)  # of a range of 2

    def test_bad_input(self):
        for arguments, words in (
            (["model:ball:4", "-o", "a.png"], ".html"),
            (["model:ball:4", "-o", "a.html", "--max-bytes", "12000"], "the page needs"),
            (["model:ball:4", "-o", "a.html", "--fields", "density,gone"], "gone"),
            (["model:ball:4", "-o", "a.html", "--look", "isosurface"], "no lit isosurfaces"),
            (["model:ball:4", "-o", "a.html", "--kernel", "gaussian"], "compact kernel"),
            (["model:ball:4", "-o", "a.html", "--correction", "full"], "Hessians"),
            (["gone.vtk", "-o", "a.html"], "gone.vtk"),
        ):
            with self.subTest(arguments=arguments):
                done = subvol("page", *arguments, folder=self.folder)
                self.assertEqual(done.code, 2, done.err)
                self.assertIn(words, done.err)
                self.assertEqual(done.err.count("\n"), 1, done.err)
        self.assertEqual(self.files(), [])


@unittest.skipUnless(find_chromium(), "no chromium")
class InTheBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = Path(cls.temporary.name)
        cls.browser = Browser(find_chromium(), webgl=True)
        cls.addClassCleanup(cls.browser.close)

    def command(self, *arguments):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 0, done.err)
        return done

    def open(self, name, width=900, height=560, mobile=False):
        self.browser.resize(width, height, mobile=mobile)
        self.browser.open((self.folder / name).as_uri())
        self.wait()

    def wait(self):
        """Until the picture is finished."""
        deadline = time.monotonic() + 1500
        while not self.browser.evaluate("!!(window.subvolPage && subvolPage.firstPicture && !subvolPage.drawing)"):
            state = self.browser.evaluate("(s => s && s.className === 'fault' ? s.textContent : '')(document.getElementById('state'))")
            if "WebGL2" in state:
                self.skipTest(state)
            self.assertEqual(state, "")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)

    def picture(self, name, size):
        """The page's own picture, as a file."""
        text = self.browser.evaluate(f"""subvolPage.picture({size}, {size}).then(({{ pixels }}) => {{
            const bytes = new Uint8Array(pixels.buffer);
            let text = '';
            for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
            return btoa(text);
        }})""")
        write_tiff(self.folder / name, size, size, base64.b64decode(text))

    def shot(self, name=None):
        """The picture as it is seen now. Saved in the folder that SUBVOL_SCREENSHOTS names, for people to look at."""
        self.wait()
        folder = Path(os.environ.get("SUBVOL_SCREENSHOTS") or self.folder)
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / (name or "page_now.png")
        self.browser.screenshot(path)
        return path.read_bytes()

    def box(self, element):
        return self.browser.evaluate(f"(r => [r.x, r.y, r.width, r.height])(document.querySelector('{element}').getBoundingClientRect())")

    def mouse(self, kind, x, y, **more):
        self.browser.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, x, y, dx, dy):
        self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        for k in range(1, 5):
            self.mouse("mouseMoved", x + dx * k / 4, y + dy * k / 4, button="left", buttons=1)
        self.mouse("mouseReleased", x + dx, y + dy, button="left", clickCount=1)

    def test_same_picture_as_render(self):
        # Rounding of kernels, and for transparent bodies the values where rays cross the boundary.
        for name, look in (("solid", ["--look", "solid"]), ("volume", ["--look", "volume", "--tf", "coolwarm"]),
                           ("ortho", ["--look", "volume", "--ortho", "--view", "-y"]),
                           ("one colour", ["--look", "solid", "--tf", "constant"])):
            with self.subTest(look=name):
                self.command("page", "model:nozzle", "-o", "a.html", *look)
                self.command("render", "model:nozzle", "-o", "a.exr", "--size", "192", *look)
                self.open("a.html", 300)
                self.picture("a.tif", 192)
                compared = self.command("compare", "a.tif", "a.exr", "--json").json()
                self.assertGreater(compared["psnr"], 40, name)
                self.assertEqual(self.browser.requests(), [])
                self.assertEqual(self.browser.complaints(), [])

    def test_fog_is_the_picture_that_render_makes(self):
        self.command("model", "ball", "--resolution", "6", "-o", "ball.vtu")
        self.command("vdb", "ball.vtu", "-o", "smoke.vdb", "--density", "1.2-x*x-y*y-z*z", "--resolution", "24")
        seen = ["--opacity", "0%:.1,100%:.3"]  # up to the rim
        made = self.command("page", "smoke.vdb", "-o", "f.html", *seen, "--json").json()
        self.assertEqual(made["points"], made["active_voxels"])
        self.command("render", "smoke.vdb", "-o", "f.exr", "--size", "128", *seen)
        self.open("f.html", 300)
        self.picture("f.tif", 128)
        compared = self.command("compare", "f.tif", "f.exr", "--json").json()
        self.assertGreater(compared["psnr"], 45)  # its rays end at the faces of voxels, those of `render` at a weight
        self.assertEqual(self.browser.evaluate("[...document.getElementById('look').options].map(o => o.value).join()"), "volume,xray")
        self.assertEqual(self.browser.evaluate("document.getElementById('look').value"), "volume")
        self.assertEqual(self.browser.complaints(), [])
        self.shot("fog.png")

    def test_same_picture_as_render_with_the_eye_inside(self):
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        inside, apart = "--camera", ".4,.5,.6,1,.6,.5,0,0,1,60"
        for name, options in (("solid", ["--look", "solid", inside, apart]), ("volume", ["--look", "volume", inside, apart]),
                              ("open", ["--look", "solid", inside, apart + ",2"]), ("opened volume", ["--look", "volume", inside, apart + ",2"])):
            with self.subTest(look=name):
                self.command("page", "two.vtk", "-o", "i.html", "--fields", "Temp", *options)
                self.command("render", "two.vtk", "-o", "i.exr", "--field", "Temp", "--size", "96", *options)
                self.open("i.html", 300)
                self.picture("i.tif", 96)
                compared = self.command("compare", "i.tif", "i.exr", "--json").json()
                self.assertGreater(compared["psnr"], 40, name)
                self.assertEqual(self.browser.complaints(), [])

    def test_hands_change_the_picture(self):
        self.command("page", "model:ball:6", "-o", "b.html")
        self.open("b.html")
        first = self.shot("page_first.png")
        x, y, width, height = self.box("#picture")
        # A click says the value there.
        for kind in ("mousePressed", "mouseReleased"):
            self.mouse(kind, x + width / 2, y + height / 2, button="left", clickCount=1)
        picked = self.browser.evaluate("subvolPage.picked")
        probe = self.command("probe", "model:ball:6", "--at", ",".join(str(0.999 * c) for c in picked["place"]), "--json").json()
        self.assertAlmostEqual(picked["value"], probe["values"][0]["value"], delta=0.02)
        # A drag turns the volume; the wheel makes it larger.
        self.drag(x + width / 2, y + height / 2, 120, 30)
        turned = self.shot("page_turned.png")
        self.assertNotEqual(turned, first)
        self.mouse("mouseWheel", x + width / 2, y + height / 2, deltaX=0, deltaY=-120)
        self.assertNotEqual(self.shot(), turned)
        # The clip plane: the slider's drag cuts the ball open, and what is picked then lies in it.
        left, top, long, high = self.box("#clip-at")
        self.drag(left + long / 2, top + high / 2, 0.05 * long, 0)
        cut = self.shot("page_cut.png")
        self.assertTrue(self.browser.evaluate("document.getElementById('clip').checked"))
        self.assertNotEqual(cut, turned)
        # A point of the opacities: a solid stays what it is, and the page says where opacities show.
        left, top, long, high = self.box("#editor")
        last = self.browser.evaluate("(e => e.transfer.opacity.map(([v, a]) => [e.xOf(v), e.yOf(a)]).at(-1))(subvolPage.editor)")
        self.drag(left + last[0], top + last[1], -0.3 * long, -20)
        self.assertEqual(self.browser.evaluate("document.getElementById('look').value"), "solid")
        self.assertFalse(self.browser.evaluate("document.getElementById('opacity-note').hidden"))
        self.browser.evaluate("(s => { s.value = 'volume'; s.dispatchEvent(new Event('change')); })(document.getElementById('look'))")
        self.assertTrue(self.browser.evaluate("document.getElementById('opacity-note').hidden"))
        opacity = self.browser.evaluate("subvolPage.editor.transfer.opacity.at(-1)[1]")
        self.assertGreater(opacity, 0.5)
        self.assertNotEqual(self.shot("page_opacity.png"), cut)
        self.assertEqual(self.browser.requests(), [])
        self.assertEqual(self.browser.complaints(), [])

    def test_a_side_is_upright_where_y_is_up(self):
        self.command("page", "model:ball:4", "-o", "b.html", "--up", "y")
        self.open("b.html")
        for view, up, eye in (("0,0,1", [0, 1, 0], [0, 0, 1]), ("1,-1,1", [0, 1, 0], [1, 1, 1]), ("0,1,0", [0, 0, -1], [0, 1, 0])):
            self.browser.evaluate(f"subvolPage.camera.lookFrom('{view}'.split(',').map(Number))")
            camera = self.browser.evaluate("({up: subvolPage.camera.up, eye: subvolPage.camera.eye})")
            self.assertEqual([value + 0.0 for value in camera["up"]], up, view)
            length = sum(value * value for value in camera["eye"]) ** 0.5
            for found, wanted in zip(camera["eye"], eye):
                self.assertAlmostEqual(found / length, wanted / sum(value * value for value in eye) ** 0.5, places=6)

    def choose(self, element, value):
        self.browser.evaluate(f"(s => {{ s.value = '{value}'; s.dispatchEvent(new Event('change')); }})(document.getElementById('{element}'))")

    def test_colours_have_scales_and_bands(self):
        self.command("page", "model:ball:4", "-o", "s.html", "--density", "exp(4*z)", "--range", "1,40", "--below", "red", "--above", "white")
        self.open("s.html", 300)
        at = "(v => colorAt(subvolPage.transfers[0].transfer, v))"
        self.assertEqual(self.browser.evaluate(f"{at}(.5)"), [1, 0, 0])
        self.assertEqual(self.browser.evaluate(f"{at}(41)"), [1, 1, 1])
        self.assertEqual(self.browser.evaluate("tipsOf(subvolPage.transfers[0].transfer.color)"), {"below": [1, 0, 0], "above": [1, 1, 1]})
        self.shot("page_tips.png")
        middle = self.browser.evaluate(f"{at}(20.5)")
        self.choose("scale", "log")
        for found, expected in zip(self.browser.evaluate(f"{at}(Math.sqrt(40))"), middle):
            self.assertAlmostEqual(found, expected, delta=.02)  # halfway between 1 and 40 by ratios
        self.choose("bands", 4)
        self.assertEqual(self.browser.evaluate(f"new Set([1.2, 3, 8, 20, 30, 39].map((v) => {at}(v).join())).size"), 4)
        self.assertEqual(self.browser.evaluate(f"{at}(.5)"), [1, 0, 0])  # the tips stay
        self.shot("page_bands.png")
        self.choose("scale", "symlog")
        self.choose("colors", "coolwarm")
        self.assertEqual(self.browser.evaluate("new Set([1.01, 30, 39].map((v) => colorAt(subvolPage.transfers[0].transfer, v).join())).size"), 2)
        self.browser.evaluate("document.getElementById('restore').click()")
        self.assertEqual(self.browser.evaluate(f"{at}(20.5)"), middle)
        self.assertEqual(self.browser.evaluate("[document.getElementById('scale').value, document.getElementById('bands').value]"), ["linear", "0"])
        self.command("page", "model:ball:3", "-o", "n.html")
        self.open("n.html", 300)
        self.assertTrue(self.browser.evaluate("document.getElementById('scale').options[1].disabled"))  # values below 0 have no logarithm
        self.assertEqual(self.browser.complaints(), [])

    def test_colours_have_the_values_of_their_ends(self):
        self.command("page", "model:ball:4", "-o", "u.html", "--unit", "K")
        self.open("u.html", 300)
        ticks = self.browser.evaluate("ticksWithEnds(1.25, 99, 6, .1)")
        self.assertEqual([ticks[0], ticks[-1]], [[1.25, "1.25"], [99, "99"]])
        for value, _ in ticks[1:-1]:
            self.assertTrue(1.25 + 9.7 < value < 99 - 9.7, ticks)  # beside the ends, not on them
        self.assertEqual(self.browser.evaluate("document.getElementById('field').options[0].text"), "density [K]")
        self.shot("page_ends.png")
        self.assertEqual(self.browser.complaints(), [])

    def test_hostile_names_are_shown_and_nothing_else_runs(self):
        (self.folder / "two.vtk").write_text(TWO_FIELDS.replace("Temp", HOSTILE_NAME))
        self.command("page", "two.vtk", "-o", "d.html", "--fields", "all", "--title", HOSTILE_TITLE)
        self.open("d.html", 300)
        self.assertIn(HOSTILE_NAME, self.browser.evaluate("[...document.getElementById('field').options].map(o => o.text)"))
        # A separator of lines, which a reader would not see, is shown by its bytes.
        self.assertEqual(self.browser.evaluate("document.title"), HOSTILE_TITLE.replace("\u2028", r"\xe2\x80\xa8"))
        self.assertEqual(self.browser.complaints(), [])
        # What would get into the page as a tag after all does nothing, and nothing is loaded.
        self.browser.evaluate("""(() => {
            const script = Object.assign(document.createElement('script'), { textContent: 'window.foreign = 1' });
            document.body.append(script);
            document.body.insertAdjacentHTML('beforeend', '<img src="http://127.0.0.1:9/a.png" onerror="window.foreign = 2">');
        })()""")
        self.assertEqual(self.browser.evaluate("fetch('http://127.0.0.1:9/').then(() => 'loaded', () => 'refused')"), "refused")
        self.assertEqual(self.browser.evaluate("String(window.foreign)"), "undefined")
        self.assertIn("Content Security Policy", json.dumps(self.browser.complaints()))

    def test_a_comparison_that_is_left_at_once_stays_left(self):
        self.command("page", "model:ball:4", "-o", "e.html")
        self.open("e.html", 300)
        state = "[document.getElementById('view').classList.contains('comparing'), document.getElementById('compare').checked]"
        click = "document.getElementById('compare').click()"
        # While the reference is decoded, and while the page's own picture is drawn.
        for held, kind in (("HTMLImageElement.prototype", "decode"), ("subvolPage.constructor.prototype", "picture")):
            self.browser.evaluate(f"""{{
                const whole = {held}.{kind};
                window.release = () => 0;
                window.entered = 0;
                {held}.{kind} = function (...of) {{
                    ++window.entered;
                    {held}.{kind} = whole;
                    return new Promise((go) => {{ window.release = () => go(whole.apply(this, of)); }});
                }};
            }}""")
            self.browser.evaluate(click)
            deadline = time.monotonic() + 1500
            while not self.browser.evaluate("window.entered"):
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.02)
            self.browser.evaluate(click)
            self.browser.evaluate("window.release()")
            self.wait()
            self.browser.evaluate("new Promise((go) => setTimeout(go, 200))")
            self.wait()
            self.assertEqual(self.browser.evaluate(state), [False, False], kind)
            self.assertEqual(self.browser.evaluate("document.getElementById('compare-state').textContent"), "")
        # And one that is not left is shown.
        self.browser.evaluate(click)
        while not self.browser.evaluate("document.getElementById('compare-state').textContent"):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        self.assertEqual(self.browser.evaluate(state), [True, True])
        self.assertEqual(self.browser.complaints(), [])

    def test_steps_are_chosen(self):
        for step in (0, 1):
            self.command("model", "ball", "--resolution", 2 + step, "-o", f"ball_{step}.vtu")
        (self.folder / "run.pvd").write_text(
            '<VTKFile type="Collection"><Collection><DataSet timestep="0" file="ball_0.vtu"/>'
            '<DataSet timestep="1" file="ball_1.vtu"/></Collection></VTKFile>')
        self.command("page", "run.pvd", "-o", "run.html", "--step", "0-1", "--look", "volume")
        self.open("run.html", 300)
        before = self.shot("page_step.png")
        camera = self.browser.evaluate("subvolPage.camera.eye.slice()")
        choice = "document.getElementById('step')"
        last = self.browser.evaluate(f"{choice}.value")
        self.browser.evaluate(f"(s => {{ s.value = {1 - int(last)}; for (const e of ['input', 'change']) s.dispatchEvent(new Event(e)); }})({choice})")
        self.assertNotEqual(self.shot(), before)
        self.assertEqual(self.browser.evaluate("subvolPage.camera.eye.slice()"), camera)
        self.assertEqual(self.browser.complaints(), [])

    def test_fits_a_phone(self):
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        self.command("page", "two.vtk", "-o", "c.html", "--fields", "Temp,Pres,V")
        self.open("c.html", 390, mobile=True)
        self.assertLessEqual(self.browser.evaluate("document.documentElement.scrollWidth"), 390)
        self.assertEqual(self.browser.evaluate("[...document.getElementById('field').options].map(o => o.text)"), ["Temp", "Pres", "V"])
        before = self.shot("page_phone.png")
        self.browser.evaluate("(s => { s.value = 1; s.dispatchEvent(new Event('change')); })(document.getElementById('field'))")
        self.assertNotEqual(self.shot(), before)
        # A finger turns it.
        x, y, width, height = self.box("#picture")
        old = self.browser.evaluate("subvolPage.camera.eye.slice()")
        for kind, dx in (("touchStart", 0), ("touchMove", 30), ("touchMove", 60), ("touchEnd", None)):
            points = [] if dx is None else [{"x": x + width / 2 + dx, "y": y + height / 2}]
            self.browser.send("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        self.assertNotEqual(self.browser.evaluate("subvolPage.camera.eye.slice()"), old)
        self.assertEqual(self.browser.complaints(), [])


if __name__ == "__main__":
    if not find_chromium():
        print("skipped: no chromium here; what needs none is tested", file=sys.stderr)
    unittest.main()
