"""Makes gap.xml, slot.xml, socket.xml, peg.xml and piano.xml: narrow passages of known width. Those here are made without arguments."""
import argparse
import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from mesh_tools import Mesh
from scene_tools import Scene, element, radians


def add_wall(scene, thickness, opening, beyond, x=0.0):
    """Four boxes around an opening (y from, to; z from, to) of a wall at x, that reach that far beyond it."""
    wall = element(scene.world, "body", name="wall", pos=(x, 0, 0))
    left, right, low, high = opening
    sides = {"left": (left - beyond, left, low - beyond, high + beyond), "right": (right, right + beyond, low - beyond, high + beyond),
             "below": (left, right, low - beyond, low), "above": (left, right, high, high + beyond)}
    for name, (y0, y1, z0, z1) in sides.items():
        element(wall, "geom", name=name, type="box", pos=(0, (y0 + y1) / 2, (z0 + z1) / 2),
                size=(thickness / 2, (y1 - y0) / 2, (z1 - z0) / 2), material="wall")


def new_scene(name, folder, camera_pos, camera_xyaxes, look_at, extent):
    scene = Scene(name, folder)
    scene.material("mover", (0.85, 0.35, 0.2, 1))
    scene.material("wall", (0.6, 0.58, 0.55, 1))
    scene.look(camera_pos, camera_xyaxes, look_at, extent)
    return scene


GAP = """
A disc in the plane and a gap in a wall. Made by make_passages.py; change that, not this.

Units: m, kg, s. The disc has a diameter of {wide} m and two slides; the gap is {gap} m wide.
"""


def make_gap(folder, slack):
    wide = 0.4
    gap = wide * (1 + slack)
    scene = new_scene("gap", folder, (0, -0.5, 6), (1, 0, 0, 0, 1, 0.1), (0, 0, 0), 1.5)
    add_wall(scene, 0.2, (-gap / 2, gap / 2, -0.5, 0.5), 3.0)
    disc = element(scene.world, "body", name="disc")
    for name, axis in (("x", (1, 0, 0)), ("y", (0, 1, 0))):
        element(disc, "joint", name=name, type="slide", axis=axis, range=(-2, 2))
    element(disc, "geom", name="disc", type="cylinder", size=(wide / 2, 0.1), material="mover")
    scene.key("start", {"x": -1, "y": 0.7})
    scene.key("goal", {"x": 1, "y": -0.7})
    scene.write(GAP.format(wide=wide, gap=round(gap, 6)))


def add_arm(scene):
    """Seven hinges. Returns the last link, of which the hand is to be a part."""
    # Where each hinge is on the link before, its axis and range, and the capsule behind it: radius, from, to.
    links = [(0.2, "z", 170, 0.05, 0, 0.15), (0.2, "y", 110, 0.04, 0.05, 0.25), (0.25, "z", 170, 0.04, 0.05, 0.1),
             (0.1, "y", 150, 0.04, 0.08, 0.2), (0.2, "z", 170, 0.025, 0.07, 0.15), (0.15, "y", 120, 0.02, 0.06, 0.1),
             (0.1, "z", 170, None, None, None)]
    parent = scene.world
    for k, (height, axis, most, radius, low, top) in enumerate(links, 1):
        parent = element(parent, "body", name=f"link{k}", pos=(0, 0, height))
        element(parent, "joint", name=f"hinge{k}", axis=[float(axis == a) for a in "xyz"], range=radians(-most, most))
        if radius:
            element(parent, "geom", name=f"link{k}", type="capsule", size=radius, fromto=(0, 0, low, 0, 0, top), material="mover")
    return parent


def add_keys_of_arm(scene):
    """The goal has the hand level, at a height of 0.45 m; it begins 0.63 m from the base."""
    scene.key("start", {"hinge2": -20, "hinge4": 60, "hinge6": 80, "hinge1": 40})
    # Two links of 0.35 m from the shoulder, 0.4 m high, to the wrist before the wall; the hand is level, behind it.
    x, z = 0.53, 0.05
    to_wrist, half = math.degrees(math.atan2(x, z)), math.degrees(math.acos(math.hypot(x, z) / 0.7))
    scene.key("goal", {"hinge2": to_wrist - half, "hinge4": 2 * half, "hinge6": 90 - to_wrist - half})


SLOT = """
An arm of seven hinges and a slot in a wall. Made by make_passages.py; change that, not this.

Units: m, kg, s, rad. The hand is a cylinder of {thick} m, the slot {high} m high and {slot} m broad.
"""


def make_slot(folder, slack):
    thick = 0.06
    high, slot = thick * (1 + slack), 0.2
    scene = new_scene("slot", folder, (1.0, -2.2, 1.0), (1, 0.25, 0, -0.07, 0.3, 1), (0.4, 0, 0.45), 0.7)
    add_wall(scene, 0.02, (-slot / 2, slot / 2, 0.45 - high / 2, 0.45 + high / 2), 1.5, x=0.64)
    element(add_arm(scene), "geom", name="hand", type="cylinder", size=(thick / 2, 0.05), pos=(0, 0, 0.1), material="mover")
    add_keys_of_arm(scene)
    scene.write(SLOT.format(thick=thick, high=round(high, 6), slot=slot))


SOCKET = """
An arm of seven hinges and a deep hole that its hand is to fill. Made by make_passages.py; change that, not this.

Units: m, kg, s, rad. The hand is {wide} m wide, {thick} m thick and {long} m long, the hole {hole_wide} m wide, {hole_thick} m high and {deep} m deep.
"""


def make_socket(folder, slack):
    wide, thick, long, deep = 0.06, 0.04, 0.2, 0.2
    hole_wide, hole_thick = wide * (1 + slack), thick * (1 + slack)
    scene = new_scene("socket", folder, (1.0, -2.2, 1.0), (1, 0.25, 0, -0.07, 0.3, 1), (0.4, 0, 0.45), 0.7)
    add_wall(scene, deep, (-hole_wide / 2, hole_wide / 2, 0.45 - hole_thick / 2, 0.45 + hole_thick / 2), 1.5, x=0.67 + deep / 2)
    element(add_arm(scene), "geom", name="hand", type="box", size=(thick / 2, wide / 2, long / 2), pos=(0, 0, 0.02 + long / 2),
            material="mover")
    add_keys_of_arm(scene)
    scene.write(SOCKET.format(wide=wide, thick=thick, long=long, deep=deep, hole_wide=round(hole_wide, 6), hole_thick=round(hole_thick, 6)))


PEG = """
A peg in space and a hole in a wall. Made by make_passages.py; change that, not this.

Units: m, kg, s, rad. The peg is free, {wide} m wide and thick and {long} m long; the hole is {hole} m wide and high, the wall {wall} m thick.
"""


def make_peg(folder, slack):
    wide, long, wall = 0.1, 0.4, 0.2
    hole = wide * (1 + slack)
    scene = new_scene("peg", folder, (-1.4, -2.0, 1.2), (0.85, -0.53, 0, 0.23, 0.37, 0.9), (0, 0, 0), 1.0)
    add_wall(scene, wall, (-hole / 2, hole / 2, -hole / 2, hole / 2), 4.0)
    body = element(scene.world, "body", name="peg")
    element(body, "freejoint", name="peg")
    element(body, "geom", name="peg", type="box", size=(long / 2, wide / 2, wide / 2), material="mover")
    scene.key("start", {"peg": (-0.6, 0.3, 0.2, 90, 0, 0)})
    scene.key("goal", {"peg": (0.6, 0.1, -0.2, 0, 90, 0)})
    scene.write(PEG.format(wide=wide, long=long, hole=round(hole, 6), wall=wall))


PIANO = """
A piano and a door. Made by make_passages.py; change that, not this.

Units: m, kg, s, rad. The piano is free, without legs, {thick} m thick, 1.5 m wide and 1.7 m long, and an exact mesh, since its
side is bent inwards; the door is {door} m wide and {high} m high. It must be stood on its straight side. {triangles} triangles.
"""
# Seen from above: along the keys, the short side, the bent one, the tail, and back along the straight side.
OUTLINE = [(0, 0), (1.5, 0), (1.5, 0.55), (1.42, 0.7), (1.25, 0.8), (1.05, 0.87), (0.9, 0.98), (0.8, 1.15), (0.74, 1.35),
           (0.66, 1.52), (0.52, 1.65), (0.33, 1.7), (0.12, 1.66), (0, 1.55)]


def piano_mesh(thick):
    """OUTLINE is seen whole from a point inside it, around which its faces are fans."""
    rings = [[(x, y, z) for x, y in OUTLINE] for z in (-thick / 2, thick / 2)]
    n = len(OUTLINE)
    vertices = rings[0] + rings[1] + [(0.5, 0.7, -thick / 2), (0.5, 0.7, thick / 2)]
    faces = []
    for k in range(n):
        k1 = (k + 1) % n
        faces += [(k, k1, n + k1), (k, n + k1, n + k), (k1, k, 2 * n), (n + k, n + k1, 2 * n + 1)]
    return Mesh(vertices, faces)


def make_piano(folder):
    thick = 0.3
    door, high = 0.4, 1.6
    scene = new_scene("piano", folder, (-3.5, -5, 3.5), (0.82, -0.57, 0, 0.28, 0.4, 0.87), (0, 0, 0.7), 2.5)
    element(scene.world, "geom", name="floor", type="plane", size=(5, 5, 0.1), material="wall")
    add_wall(scene, 0.12, (-door / 2, door / 2, 0, high), 5.0)
    body = element(scene.world, "body", name="piano")
    element(body, "freejoint", name="piano")
    scene.mesh_geom(body, "piano", piano_mesh(thick), material="mover", density=250)
    scene.key("start", {"piano": (-2.6, -0.8, 0.3, 0, 0, 0)})
    scene.key("goal", {"piano": (2.4, 0.2, 0.3, 0, 0, 90)})
    element(element(scene.root, "custom"), "text", name="mjcf_pdg.exact_mesh", data="piano")
    scene.write(PIANO.format(thick=thick, door=door, high=high, triangles=scene.count(body)[1]))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__)
    parser.add_argument("--slack", type=float, default=0.03,
                        help="by which gap, slot and holes are wider than what must pass, a share of that")
    parser.add_argument("--folder", type=Path, default=HERE, help="where they are written")
    arguments = parser.parse_args()
    make_gap(arguments.folder, arguments.slack)
    make_slot(arguments.folder, arguments.slack)
    make_socket(arguments.folder, arguments.slack)
    make_peg(arguments.folder, arguments.slack)
    make_piano(arguments.folder)
