"""apps/grasp_transfer: grasps moved to new cups are freed, fingers stay in contact, and a lift tells what holds."""

import csv
import os
import pathlib
import subprocess
import sys

import mujoco
import numpy as np
import pytest

import mjcf_pdg

APP = pathlib.Path(__file__).resolve().parents[2] / "apps" / "grasp_transfer"


@pytest.fixture(scope="module")
def app():
    """The app's modules by name, without leaving its folder on the path."""
    sys.path.insert(0, str(APP))
    try:
        import grasp_transfer
        import lift
        import scene
        import vessels
    finally:
        sys.path.remove(str(APP))
    return {"grasp_transfer": grasp_transfer, "lift": lift, "scene": scene, "vessels": vessels}


def run(*arguments):
    command = [sys.executable, APP / "grasp_transfer.py", *map(str, arguments)]
    environment = {**os.environ, "MUJOCO_GL": "egl"}
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


def signed_volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.sum(a * np.cross(b, c))) / 6


@pytest.mark.parametrize("kind", ["cup", "bottle"])
def test_triangles_and_convex_pieces_are_the_same_solid(app, kind):
    vessels, scene = app["vessels"], app["scene"]
    rng = np.random.default_rng(0)
    for _ in range(5):
        vessel = getattr(vessels, f"random_{kind}")(rng)
        vertices, faces = vessels.triangles(vessel)
        edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        assert {tuple(edge) for edge in edges} == {tuple(edge[::-1]) for edge in edges}  # closed, faces agree
        body = scene.for_lift(vessel).body("vessel")
        assert body.mass[0] == pytest.approx(vessel.density * signed_volume(vertices, faces), rel=1e-5)
        assert max(np.ptp(piece[:, 2]) for piece in vessels.pieces(vessel)) <= vessel.height


def test_difference_of_cylinders_is_that_of_their_radii(app):
    vessels = app["vessels"]

    def cylinder(radius, height):
        return vessels.Vessel("cup", ((radius, 0.0), (radius, height)), 0.003)

    assert vessels.difference(cylinder(0.03, 0.1), cylinder(0.035, 0.1)) == pytest.approx(0.005)
    # Above the shorter one there is nothing: half of the height differs by the whole radius.
    assert vessels.difference(cylinder(0.03, 0.1), cylinder(0.03, 0.05)) == pytest.approx(0.03 / np.sqrt(2), rel=0.01)
    assert vessels.excess(cylinder(0.03, 0.1), cylinder(0.035, 0.2)) == pytest.approx(-0.005)


def test_the_databases_grasps_are_free_and_fingers_touch(app):
    grasps = app["grasp_transfer"].read_database()
    assert {grasp.vessel.kind for grasp in grasps} == {"cup", "bottle"}
    for grasp in grasps:
        assert mjcf_pdg.verify(app["scene"].for_repair(grasp.vessel), grasp.q, exact_mesh=True)
        assert len(app["scene"].touching_fingers(app["scene"].for_lift(grasp.vessel), grasp.q)) >= 3


def test_repaired_grasps_are_free_and_fingers_stay_in_contact(app):
    """On six cups, by the independent verifier; no lifts, which take the time."""
    transfer, scene = app["grasp_transfer"], app["scene"]
    database = transfer.read_database()
    rng = np.random.default_rng(5)
    solved = 0
    for cup in [app["vessels"].random_cup(rng) for _ in range(6)]:
        model, simulated = scene.for_repair(cup), scene.for_lift(cup)
        q = transfer.most_similar(database, cup, any_width=False)[0].q
        options = {"exact_mesh": True, "allow": transfer.allowed(model)}
        result = mjcf_pdg.solve(model, q, root="palm", **options)
        assert mjcf_pdg.verify(model, result.q, **options)
        raw, repaired = (scene.touching_fingers(simulated, pose) for pose in (q, result.q))
        if result.status == "solved":
            solved += 1
            assert not mjcf_pdg.verify(model, q, **options)
            assert repaired and len(raw & repaired) >= len(raw) - 1
    assert solved >= 3


def test_a_vessel_in_no_hand_stays_on_the_table(app):
    """A hand far from the cup lifts nothing; and the force on the cup is its weight, once it stands."""
    vessel = app["vessels"].random_cup(np.random.default_rng(0))
    model = app["scene"].for_lift(vessel)
    q = model.qpos0[: app["scene"].HAND_NQ].copy()
    q[1] -= 0.3
    made = app["lift"].lift(model, q)
    assert not made.holds and abs(made.rise) < 0.001
    assert made.force == pytest.approx(model.body("vessel").mass[0] * 9.81, rel=0.2)


@pytest.mark.parametrize(
    ("rise", "slip", "overlap", "holds"),
    [
        (0.1, 0.02, 1e-4, True),
        (0.079, 0.02, 1e-4, False),  # slipped
        (0.1, 2.0, 0.0, False),  # thrown
        (0.1, 0.02, 2e-3, False),  # a finger is in the wall
    ],
)
def test_a_cup_that_holds_is_up_in_the_hand_and_outside_the_fingers(app, rise, slip, overlap, holds):
    assert app["lift"].Lift(np.zeros((1, 0)), rise, slip, 20.0, overlap, force=100.0).holds == holds


@pytest.mark.parametrize("height", [0.005, 0.01, 0.03])
def test_what_is_dropped_keeps_half_of_its_speed(app, height):
    """Contacts of the lift neither swallow the energy of an overlap nor add to it. (The time step makes some noise.)"""
    contacts = app["scene"].Contacts()
    solref = " ".join(map(str, contacts.solref))
    xml = f"""<mujoco><default><geom solref="{solref}"/></default><worldbody><geom type="plane" size="1 1 1"/>
        <body pos="0 0 {0.02 + height}"><freejoint/><geom size="0.02" mass="0.1"/></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    model.opt.timestep = contacts.timestep
    data, v = mujoco.MjData(model), []
    while data.time < 1.5 * np.sqrt(2 * height / 9.81):
        mujoco.mj_step(model, data)
        v.append(data.qvel[2])
    assert max(v) / -min(v) == pytest.approx(0.52, abs=0.04)


def test_tallies_add_up_and_a_seed_gives_the_same_cups(tmp_path):
    tables = []
    for cups in (1, 2):
        done = run("--cups", cups, "--seed", 3, "--frequency", 1000, "--csv", tmp_path / "grasps.csv")
        assert done.returncode == 0, done.stderr
        with open(tmp_path / "grasps.csv", newline="") as file:
            tables.append([{key: value for key, value in row.items() if key != "ms"} for row in csv.DictReader(file)])
    assert tables[0] == tables[1][:2]
    assert [(row["cup"], row["run"]) for row in tables[1]] == [(k, run) for k in "01" for run in ("raw", "repaired")]
    for name in ("raw", "repaired"):
        chosen = [row for row in tables[1] if row["run"] == name]
        holds = [row for row in chosen if row["holds"] == "yes"]
        line = next(line for line in done.stdout.splitlines() if line.strip().startswith(f"{name}  in contact"))
        assert f"hold {len(holds)};" in line
        assert all(float(row["rise mm"]) >= 80 and float(row["overlap mm"]) <= 1 for row in holds)
    assert "148 ms" in done.stdout


def test_repaired_grasps_lift_cups_and_most_raw_ones_do_not(tmp_path):
    """How many times as many is for hundreds of cups to say: docs/grasps.md."""
    done = run("--cups", 8, "--seed", 11, "--csv", tmp_path / "grasps.csv")
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "grasps.csv", newline="") as file:
        holding = [row["run"] for row in csv.DictReader(file) if row["holds"] == "yes"]
    assert holding.count("repaired") >= 7 and holding.count("raw") <= 2, holding


def test_the_most_similar_vessel_is_nowhere_wider_if_there_is_one(app):
    transfer, vessels = app["grasp_transfer"], app["vessels"]

    def cylinder(radius):
        return vessels.Vessel("cup", ((radius, 0.0), (radius, 0.1)), 0.003)

    database = [transfer.Grasp(cylinder(radius), np.zeros(0)) for radius in (0.03, 0.041)]
    narrow, wide = database
    assert transfer.most_similar(database, cylinder(0.04), any_width=False) == (narrow, True)
    assert transfer.most_similar(database, cylinder(0.04), any_width=True) == (wide, True)
    assert transfer.most_similar(database, cylinder(0.02), any_width=False) == (narrow, False)


def test_plot_and_animation_are_written(tmp_path):
    for package in ("matplotlib", "PIL", "OpenGL"):
        pytest.importorskip(package)
    from PIL import Image

    png, gif = tmp_path / "grasps.png", tmp_path / "grasps.gif"
    done = run("--cups", 1, "--seed", 3, "--frequency", 500, "--png", png, "--gif", gif)
    assert done.returncode == 0, done.stderr
    with Image.open(png) as image:
        assert min(image.size) > 400
    with Image.open(gif) as animation:
        assert animation.n_frames == 50


@pytest.mark.parametrize(
    "arguments",
    [
        ["--cups", "0"],
        ["--seed", "-1"],
        ["--damping-ratio", "0"],
        ["--frequency", "5"],
        ["--csv", "/nowhere/grasps.csv"],
        ["--png", "grasps.pdf"],
    ],
)
def test_bad_input_is_one_clear_line(arguments):
    done = run(*arguments)
    assert done.returncode == 2 and arguments[0] in done.stderr and len(done.stderr.splitlines()) == 1
