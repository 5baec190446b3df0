"""Closes fingers about a vessel until they touch it: mjcf_pdg.check_motion ends each motion where it would collide."""

import mujoco
import numpy as np

import mjcf_pdg

from scene import FINGERS

RATES = {"mcp": 1.0, "pip": 1.0, "dip": 0.7, "ip": 0.7}  # joints of a finger flex together, this fast


def close_hand(model: mujoco.MjModel, q: np.ndarray) -> np.ndarray:
    """From a free q, finger by finger; what the thumb's base is turned to stays."""
    for finger in FINGERS:
        q = close_finger(model, q, finger)
    return q


def close_finger(model: mujoco.MjModel, q: np.ndarray, finger: str) -> np.ndarray:
    """Joints between the palm and a segment that touches stop, and those beyond go on, as in GraspIt's autograsp."""
    moving = [j for j in range(model.njnt) if is_flexing(model, j, finger)]
    while moving:
        at = model.jnt_qposadr[moving]
        rate = np.array([RATES[kind(model, j)] for j in moving])
        room = (model.jnt_range[moving, 1] - q[at]) / rate
        if room.min() <= 1e-9:
            moving.pop(int(np.argmin(room)))  # is at its limit
            continue
        target = q.copy()
        target[at] += rate * room.min()
        motion = mjcf_pdg.check_motion(model, q, target, exact_mesh=True)
        q = motion.q
        if motion.outcome != "free":
            touching = [int(model.geom(name).bodyid[0]) for pair in motion.pairs for name in pair]
            free = [j for j in moving if not any(carries(model, j, body) for body in touching)]
            moving = free if len(free) < len(moving) else []  # else something other than this finger collides
    return q


def kind(model: mujoco.MjModel, joint: int) -> str:
    return model.joint(joint).name.split("_")[-1]


def is_flexing(model: mujoco.MjModel, joint: int, finger: str) -> bool:
    return model.joint(joint).name.startswith(finger + "_") and kind(model, joint) in RATES


def carries(model: mujoco.MjModel, joint: int, body: int) -> bool:
    while body and body != model.jnt_bodyid[joint]:
        body = int(model.body_parentid[body])
    return body != 0
