"""Makes placement.xml: the figure takes a tool from a desk to a book shelf. Run it without arguments."""
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "figure")]

from make_figure_bench import HIP, add_figure, both
from scene_tools import Scene, element

COMMENT = """
The figure of ../figure with a tool in its right hand, a desk and a book shelf. Made by make_placement.py; change that, not this.

Units: m, kg, s, rad. Figure and tool: {links} links, 41 DoF, {figure} triangles. Desk and shelf are boxes, the books {books}
triangles; floor z = 0. In the keyframe start the tool is in a tray on the desk; in goal it is in a gap between books.
After Tang & Kim, "Placement". The figure's meshes are those of ../figure/assets, the books MuJoCo's own superspheres.
"""

STANDING = {"pelvis": (0, 0, HIP, 0, 0, 0), **both("shoulder", (0, 8, 0)), **both("elbow", 0)}
KEYS = {
    "start": {**STANDING, "pelvis": (0.1, 0.1, HIP, 0, 0, 0), "right_shoulder": (0, 0, 0), "right_elbow": 70},
    "goal": {**STANDING, "pelvis": (0.08, -0.845, HIP, 0, 0, 0), "right_shoulder": (0, -50, 0), "right_elbow": 40},
}


def add_furniture(scene):
    def box(body, name, pos, size):
        element(body, "geom", name=name, type="box", pos=pos, size=size, material="wood")

    desk = element(scene.world, "body", name="desk", pos=(0.62, 0, 0))
    box(desk, "desk_top", (0, 0, 0.74), (0.35, 0.45, 0.015))
    box(desk, "desk_left", (0, 0.43, 0.36), (0.33, 0.015, 0.36))
    box(desk, "desk_right", (0, -0.43, 0.36), (0.33, 0.015, 0.36))
    # Hand and tool are in a tray, 1 mm from its walls on either side and 4 mm below its roof: BiRRT takes half a minute.
    box(desk, "tray_top", (0.06, -0.157, 1.058), (0.29, 0.12, 0.01))
    box(desk, "tray_left", (0.06, -0.1314, 0.93), (0.29, 0.01, 0.18))
    box(desk, "tray_right", (0.06, -0.1905, 0.93), (0.29, 0.01, 0.18))
    shelf = element(scene.world, "body", name="shelf", pos=(0.62, -1.15, 0))
    for k in range(6):
        box(shelf, f"shelf_board{k}", (0, 0, 0.06 + 0.36 * k), (0.16, 0.42, 0.01))
    for side, y in (("left", 0.43), ("right", -0.43)):
        box(shelf, f"shelf_{side}", (0, y, 0.96), (0.16, 0.01, 0.92))
    box(shelf, "shelf_divider", (0, 0.09, 1.34), (0.15, 0.05, 0.01))
    books = 0
    for k in range(5):
        for i in range(9):
            if k == 3 and i == 5:
                continue  # the gap where the tool goes: 1.7 mm and 4 mm from the forearm
            y = 0.152 if (k, i) == (3, 6) else -0.36 + 0.09 * i
            scene.supersphere(shelf, f"book{k}_{i}", (0.13, 0.0465, 0.14), 0.2, 24, pos=(0.02, y, 0.212 + 0.36 * k), material="book")
            books += scene.triangles[f"book{k}_{i}"]
    return books


def main():
    scene = Scene("placement", HERE, assets_of="figure")
    for name, rgba in [("skin", (0.88, 0.68, 0.55, 1)), ("shirt", (0.30, 0.50, 0.72, 1)), ("trousers", (0.25, 0.27, 0.34, 1)),
                       ("shoe", (0.35, 0.22, 0.15, 1)), ("wood", (0.66, 0.44, 0.24, 1)), ("book", (0.5, 0.2, 0.2, 1)),
                       ("tool", (0.2, 0.22, 0.25, 1))]:
        scene.material(name, rgba, 0.2, 0.3)
    scene.stage(camera_pos=(-2.5, -2.5, 2.2), camera_xyaxes=(0.6, -0.8, 0, 0.3, 0.2, 0.9), look_at=(0.3, -0.6, 0.9), extent=1.4,
                tile=0.3)
    pelvis = add_figure(scene)
    hand = next(body for body in scene.world.iter("body") if body.get("name") == "right_hand")
    scene.supersphere(hand, "tool", (0.015, 0.015, 0.11), 0.5, 20, pos=(0.035, 0, -0.18), material="tool", mass=0.3)
    books = add_furniture(scene)
    for name, pose in KEYS.items():
        scene.key(name, pose)
    links, triangles = scene.count(pelvis)
    scene.write(COMMENT.format(links=links, figure=triangles, books=books))


if __name__ == "__main__":
    main()
