"""The package gives the bytes that the program gives: MJCF_PDG_CLI names it (default: build/bin/mjcf-pdg)."""

import json
import os
import pathlib
import subprocess

import mujoco
import numpy as np
import pytest
from conftest import MODELS

import mjcf_pdg

ROOT = MODELS.parent
PROGRAM = pathlib.Path(os.environ.get("MJCF_PDG_CLI", ROOT / "build" / "bin" / "mjcf-pdg"))
SCENES = ["puma/puma_car.xml", "hand/hand_bottle.xml", "figure/figure_bench.xml"]
EXACT = ["rigid/spoon_cup.xml", "rigid/nut_on_bolt.xml"]

pytestmark = pytest.mark.skipif(
    "MJCF_PDG_CLI" not in os.environ and not PROGRAM.exists(), reason=f"{PROGRAM} is not built"
)


def ask(*arguments: str) -> list[dict]:
    """The JSON lines of a call of the program."""
    run = subprocess.run([PROGRAM, *arguments, "--json", "-"], capture_output=True, text=True)
    assert run.returncode in (0, 3), run.stderr
    return [json.loads(line) for line in run.stdout.splitlines()]


def load(scene: str) -> tuple[mujoco.MjModel, str]:
    path = str(MODELS / scene)
    return mujoco.MjModel.from_xml_path(path), path


def assert_same(result: mjcf_pdg.Result, line: dict) -> None:
    assert result.q.tobytes() == np.array(line["qpos"]).tobytes()
    for name in ("status", "sigma", "rms", "sigma_lower_bound", "depth_in", "min_distance", "start", "certified",
                 "proven", "iterations"):
        assert getattr(result, name) == line[name], name
    assert result.queries == line["collision_queries"]
    assert (result.reason, result.cause) == (line.get("reason", ""), line.get("cause", ""))
    for mine, theirs in ((result.contacts_in, line["contacts_in"]), (result.contacts, line["contacts"])):
        assert len(mine) == len(theirs)
        for contact, other in zip(mine, theirs):
            assert (contact.geom1, contact.geom2) == (other["geom1"], other["geom2"])
            assert contact.distance == other["distance"]
            assert contact.normal.tolist() == other["normal"] and contact.position.tolist() == other["position"]


@pytest.mark.parametrize("scene", SCENES)
def test_keyframes_give_the_same_bytes(scene):
    model, path = load(scene)
    lines = ask("solve", path)
    solver = mjcf_pdg.Solver(model)
    assert len(lines) == model.nkey > 10
    for key, line in enumerate(lines):
        assert_same(solver.solve(model.key_qpos[key]), line)
    rows = mjcf_pdg.solve(model, model.key_qpos, threads=2)
    assert [row.tobytes() for row in rows.q] == [np.array(line["qpos"]).tobytes() for line in lines]
    for column, name in ((rows.sigma, "sigma"), (rows.depth_in, "depth_in"), (rows.min_distance, "min_distance"),
                         (rows.status, "status"), (rows.start, "start"), (rows.queries, "collision_queries")):
        assert column.tolist() == [line[name] for line in lines], name


@pytest.mark.parametrize("scene", EXACT)
def test_exact_meshes_give_the_same_bytes(scene):
    model, path = load(scene)
    lines = ask("solve", path, "--exact-mesh", "--effort", "fast")
    rows = model.key_qpos if model.nkey else model.qpos0[None]
    assert len(lines) == len(rows)
    for q, line in zip(rows, lines):
        assert_same(mjcf_pdg.solve(model, q, exact_mesh=True, effort="fast"), line)


@pytest.mark.parametrize("options", [
    {"effort": "fast", "seed": 7}, {"metric": "displacement", "clearance": 0.002}, {"method": "paper"},
    {"movable": "link1", "tolerance": 1e-5}, {"root": "link6", "rest": 0.03}, {"trajectory": True},
])
def test_options_mean_the_same(options):
    model, path = load("puma/puma_car.xml")
    flags = []
    for name, value in options.items():
        flags += ["--" + name] if value is True else ["--" + name, str(value)]
    lines = ask("solve", path, *flags)
    results = mjcf_pdg.solve(model, model.key_qpos, **options)
    assert [row.tobytes() for row in results.q] == [np.array(line["qpos"]).tobytes() for line in lines]
    assert results.sigma.tolist() == [line["sigma"] for line in lines]


def test_norm_check_and_motion_are_the_same():
    model, path = load("hand/hand_bottle.xml")
    q0, q1 = model.key("home").qpos, model.key("tight_grasp").qpos
    ends = ("--from", " ".join(map(repr, q0.tolist())), "--to", " ".join(map(repr, q1.tolist())))
    assert mjcf_pdg.object_norm(model, q0, q1, root="palm") == ask("norm", path, *ends, "--root", "palm")[0]["sigma"]
    (line,) = ask("check", path, "--motion", *ends)
    motion = mjcf_pdg.check_motion(model, q0, q1)
    assert (motion.outcome, motion.t, motion.q.tolist()) == (line["outcome"], line["t"], line["qpos"])
    assert motion.pairs == [(pair["geom1"], pair["geom2"]) for pair in line["pairs"]] != []
    assert (motion.poses, motion.distance_queries) == (line["poses"], line["distance_queries"])
    (line,) = ask("check", path, "--key", "tight_grasp")
    verdict = mjcf_pdg.verify(model, q1)
    assert (verdict.free, verdict.min_distance, verdict.reason) == (False, line["min_distance"], line["reason"])
    assert [c.distance for c in verdict.contacts] == [c["distance"] for c in line["contacts"]] != []


def test_audit_is_the_same():
    model, path = load("puma/puma_car.xml")
    (line,) = ask("audit", path, "--samples", "50", "--seed", "3")
    report = mjcf_pdg.audit(model, samples=50, seed=3)
    assert list(report) == list(line)
    assert {**report, "model": None} == {**line, "model": None}
