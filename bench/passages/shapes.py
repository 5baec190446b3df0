"""Shapes of bodies and of the openings through which they pass (make.py)."""
import itertools
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "models"))

from mesh_tools import arc, loft, superellipse  # noqa: E402
from scene_tools import quaternion  # noqa: E402

MARGIN = 0.03  # between the wall and a body that has yet to go in, or has come out
INFINITE = math.inf


class Shape(NamedTuple):
    """A body that goes through a wall along x. A frame is (x, y, z, rotation vector in degrees) of the body, as seen from the opening."""
    parts: list  # attributes of its geoms
    wall: float  # thickness
    openings: Callable  # of the slack: rectangles (y from, to, z from, to) in the wall; or (sides, radius of the circle inside), of one polygon
    frames: Callable  # of the slack: from before the wall to behind it
    width: float  # the least of the opening


def box(x, y, z, pos=(0, 0, 0)):
    return {"type": "box", "size": (x / 2, y / 2, z / 2), "pos": pos}


def cylinder(diameter, long, axis):
    return {"type": "cylinder", "size": (diameter / 2, long / 2), "quat": quaternion((0, 90 if axis == "x" else 0, 0))}


def prism(ring, long, axis):
    return {"type": "mesh", "vertices": loft([(-long / 2, ring), (long / 2, ring)], axis).vertices}


def moved(part, by):
    return {**part, "pos": tuple(np.add(part.get("pos", (0, 0, 0)), by))}


def corners(part):
    """Points whose hull holds the part."""
    if part["type"] == "mesh":
        return np.array(part["vertices"])
    if part["type"] == "capsule":
        a, b = np.reshape(part["fromto"], (2, 3))
        return np.concatenate([end + part["size"] * np.vstack([np.eye(3), -np.eye(3)]) * math.sqrt(3) for end in (a, b)])
    half = part["size"] if part["type"] == "box" else (part["size"][0], *part["size"])
    return np.array(list(itertools.product(*[(-h, h) for h in half]))) @ matrix_of(part.get("quat", (1, 0, 0, 0))).T + part.get("pos", (0, 0, 0))


def reach_of(shape):
    return max(np.linalg.norm(corners(part), axis=1).max() for part in shape.parts)


def matrix_of(quat):
    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, np.array(quat, dtype=float))
    return flat.reshape(3, 3)


def straight(parts, wall, openings, width, turn=0.0, y=0.0):
    """A shape that goes straight on, turned about z and moved along y."""
    points = np.concatenate([corners(part) for part in parts]) @ matrix_of(quaternion((0, 0, turn))).T
    first, last = -points[:, 0].max() - wall / 2 - MARGIN, -points[:, 0].min() + wall / 2 + MARGIN
    return Shape(parts, wall, openings, lambda _: [(x, y, 0, (0, 0, turn)) for x in (first, last)], width)


def rectangle(y, z):
    """An opening in the middle that grows with the slack."""
    return lambda slack: [(-y / 2 * (1 + slack), y / 2 * (1 + slack), -z / 2 * (1 + slack), z / 2 * (1 + slack))]


def slot(broad, thick):
    """An opening of which the height alone grows with the slack."""
    return lambda slack: [(-broad / 2, broad / 2, -thick / 2 * (1 + slack), thick / 2 * (1 + slack))]


def planar(parts, wall=None):
    """A body of the plane and a gap as wide as the hull of the body is at least; without `wall` a tunnel that is longer than the body.

    The least width of a hull is across one of its edges.
    """
    points = np.concatenate([corners(part) for part in parts])[:, :2]
    best = (INFINITE,)
    for a, b in itertools.combinations(points, 2):
        if np.linalg.norm(b - a) > 1e-9:
            along = (b - a) / np.linalg.norm(b - a)
            across = points @ (-along[1], along[0])
            best = min(best, (np.ptp(across), math.degrees(-math.atan2(along[1], along[0])), -(across.max() + across.min()) / 2))
    width, turn, y = (float(number) for number in best)
    if wall is None:
        wall = 1.1 * max(np.linalg.norm(b - a) for a, b in itertools.combinations(points, 2))
    return straight(parts, wall, rectangle(width, INFINITE), width, turn, y)


def bent(lengths, turns, wide, wall, height=None, hand=False):
    """Bars, each at a right angle to the last (turns of +1 and -1), that must turn about each of their inner corners in the opening.

    With `height` the body is one of space, and the hole is as high as it (times 1 + slack), so that it stays in its plane. Each outer corner
    must come to the middle of the wall once. The body is then at least wide √2 plus half of the wall's thickness: at 45°, the wall's edge
    being in the inner corner, and in every other position more. A hand ends, as it begins, with the last bar on the near side.
    """
    along, points = np.array([1.0, 0.0]), [np.zeros(2)]
    directions = []
    for length, turn in zip(lengths[::-1], [*turns[::-1], 0]):
        directions.append(along)
        points.append(points[-1] + length * along)
        along = np.array([-turn * along[1], turn * along[0]])
    points, directions = np.array(points[::-1]), directions[::-1]
    if not hand:
        points -= (points.max(0) + points.min(0)) / 2
    z = height or 0.2
    parts = []
    for a, b, d in zip(points, points[1:], directions):
        x, y = np.linalg.norm(b - a) * np.abs(d) + wide
        parts.append(box(x, y, z, (*(a + b) / 2, 0)))
    least = wide * math.sqrt(2) + wall / 2

    def pose(angle, world, point):
        return (*(world - matrix_of(quaternion((0, 0, angle)))[:2, :2] @ point), 0, (0, 0, angle))

    def frames(slack):
        clearance = least * slack / 3
        angle = -math.degrees(math.atan2(directions[0][1], directions[0][0]))
        found = [pose(angle, np.array([-(wall + wide) / 2 - MARGIN, 0]), points[0])]
        for k, turn in enumerate(turns):
            # The inner corner goes along half a circle about the middle of the wall's edge, on which both bars lean.
            inner = points[k + 1] + wide / 2 * (directions[k] - directions[k + 1])
            for t in np.linspace(0, math.pi / 2, 91):
                circle = np.array([-math.cos(2 * t), -turn * math.sin(2 * t)]) * (wall / 2 + clearance)
                corner = np.array([0, turn * (least * (1 + slack) / 2 - clearance)]) + circle
                found.append(pose(angle + turn * math.degrees(t), corner, inner))
            angle += 90 * turn
        x, _, *rest = found[-1]  # that of a hand, which begins in the middle of the last bar
        return found + [(x + MARGIN, 0, *rest) if hand else pose(angle, np.array([(wall + wide) / 2 + MARGIN, 0]), points[-1])]

    def openings(slack):
        y, z = least * (1 + slack) / 2, (height or INFINITE) / 2 * (1 + slack)
        return [(-y, y, -z, z)]

    return Shape(parts, wall, openings, frames, least)


def tube(radius, bend, angle, wall, pieces=12):
    """A bent tube of capsules, that goes about the centre of its bend through a hole as broad as the tube is thick."""
    ends = [(*p, 0) for p in arc((0, 0), bend, 90 - angle / 2, 90 + angle / 2, pieces)]
    parts = [{"type": "capsule", "size": radius, "fromto": (*a, *b)} for a, b in zip(ends, ends[1:])]
    top = bend + radius
    low = math.sqrt((bend * math.cos(math.radians(angle / pieces / 2)) - radius) ** 2 - wall * wall / 4)

    def openings(slack):
        grown = (top - low) / 2 * (1 + slack)
        return [(-grown, grown, -radius * (1 + slack), radius * (1 + slack))]

    turns = np.linspace(angle / 2 + 20, -angle / 2 - 20, 181)
    return Shape(parts, wall, openings, lambda _: [(0, -(top + low) / 2, 0, (0, 0, t)) for t in turns], 2 * radius)


def profile(rectangles, long, wall):
    """A bar of that cross-section, and a hole of the same."""
    parts = [moved(box(long, y1 - y0, z1 - z0), (0, (y0 + y1) / 2, (z0 + z1) / 2)) for y0, y1, z0, z1 in rectangles]
    return straight(parts, wall, lambda slack: [[(1 + slack) * v for v in r] for r in rectangles], rectangles[0][1] - rectangles[0][0])


def prism_in_hole(sides, radius, long, wall, part=None):
    """`radius` is that of the circle inside."""
    ring = superellipse(*[radius / math.cos(math.pi / sides)] * 2, sides)
    return straight([part or prism(ring, long, "x")], wall, lambda slack: (sides, radius * (1 + slack)), 2 * radius)


def coin(diameter, thick, wall):
    return straight([cylinder(diameter, thick, "z")], wall, slot(1.1 * diameter, thick), thick)


def plate(x, y, z, wall):
    return straight([box(x, y, z)], wall, slot(1.1 * y, z), z)


def flat(parts, broad, thick, wall):
    return straight(parts, wall, slot(broad, thick), thick)


def flat_ell(x, y, wide, thick):
    return [box(x, wide, thick), box(wide, y, thick, ((x - wide) / 2, (y - wide) / 2, 0))]
