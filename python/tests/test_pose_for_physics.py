"""apps/pose_for_physics: a sketched, colliding pose bursts in a simulation, and its repair does not."""

import csv
import os
import pathlib
import subprocess
import sys

import mujoco
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


def in_bounds(row):
    return float(row["force/weight"]) <= 3 and float(row["speed m/s"]) <= 0.5


def test_every_repaired_pose_that_is_held_rests_and_every_sketch_exceeds_a_bound_tenfold(tmp_path):
    tables = [measured(tmp_path, model) for model in (CHAIR, BENCH)]  # some names are in both
    sketched, repaired = (sum((runs(rows, name) for rows in tables), []) for name in ("sketched", "repaired"))
    assert len(sketched) == len(repaired) == 26
    assert all(in_bounds(row) for row in repaired)
    assert all(float(row["energy J"]) < 0.01 for row in repaired)
    assert all(float(row["energy J"]) > 10 for row in sketched)
    assert all(max(float(row["force/weight"]) / 3, float(row["speed m/s"]) / 0.5) > 10 for row in sketched)
    assert sum(float(row["force/weight"]) > 30 for row in sketched) == 25


@pytest.mark.parametrize(
    "arguments", [["--contact-time", "0.001"], ["--contact-time", "0.02"], ["--gains", "0.25"], ["--gains", "4"]]
)
def test_repaired_poses_rest_whatever_the_contacts_and_servos(tmp_path, arguments):
    repaired = runs(measured(tmp_path, CHAIR, *arguments), "repaired")
    assert len(repaired) == 9
    assert all(in_bounds(row) for row in repaired)


def test_repaired_poses_rest_by_whatever_integrator_the_model_names(tmp_path):
    """With Runge and Kutta's servos as stiff as these explode."""
    spec = mujoco.MjSpec.from_file(str(CHAIR))
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.meshdir = str((CHAIR.parent / spec.meshdir).resolve())
    model = tmp_path / "chair.xml"
    spec.compile()
    model.write_text(spec.to_xml())
    rows = measured(tmp_path, model, "--key", "sunk_to_waist", "--key", "legs_crossed")
    assert len(rows) == 4 and all(in_bounds(row) for row in runs(rows, "repaired"))


ROBOT = """
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.001"%s/>
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


def robot(tmp_path, option="", **replaced):
    """A file with ROBOT, with an attribute of its option and with other texts in place of some."""
    text = ROBOT % option
    for old, new in replaced.values():
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "robot.xml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("option", ["", ' gravity="0 -9.81 0"'])
def test_sketches_of_a_robot_with_other_joints_burst_and_their_repairs_rest(tmp_path, option):
    sketches = tmp_path / "sketches.xml"
    done = run(robot(tmp_path, option), "--out", sketches, "--count", 10, script="make_sketches.py")
    assert done.returncode == 0, done.stderr
    rows = measured(tmp_path, sketches)
    sketched, repaired = runs(rows, "sketched"), runs(rows, "repaired")
    assert len(sketched) == len(repaired) == 10
    assert all(in_bounds(row) for row in repaired)
    assert not any(in_bounds(row) for row in sketched)


PULLED = {
    "actuator": ("<actuator>", "<actuator>"),
    "spring": ('name="hip" axis', 'name="hip" stiffness="1000" springref="1" axis'),
    "tendon": (
        "<actuator>",
        '<tendon><fixed stiffness="1000" springlength="1"><joint joint="hip" coef="1"/></fixed></tendon><actuator>',
    ),
    "mocap": (
        "</worldbody>",
        '<body name="hand_that_pulls" mocap="true" pos="0 0 1"/></worldbody>'
        '<equality><weld body1="hand_that_pulls" body2="trunk" relpose="0 0 0 1 0 0 0"/></equality>',
    ),
}


@pytest.mark.parametrize("by", PULLED)
def test_servos_hold_a_robot_that_its_model_would_pull_elsewhere(tmp_path, by):
    [row] = measured(tmp_path, robot(tmp_path, pulled=PULLED[by])).values()
    assert row["run"] == "free"
    assert 0 < float(row["moved mm"]) < 5  # the actuator alone would turn the leg by 1.5 rad


def test_mocap_bodies_are_where_the_keyframe_says(tmp_path):
    """A table that the model has elsewhere."""
    table = '<body name="table" mocap="true" pos="5 0 0"><geom type="box" size="0.2 0.2 0.05"/></body></worldbody>'
    moved = robot(tmp_path, table=("</worldbody>", table), key=('  0.1"/>', '  0.1" mpos="0 0 0.6"/>'))
    rows = measured(tmp_path, moved)
    assert float(rows["bent", "sketched"]["force/weight"]) > 3
    assert in_bounds(rows["bent", "repaired"])


def test_repairs_keep_the_margins_within_which_contacts_push(tmp_path):
    """A seat under the trunk whose contacts begin 1 cm above it: in touch with it the trunk would be thrown off."""
    seat = '<geom type="box" size="0.3 0.3 0.05" pos="0 0 0.58" margin="0.01"/></worldbody>'
    rows = measured(tmp_path, robot(tmp_path, seat=("</worldbody>", seat)))
    assert float(rows["bent", "sketched"]["force/weight"]) > 30
    assert in_bounds(rows["bent", "repaired"])


def test_sketches_have_no_keyframes_but_their_own(tmp_path):
    """The robot announces seven and has one: MuJoCo would fill them up with its reference pose."""
    announced = robot(tmp_path, size=("<worldbody>", '<size nkey="7"/><worldbody>'))
    sketches = tmp_path / "sketches.xml"
    done = run(announced, "--out", sketches, "--count", 2, script="make_sketches.py")
    assert done.returncode == 0, done.stderr
    model = mujoco.MjModel.from_xml_path(str(sketches))
    assert [model.key(k).name for k in range(model.nkey)] == ["sketch_0", "sketch_1"]


def test_a_pose_that_only_violates_a_limit_is_no_sketch(tmp_path):
    rows = measured(tmp_path, robot(tmp_path, pose=("0 0 0.7  1 0 0 0  -1.5", "0 0 0.7  1 0 0 0  1.2")))
    assert set(rows) == {("bent", "repaired")}


def test_an_unsolved_pose_is_told_as_that(tmp_path):
    welded = (
        "</worldbody>",
        """<body pos="0 0 3"><geom size="0.1"/><joint/>
        <body><joint axis="1 0 0"/><geom size="0.1" pos="0 0 0.05"/><body><joint/><geom size="0.2"/></body></body>
        </body></worldbody>""",
    )
    text = robot(tmp_path, pose=('  0.1"/></keyframe>', '  0.1  0 0 0"/></keyframe>'), stuck=welded)
    rows = measured(tmp_path, text)
    assert set(rows) == {("bent", "sketched"), ("bent", "unsolved")}


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
    assert word in done.stderr and len(done.stderr.splitlines()) == 1
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
        ([CHAIR, "--png", "plot.pdf"], ".png"),
        ([CHAIR, "--key", "home", "--csv", "/nowhere/poses.csv"], "/nowhere/poses.csv"),
        ([CHAIR, "--png", "/nowhere/plot.png"], "--png: /nowhere/plot.png"),
    ],
)
def test_bad_input_is_one_clear_line(arguments, word):
    done = run(*arguments)
    assert done.returncode == 2
    assert word in done.stderr and len(done.stderr.splitlines()) == 1
