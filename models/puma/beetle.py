"""A car like the Volkswagen Beetle of 1963 out of convex parts: 4.08 m long, 1.54 m wide, 1.50 m high, hollow cabin.

x forward, y to the left, z up from the road, origin below the middle of the car. The side windows are open.
"""
import math

import mesh_tools as mt

AXLE, TRACK, WHEEL = 1.2, 0.63, 0.32  # half wheel base, half track, wheel radius
SILL = 0.74  # |y| of the flat outer face of the running boards


def nose(front, length, top, bottom, half_width):
    """A lid, high and wide at its flat end, that rounds off to `front`; its `length` reaches back from there."""
    middle = bottom + 0.35 * (top - bottom)
    sections = []
    for angle in (0, 20, 38, 53, 66, 77, 85):
        reach, size = math.sin(math.radians(angle)), math.cos(math.radians(angle)) ** 0.55
        ring = mt.superellipse(half_width * size, (top - middle) * size, 22, 2.5, (middle - bottom) * size)
        sections.append((front - length * (1 - reach), mt.moved(ring, 0, middle)))
    return mt.loft(sections if length > 0 else sections[::-1], "x")


def dome(low, high, half_length, half_width, n, power, steps=4):
    """A flat-bottomed lid with its top at `high`."""
    sections = [(low + (high - low) * s, mt.superellipse(half_length * c, half_width * c, n, power))
                for c, s in mt.arc((0, 0), 1, 0, 90, steps)[:-1]]
    return mt.loft(sections + [(high, [(0.0, 0.0)])])


def body_parts():
    """Name -> (mesh, position, material) of the parts that lie across the car."""
    back = mt.rounded_box(0.06, 0.22, 0.0, 0.55, 0.04, 1)
    cushion = mt.rounded_box(0.24, 0.23, 0.0, 0.16, 0.05, 1)
    parts = {
        "floor_pan": (mt.rounded_box(0.95, 0.55, 0.24, 0.33, 0.03), (-0.15, 0, 0), "chassis"),
        "hood": (nose(1.93, 1.33, 0.99, 0.38, 0.56), (0, 0, 0), "paint"),
        "tail": (nose(-2.02, -1.22, 1.36, 0.36, 0.56), (0, 0, 0), "paint"),
        "roof": (dome(1.29, 1.50, 0.86, 0.54, 32, 3.0), (-0.43, 0, 0), "paint"),
        "windscreen": (mt.bar((0.61, 0, 0.96), (0.36, 0, 1.33), 0.012, 0.5, 8.0), (0, 0, 0), "glass"),
        "front_bumper": (bumper(0.11, 0.03), (1.90, 0, 0.46), "chrome"),
        "rear_bumper": (bumper(0.03, 0.11), (-1.95, 0, 0.46), "chrome"),
    }
    for side, y in (("left", 0.28), ("right", -0.28)):
        parts[f"{side}_seat"] = (cushion, (-0.20, y, 0.36), "seat")
        parts[f"{side}_seat_back"] = (back, (-0.48, y, 0.46), "seat")
    return parts


def bumper(front, back):
    """A round bar across the car; `front` and `back` are its reach from its line at the middle, 3 cm at its ends."""
    sections = []
    for s in (-1, -0.7, -0.35, 0, 0.35, 0.7, 1):
        bow = 1 - s * s
        ring = mt.superellipse(0.045, 0.03 + (front - 0.03) * bow, 10, 2, 0.03 + (back - 0.03) * bow)
        sections.append((0.74 * s, ring))
    return mt.loft(sections, "y")


def door():
    """A panel whose outer face bulges, in the place of the left door."""
    outline = mt.superellipse(0.325, 0.86, 28, 8)
    sections = [(0.52, 1.0), (0.57, 0.985), (0.60, 0.95), (0.615, 0.88)]
    return mt.loft([(y, [(u * size, v * size) for u, v in outline]) for y, size in sections], "y")


def side_parts():
    """The same for the parts of the left side, which the right side mirrors."""
    fender = dome(0.40, 0.80, 0.52, 0.20, 18, 2.3)
    tyre = mt.revolve([(0.27, -0.09), (WHEEL, -0.055), (WHEEL, 0.055), (0.27, 0.09)], 16, "y")
    hub = mt.revolve([(0.14, 0.0), (0.11, 0.025), (0.0, 0.035)], 10, "y")
    parts = {
        "door": (door(), (-0.15, 0, 0.645), "paint"),
        "running_board": (mt.rounded_box(0.74, 0.09, 0.20, 0.30, 0.02), (0, SILL - 0.09, 0), "chassis"),
        "a_pillar": (mt.bar((0.62, 0.56, 0.93), (0.34, 0.48, 1.34), 0.03, 0.03), (0, 0, 0), "paint"),
        "b_pillar": (mt.bar((-0.42, 0.57, 0.93), (-0.42, 0.51, 1.34), 0.05, 0.025), (0, 0, 0), "paint"),
        "headlight": (mt.ellipsoid(0.09, 0.10, 0.11, 14, 6), (1.60, 0.56, 0.72), "chrome"),
    }
    for end, x in (("front", AXLE), ("rear", -AXLE)):
        parts[f"{end}_fender"] = (fender, (x, 0.59, 0), "paint")
        parts[f"{end}_wheel"] = (tyre, (x, TRACK, WHEEL + 0.005), "rubber")
        parts[f"{end}_hub"] = (hub, (x, TRACK + 0.09, WHEEL + 0.005), "chrome")
    return parts


def parts():
    """All of the car: name -> (mesh, position, material)."""
    everything = body_parts()
    for name, (mesh, (x, y, z), material) in side_parts().items():
        everything[f"left_{name}"] = (mesh, (x, y, z), material)
        everything[f"right_{name}"] = (mt.mirrored_y(mesh), (x, -y, z), material)
    return everything
