"""Makes hand_bottle.xml and assets/*.obj: a hand of 25 links and a bottle. Run it without arguments."""
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import mesh_tools as mt
from scene_tools import Scene, element, quaternion, radians

COMMENT = """
A right hand beside a bottle on a table. Made by make_hand_bottle.py; change that, not this.

Units: m, kg, s, rad. Hand: {links} links, 25 DoF (free palm 6; index, middle, ring, little finger 4 each: abduction, MCP,
PIP, DIP; thumb 3: CMC, MCP, IP; the five fingertips are fixed to the last segments), {hand} triangles.
Bottle: {bottle} triangles in 4 convex parts, fixed. After Tang & Kim, "Hand". The table is the plane z = 0.
Palm frame: origin at the wrist, x to the fingers, y to the thumb's side, z out of the back of the hand.

Sources. Segment lengths: fractions of hand length (here 0.190 m) of the kinematic hand model of B. Buchholz and
T. Armstrong, J. Biomechanics 25(2), 1992, as hand models commonly repeat them (the original table was not at hand). Mass
and inertia: volume of the meshes times 1160 kg/m^3, the density of the hand by Dempster as given in D. Winter,
"Biomechanics and Motor Control of Human Movement" (overlaps at the joints count twice; a real hand is 0.6 % of body mass,
0.45 kg of 75). Ours: thickness, where joints sit on the palm, joint ranges (usual active ranges, rounded).
Weight is compensated: an arm holds the hand.

Known answer: keyframe edge_into_table. The palm stands on its little finger's side, its widest point exactly 10 mm below
the table: the deepest contact is 0.010 m, and as lifting by 10 mm is one repair, sigma <= 1e-4 m^2.
"""

HAND_LENGTH = 0.190
SPREAD = 0.044  # half the palm's greatest width
# knuckle on the palm, lengths of proximal, middle, distal segment (of hand length), radius at the knuckle
FINGERS = {
    "index": ((0.092, 0.033), (0.265, 0.143, 0.097), 0.0097),
    "middle": ((0.095, 0.011), (0.277, 0.170, 0.108), 0.0099),
    "ring": ((0.091, -0.011), (0.259, 0.165, 0.107), 0.0095),
    "little": ((0.086, -0.032), (0.206, 0.117, 0.093), 0.0083),
}
THUMB = ((0.251, 0.196, 0.158), (0.0150, 0.0118, 0.0105))  # lengths, radii
THUMB_BASE = (0.016, 0.024, -0.008)
THUMB_AXES = (0.75, 0.60, -0.28, -0.55, 0.22, -0.80)  # x along the thumb, y its flexion axis, in the palm
OPPOSITION = (-0.75, 0.55, 0.37)  # minus the palm's x, in the thumb's frame
UPRIGHT = (90, 0, 0)  # palm towards +y, thumb up

SKIN, PAD = ({"material": material, "density": 1160} for material in ("skin", "pad"))

FINGER_RANGES = {"abduction": (-15, 15), "mcp": (-20, 90), "pip": (0, 105), "dip": (0, 80)}
THUMB_RANGES = {"cmc": (-15, 60), "mcp": (-5, 60), "ip": (-10, 80)}

HOME = {"palm": (-0.09, -0.085, 0.095, *UPRIGHT)}
ASIDE = (-0.10, -0.16, 0.10, *UPRIGHT)


def curl(mcp, pip, dip, fingers=tuple(FINGERS)):
    """The same bend for several fingers."""
    bend = {"mcp": mcp, "pip": pip, "dip": dip}
    return {f"{finger}_{joint}": angle for finger in fingers for joint, angle in bend.items()}


def thumb(*angles):
    return {f"thumb_{kind}": angle for kind, angle in zip(THUMB_RANGES, angles)}


KEYS = {  # what differs from HOME
    "edge_into_table": {"palm": (-0.16, -0.12, SPREAD - 0.010, *UPRIGHT)},
    "finger_pokes_bottle": {"palm": (-0.237, 0.005, 0.10, *UPRIGHT)},
    "gentle_grasp": {"palm": (-0.085, -0.058, 0.095, *UPRIGHT), **curl(40, 44, 22), **thumb(-12, 0, 0),
                     "little_mcp": 30},
    "tight_grasp": {"palm": (-0.085, -0.052, 0.10, *UPRIGHT), **curl(50, 50, 40), **thumb(25, 0, 20)},
    "grasp_through_table": {"palm": (-0.085, -0.05, 0.035, *UPRIGHT), **curl(50, 50, 40), **thumb(20, 10, 30)},
    "fingers_through_bottle": {"palm": (-0.17, 0, 0.10, *UPRIGHT)},
    "two_fingers_through_bottle": {"palm": (-0.13, 0, 0.10, *UPRIGHT), **curl(70, 90, 60, ("ring", "little"))},
    "palm_inside_bottle": {"palm": (-0.04, 0, 0.10, *UPRIGHT)},
    "thumb_through_neck": {"palm": (-0.075, -0.06, 0.165, *UPRIGHT), "thumb_cmc": 25},
    "cap_in_palm": {"palm": (-0.06, 0, 0.24, 0, 0, 0), **curl(20, 20, 10)},
    "hand_down_to_shoulder": {"palm": (-0.06, 0, 0.16, 0, 0, 0), **curl(20, 20, 10)},
    "fingers_under_table": {"palm": (-0.15, -0.15, 0.03, 0, 0, 0), **curl(40, 30, 20)},
    "thumb_inside_fist": {"palm": ASIDE, **curl(88, 100, 60), **thumb(40, 0, 30)},
    "thumb_against_index": {"palm": ASIDE, **curl(50, 60, 30), **thumb(40, 20, 20)},
    "crossed_fingers": {"palm": ASIDE, "index_abduction": -8, "middle_abduction": 6},
    "fist_around_neck": {"palm": (-0.08, -0.034, 0.212, *UPRIGHT), **curl(75, 85, 60), **thumb(20, 40, 40)},
}


def palm_mesh():
    sections = [(-0.020, 0.0290, 0.0185), (0.0, 0.0315, 0.0188), (0.022, 0.0360, 0.0180), (0.040, 0.0395, 0.0168),
                (0.054, 0.0425, 0.0155), (0.064, SPREAD, 0.0143), (0.071, 0.0432, 0.0125), (0.0755, 0.0400, 0.0090)]
    return mt.loft([(x, mt.superellipse(y, z, 24, 2.6)) for x, y, z in sections], "x")


def add_joint(scene, body, name, axis, limits):
    element(body, "joint", name=name, axis=axis, range=radians(*limits), damping=0.02, armature=0.0005)
    element(scene.actuator, "position", name=f"{name}_drive", joint=name, kp=2, kv=0.02, inheritrange=1)


def add_segment(scene, parent, name, pos, joint, **frame):
    """A body with one hinge; joint is (name, axis, range in degrees)."""
    body = element(parent, "body", name=name, pos=pos, gravcomp=1, **frame)
    add_joint(scene, body, *joint)
    return body


def add_tip(scene, parent, finger, length, radius):
    """The fixed last body: the pad, on the palm's side of the segment's end."""
    tip = element(parent, "body", name=f"{finger}_tip", pos=(length, 0, 0), gravcomp=1)
    mesh = mt.ellipsoid(1.25 * radius, radius, 0.92 * radius, 16, 8)
    scene.mesh_geom(tip, f"{finger}_tip", mesh, **PAD, pos=(0, 0, -0.1 * radius))


def add_finger(scene, palm, finger):
    (x, y), fractions, radius = FINGERS[finger]
    joints = {kind: (f"{finger}_{kind}", (0, 0, 1) if kind == "abduction" else (0, 1, 0), limits)
              for kind, limits in FINGER_RANGES.items()}
    body = add_segment(scene, palm, f"{finger}_knuckle", (x, y, 0), joints["abduction"])
    knuckle = mt.ellipsoid(1.25 * radius, 1.02 * radius, 1.06 * radius, 14, 8)
    scene.mesh_geom(body, f"{finger}_knuckle", knuckle, **SKIN, pos=(-0.004, 0, 0))
    pos = (0, 0, 0)
    for segment, kind, fraction in zip(("proximal", "middle", "distal"), ("mcp", "pip", "dip"), fractions):
        body = add_segment(scene, body, f"{finger}_{segment}", pos, joints[kind])
        length = fraction * HAND_LENGTH - (0.005 if segment == "distal" else 0)
        mesh = mt.capsule(radius, 0.91 * radius, length, 16, 4, "x")
        scene.mesh_geom(body, f"{finger}_{segment}", mesh, **SKIN)
        radius, pos = 0.91 * radius, (length, 0, 0)
    add_tip(scene, body, finger, pos[0], 0.98 * radius)


def add_thumb(scene, palm):
    fractions, radii = THUMB
    body, pos, frame = palm, THUMB_BASE, {"xyaxes": THUMB_AXES}
    for i, (segment, kind) in enumerate(zip(("metacarpal", "proximal", "distal"), THUMB_RANGES)):
        axis = OPPOSITION if kind == "cmc" else (0, 1, 0)
        body = add_segment(scene, body, f"thumb_{segment}", pos, (f"thumb_{kind}", axis, THUMB_RANGES[kind]), **frame)
        length = fractions[i] * HAND_LENGTH - (0.006 if kind == "ip" else 0)
        mesh = mt.capsule(radii[i], radii[i + 1] if i < 2 else 0.0090, length, 16, 4, "x")
        scene.mesh_geom(body, f"thumb_{segment}", mesh, **SKIN)
        pos, frame = (length, 0, 0), {}
    add_tip(scene, body, "thumb", pos[0], 0.0094)


def add_hand(scene):
    palm = element(scene.world, "body", name="palm", pos=HOME["palm"][:3], quat=quaternion(UPRIGHT), gravcomp=1)
    element(palm, "freejoint", name="palm")
    scene.mesh_geom(palm, "palm", palm_mesh(), **SKIN)
    for finger in FINGERS:
        add_finger(scene, palm, finger)
    add_thumb(scene, palm)
    return palm


def add_bottle(scene):
    body = element(scene.world, "body", name="bottle")
    shoulder = [(0.014 + 0.022 * c, 0.155 + 0.045 * s) for c, s in mt.arc((0, 0), 1, 0, 80, 4)]
    for part, material, profile in [
            ("body", "glass", [(0.032, 0.001), (0.036, 0.005), (0.036, 0.155), (0.034, 0.157)]),
            ("shoulder", "glass", shoulder),
            ("neck", "glass", [(0.0135, 0.190), (0.0135, 0.236)]),
            ("cap", "cap", [(0.0155, 0.234), (0.0155, 0.252), (0.0140, 0.254)])]:
        scene.mesh_geom(body, f"bottle_{part}", mt.revolve(profile, 24), material=material)
    return body


def main():
    scene = Scene("hand_bottle", HERE)
    scene.material("skin", (0.90, 0.70, 0.58, 1), 0.2, 0.3)
    scene.material("pad", (0.93, 0.62, 0.54, 1), 0.2, 0.3)
    scene.material("glass", (0.20, 0.55, 0.38, 0.85), 0.9, 0.9)
    scene.material("cap", (0.85, 0.20, 0.18, 1))
    scene.stage(camera_pos=(0.08, -0.46, 0.30), camera_xyaxes=(1, 0.18, 0, -0.07, 0.40, 0.91), look_at=(0, 0, 0.1),
                extent=0.25, tile=0.1)
    palm, bottle = add_hand(scene), add_bottle(scene)
    for name, pose in {"home": {}, **KEYS}.items():
        scene.key(name, {**HOME, **pose})
    links, triangles = scene.count(palm)
    scene.write(COMMENT.format(links=links, hand=triangles, bottle=scene.count(bottle)[1]))


if __name__ == "__main__":
    main()
