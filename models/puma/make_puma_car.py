"""Makes puma_car.xml and assets/*.obj: a Puma 560 on a cart beside a car. Run it without arguments."""
import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import beetle
import mesh_tools as mt
from scene_tools import Scene, element, radians

COMMENT = """
Puma 560 on a cart, beside a car like a Volkswagen Beetle. Made by make_puma_car.py; change that, not this.

Units: m, kg, s, rad. Robot: {links} links, 9 DoF (cart x and y, pedestal yaw, six arm hinges), {robot} triangles.
Car: {car} triangles in {parts} convex parts; hollow cabin, side windows open. After Tang & Kim, "Puma1" and "Puma2".

Sources. Denavit-Hartenberg parameters (standard convention: the frame of body link<i> is DH frame i), masses, centres
of mass and inertias: P. Corke, B. Armstrong-Helouvry, "A search for consensus among model parameters reported for the
PUMA 560 robot", ICRA 1994, from B. Armstrong, O. Khatib, J. Burdick, "The explicit dynamic model and inertial
parameters of the PUMA 560 arm", ICRA 1986. Joint limits: Wang & Chen, IEEE Trans. RA 7(4), 1991.
All read from the Puma 560 of Corke's Robotics Toolbox.
Ours: link1 has a published inertia about its axis (0.35) but no published mass: 13 kg, placed and spread by its shape.
link3's published 0.086 breaks Ixx + Izz >= Iyy, which MuJoCo refuses; 0.066 stands in its place. The published values
of link6 stay although a tool of no weight was added. Cart and pedestal are plain boxes of 60 and 20 kg.

Known answer: keyframe cart_in_running_board. The cart's flat front overlaps the flat face of the running board by 20 mm.
Only the two slides move the cart, they carry the whole robot, and so the nearest free configuration is exactly 20 mm
back along x: sigma = 0.02^2 = 4e-4 m^2, root-mean-square displacement 0.02 m, depth 0.02 m.
"""

CAR_X = 1.75  # the car stands across the robot's x axis, its left side towards the robot
CART_TOP, CART_HALF = 0.30, 0.35
SHOULDER = 0.672  # above the cart's top

# DH rows of link 1..6: a, alpha (degrees), d, joint range (degrees), mass, centre of mass, inertia (xx, yy, zz)
LINKS = [
    (0.0, 90, SHOULDER, (-160, 160), 13.0, (0, -0.06, 0.03), (0.28, 0.35, 0.20)),
    (0.4318, 0, 0.0, (-45, 225), 17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539)),
    (0.0203, -90, 0.15005, (-225, 45), 4.8, (-0.0203, -0.0141, 0.070), (0.066, 0.066, 0.0125)),
    (0.0, 90, 0.4318, (-110, 170), 0.82, (0, 0.019, 0), (1.8e-3, 1.3e-3, 1.8e-3)),
    (0.0, -90, 0.0, (-100, 100), 0.34, (0, 0, 0), (0.3e-3, 0.4e-3, 0.3e-3)),
    (0.0, 0, 0.0, (-266, 266), 0.09, (0, 0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3)),
]
DRIVES = [(2000, 300), (2000, 300), (1200, 150), (200, 20), (200, 20), (50, 5)]  # position gain, damping

HOME = {"j2": 110, "j3": -150, "j5": -50}
KEYS = {  # what differs from HOME
    "cart_in_running_board": {"cart_x": 0.68, "j1": 150},
    "tool_scratches_door": {"cart_x": 0.155, "j2": 20, "j3": -130, "j5": 20},
    "reach_through_window": {"cart_x": 0.6, "cart_y": 0.1, "j2": 25, "j3": -155, "j5": 0},
    "tool_under_roof_edge": {"cart_x": 0.6, "cart_y": -0.1, "j2": 50, "j3": -140, "j5": 0},
    "arm_through_roof": {"cart_x": 0.6, "j2": 60, "j3": -150, "j5": 0},
    "arm_through_door": {"cart_x": 0.5, "j2": -10, "j3": -90, "j5": 0},
    "arm_through_windscreen": {"cart_x": 0.55, "cart_y": 0.65, "j2": 20, "j3": -110, "j5": 0},
    "wrist_in_seat_back": {"cart_x": 0.6, "cart_y": -0.3, "j2": 30, "j3": -150, "j5": 0},
    "arm_deep_in_tail": {"cart_x": 0.6, "cart_y": -1.3, "base_yaw": 10, "j2": 20, "j3": -120, "j5": 0},
    "wheel_against_wheel": {"cart_x": 0.72, "cart_y": 1.1, "base_yaw": 40, "j1": 90},
    "cart_inside_car": {"cart_x": 1.75, "cart_y": 0.2},
    "tool_in_own_column": {"j2": -44, "j3": -184, "j4": -90, "j5": 80},
    "tool_in_own_cart": {"j2": -40, "j3": -160, "j5": 0},
    "own_cart_and_running_board": {"cart_x": 0.72, "j1": 150, "j2": -40, "j3": -165, "j5": 10},
}


def link_shapes():
    """For each arm link its convex parts, in its DH frame: suffix -> (mesh, material)."""
    def upper_arm(inset):
        return mt.moved(mt.tapered_stadium(0.125 - inset, 0.075 - inset, 0.4318, 6), -0.4318, 0)

    forearm = [(-0.09, 0.040), (-0.05, 0.064), (0.03, 0.062), (0.30, 0.042)]
    return [
        {"column": (mt.revolve([(0.085, -0.25), (0.085, 0.0)], 16, "y"), "white"),
         "shoulder": (mt.revolve([(0.08, -0.12), (0.10, -0.10), (0.10, 0.185)], 16), "white")},
        {"arm": (mt.bevelled(upper_arm, 0.19, 0.285, 0.02, 1), "white")},
        {"forearm": (mt.loft([(z, mt.superellipse(a, 0.6 * a, 12, 3)) for z, a in forearm]), "white")},
        {"barrel": (mt.revolve([(0.036, -0.125), (0.036, -0.035)], 10, "y"), "grey")},
        {"knuckle": (mt.revolve([(0.030, -0.034), (0.030, 0.034)], 10, "y"), "white")},
        {"flange": (mt.revolve([(0.030, 0.020), (0.030, 0.056)], 10), "grey"),
         "tool": (mt.rounded_box(0.012, 0.026, 0.056, 0.19, 0.008, 1), "orange")},
    ]


def add_base(scene):
    """Cart with the slides x and y, and on it the pedestal with the yaw; returns the pedestal."""
    cart = element(scene.world, "body", name="cart", pos=(0, 0, 0))
    element(cart, "inertial", pos=(0, 0, 0.18), mass=60, diaginertia=(1.7, 2.6, 4.0))
    for name, axis in (("cart_x", (1, 0, 0)), ("cart_y", (0, 1, 0))):
        element(cart, "joint", name=name, type="slide", axis=axis, range=(-6, 6), damping=200)
    deck = mt.rounded_box(CART_HALF, 0.27, 0.11, CART_TOP, 0.04, 1)
    scene.mesh_geom(cart, "cart_deck", deck, material="orange")
    wheel = mt.revolve([(0.08, -0.025), (0.08, 0.025)], 10, "y")
    for i, (x, y) in enumerate([(0.24, 0.22), (0.24, -0.22), (-0.24, 0.22), (-0.24, -0.22)]):
        scene.mesh_geom(cart, f"cart_wheel{i + 1}", wheel, pos=(x, y, 0.085), material="rubber")
    pedestal = element(cart, "body", name="pedestal", pos=(0, 0, CART_TOP))
    element(pedestal, "inertial", pos=(0, 0, 0.18), mass=20, diaginertia=(0.35, 0.35, 0.12))
    element(pedestal, "joint", name="base_yaw", axis=(0, 0, 1), range=radians(-180, 180), damping=100)
    profile = [(0.15, 0.0), (0.15, 0.025), (0.09, 0.07), (0.085, 0.41)]
    scene.mesh_geom(pedestal, "pedestal_foot", mt.revolve(profile[:3], 16), material="grey")
    scene.mesh_geom(pedestal, "pedestal_column", mt.revolve(profile[2:], 16), material="white")
    return pedestal


def add_arm(scene, parent):
    """Links 1..6; each body frame is the DH frame, so the joint sits at the frame before it."""
    for i, (row, shapes, drive) in enumerate(zip(LINKS, link_shapes(), DRIVES), 1):
        a, alpha, d, limits, mass, centre, inertia = row
        twist = math.radians(alpha)
        turn = (math.sin(twist), math.cos(twist))
        body = element(parent, "body", name=f"link{i}", pos=(a, 0, d),
                       quat=(math.cos(twist / 2), math.sin(twist / 2), 0, 0))
        element(body, "inertial", pos=centre, mass=mass, diaginertia=inertia)
        element(body, "joint", name=f"j{i}", pos=(-a, -d * turn[0], -d * turn[1]), axis=(0, *turn),
                range=radians(*limits), damping=1, armature=0.2)
        for suffix, (mesh, material) in shapes.items():
            scene.mesh_geom(body, f"link{i}_{suffix}", mesh, material=material)
        element(scene.actuator, "position", name=f"j{i}_drive", joint=f"j{i}", kp=drive[0], kv=drive[1],
                inheritrange=1)
        parent = body


def add_car(scene):
    car = element(scene.world, "body", name="car", pos=(CAR_X, 0, 0), quat=(math.sqrt(0.5), 0, 0, math.sqrt(0.5)))
    for name, (mesh, pos, material) in beetle.parts().items():
        scene.mesh_geom(car, f"car_{name}", mesh, pos=pos, material=material, density=260)
    return car


def main():
    scene = Scene("puma_car", HERE)
    for name, *look in [("paint", (0.55, 0.78, 0.80, 1), 0.8, 0.8), ("chrome", (0.85, 0.86, 0.88, 1), 1.0, 0.9),
                        ("rubber", (0.12, 0.12, 0.13, 1), 0.1, 0.1), ("chassis", (0.20, 0.22, 0.24, 1), 0.2, 0.2),
                        ("glass", (0.75, 0.88, 0.95, 0.35), 1.0, 0.9), ("seat", (0.45, 0.25, 0.18, 1), 0.2, 0.2),
                        ("white", (0.93, 0.92, 0.88, 1)), ("grey", (0.45, 0.47, 0.50, 1)),
                        ("orange", (0.93, 0.50, 0.15, 1))]:
        scene.material(name, *look)
    scene.stage(camera_pos=(-2.2, -3.7, 2.2), camera_xyaxes=(0.80, -0.60, 0, 0.15, 0.20, 0.97), look_at=(1, 0, 0.7),
                extent=2.5, tile=0.5)
    add_arm(scene, add_base(scene))
    car = add_car(scene)
    for name, pose in {"home": {}, **KEYS}.items():
        scene.key(name, {**HOME, **pose})
    links, robot = scene.count(scene.world.find("body[@name='cart']"))
    scene.write(COMMENT.format(links=links, robot=robot, car=scene.count(car)[1], parts=len(beetle.parts())))


if __name__ == "__main__":
    main()
