#!/usr/bin/env python3
"""Makes database.json: vessels, generated from a seed, and for each the best grasp of our hand that was found.

    python3 apps/grasp_transfer/make_database.py        # one or two minutes

A palm is put beside the vessel at random, with straight fingers, which close until they touch; what then passes the
lift test is a grasp. The best of three is the one that passes it most often when the open hand is first moved a few
millimetres, and slips least. PDg has no part in this.
"""

import argparse
import concurrent.futures
import dataclasses
import json
import pathlib

import mujoco
import numpy as np

import mjcf_pdg

from closing import close_hand
from lift import lift
from scene import for_lift, for_repair
from vessels import Vessel, outside, random_bottle, random_cup

DATABASE = pathlib.Path(__file__).resolve().parent / "database.json"
SEED, CUPS, BOTTLES = 0, 4, 2
SAMPLES = 50  # free palm poses that are tried for a vessel
GRASPS = 3  # the search ends when so many have passed the lift test
DISTURBED, NOISE = 3, 0.003  # hands moved; standard deviation of that, each way [m]


def random_palm(model: mujoco.MjModel, vessel: Vessel, rng: np.random.Generator) -> np.ndarray:
    """A palm that faces the vessel, thumb up, with straight fingers, the thumb anywhere."""
    z = rng.uniform(0.04, min(0.11, vessel.height))
    tilt = rng.normal(0.0, [0.25, 0.25, 0.3])  # rotation vector in the palm's frame [rad]
    # Where the vessel's axis is in that frame: before the knuckles, 15 to 35 mm between middle of the palm and wall.
    axis = [rng.uniform(0.06, 0.115), rng.uniform(-0.03, 0.03), -rng.uniform(0.015, 0.035) - float(outside(vessel, z))]
    turn, upright, small, p_W = np.zeros(4), np.array([1.0, 1.0, 0.0, 0.0]) / np.sqrt(2), np.zeros(4), np.zeros(3)
    mujoco.mju_axisAngle2Quat(small, tilt / np.linalg.norm(tilt), np.linalg.norm(tilt))
    mujoco.mju_mulQuat(turn, upright, small)
    mujoco.mju_rotVecQuat(p_W, np.array(axis), turn)
    q = np.zeros(model.nq)
    q[:3] = np.array([0.0, 0.0, z]) - p_W
    q[3:7] = turn
    q[model.joint("thumb_cmc").qposadr] = rng.uniform(*model.joint("thumb_cmc").range)
    return q


def quality(
    solver: mjcf_pdg.Solver, model: mujoco.MjModel, simulated: mujoco.MjModel, q: np.ndarray, rng: np.random.Generator
) -> tuple[int, float]:
    """Of DISTURBED open hands near q that close: how many lifts hold, and minus the mean slip [m]."""
    lifts = []
    for _ in range(DISTURBED):
        moved = q.copy()
        moved[:3] += rng.normal(0.0, NOISE, 3)
        if solver.is_free(moved):
            lifts.append(lift(simulated, close_hand(model, moved)))
    return sum(each.holds for each in lifts), -float(np.mean([each.slip for each in lifts])) if lifts else -np.inf


def best_grasp(vessel: Vessel, rng: np.random.Generator) -> np.ndarray:
    model, simulated = for_repair(vessel), for_lift(vessel)
    solver = mjcf_pdg.Solver(model, exact_mesh=True, root="palm")
    grasps, tried = [], 0
    while tried < SAMPLES and len(grasps) < GRASPS:
        q = random_palm(model, vessel, rng)
        if not solver.is_free(q):
            continue
        tried += 1
        grasp = close_hand(model, q)
        if lift(simulated, grasp).holds:
            grasps.append((quality(solver, model, simulated, q, rng), grasp))
    if not grasps:
        raise RuntimeError(f"no grasp found in {SAMPLES} samples of {vessel}")
    return max(grasps, key=lambda grasp: grasp[0])[1]


def entry(k: int) -> dict:
    rng = np.random.default_rng([SEED, k])
    vessel = random_cup(rng) if k < CUPS else random_bottle(rng)
    q = np.round(best_grasp(vessel, rng), 9)
    return {**dataclasses.asdict(vessel), "q": q.tolist()}


def main() -> None:
    argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__.splitlines()[0]).parse_args()
    with concurrent.futures.ProcessPoolExecutor() as pool:
        entries = list(pool.map(entry, range(CUPS + BOTTLES)))
    DATABASE.write_text("[\n" + ",\n".join(json.dumps(each) for each in entries) + "\n]\n")


if __name__ == "__main__":
    main()
