"""Makes bridge.xml: a chain of 13 links that crawls through a narrow hole under a bridge. Run it without arguments."""
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from scene_tools import Scene, element, radians

COMMENT = """
A robot and a bridge. Made by make_bridge.py; change that, not this.

Units: m, kg, s, rad. Robot: {links} links, 40 DoF (free head 6, eleven balls of at most 40 degrees, a hinge at the tail),
{robot} triangles. Bridge: a wall of stones with a square hole of {hole} m; links are {width} m thick. {bridge} triangles; no floor.
After Tang & Kim, "Bridge". Meshes are MuJoCo's own superspheres: there are no mesh files.
"""

WIDTH, LENGTH, HOLE, THICKNESS = 0.12, 0.16, 0.20, 0.10
LINKS = 13


def add_robot(scene):
    parent = scene.world
    for i in range(LINKS):
        parent = element(parent, "body", name=f"link{i}", pos=(-0.9, 0, 0) if i == 0 else (-LENGTH - 0.02, 0, 0))
        if i == 0:
            element(parent, "freejoint", name="head")
        elif i < LINKS - 1:
            element(parent, "joint", name=f"ball{i}", type="ball", pos=(0.02, 0, 0), range=radians(0, 40))
        else:
            element(parent, "joint", name="tail", axis=(0, 1, 0), pos=(0.02, 0, 0), range=radians(-60, 60))
        scene.supersphere(parent, f"link{i}", (LENGTH / 2, WIDTH / 2, WIDTH / 2), 0.6, 32, pos=(-LENGTH / 2, 0, 0),
                          density=500, material="robot")
    return scene.world.find("body")


def add_bridge(scene):
    bridge = element(scene.world, "body", name="bridge")
    half, wide = HOLE / 2, 2.0  # too wide to go around
    for side, (y, z, sy, sz) in {"above": (0, half + wide / 2, wide, wide / 2), "below": (0, -half - wide / 2, wide, wide / 2),
                                 "left": (half + wide / 2, 0, wide / 2, half), "right": (-half - wide / 2, 0, wide / 2, half)}.items():
        element(bridge, "geom", name=side, type="box", pos=(0, y, z), size=(THICKNESS / 2, sy, sz), material="stone")
    for i in range(9):  # a balustrade
        scene.supersphere(bridge, f"post{i}", (0.08, 0.08, 0.16), 0.4, 18, pos=(0, 0.28 * (i - 4), half + wide + 0.14),
                          material="stone")
    return bridge


def main():
    scene = Scene("bridge", HERE)
    scene.material("robot", (0.85, 0.35, 0.2, 1))
    scene.material("stone", (0.6, 0.58, 0.55, 1))
    scene.look(camera_pos=(0.5, -4.5, 1.5), camera_xyaxes=(1, 0.1, 0, 0, 0.3, 1), look_at=(0, 0, 0), extent=1.2)
    robot, bridge = add_robot(scene), add_bridge(scene)
    scene.key("start", {"head": (-0.5, 0.25, 0.3, 0, 0, 0)})
    scene.key("goal", {"head": (2.7, -0.2, -0.25, 0, 0, 0)})
    links, triangles = scene.count(robot)
    scene.write(COMMENT.format(links=links, robot=triangles, bridge=scene.count(bridge)[1], hole=HOLE, width=WIDTH))


if __name__ == "__main__":
    main()
