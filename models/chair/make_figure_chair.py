"""Makes figure_chair.xml: the figure and a chair in the shape of a cup. Run it without arguments."""
import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "figure")]

from make_figure_bench import UPRIGHT, add_figure, both
from scene_tools import Scene, element, quaternion

COMMENT = """
The figure of ../figure and a chair in the shape of a cup. Made by make_figure_chair.py; change that, not this.

Units: m, kg, s, rad. Figure: 1.74 m, 73 kg, {links} links, 41 DoF, {figure} triangles; its meshes are those of ../figure/assets.
Chair: a round seat on a foot, cylinders, and around it a wall of {staves} equal staves that widens upwards and is open in
front; fixed; floor z = 0. After Tang & Kim, "poses for physics" (Fig. 15); the measures are ours.
"""

SEAT, SEAT_RADIUS, SEAT_X = 0.45, 0.28, 0.05  # the seat's height and radius; its middle is before the pelvis
STAVES, COVERED = 14, 250  # of the wall; the angle [degrees] around the sitter's back
WALL, FLARE, THICKNESS = 0.42, 0.12, 0.03  # height over the seat; how much wider it is there; of a stave

SEATED = {"pelvis": (0, 0, SEAT + 0.092, *UPRIGHT), **both("hip", (0, -87, 0)), **both("knee", 84), **both("ankle", (0, 3, 0)),
          **both("shoulder", (0, -25, 0)), **both("elbow", 45)}
KEYS = {
    "home": SEATED,
    "sunk_into_seat": {**SEATED, "pelvis": (0, 0, SEAT + 0.03, *UPRIGHT)},
    "sunk_to_waist": {**SEATED, "pelvis": (0, 0, SEAT - 0.06, *UPRIGHT)},
    "back_through_wall": {**SEATED, "pelvis": (-0.14, 0, SEAT + 0.10, 0, -22, 0)},
    "leaning_to_the_side": {**SEATED, "pelvis": (0.02, 0.12, SEAT + 0.10, -14, 0, 0)},
    "turned_in_the_cup": {**SEATED, "pelvis": (0, 0, SEAT + 0.092, 0, 0, 40)},
    "elbows_in_wall": {**SEATED, **both("shoulder", (32, 10, 0)), **both("elbow", 70)},
    "knees_drawn_up": {**SEATED, **both("hip", (0, -112, 0)), **both("knee", 128)},
    "legs_crossed": {**SEATED, "right_hip": (5, -100, 28)},
    "arms_crossed": {**SEATED, **both("shoulder", (0, -20, -70)), **both("elbow", 100)},
}


def stave_vertices():
    """Of a convex piece of the wall, behind the z axis: its inner face spans COVERED / STAVES degrees."""
    half = math.tan(math.radians(COVERED / STAVES / 2))
    corners = []
    for z, inner in ((-0.03, SEAT_RADIUS), (WALL, SEAT_RADIUS + FLARE)):
        for radius in (inner, inner + THICKNESS):
            corners += [(-radius, sign * radius * half, z) for sign in (-1, 1)]
    return corners


def add_chair(scene):
    chair = element(scene.world, "body", name="chair", pos=(SEAT_X, 0, 0))

    def cylinder(name, radius, low, high, material):
        element(chair, "geom", name=name, type="cylinder", size=(radius, (high - low) / 2), pos=(0, 0, (low + high) / 2),
                material=material)

    cylinder("seat", SEAT_RADIUS, SEAT - 0.04, SEAT, "cushion")
    cylinder("column", 0.04, 0.02, SEAT - 0.04, "iron")
    cylinder("foot_plate", 0.22, 0, 0.02, "iron")
    element(scene.asset, "mesh", name="stave", vertex=[x for corner in stave_vertices() for x in corner])
    for i in range(STAVES):
        turn = COVERED * ((i + 0.5) / STAVES - 0.5)
        element(chair, "geom", name=f"stave{i + 1}", type="mesh", mesh="stave", material="shell", pos=(0, 0, SEAT),
                quat=quaternion((0, 0, turn)))


def main():
    scene = Scene("figure_chair", HERE, assets_of="figure")
    for name, rgba in [("skin", (0.88, 0.68, 0.55, 1)), ("shirt", (0.30, 0.50, 0.72, 1)),
                       ("trousers", (0.25, 0.27, 0.34, 1)), ("shoe", (0.35, 0.22, 0.15, 1)),
                       ("shell", (0.80, 0.76, 0.68, 1)), ("cushion", (0.55, 0.25, 0.20, 1)), ("iron", (0.22, 0.24, 0.25, 1))]:
        scene.material(name, rgba, 0.2, 0.3)
    scene.stage(camera_pos=(2.3, -1.9, 1.5), camera_xyaxes=(0.64, 0.77, 0, -0.22, 0.18, 0.96), look_at=(0.1, 0, 0.65),
                extent=1.0, tile=0.3)
    pelvis = add_figure(scene)
    add_chair(scene)
    for name, pose in KEYS.items():
        scene.key(name, pose)
    links, triangles = scene.count(pelvis)
    scene.write(COMMENT.format(links=links, figure=triangles, staves=STAVES))


if __name__ == "__main__":
    main()
