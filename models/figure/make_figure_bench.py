"""Makes figure_bench.xml and assets/*.obj: a person of 15 links and a bench. Run it without arguments."""
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import mesh_tools as mt
from scene_tools import Scene, element, quaternion, radians

COMMENT = """
A human figure and a bench. Made by make_figure_bench.py; change that, not this.

Units: m, kg, s, rad. Figure: 1.74 m, 73 kg, {links} links, 41 DoF (free pelvis 6, waist ball 3, neck 2; each side:
shoulder ball 3, elbow 2, wrist ball 3, hip ball 3, knee 1, ankle ball 3), {figure} triangles. After Tang & Kim, "Bench".
Ball joints with a limit on their total angle: waist, hips, wrists, ankles; without: shoulders.
Bench: seat, back, legs and armrests from {boxes} boxes and seven meshes ({bench} triangles), fixed; floor z = 0.
The figure looks along x, y is its left, z up; at qpos0 it stands with hanging arms before the bench.

Sources. Segment masses and lengths: P. de Leva, "Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters",
J. Biomechanics 29(9), 1996, males, 73 kg and 1.741 m; the chest is his upper and middle trunk, the pelvis his lower
trunk. Centres of mass and inertias follow from the meshes with these masses, evenly filled. Ours: thickness, joint
ranges (rounded).

Known answer: keyframe feet_in_floor. Both flat soles are 20 mm below the floor and nothing else touches: the depth is
0.020 m, and as lifting the whole figure by 20 mm is one repair, sigma <= 4e-4 m^2.
"""

MASS = 73.0
# share of body mass (de Leva 1996, males)
SHARE = {"pelvis": 0.1117, "chest": 0.1596 + 0.1633, "head": 0.0694, "upper_arm": 0.0271, "forearm": 0.0162,
         "hand": 0.0061, "thigh": 0.1416, "shank": 0.0433, "foot": 0.0137}
THIGH, SHANK, SOLE = 0.422, 0.434, 0.075  # lengths; ankle above the sole
UPPER_ARM, FOREARM = 0.282, 0.269
CLEARANCE = 0.005  # soles over the floor at qpos0
HIP = THIGH + SHANK + SOLE + CLEARANCE
BENCH_X, SEAT, HALF_WIDTH = -0.62, 0.45, 0.66  # the bench's middle, its seat's height, half its width


def both(joint, value):
    """The same for left and right; a ball's rotation vector is mirrored."""
    other = (-value[0], value[1], -value[2]) if isinstance(value, tuple) else value
    return {f"left_{joint}": value, f"right_{joint}": other}


UPRIGHT = (0, 0, 0)
SEATED = {"pelvis": (BENCH_X - 0.06, 0, SEAT + 0.092, *UPRIGHT), **both("hip", (0, -87, 0)), **both("knee", 84),
          **both("ankle", (0, 3, 0)), **both("shoulder", (0, -25, 0)), **both("elbow", 45)}
ON_BACK = (-69.282, -69.282, -69.282)  # 120 degrees: head to +y, face up
KEYS = {
    "home": SEATED,
    "feet_in_floor": {"pelvis": (0, 0, HIP - CLEARANCE - 0.020, *UPRIGHT)},
    "slumped_into_seat": {**SEATED, "pelvis": (BENCH_X - 0.06, 0, SEAT + 0.062, *UPRIGHT)},
    "lean_on_back": {**SEATED, "waist": (0, -22, 0)},
    "sunk_into_seat": {**SEATED, "pelvis": (BENCH_X - 0.06, 0, SEAT + 0.03, *UPRIGHT)},
    "sunk_to_waist": {**SEATED, "pelvis": (BENCH_X - 0.05, 0, SEAT - 0.06, *UPRIGHT)},
    "waist_deep_in_floor": {"pelvis": (0.2, 0, 0.02, *UPRIGHT)},
    "leaning_through_back": {**SEATED, "pelvis": (BENCH_X - 0.08, 0, SEAT + 0.09, 0, -22, 0)},
    "beside_armrest": {**SEATED, "pelvis": (BENCH_X - 0.06, 0.48, SEAT + 0.092, *UPRIGHT)},
    "sitting_on_armrest": {**SEATED, "pelvis": (BENCH_X - 0.02, 0.62, SEAT + 0.23, *UPRIGHT)},
    "shanks_in_front_leg": {**SEATED, **both("knee", 110), "pelvis": (BENCH_X - 0.06, 0.52, SEAT + 0.092, *UPRIGHT)},
    "standing_through_seat": {"pelvis": (BENCH_X, 0.1, HIP, *UPRIGHT)},
    "lying_under_armrest": {"pelvis": (BENCH_X - 0.02, 0, SEAT + 0.095, *ON_BACK)},
    "arms_in_lap": {**SEATED, **both("shoulder", (-24, -5, 0)), **both("elbow", 45)},
    "arms_crossed": {**SEATED, **both("shoulder", (0, -20, -70)), **both("elbow", 100)},
    "legs_crossed": {**SEATED, "right_hip": (5, -100, 28)},
    "forearm_in_face": {**SEATED, "right_shoulder": (0, -130, 60), "right_elbow": 90},
    "crouching_into_floor": {"pelvis": (0.2, 0, 0.30, *UPRIGHT), "waist": (0, 50, 0), **both("hip", (0, -120, 0)),
                             **both("knee", 138), **both("ankle", (0, -15, 0)), **both("shoulder", (0, -60, 0)),
                             **both("elbow", 20)},
}


def rings(sections, power=2.4, n=20):
    """A loft along z through (z, half x, half y, centre x)."""
    return mt.loft([(z, mt.moved(mt.superellipse(a, b, n, power), x, 0)) for z, a, b, x in sections])


def pelvis_mesh():
    return rings([(-0.085, 0.06, 0.085, 0), (-0.065, 0.095, 0.135, 0), (-0.02, 0.112, 0.165, 0),
                  (0.04, 0.108, 0.160, 0), (0.09, 0.095, 0.142, 0), (0.105, 0.07, 0.11, 0)])


def chest_mesh():
    return rings([(0.02, 0.07, 0.105, 0), (0.04, 0.088, 0.130, 0), (0.14, 0.106, 0.148, 0), (0.25, 0.118, 0.160, 0),
                  (0.33, 0.108, 0.158, 0), (0.385, 0.080, 0.120, 0), (0.415, 0.045, 0.060, 0)])


def head_mesh():
    return mt.translated(mt.ellipsoid(0.098, 0.078, 0.125, 20, 10), 0.015, 0, 0.135)


def foot_mesh():
    """Flat sole at z = -SOLE, the toes towards x."""
    shape = [(-SOLE, 0.034, 0.041, 0.165), (-SOLE + 0.008, 0.040, 0.047, 0.165), (-SOLE + 0.035, 0.036, 0.043, 0.165),
             (0.015, 0.033, 0.030, 0.050)]  # height, radius at heel and toes, the distance of those
    return mt.loft([(z, mt.moved(mt.tapered_stadium(heel, toes, length, 6), -0.035, 0))
                    for z, heel, toes, length in shape])


def hand_mesh():
    return rings([(-0.172, 0.020, 0.008, 0.006), (-0.130, 0.036, 0.012, 0.006), (-0.070, 0.042, 0.0145, 0.004),
                  (-0.010, 0.030, 0.015, 0.0), (0.010, 0.016, 0.010, 0)], 2.6, 16)


def limb(radius, end_radius, length):
    """A tapered capsule that hangs down from the origin."""
    return mt.translated(mt.capsule(end_radius, radius, length, 16, 4), 0, 0, -length)


def add_link(scene, parent, name, pos, mesh, material, **frame):
    """A body of one mesh with its share of the mass; its name may begin with the side."""
    body = element(parent, "body", name=name, pos=pos, **frame)
    share = SHARE[name.replace("left_", "").replace("right_", "")]
    scene.mesh_geom(body, name, mesh, material=material, mass=MASS * share)
    return body


def add_ball(body, name, limit=None):
    """A ball joint; limit (degrees) is on its total angle."""
    extra = {} if limit is None else {"range": radians(0, limit)}
    element(body, "joint", name=name, type="ball", damping=2, armature=0.02, **extra)


def add_hinge(body, name, axis, limits):
    element(body, "joint", name=name, axis=axis, range=radians(*limits), damping=1.5, armature=0.02)


def add_trunk(scene):
    pelvis = add_link(scene, scene.world, "pelvis", (0, 0, HIP), pelvis_mesh(), "trousers")
    element(pelvis, "freejoint", name="pelvis")
    chest = add_link(scene, pelvis, "chest", (0, 0, 0.10), chest_mesh(), "shirt")
    add_ball(chest, "waist", 60)
    head = add_link(scene, chest, "head", (0, 0, 0.43), head_mesh(), "skin")
    add_hinge(head, "neck_nod", (0, 1, 0), (-45, 50))
    add_hinge(head, "neck_turn", (0, 0, 1), (-75, 75))
    scene.mesh_geom(head, "neck", mt.translated(mt.capsule(0.056, 0.050, 0.09, 14, 3), 0, 0, -0.01), material="skin",
                    mass=0)
    return pelvis, chest


def add_arm(scene, chest, side, sign):
    upper = add_link(scene, chest, f"{side}_upper_arm", (0, sign * 0.205, 0.355), limb(0.050, 0.039, UPPER_ARM), "shirt",
                     quat=quaternion((sign * 8, 0, 0)))
    add_ball(upper, f"{side}_shoulder")
    fore = add_link(scene, upper, f"{side}_forearm", (0, 0, -UPPER_ARM), limb(0.039, 0.026, FOREARM), "skin")
    add_hinge(fore, f"{side}_elbow", (0, -1, 0), (0, 145))
    add_hinge(fore, f"{side}_pronation", (0, 0, 1), (-90, 90))
    hand = add_link(scene, fore, f"{side}_hand", (0, 0, -FOREARM), hand_mesh(), "skin")
    add_ball(hand, f"{side}_wrist", 75)


def add_leg(scene, pelvis, side, sign):
    thigh = add_link(scene, pelvis, f"{side}_thigh", (0, sign * 0.09, 0), limb(0.079, 0.054, THIGH), "trousers")
    add_ball(thigh, f"{side}_hip", 125)
    shank = add_link(scene, thigh, f"{side}_shank", (0, 0, -THIGH), limb(0.054, 0.038, SHANK), "trousers")
    add_hinge(shank, f"{side}_knee", (0, 1, 0), (0, 140))
    foot = add_link(scene, shank, f"{side}_foot", (0, 0, -SHANK), foot_mesh(), "shoe")
    add_ball(foot, f"{side}_ankle", 50)


def add_figure(scene):
    pelvis, chest = add_trunk(scene)
    for side, sign in (("left", 1), ("right", -1)):
        add_arm(scene, chest, side, sign)
    for side, sign in (("left", 1), ("right", -1)):
        add_leg(scene, pelvis, side, sign)
    return pelvis


def add_bench(scene):
    """Four slats to sit on, three to lean on, and an iron frame of boxes at either end."""
    bench = element(scene.world, "body", name="bench", pos=(BENCH_X, 0, 0))
    slat = mt.rounded_box(HALF_WIDTH, 0.046, -0.016, 0.016, 0.008)
    for i in range(4):
        scene.mesh_geom(bench, f"seat_slat{i + 1}", slat, material="wood", pos=(-0.15 + 0.105 * i, 0, SEAT - 0.016),
                        quat=quaternion((0, 0, 90)))
    for i in range(3):
        scene.mesh_geom(bench, f"back_slat{i + 1}", slat, material="wood",
                        pos=(-0.225 - 0.014 * i, 0, SEAT + 0.16 + 0.125 * i), xyaxes=(0, 1, 0, -0.11, 0, 1))
    for side, y in (("left", HALF_WIDTH - 0.05), ("right", 0.05 - HALF_WIDTH)):
        for part, pos, size in [("front_leg", (0.17, 0, 0.315), (0.022, 0.025, 0.315)),
                                ("back_leg", (-0.27, 0, 0.43), (0.018, 0.025, 0.43)),
                                ("armrest", (-0.03, 0, 0.645), (0.23, 0.035, 0.015)),
                                ("rail", (-0.03, 0, SEAT - 0.052), (0.23, 0.020, 0.020))]:
            element(bench, "geom", name=f"{side}_{part}", type="box", size=size, pos=(pos[0], y, pos[2]), material="iron")
    return bench


def main():
    scene = Scene("figure_bench", HERE)
    for name, rgba in [("skin", (0.88, 0.68, 0.55, 1)), ("shirt", (0.30, 0.50, 0.72, 1)),
                       ("trousers", (0.25, 0.27, 0.34, 1)), ("shoe", (0.35, 0.22, 0.15, 1)),
                       ("wood", (0.66, 0.44, 0.24, 1)), ("iron", (0.22, 0.24, 0.25, 1))]:
        scene.material(name, rgba, 0.2, 0.3)
    scene.stage(camera_pos=(2.1, -2.3, 1.5), camera_xyaxes=(0.68, 0.73, 0, -0.18, 0.17, 0.97),
                look_at=(-0.4, 0, 0.7), extent=1.2, tile=0.3)
    pelvis, bench = add_figure(scene), add_bench(scene)
    for name, pose in KEYS.items():
        scene.key(name, pose)
    links, triangles = scene.count(pelvis)
    boxes = len(bench.findall("geom[@type='box']"))
    scene.write(COMMENT.format(links=links, figure=triangles, bench=scene.count(bench)[1], boxes=boxes))


if __name__ == "__main__":
    main()
