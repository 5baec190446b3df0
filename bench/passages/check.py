"""Checks what make.py writes, with MuJoCo's contacts alone.

    python3 bench/passages/check.py DIR            # witnesses are free (slack above 0)
    python3 bench/passages/check.py DIR --hit      # they are not (slack below 0)

A witness is looked at 1000 times between two of its configurations where they are few, else 2000 times in all. Start and goal must be free
and the ends of the witness, and every configuration within the joints' limits. Exit code 1 if anything is otherwise.
"""
import argparse
import sys
from pathlib import Path

import mujoco
import numpy as np


def depth(model, data, qpos):
    data.qpos = qpos
    mujoco.mj_fwdPosition(model, data)
    return max(0.0, -data.contact.dist.min()) if data.ncon else 0.0


def is_within_limits(model, qpos):
    value, limited = qpos[model.jnt_qposadr], model.jnt_limited.astype(bool)
    low, high = model.jnt_range.T
    return bool(((value >= low - 1e-9) & (value <= high + 1e-9) | ~limited).all())


def deepest(model, data, way):
    """Of all between the configurations of a way [m]."""
    steps = 1000 if len(way) < 20 else max(10, 2000 // len(way))
    by, found = np.zeros(model.nv), 0.0
    for a, b in zip(way, way[1:]):
        mujoco.mj_differentiatePos(model, by, 1, a, b)
        for t in np.linspace(0, 1, steps + 1):
            q = a.copy()
            mujoco.mj_integratePos(model, q, by, t)
            found = max(found, depth(model, data, q))
    return found


def faults(path, hit):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    way = np.loadtxt(path.with_suffix(".witness.csv"), delimiter=",", ndmin=2)
    for key, end in (("start", way[0]), ("goal", way[-1])):
        if np.abs(model.key(key).qpos - end).max() > 1e-8:
            yield f"the witness does not end at {key}"
        if depth(model, data, end) > 0:
            yield f"{key} is not free"
    if not all(is_within_limits(model, q) for q in way):
        yield "the witness leaves the joints' limits"
    deep = deepest(model, data, way)
    if (deep > 0) != hit:
        yield f"the witness is {1000 * deep:.3g} mm deep" if deep else "the witness is free"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--hit", action="store_true", help="witnesses must collide")
    options = parser.parse_args()
    paths = sorted(options.folder.glob("*.xml"))
    found = [f"{path.stem}: {fault}" for path in paths for fault in faults(path, options.hit)]
    print("\n".join([*found, f"{len(paths)} models, {len(found)} faults"]))
    sys.exit(bool(found) or not paths)
