#!/usr/bin/env pvpython
# SPDX-License-Identifier: Apache-2.0
"""Error and speed of Subdivision splats and of ParaView's own Volume, in one run: the table of docs/paraview.md.

    pvpython bench/paraview_frames.py SubvolPlugin.so FOLDER mesh.vtu[:FIELD]… [--frames N] [--pictures FOLDER]

For each mesh both representations draw the same view at 512² with the same transfer function: opacities from 0 to .5 over the field's range, for 1/100 of
the diagonal, ParaView's default colours, without its smoothing of edges. FIELD may be an expression, as `--density` takes. Seconds are those of the processor, of all
threads (user and system): of the first picture, of each later one with the view turned by 10°, and of one while the view turns, of pictures with as many
pixels as the window. Frames a second are those of the clock, which on a busy machine are too few. The error is the root mean square difference from the
method dense of the same representation, in parts of full light, over all pixels and over those that show something.
"""
import argparse
import os
import statistics
import time

import numpy as np
import subvol
from paraview import simple
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

SIZE = (512, 512)
STEP = 10  # degrees


def say(row):
    os.write(1, f"{row}\n".encode())  # what pvpython has for sys.stdout is lost at its end


def rendered(view, call):
    """Seconds of the processor and of the clock."""
    start, clock = time.process_time(), time.monotonic()
    call()
    return time.process_time() - start, time.monotonic() - clock


def mesh_of(name, folder):
    path, _, field = name.partition(":")
    mesh = subvol.read_mesh(path)
    field = field or next(iter(mesh.fields))
    values = mesh.fields[field] if field in mesh.fields else subvol.quantity(mesh, field)
    field = field if field in mesh.fields else "density"
    file = os.path.join(folder, os.path.splitext(os.path.basename(path))[0] + "_bench.vtu")
    subvol.write_mesh(subvol.HexMesh(mesh.points, mesh.cells, {field: values}), file)
    return file, field


class Scene:
    def __init__(self, file, field, folder):
        self.folder = folder
        self.reader = simple.XMLUnstructuredGridReader(FileName=[file])
        self.view = simple.CreateRenderView()
        view = self.view
        view.ViewSize = SIZE
        view.OrientationAxesVisibility = view.UseColorPaletteForBackground = view.UseFXAA = 0
        view.Background = [0, 0, 0]
        view.LODThreshold = 0
        self.shown = simple.Show(self.reader, view)
        simple.ColorBy(self.shown, ("POINTS", field))
        self.shown.SetScalarBarVisibility(view, False)
        low, high = self.reader.PointData[field].GetRange()
        opacities = simple.GetOpacityTransferFunction(field)
        opacities.Points = [low, 0, 0.5, 0, high, 0.5, 0.5, 0]
        simple.GetColorTransferFunction(field).RescaleTransferFunction(low, high)
        bounds = np.reshape(self.reader.GetDataInformation().GetBounds(), (3, 2))
        self.shown.ScalarOpacityUnitDistance = float(np.linalg.norm(bounds[:, 1] - bounds[:, 0])) / 100
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [1, -2, 1], [0, 0, 0], [0, 0, 1]
        view.ResetCamera()

    def show(self, representation, method="splat"):
        self.shown.SetRepresentationType(representation)
        self.shown.SubvolMethod = method

    def turn(self, degrees):
        self.view.GetActiveCamera().Azimuth(degrees)

    def still(self):
        return rendered(self.view, lambda: simple.Render(self.view))

    def turning(self):
        return rendered(self.view, self.view.SMProxy.InteractiveRender)

    def pixels(self, name):
        path = os.path.join(self.folder, name + ".png")
        simple.SaveScreenshot(path, self.view, ImageResolution=SIZE)
        reader = vtkPNGReader()
        reader.SetFileName(path)
        reader.Update()
        image = reader.GetOutput()
        return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(*SIZE, -1)[..., :3] / 255.0

    def times(self, frames):
        """First, later and turning: medians of seconds of the processor, and frames a second by the clock while turning."""
        first = self.still()[0]
        later, moving, clocks = [], [], []
        for _ in range(frames):
            self.turn(STEP)
            later.append(self.still()[0])
        self.turning()
        for _ in range(frames):
            self.turn(STEP)
            used, clock = self.turning()
            moving.append(used)
            clocks.append(clock)
        self.turn(-2 * STEP * frames)
        return first, statistics.median(later), statistics.median(moving), 1 / statistics.median(clocks)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("plugin")
    options.add_argument("folder")
    options.add_argument("meshes", nargs="+")
    options.add_argument("--frames", type=int, default=9)
    asked = options.parse_args()
    simple.LoadPlugin(asked.plugin, remote=False, ns=vars(simple))
    say("| mesh | | first | later | turning | frames/s, clock | error | of what shows |")
    say("|---|---|---|---|---|---|---|---|")
    for name in asked.meshes:
        file, field = mesh_of(name, asked.folder)
        base = os.path.splitext(os.path.basename(file))[0].removesuffix("_bench")
        scene = Scene(file, field, asked.folder)
        rows = {}
        for representation in ("Subdivision splats", "Volume"):
            scene.show(representation)
            rows[representation] = scene.times(asked.frames), scene.pixels(f"{base}_{representation.split()[0]}")
        scene.show("Subdivision splats", "dense")
        exact = scene.pixels(base + "_dense")
        seen = exact.max(-1) > 0.02
        for representation, (times, picture) in rows.items():
            squares = np.mean((picture - exact) ** 2, -1)
            first, later, moving, frames = times
            say(f"| {base} | {representation} | {first:.3f} | {later:.3f} | {moving:.3f} | {frames:.1f} | {np.sqrt(squares.mean()):.5f} | "
                  f"{np.sqrt(squares[seen].mean()):.5f} |")
        (ours, picture), (theirs, other) = rows.values()
        errors = [np.sqrt(np.mean((each - exact) ** 2)) for each in (picture, other)]
        say(f"| | ratio | {theirs[0] / ours[0]:.1f} | {theirs[1] / ours[1]:.1f} | {theirs[2] / ours[2]:.1f} | | {errors[1] / errors[0]:.1f} | |")
        simple.Delete(scene.view)
        simple.Delete(scene.reader)
    os._exit(0)  # pvpython's own end fails in its X context


main()
