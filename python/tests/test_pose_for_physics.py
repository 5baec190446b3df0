"""apps/pose_for_physics: a sketched, colliding pose bursts in a simulation, and its repair does not."""

import csv
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CHAIR = ROOT / "models/chair/figure_chair.xml"
BENCH = ROOT / "models/figure/figure_bench.xml"


def run(*arguments, script="pose_for_physics.py"):
    script = ROOT / "apps" / "pose_for_physics" / script
    environment = {**os.environ, "MUJOCO_GL": "egl"}
    command = [sys.executable, script, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


def measured(tmp_path, *arguments):
    """The rows of the table by pose and run."""
    done = run(*arguments, "--csv", tmp_path / "poses.csv")
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "poses.csv", newline="") as file:
        return {(row["pose"], row["run"]): row for row in csv.DictReader(file)}


def runs(rows, name):
    return [row for (_, run), row in rows.items() if run == name]


def test_every_repaired_pose_that_is_held_rests_and_no_sketch_does(tmp_path):
    tables = [measured(tmp_path, model) for model in (CHAIR, BENCH)]  # some names are in both
    sketched, repaired = (sum((runs(rows, name) for rows in tables), []) for name in ("sketched", "repaired"))
    assert len(sketched) == len(repaired) == 26
    assert all(float(row["force/weight"]) < 3 and float(row["speed m/s"]) < 0.5 for row in repaired)
    assert all(float(row["energy J"]) < 0.01 for row in repaired)
    assert not any(float(row["force/weight"]) <= 3 and float(row["speed m/s"]) <= 0.5 for row in sketched)
    assert all(float(row["energy J"]) > 0.5 for row in sketched)
    assert sum(float(row["force/weight"]) > 30 for row in sketched) >= 18


@pytest.mark.parametrize("contact_time", [0.001, 0.02])
def test_repaired_poses_rest_on_hard_and_soft_seats(tmp_path, contact_time):
    repaired = runs(measured(tmp_path, CHAIR, "--contact-time", contact_time), "repaired")
    assert len(repaired) == 9
    assert all(float(row["force/weight"]) < 3 and float(row["speed m/s"]) < 0.5 for row in repaired)


ROBOT = """
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.001"/>
  <worldbody>
    <body name="trunk" pos="0 0 0.7">
      <freejoint/>
      <geom type="capsule" fromto="0 0 0 0 0 0.4" size="0.1" mass="10"/>
      <body name="leg" pos="0 0.15 -0.1">
        <joint name="hip" axis="0 1 0" range="-2 1"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.5" size="0.05" mass="4"/>
      </body>
      <body name="arm" pos="0 -0.2 0.4">
        <joint name="shoulder" type="ball"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.04" mass="2"/>
        <body name="hand" pos="0 0 -0.45">
          <joint name="reach" type="slide" axis="0 0 1"/>
          <geom type="sphere" size="0.05" mass="0.5"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><position joint="hip" kp="1000"/></actuator>
  <keyframe><key name="bent" qpos="0 0 0.7  1 0 0 0  -1.5  1 0 0 0  0.1"/></keyframe>
</mujoco>
"""


def test_sketches_of_a_robot_with_other_joints_burst_and_their_repairs_rest(tmp_path):
    robot, sketches = tmp_path / "robot.xml", tmp_path / "sketches.xml"
    robot.write_text(ROBOT)
    done = run(robot, "--out", sketches, "--count", 10, script="make_sketches.py")
    assert done.returncode == 0, done.stderr
    rows = measured(tmp_path, sketches)
    sketched, repaired = runs(rows, "sketched"), runs(rows, "repaired")
    assert len(sketched) == len(repaired) == 10
    assert all(float(row["force/weight"]) < 3 and float(row["speed m/s"]) < 0.5 for row in repaired)
    assert not any(float(row["force/weight"]) <= 3 and float(row["speed m/s"]) <= 0.5 for row in sketched)


def test_servos_hold_a_robot_where_its_actuators_would_draw_it_elsewhere(tmp_path):
    robot = tmp_path / "robot.xml"
    robot.write_text(ROBOT)
    [row] = measured(tmp_path, robot).values()
    assert row["run"] == "free"
    assert 0 < float(row["moved mm"]) < 15  # its actuator would turn the leg by 1.5 rad


@pytest.mark.parametrize(
    ("model", "word"),
    [
        (ROOT / "models/puma/puma_car.xml", "no free base"),
        ("nowhere.xml", "nowhere.xml"),
    ],
)
def test_sketches_of_what_cannot_sit_are_refused_in_one_line(tmp_path, model, word):
    done = run(model, "--out", tmp_path / "sketches.xml", script="make_sketches.py")
    assert done.returncode == 2
    assert word in done.stderr and "Traceback" not in done.stderr
    assert not (tmp_path / "sketches.xml").exists()


def test_a_repair_is_balanced_where_the_seat_carries_it(tmp_path):
    rows = measured(tmp_path, CHAIR, "--free-pelvis", "--key", "home", "--key", "sunk_to_waist")
    assert set(rows) == {("home", "free"), ("sunk_to_waist", "sketched"), ("sunk_to_waist", "repaired")}
    sketched, repaired = rows["sunk_to_waist", "sketched"], rows["sunk_to_waist", "repaired"]
    assert float(sketched["force/weight"]) > 100 and float(sketched["energy J"]) > 100
    assert 0.99 < float(repaired["force/weight"]) < 1.5  # seat and floor hold it up, and no more than that
    assert float(repaired["speed m/s"]) < 0.5 and float(repaired["energy J"]) < 0.1
    assert 0 < float(repaired["moved mm"]) < float(sketched["moved mm"])


def test_without_gravity_only_penetration_moves_the_figure(tmp_path):
    rows = measured(tmp_path, CHAIR, "--weightless")
    sketched, repaired = runs(rows, "sketched"), runs(rows, "repaired")
    assert len(sketched) == len(repaired) == 9
    assert all(float(row["speed m/s"]) > 0.2 and float(row["energy J"]) > 0.5 for row in sketched)
    assert all(float(row["speed m/s"]) < 0.01 and float(row["force/weight"]) < 0.01 for row in repaired)


def test_plot_and_animation_are_written(tmp_path):
    for package in ("matplotlib", "PIL", "OpenGL"):
        pytest.importorskip(package)
    from PIL import Image

    png, gif = tmp_path / "runs.png", tmp_path / "runs.gif"
    done = run(CHAIR, "--key", "sunk_to_waist", "--png", png, "--gif", gif)
    assert done.returncode == 0, done.stderr
    with Image.open(png) as image:
        assert min(image.size) > 400
    with Image.open(gif) as animation:
        assert animation.n_frames == 51  # of 20 ms of the simulation each, and the first pose


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["nowhere.xml"], "nowhere.xml"),
        ([CHAIR, "--key", "no_such_pose"], "no_such_pose"),
        ([CHAIR, "--gains", "-1"], "--gains"),
        ([CHAIR, "--contact-time", "0"], "--contact-time"),
        ([ROOT / "models/loops/leg.xml"], "no keyframes"),
    ],
)
def test_bad_input_is_one_clear_line(arguments, word):
    done = run(*arguments)
    assert done.returncode == 2
    assert word in done.stderr and "Traceback" not in done.stderr
