"""Arms with hands that go through a wall (make.py)."""
import itertools
import math
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "models"))

from scene_tools import element, quaternion, radians  # noqa: E402
from scenes import add_mover, add_parts, add_wall, new_scene  # noqa: E402
from shapes import INFINITE, bent, box, corners, matrix_of, moved, rectangle, straight  # noqa: E402


def on_stick(shape):
    """A shape as the hand at the end of a stick that is longer than the wall is thick, and does not fill the opening."""
    points = np.concatenate([corners(part) for part in shape.parts])
    back, stick = -points[:, 0].min(), shape.wall + 0.12
    parts = [{"type": "capsule", "size": 0.3 * shape.width, "fromto": (0, 0, 0, stick, 0, 0)}, *[moved(p, (stick + back, 0, 0)) for p in shape.parts]]
    return shape._replace(parts=parts, frames=lambda slack: [(x - stick - back, *rest) for x, *rest in shape.frames(slack)])


def two_slots(shape, apart):
    """Out of one opening and into another."""
    def frames(slack):
        into = shape.frames(slack)
        return [(x, y + sign * apart / 2, z, r) for sign, way in ((-1, into[::-1]), (1, into)) for x, y, z, r in way]

    return shape._replace(frames=frames, openings=lambda slack: [(y0 + k, y1 + k, z0, z1) for k in (-apart / 2, apart / 2)
                                                                  for y0, y1, z0, z1 in shape.openings(slack)])


def hand(x, y, z, wall):
    return on_stick(straight([box(x, y, z)], wall, rectangle(y, z), min(y, z)))


def hook():
    return bent((0.1, 0.3), (1,), 0.03, 0.02, hand=True)


def dense(frames, step=0.004):
    for (*a, ra), (*b, rb) in itertools.pairwise(frames):
        count = max(1, math.ceil(math.dist(a, b) / step))
        for t in np.arange(count) / count:
            yield (*(np.array(a) * (1 - t) + np.array(b) * t), np.array(ra) * (1 - t) + np.array(rb) * t)
    yield frames[-1]


def follow(model, qpos, targets):
    """Configurations with the last body at each (rotation matrix, place), from one to the next by Newton's method."""
    data, found, error = mujoco.MjData(model), [], np.zeros(6)
    jacobian, quat = np.zeros((6, model.nv)), np.zeros(4)
    for rotation, place in targets:
        for _ in range(100):
            data.qpos = qpos
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            error[:3] = place - data.xpos[-1]
            mujoco.mju_mat2Quat(quat, (rotation @ data.xmat[-1].reshape(3, 3).T).flatten())
            mujoco.mju_quat2Vel(error[3:], quat, 1)
            if np.abs(error).max() < 1e-10:
                break
            mujoco.mj_jacBody(model, data, jacobian[:3], jacobian[3:], model.nbody - 1)
            qpos = qpos + np.linalg.lstsq(jacobian, error, rcond=1e-6)[0]
        else:
            raise ValueError(f"no configuration has the hand at {place}, the {len(found)}. place")
        found.append(qpos)
    return found


def is_free(model, configurations):
    data = mujoco.MjData(model)
    for qpos in configurations:
        data.qpos = qpos
        mujoco.mj_fwdPosition(model, data)
        if (data.contact.dist < 0).any():
            return False
    return True


def compiled(scene):
    return mujoco.MjModel.from_xml_string(ET.tostring(scene.root, encoding="unicode"))


def add_arm(scene, axes, lengths, parts, base):
    """A chain of hinges along x, by the letters of their axes; with a base it begins on one that slides and turns. The hand is the last body."""
    body = scene.world
    if base:
        body, _ = add_mover(scene, "planar", "base", 2)
        element(body, "geom", name="base", type="cylinder", size=(0.12, 0.05), material="mover")
    for k, axis in enumerate(axes, 1):
        before = lengths[k - 2] if k > 1 else 0
        body = element(body, "body", name=f"link{k}", pos=(before, 0, 0.1 if base and k == 1 else 0))
        most = 140 if axis == "y" else 165
        element(body, "joint", name=f"hinge{k}", axis=[float(axis == a) for a in "xyz"], range=radians(-most, most))
        if k < len(axes):
            element(body, "geom", name=f"link{k}", type="capsule", size=0.025, fromto=(0.03, 0, 0, lengths[k - 1] - 0.03, 0, 0), material="mover")
    add_parts(body, parts, scene, "hand")


def make_arm(name, slack, axes, lengths, goal, shape, base=False):
    """The wall stands where the hand is behind it at the goal (degrees of the hinges). The start is another posture, in front of the wall;
    but a hand that is behind the wall at first as well begins there."""
    frames = shape.frames(slack)
    bare = new_scene(name, 1.0)
    add_arm(bare, axes, lengths, shape.parts, base)
    model = compiled(bare)
    qpos = np.array([0.0] * (3 if base else 0) + list(radians(*goal)))
    data = mujoco.MjData(model)
    data.qpos = qpos
    mujoco.mj_kinematics(model, data)
    turned = data.xmat[-1].reshape(3, 3) @ matrix_of(quaternion(frames[-1][3])).T
    middle = data.xpos[-1] - turned @ frames[-1][:3]
    targets = [(turned @ matrix_of(quaternion(rotation)), middle + turned @ at) for *at, rotation in dense(frames)]
    configurations = follow(model, qpos, targets[::-1])[::-1]

    scene, quat = new_scene(name, 1.0), np.zeros(4)
    mujoco.mju_mat2Quat(quat, turned.flatten())
    add_wall(scene, shape.openings(slack), shape.wall, 5, pos=middle, quat=quat)
    add_arm(scene, axes, lengths, shape.parts, base)
    model = compiled(scene)
    if frames[0][0] != frames[-1][0]:
        configurations.insert(0, other_posture(model, configurations[0]))
    units = [(model.joint(k).name, model.jnt_type[k] == mujoco.mjtJoint.mjJNT_HINGE) for k in range(model.njnt)]
    return scene, [{joint: math.degrees(v) if hinge else v for (joint, hinge), v in zip(units, q)} for q in configurations], shape.width


def other_posture(model, qpos):
    """One that is joined to this by a free straight motion."""
    random = np.random.default_rng(1)
    bounded = model.jnt_limited.astype(bool)
    low, high = np.where(bounded, model.jnt_range.T, [[-INFINITE], [INFINITE]])
    for _ in range(1000):
        other = np.clip(qpos + random.uniform(-1.2, 1.2, model.nq), low, high)
        if is_free(model, (qpos + t * (other - qpos) for t in np.linspace(1, 0, 501))):
            return other
    raise ValueError("no other posture")
