"""apps/control_loop: targets of servos that run into obstacles are repaired in every tick."""

import csv
import pathlib
import subprocess
import sys

import mujoco
import numpy as np
import pytest

import mjcf_pdg

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "apps" / "control_loop"))

import control_loop
import filters
import governor
from robot import TIMESTEP, load


def run(*arguments):
    script = ROOT / "apps" / "control_loop" / "control_loop.py"
    return subprocess.run([sys.executable, script, *map(str, arguments)], capture_output=True, text=True, check=False)


def test_what_the_tracker_sends_to_the_servos_is_free(tmp_path):
    ticks = tmp_path / "ticks.csv"
    done = run(ROOT / "models/puma/puma_car.xml", "--ticks", 2800, "--obstacles", 12, "--csv", ticks, "--filters", "tracker")
    assert done.returncode == 0, done.stderr
    with open(ticks, newline="") as file:
        rows = list(csv.DictReader(file))
    raw, tracked = ([row for row in rows if row["filter"] == name] for name in ("raw", "tracker"))
    assert len(raw) == len(tracked) > 1700
    assert any(row["answer_free"] == "False" for row in raw)
    assert all(row["answer_free"] == "True" for row in tracked)
    assert any(float(row["error"]) > 0 for row in tracked)
    assert "tracker" in done.stdout and "100.00" in done.stdout


def test_governed_servos_touch_nothing_and_accelerate_no_harder_than_the_free_command():
    done = run(ROOT / "models/puma/puma_car.xml", "--ticks", 4000, "--filters", "raw,governed")
    assert done.returncode == 0, done.stderr
    rows = {cells[0]: cells[1:] for cells in map(str.split, done.stdout.splitlines()[2:])}
    assert float(rows["raw"][1]) > 1.0  # mm deep
    assert float(rows["raw"][4]) > 5.0  # over the free command
    assert float(rows["governed"][0]) == 100.0
    assert float(rows["governed"][1]) == 0.0
    assert float(rows["governed"][4]) <= 1.2


def test_bodies_that_are_near_at_home_keep_half_of_that_in_proportion():
    """Else no finger of the hand could move: they are nearer to each other at home than a cushion asks."""
    model, robot = load(str(ROOT / "models/hand/hand_bottle.xml"), control_loop.parse(["-", "--obstacles", "0"]))
    clearance, widest = 0.003, 0.005
    options = filters.scene_options(model, robot, clearance, widest)
    names = {name: options[name] for name in ("movable", "fixed", "exclude", "equality")}
    near: dict[tuple[str, str], float] = {}  # the least distance at home of two bodies
    for contact in mjcf_pdg.verify(model, robot.home, **names, clearance=2.0 * widest).contacts:
        bodies = filters.body_of(model, contact.geom1), filters.body_of(model, contact.geom2)
        if 0.0 < contact.distance < 2.0 * widest:
            near[bodies] = min(near.get(bodies, np.inf), contact.distance)
    assert near and set(near) == set(options["allow"])
    for bodies, distance in near.items():
        kept = clearance - options["allow"][bodies]
        assert kept == pytest.approx(0.5 * distance * clearance / widest)


@pytest.mark.parametrize("seed", range(5))
def test_a_governor_keeps_its_limits_and_stays_free_wherever_its_target_jumps(seed):
    """A point in the plane among discs; its target is free, but jumps from one side of them to another."""
    rng = np.random.default_rng(seed)
    centres, radius = rng.uniform(-1.0, 1.0, (6, 2)), 0.2
    clear = lambda q, gap: bool(np.all(np.linalg.norm(centres - q, axis=1) > radius + gap))  # noqa: E731
    free_points = [q for q in rng.uniform(-1.5, 1.5, (100, 2)) if clear(q, 0.05)]
    limits = governor.Limits(bandwidth=6.0, acceleration=3.0, speed=1.0, gap=0.02, looks=4)
    home = free_points[-1]
    governed = governor.Governor(home, np.ones((1, 2)), limits, lambda q: clear(q, 0.01))
    position, speed, travelled = home, np.zeros(2), 0.0
    for tick in range(4000):
        if tick % 250 == 0:
            target = free_points[tick // 250]
        before = position, speed
        position, speed, acceleration = governed.step(target)
        assert clear(position, 0.0), tick
        assert np.abs(acceleration).max() <= limits.acceleration * (1 + 1e-9)
        assert np.abs(speed).max() <= limits.speed * (1 + 1e-9)
        assert np.abs(speed - before[1]).max() <= limits.acceleration * TIMESTEP * (1 + 1e-6)
        assert np.abs(position - before[0]).max() <= limits.speed * TIMESTEP * (1 + 1e-6)
        travelled += np.abs(position - before[0]).sum()
    assert travelled > 1.0
    assert governed.is_free(governed.setpoint)


def test_a_governor_goes_with_a_free_command_without_lag():
    limits = governor.Limits(bandwidth=6.0, acceleration=4.0, speed=2.0, gap=0.05, looks=8)
    command = lambda t: np.array([0.5 * np.sin(2.0 * t), 0.3 * np.cos(3.0 * t)])  # noqa: E731
    governed = governor.Governor(command(0.0), np.ones((1, 2)), limits, lambda q: True)
    behind = []
    for tick in range(4000):
        now = command(tick * TIMESTEP)
        position, _, _ = governed.step(governed.lead(now))
        behind.append(np.abs(position - now).max())
    assert max(behind[1500:]) < 0.03


def test_levers_bound_how_far_geoms_move_against_each_other():
    model = mujoco.MjModel.from_xml_path(str(ROOT / "models/hand/hand_bottle.xml"))
    _, robot = load(str(ROOT / "models/hand/hand_bottle.xml"), control_loop.parse(["-"]))
    lever = governor.levers(model, robot)
    data, rng = mujoco.MjData(model), np.random.default_rng(1)
    carried = [g for g in range(model.ngeom) if control_loop.carrier(model, int(model.geom_bodyid[g]), robot.bodies)]
    tight = 0.0
    for _ in range(50):
        places, moved = [], rng.uniform(-0.2, 0.2, len(robot.dofs)) * (rng.uniform(size=len(robot.dofs)) < 0.3)
        for share in (0.0, 1.0):
            data.qpos[:] = robot.home
            data.qpos[robot.qpos] += share * moved
            mujoco.mj_kinematics(model, data)
            places.append(data.geom_xpos[carried].copy())
        farthest = np.linalg.norm(places[1] - places[0], axis=1).max()
        bound = (lever @ np.abs(moved)).max()
        assert farthest <= bound + 1e-12
        tight = max(tight, farthest / bound if bound else 0.0)
    assert tight > 0.2


def test_a_floating_base_stays_where_it_is():
    model, robot = load(str(ROOT / "models/hand/hand_bottle.xml"), control_loop.parse(["-", "--obstacles", "0"]))
    data = mujoco.MjData(model)
    data.qpos[:] = robot.home
    for _ in range(500):
        data.ctrl[robot.actuators] = robot.home[robot.qpos]
        mujoco.mj_step(model, data)
    assert np.abs(data.qpos - robot.home).max() < 1e-3


def test_a_joint_without_servo_beyond_its_limit_does_not_count():
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><body><joint name="passive" axis="0 0 1" range="-1 1" limited="true"/><geom size=".1"/>
        </body></worldbody></mujoco>"""
    )
    data, seen = mujoco.MjData(model), mujoco.MjData(model)
    data.qpos[0] = np.deg2rad(1.0) + 1e-5
    control_loop.see(model, data, seen)
    assert seen.qpos[0] == model.jnt_range[0, 1] < data.qpos[0]


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["nowhere.xml"], "nowhere.xml"),
        ([ROOT / "models/figure/figure_bench.xml"], "no position actuators"),
        ([ROOT / "models/puma/puma_car.xml", "--filters", "raw,magic"], "magic"),
        ([ROOT / "models/puma/puma_car.xml", "--ticks", 1010], "--ticks"),
        ([ROOT / "models/puma/puma_car.xml", "--error-every", 0], "--error-every"),
        ([ROOT / "models/puma/puma_car.xml", "--ticks", 1011, "--filters", "tracker", "--queries", 5], "6 queries"),
    ],
)
def test_bad_input_is_one_clear_line(arguments, word):
    done = run(*arguments)
    assert done.returncode == 2
    assert word in done.stderr and len(done.stderr.splitlines()) == 1
