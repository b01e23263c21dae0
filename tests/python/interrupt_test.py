# SPDX-License-Identifier: Apache-2.0
"""Progress, Ctrl-C, and the GIL."""
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest
import subvol
from conftest import grid_of


def test_progress_is_reported_on_the_calling_thread():
    seen = []
    subvol.subdivide(grid_of(20), 2, progress=lambda stage, part: seen.append((stage, part, threading.get_ident())))
    assert seen
    assert all(isinstance(stage, str) and 0 <= part <= 1 for stage, part, _ in seen)
    assert {thread for *_, thread in seen} == {threading.get_ident()}


def test_an_exception_in_progress_cancels_and_is_raised():
    class Enough(Exception):
        pass

    def stop(stage, part):
        raise Enough(stage)

    with pytest.raises(Enough):
        subvol.subdivide(grid_of(24), 2, progress=stop)
    with pytest.raises(Enough):
        subvol.render(subvol.sample(subvol.model("pawn")), size=(1024, 1024), progress=stop, samples=4)


def calls(ball):
    """Each long call, by its name."""
    volume, fine = subvol.sample(ball), subvol.subdivide(ball)
    around = subvol.surface(ball, boundary=True)
    grid = subvol.rasterize(ball, resolution=16)[0]
    flow = ball.with_fields({**ball.fields, "U": ball.points})
    return {"subdivide": lambda p: subvol.subdivide(ball, 2, progress=p), "Refinement": lambda p: subvol.Refinement(ball, 2, progress=p),
            "tets": lambda p: subvol.subdivide(ball, 1, "tetoct", progress=p), "evaluate": lambda p: subvol.evaluate(ball, "density", [[0, 0, 0]], progress=p),
            "as_field": lambda p: subvol.as_field(ball, "density", progress=p), "levels": lambda p: subvol.as_field(ball, "density", levels=2, progress=p),
            "evaluate_limit": lambda p: subvol.evaluate_limit(ball, [0], [[.5, .5, .5]], progress=p), "probe": lambda p: subvol.probe(ball, at=[[0, 0, 0]], progress=p),
            "measure": lambda p: subvol.measure(ball, progress=p), "part": lambda p: subvol.measure(ball, only="half:0,0,0,1,0,0", progress=p),
            "slice": lambda p: subvol.slice(ball, point=(0, 0, 0), normal=(0, 0, 1), progress=p), "surface": lambda p: subvol.surface(ball, iso=.3, progress=p),
            "streamlines": lambda p: subvol.streamlines(flow, "U", progress=p), "check_folds": lambda p: subvol.check_folds(ball, progress=p),
            "mend_folds": lambda p: subvol.mend_folds(ball, progress=p), "mesh_difference": lambda p: subvol.mesh_difference(fine, ball, progress=p), "approximate": lambda p: subvol.approximate(ball, fine, progress=p),
            "series": lambda p: list(subvol.approximate_series(ball, [fine], progress=p)),
            "control_mesh": lambda p: subvol.control_mesh(around.points, around.triangles, cells=4, progress=p),
            "fit_shape": lambda p: subvol.fit_shape(ball, around.points, around.triangles, progress=p), "sample": lambda p: subvol.sample(ball, per_edge=2, progress=p),
            "reduce": lambda p: subvol.reduce(ball, progress=p), "points_error": lambda p: subvol.points_error(volume, ball, progress=p),
            "rasterize": lambda p: subvol.rasterize(ball, resolution=20, progress=p), "sample_grid": lambda p: subvol.sample_grid(grid, progress=p),
            "compare": lambda p: subvol.compare(ball, volume, samples=1000, progress=p),
            **{method: lambda p, method=method: subvol.render(ball, size=(32, 32), method=method, progress=p) for method in ("tets", "dense")}}


def test_each_long_call_ends_when_it_is_told_to(ball):
    class Enough(Exception):
        pass

    def stop(stage, part):
        raise Enough(stage)

    for name, call in calls(ball).items():
        try:
            call(stop)
        except Enough:
            continue
        pytest.fail(f"{name} went on")


def test_progress_must_be_callable(cube):
    for wrong in (3, "yes", [1]):
        with pytest.raises((subvol.InvalidInput, TypeError)):
            subvol.subdivide(cube, progress=wrong)


def test_true_draws_a_bar(capsys):
    subvol.subdivide(grid_of(20), 2, progress=True)
    assert "refine" in capsys.readouterr().err.lower()


def test_ctrl_c_ends_the_work():
    program = textwrap.dedent("""
        import subvol, sys
        mesh = subvol.model("ball", 24)
        print("ready", flush=True)
        try:
            for _ in range(1000):
                subvol.subdivide(mesh, 3)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
            sys.exit(7)
        """)
    running = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert running.stdout.readline() == "ready\n"
    time.sleep(0.5)
    running.send_signal(signal.SIGINT)
    out, _ = running.communicate(timeout=300)
    assert out == "interrupted\n" and running.returncode == 7


@pytest.mark.parametrize("call", ["subvol.quantity(mesh, 'grad(density)')", "subvol.quantity(mesh, 'curl(u)')", "subvol.streamlines(mesh, 'u', seed_count=2)",
                                  "grid.values(places)"])
def test_ctrl_c_ends_calls_without_progress(call):
    """Interrupted early, a call takes a part of the time that it takes in all."""
    program = textwrap.dedent(f"""
        import os, signal, subvol, sys, threading, time, warnings
        import numpy as np
        warnings.simplefilter("ignore")
        ball = subvol.model("ball", 24)
        mesh = ball.with_fields({{**ball.fields, "u": ball.points}})
        grid = subvol.rasterize(subvol.model("ball", 4), resolution=60)[0]
        places = np.random.default_rng(0).uniform(-.5, .5, (4_000_000, 3))
        begin = time.perf_counter()
        {call}
        whole = time.perf_counter() - begin
        threading.Timer(whole / 10, os.kill, (os.getpid(), signal.SIGINT)).start()
        begin = time.perf_counter()
        try:
            {call}
        except KeyboardInterrupt:
            part = time.perf_counter() - begin
            print(f"interrupted after {{part:.2f}} of {{whole:.2f}} s")
            sys.exit(7 if part < .7 * whole else 8)
        """)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=600)
    assert done.returncode == 7, done.stdout + done.stderr


def test_other_threads_run_while_one_refines():
    mesh = grid_of(24)
    ticks, stop = 0, threading.Event()

    def tick():
        nonlocal ticks
        while not stop.is_set():
            ticks += 1
            time.sleep(0.001)

    clock = threading.Thread(target=tick)
    clock.start()
    subvol.subdivide(mesh, 2)
    stop.set()
    clock.join()
    assert ticks > 2


def test_eight_threads_draw_the_same_picture(ball, ball_points):
    expected = np.asarray(subvol.render(ball_points, size=(64, 64), backend="cpu")).copy()
    exact = np.asarray(subvol.render(ball, size=(32, 32), method="tets", samples=1, look="volume")).copy()
    wrong, errors = [], []

    def draw():
        try:
            for _ in range(3):
                if not np.array_equal(np.asarray(subvol.render(ball_points, size=(64, 64), backend="cpu")), expected):
                    wrong.append("splat")
                if not np.array_equal(np.asarray(subvol.render(ball, size=(32, 32), method="tets", samples=1, look="volume")), exact):
                    wrong.append("tets")
        except BaseException as error:  # noqa: B902
            errors.append(error)

    threads = [threading.Thread(target=draw) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert errors == [] and wrong == []


def test_results_do_not_depend_on_the_number_of_threads(ball):
    def everything():
        volume = subvol.sample(ball, per_edge=2)
        return [subvol.subdivide(ball, 2).points.tobytes(), volume.frames.tobytes(),
                np.asarray(subvol.render(volume, size=(50, 50), backend="cpu")).tobytes()]

    try:
        many = everything()
        subvol.set_threads(1)
        assert everything() == many
    finally:
        subvol.set_threads(0)
    with pytest.raises(subvol.InvalidInput):
        subvol.set_threads(-1)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_child_of_a_fork_works_if_nothing_ran_before():
    program = "import os, subvol\npid = os.fork()\nmesh = subvol.subdivide(subvol.model('ball', 2))\n" \
              "os._exit(0) if pid == 0 else os._exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))"
    assert subprocess.run([sys.executable, "-c", program], timeout=120).returncode == 0
