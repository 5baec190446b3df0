"""MuJoCo's passive viewer with the ghost: what is drawn, on a display in memory, and where there is none."""

import os
import pathlib
import shutil
import subprocess
import sys

import mujoco
import numpy as np
import pytest

import mjcf_pdg
from mjcf_pdg import _view

# A ball before a wall, from which it can back off along x, and a post that stays.
SCENE = """<mujoco><statistic center="0 0 0" extent="1"/><visual><global azimuth="90" elevation="0"/></visual>
<worldbody><light pos="0 -2 2" dir="0 1 -1"/><geom name="wall" type="box" size=".1 .5 .5" pos=".5 0 0"/>
<body name="ball"><joint name="x" type="slide" axis="1 0 0"/><geom name="ball" size=".2"/></body>
<body name="post" pos="-.8 0 0"><joint type="hinge"/><geom name="post" size=".1"/></body></worldbody></mujoco>"""

# Runs beside a display: argv[1] is the file of its screen.
PROGRAM = f"""
import sys, mujoco, numpy as np, mjcf_pdg

def blue_and_orange():
    words = np.fromfile(sys.argv[1], dtype=">u4", count=25)
    begin = words[0] + 12 * words[19]
    pixels = np.fromfile(sys.argv[1], dtype=np.uint8)[begin : begin + words[12] * words[5]]
    b, g, r = pixels.reshape(words[5], -1, 4)[..., :3].astype(int).transpose(2, 0, 1)
    return ((b > 80) & (b > 2 * r)).sum(), ((r > 110) & (r > 2 * b) & (g < r)).sum()

model = mujoco.MjModel.from_xml_string('''{SCENE}''')
data = mujoco.MjData(model)
with mjcf_pdg.view(model, data, show_left_ui=False, show_right_ui=False) as view:
    assert view.is_running() and view.result is None
    free = view.sync()
    assert free.status == "already_free" and view.viewer.user_scn.ngeom == 0
    for k in range(2000):
        data.qpos[0] = min(0.35, 0.01 * k)
        mujoco.mj_forward(model, data)
        result = view.sync()
        assert mjcf_pdg.verify(model, result.q).free
        blue, orange = blue_and_orange()
        if data.qpos[0] > 0.3 and blue > 1000 and orange > 1000:
            break
    assert result.status == "solved" and abs(result.q[0] - 0.2) < 1e-5, result
    assert view.viewer.user_scn.ngeom == 3, view.viewer.user_scn.ngeom  # ball and wall, and the ball's ghost
    print("blue", blue, "orange", orange)
"""


def test_the_ghost_is_blue_and_what_overlaps_is_orange():
    model = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(model)
    data.qpos[:] = [0.35, 0.7]
    result = mjcf_pdg.Tracker(model, report_contacts=True).step(data.qpos)
    before = model.geom_rgba.copy(), data.qpos.copy()
    scene = mujoco.MjvScene(model, 100)
    _view.GhostScene(model).draw(scene, data, result)
    drawn = {(geom.objid, round(float(geom.rgba[0]), 2)): geom for geom in scene.geoms[: scene.ngeom]}
    ball, wall = model.geom("ball").id, model.geom("wall").id
    assert sorted(drawn) == [(wall, 0.95), (ball, 0.05), (ball, 0.95)]  # the post has not moved
    ghost = drawn[(ball, 0.05)]
    assert ghost.rgba == pytest.approx([0.05, 0.3, 0.9, 0.6])
    assert ghost.pos == pytest.approx([0.2, 0, 0], abs=1e-5)
    assert drawn[(ball, 0.95)].pos == pytest.approx([0.35, 0, 0])
    assert np.array_equal(model.geom_rgba, before[0]) and np.array_equal(data.qpos, before[1])

    data.qpos[0] = 0.0
    _view.GhostScene(model).draw(scene, data, mjcf_pdg.Tracker(model).step(data.qpos))
    assert scene.ngeom == 0


def test_without_a_display_there_is_an_exception():
    pytest.importorskip("glfw")
    code = (
        "import mujoco, mjcf_pdg\n"
        f"model = mujoco.MjModel.from_xml_string('''{SCENE}''')\n"
        "try:\n    mjcf_pdg.view(model, mujoco.MjData(model))\n"
        "except RuntimeError as error:\n    print(error)\n"
    )
    bare = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=bare, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("no window: there is no display"), done.stdout + done.stderr


def test_bad_options_are_refused_before_a_window_opens(ball):
    with pytest.raises(ValueError, match="no option 'gain'"):
        mjcf_pdg.view(ball, mujoco.MjData(ball), gain=1.0)


def test_the_ghost_follows_on_a_display(tmp_path: pathlib.Path):
    pytest.importorskip("glfw")
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is not installed")
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x768x24", "-fbdir", tmp_path, "-nolisten", "tcp"],
        pass_fds=[write],
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    try:
        with os.fdopen(read) as number:
            display = ":" + number.readline().strip()
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, tmp_path / "Xvfb_screen0"],
            capture_output=True,
            text=True,
            env=os.environ | {"DISPLAY": display},
            timeout=300,
        )
    finally:
        server.kill()
        server.wait()
    assert done.returncode == 0, done.stderr
    print(done.stdout)
