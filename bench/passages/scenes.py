"""Scenes of a wall, or several, and of bodies that are to pass (make.py)."""
import itertools
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "models"))

from mesh_tools import arc  # noqa: E402
from scene_tools import Scene, element, quaternion  # noqa: E402
from shapes import MARGIN, box, corners, moved, prism, reach_of, rectangle, straight  # noqa: E402

ROTATIONS = ((70, -50, 100), (-40, 80, -60))  # rotation vectors of free bodies at start and goal, degrees


def add_parts(body, parts, scene, name):
    for k, part in enumerate(parts):
        geom = {"name": f"{name}{k + 1}", "material": "mover", **part}
        if part["type"] == "mesh":
            element(scene.asset, "mesh", name=geom["name"], vertex=itertools.chain(*geom.pop("vertices")))
            geom["mesh"] = geom["name"]
        element(body, "geom", **geom)


def add_wall(scene, openings, thickness, beyond, name="wall", pos=(0, 0, 0), quat=(1, 0, 0, 0)):
    """A wall across x that reaches that far, but for the openings."""
    wall = element(scene.world, "body", name=name, pos=pos, quat=quat)
    boxes = []
    if isinstance(openings, tuple):
        sides, radius = openings
        for angle in [360 * (k + 0.5) / sides for k in range(sides)]:
            c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
            boxes.append(((0, (radius + beyond / 2) * c, (radius + beyond / 2) * s), (beyond / 2, beyond), quaternion((angle, 0, 0))))
    else:
        openings = np.clip(openings, -beyond, beyond)
        ys, zs = (sorted({-beyond, beyond, *openings[:, k:k + 2].flat}) for k in (0, 2))
        for y0, y1 in itertools.pairwise(ys):
            solid = [(z0, z1) for z0, z1 in itertools.pairwise(zs)
                     if not any(o[0] <= y0 and y1 <= o[1] and o[2] <= z0 and z1 <= o[3] for o in openings)]
            while solid:
                z0, z1 = solid.pop(0)
                while solid and solid[0][0] == z1:
                    z1 = solid.pop(0)[1]
                boxes.append(((0, (y0 + y1) / 2, (z0 + z1) / 2), ((y1 - y0) / 2, (z1 - z0) / 2), (1, 0, 0, 0)))
    for k, (middle, half, turned) in enumerate(boxes):
        element(wall, "geom", name=f"{name}{k + 1}", type="box", pos=middle, size=(thickness / 2, *half), quat=turned, material="wall")


def new_scene(name, extent):
    scene = Scene(name, None)
    scene.material("mover", (0.85, 0.35, 0.2, 1))
    scene.material("wall", (0.6, 0.58, 0.55, 1))
    scene.look((-1.5 * extent, -3 * extent, 2 * extent), (0.9, -0.45, 0, 0.22, 0.44, 0.87), (0, 0, 0), extent)
    return scene


def add_mover(scene, kind, name, limit):
    """A body of the plane, of space with limits, or a free one; and what makes a pose of a frame."""
    body = element(scene.world, "body", name=name)
    slides = {"planar": "xy", "space": "xyz", "free": ""}[kind]
    for axis in slides:
        element(body, "joint", name=f"{name}_{axis}", type="slide", axis=[float(axis == a) for a in "xyz"], range=(-limit, limit))
    if kind == "planar":
        element(body, "joint", name=f"{name}_turn", axis=(0, 0, 1))
    elif kind == "space":
        element(body, "joint", name=f"{name}_turn", type="ball")
    else:
        element(body, "freejoint", name=name)

    def place(frame):
        *at, rotation = frame
        if kind == "free":
            return {name: (*at, *rotation)}
        return {**{f"{name}_{axis}": value for axis, value in zip(slides, at)}, f"{name}_turn": rotation[2] if kind == "planar" else rotation}

    return body, place


def way_through(shape, slack, away, aside):
    """Frames from one side to the other, to where the body can be turned, and with another orientation at both ends."""
    frames = shape.frames(slack)
    (_, y0, z0, r0), (_, y1, z1, r1) = frames[0], frames[-1]
    (y, z), (start, goal) = aside, ROTATIONS
    return [(-1.2 * away, y, z, start), (-away, y0, z0, r0), *frames, (away, y1, z1, r1), (1.2 * away, -y, -z, goal)]


def make_one(name, slack, kind, shape):
    away = reach_of(shape) + shape.wall / 2 + MARGIN
    scene = new_scene(name, 1.5 * away)
    add_wall(scene, shape.openings(slack), shape.wall, 8 * away)
    body, place = add_mover(scene, kind, "mover", 2.5 * away)
    add_parts(body, shape.parts, scene, "mover")
    return scene, [place(frame) for frame in way_through(shape, slack, away, (0.6 * away, 0.4 * away))], shape.width


def make_gates(name, slack, shape, apart, shift):
    """Two walls one after the other."""
    away = apart / 2 + reach_of(shape) + shape.wall / 2 + MARGIN
    scene = new_scene(name, 1.5 * away)
    for k in (-1, 1):
        openings = np.array(shape.openings(slack)) + (k * shift / 2, k * shift / 2, 0, 0)
        add_wall(scene, openings, shape.wall, 8 * away, f"wall{'abc'[k + 1]}", (k * apart / 2, 0, 0))
    body, place = add_mover(scene, "planar", "mover", 2.5 * away)
    add_parts(body, shape.parts, scene, "mover")
    still = (0, 0, 0)
    way = ((-1.2 * away, 1, ROTATIONS[0]), (-away, -1, still), (0, -1, still), (0, 1, still), (away, 1, still), (1.2 * away, -1, ROTATIONS[1]))
    return scene, [place((x, k * shift / 2, 0, rotation)) for x, k, rotation in way], shape.width


def make_pair(name, slack, kind, shape, swap):
    """Two bodies that go through one after the other; or each to where the other was."""
    reach = reach_of(shape)
    away = reach + shape.wall / 2 + MARGIN
    scene = new_scene(name, 2 * away)
    add_wall(scene, shape.openings(slack), shape.wall, 12 * away)
    ways = []
    for k, mover in enumerate(("one", "two")):
        body, place = add_mover(scene, kind, mover, 4 * away)
        add_parts(body, shape.parts, scene, mover)
        y = (2.2 if k else -2.2) * reach
        frames = way_through(shape, slack, away, (y, 0))
        ways.append([place(frame) for frame in (frames[::-1] if swap and k else frames)])
    return scene, [{**one, **ways[1][0]} for one in ways[0]] + [{**ways[0][-1], **two} for two in ways[1]], shape.width


def make_snake(name, slack, kind, shape, links, joint, bend):
    """Links one after the other, of which the first is led; at start and goal each is bent by so much (degrees, or a rotation vector)."""
    points = np.concatenate([corners(part) for part in shape.parts])
    long = np.ptp(points[:, 0]) * 1.05
    away = long * (links - 0.5) + shape.wall / 2 + MARGIN
    scene = new_scene(name, 1.5 * away)
    add_wall(scene, shape.openings(slack), shape.wall, 8 * away)
    body, place = add_mover(scene, kind, "link1", 2.5 * away)
    add_parts(body, shape.parts, scene, "link1_")
    for k in range(2, links + 1):
        body = element(body, "body", name=f"link{k}", pos=(-long, 0, 0))
        element(body, "joint", name=f"bend{k}", pos=(long / 2, 0, 0), **joint)
        add_parts(body, shape.parts, scene, f"link{k}_")
    front = long / 2 + shape.wall / 2 + MARGIN
    bends = {f"bend{k}": bend for k in range(2, links + 1)}
    start, goal = ({**place((sign * (away + long), -sign * 0.3 * away, 0, rotation)), **bends} for sign, rotation in zip((-1, 1), ROTATIONS))
    return scene, [start, *[place((x, 0, 0, (0, 0, 0))) for x in (-away, -front, away)], goal], shape.width


def make_gripper(name, slack, kind, wide):
    """The fingers must close before they go through a hole as wide as the palm."""
    shape = straight([box(wide, wide, wide)], 0.3 * wide, rectangle(wide, wide), wide)
    away = 3 * wide
    scene = new_scene(name, 1.5 * away)
    add_wall(scene, shape.openings(slack), shape.wall, 8 * away)
    body, place = add_mover(scene, kind, "palm", 3 * away)
    add_parts(body, shape.parts, scene, "palm")
    finger = wide / 4
    for side, sign in (("left", 1), ("right", -1)):
        child = element(body, "body", name=side, pos=(0.5 * wide, sign * finger * 1.45, 0))
        element(child, "joint", name=side, type="slide", axis=(0, sign, 0), range=(0, wide))
        add_parts(child, [moved(box(1.5 * wide, finger, finger), (0.75 * wide, 0, 0))], scene, side)
    wide_open = {"left": 0.8 * wide, "right": 0.8 * wide}
    start, *frames, goal = way_through(shape, slack, away, (wide, 0.5 * wide))
    return scene, [{**place(start), **wide_open}, *[place(frame) for frame in frames], {**place(goal), **wide_open}], wide


def make_corner(name, slack, parts, least, frames):
    """A corridor with a right angle about the corner (0, 0), that comes from -x and goes to -y; a hall is at each end. `frames` are those in
    the bend, of the corridor's width and of what it has more than the least."""
    width = least * (1 + slack)
    long = 2 * float(np.linalg.norm(np.concatenate([corners(part) for part in parts]), axis=1).max()) + width
    scene = new_scene(name, 1.5 * long)
    wall = element(scene.world, "body", name="wall")
    ends = ((-6 * long, 0, -6 * long, 0), (-long, 6 * long, width, 6 * long), (width, 6 * long, -long, 6 * long))
    for k, (x0, x1, y0, y1) in enumerate(ends, 1):
        element(wall, "geom", name=f"wall{k}", type="box", pos=((x0 + x1) / 2, (y0 + y1) / 2, 0), size=((x1 - x0) / 2, (y1 - y0) / 2, 0.2),
                material="wall")
    body, place = add_mover(scene, "planar", "mover", 3 * long)
    add_parts(body, parts, scene, "mover")
    turning = frames(width, least * slack)
    (_, y, _, first), (x, _, _, last) = turning[0], turning[-1]
    before = [(-2 * long, long, 0, ROTATIONS[0]), (-2 * long, long, 0, first), (-2 * long, y, 0, first)]
    behind = [(x, -2 * long, 0, last), (long, -2 * long, 0, last), (long, -2 * long, 0, ROTATIONS[1])]
    return scene, [place(frame) for frame in (*before, *turning, *behind)], least


def make_corner_bar(name, slack, long, wide):
    """The width is that at 45°, where the bar lies on the inner corner and in the outer one; since it is longer than that it must turn."""
    def frames(width, more):
        clear = width - more * math.sqrt(2) / (1 + math.sqrt(2))
        return [(clear - long / 2 * c - wide / 2 * s, clear - long / 2 * s - wide / 2 * c, 0, (0, 0, -math.degrees(t)))
                for t in np.linspace(0, math.pi / 2, 181) for c, s in [(math.cos(t), math.sin(t))]]

    return make_corner(name, slack, [box(long, wide, 0.2)], (wide + long / 2) / math.sqrt(2), frames)


def make_corner_half_disc(name, slack, radius):
    """A half disc turns about the inner corner in a corridor that is as wide as it is high."""
    return make_corner(name, slack, [prism(arc((0, 0), radius, 0, 180, 32), 0.2, "z")], radius,
                       lambda _, more: [(more / 2, more / 2, 0, (0, 0, -t)) for t in np.linspace(0, 90, 91)])
