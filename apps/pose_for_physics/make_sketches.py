#!/usr/bin/env python3
"""Writes random colliding poses of a robot of your own in a chair, as keyframes for pose_for_physics.py.

    python3 apps/pose_for_physics/make_sketches.py my_robot.xml --out sketches.xml
    python3 apps/pose_for_physics/pose_for_physics.py sketches.xml

The robot needs a free base. Floor, seat and back are as large as its height asks for. A pose has its base at random
over, in or beside the seat, and each joint at random about its angle in the model; of these the first in which geoms
overlap are kept, with the chair or with each other. The scene that is written names its meshes by absolute paths, and
leaves out the keyframes of the robot.
"""

import argparse
import pathlib
import sys

import mujoco
import numpy as np

import mjcf_pdg

from simulation import moving

# In heights of the robot: the seat's thickness and half width, as of a chair for a person, and how far a base is from
# the middle of the seat at most, each way, and above it.
SEAT, HALF_WIDTH, ASIDE, ABOVE = 0.25, 0.2, 0.1, 0.2
TURNED = 0.2  # standard deviation of a base's rotation about a random axis [rad]
SPREAD = 0.125  # standard deviation of a joint over its range
UNLIMITED = 4.0  # the range of a joint without one [rad or m]
EVERYTHING = 2**31 - 1  # a contact mask that meets any other
TOUCHING = 1e-6  # what overlaps by less is free [m], as in mjcf_pdg.solve
MOST_TRIED = 100  # random poses for each that is asked for


def furnish(spec: mujoco.MjSpec, source: pathlib.Path) -> float:
    """Adds floor and chair, whatever the model's defaults say of geoms; returns the robot's height [m]."""
    for name in ("meshdir", "texturedir"):
        setattr(spec, name, str((source.parent / (getattr(spec, name) or ".")).resolve()))
    for key in list(spec.keys):
        spec.delete(key)
    spec.nkey = 0  # else unnamed keyframes stand for those that <size nkey> announced
    unit = height(spec.compile())
    world, box = spec.worldbody, mujoco.mjtGeom.mjGEOM_BOX
    seat, wide = SEAT * unit, HALF_WIDTH * unit
    furniture = [
        world.add_geom(name="sketch_floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1]),
        world.add_geom(name="sketch_seat", type=box, size=[wide, wide, seat / 2], pos=[0, 0, seat / 2]),
        world.add_geom(name="sketch_back", type=box, size=[wide / 8, wide, wide], pos=[-wide, 0, seat + wide]),
    ]
    for geom in furniture:
        geom.contype = geom.conaffinity = EVERYTHING
        geom.margin = geom.gap = 0.0
    return unit


def height(model: mujoco.MjModel) -> float:
    """Of what moves and can touch, at qpos0 [m]."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    moves = moving(model)[model.geom_bodyid] & (model.geom_contype | model.geom_conaffinity != 0)
    if not moves.any():
        raise ValueError("nothing of the model moves and can touch")
    z, radius = data.geom_xpos[moves, 2], model.geom_rbound[moves]
    return float(np.max(z + radius) - np.min(z - radius))


def stands_free(model: mujoco.MjModel) -> bool:
    """Whether the heaviest kinematic tree has a free joint."""
    roots = [b for b in range(model.nbody) if model.body_treeid[b] >= 0 and model.body_rootid[b] == b]
    if not roots:
        return False
    heaviest = max(roots, key=lambda b: model.body_subtreemass[b])
    first = model.body_jntadr[heaviest]
    return first >= 0 and mujoco.mjtJoint(model.jnt_type[first]) == mujoco.mjtJoint.mjJNT_FREE


def sketch(model: mujoco.MjModel, unit: float, rng: np.random.Generator) -> np.ndarray:
    q = model.qpos0.copy()
    for j, kind in enumerate(map(mujoco.mjtJoint, model.jnt_type)):
        at = int(model.jnt_qposadr[j])
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            q[at : at + 2] = rng.uniform(-ASIDE, ASIDE, 2) * unit
            q[at + 2] = (SEAT + rng.uniform(0.0, ABOVE)) * unit
            mujoco.mju_quatIntegrate(q[at + 3 : at + 7], rng.normal(0.0, TURNED, 3), 1.0)
        elif kind == mujoco.mjtJoint.mjJNT_BALL:
            turn = rng.normal(0.0, SPREAD * UNLIMITED, 3)
            most = model.jnt_range[j, 1] if model.jnt_limited[j] else np.pi
            turn *= min(1.0, most / np.linalg.norm(turn))
            mujoco.mju_quatIntegrate(q[at : at + 4], turn, 1.0)
        else:
            least, most = model.jnt_range[j] if model.jnt_limited[j] else q[at] + UNLIMITED * np.array([-0.5, 0.5])
            q[at] = np.clip(q[at] + rng.normal(0.0, SPREAD * (most - least)), least, most)
    return q


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__.splitlines()[0])
    parser.add_argument("robot", metavar="MODEL", help="MJCF of a robot with a free base")
    parser.add_argument("--out", required=True, help="the scene with its keyframes (MJCF)")
    parser.add_argument("--count", type=int, default=20, help="how many poses (default 20)")
    parser.add_argument("--seed", type=int, default=1, help="of the poses (default 1)")
    arguments = parser.parse_args(argv)
    if arguments.count < 1 or arguments.seed < 0:
        parser.error("--count: at least 1; --seed: at least 0")
    try:
        spec = mujoco.MjSpec.from_file(arguments.robot)
        unit = furnish(spec, pathlib.Path(arguments.robot))
        model = spec.compile()
        if not stands_free(model):
            raise ValueError(f"{arguments.robot} has no free base to put on a seat")
        rng, kept = np.random.default_rng(arguments.seed), 0
        for _ in range(MOST_TRIED * arguments.count):
            q = sketch(model, unit, rng)
            if mjcf_pdg.verify(model, q).min_distance >= -TOUCHING:
                continue
            spec.add_key(name=f"sketch_{kept}", qpos=q)
            kept += 1
            if kept == arguments.count:
                break
        else:
            raise ValueError(f"geoms overlap in only {kept} of {MOST_TRIED * arguments.count} random poses")
        spec.compile()
        pathlib.Path(arguments.out).write_text(spec.to_xml())
    except (OSError, ValueError, mujoco.FatalError) as error:
        print(f"make_sketches.py: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
