"""Closed convex triangle meshes for the scene generators: rings of points, lofted together.

Lengths are metres. A ring is a list of points, counter-clockwise seen from the end of the axis; faces point outwards.
Standard library only.
"""
import math
from typing import NamedTuple


class Mesh(NamedTuple):
    vertices: list  # (x, y, z)
    faces: list  # three vertex numbers, from 0


def superellipse(a, b, n, power=2.0, b_low=None):
    """n points of |u/a|^power + |v/b|^power = 1; b_low is the half height below v = 0 where it differs from b."""
    b_low = b if b_low is None else b_low
    points = []
    for i in range(n):
        c, s = math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n)
        u = math.copysign(abs(c) ** (2 / power), c)
        v = math.copysign(abs(s) ** (2 / power), s)
        points.append((a * u, (b if v > 0 else b_low) * v))
    return points


def arc(centre, radius, first, last, steps):
    """Points on a circle from angle first to last (degrees), both included."""
    angles = [math.radians(first + (last - first) * i / steps) for i in range(steps + 1)]
    return [(centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t)) for t in angles]


def rounded_rectangle(half_u, half_v, radius, steps=2):
    corners = [(1, 1, 0), (-1, 1, 90), (-1, -1, 180), (1, -1, 270)]
    return [point for su, sv, start in corners
            for point in arc((su * (half_u - radius), sv * (half_v - radius)), radius, start, start + 90, steps)]


def tapered_stadium(radius0, radius1, length, steps=8):
    """Outline of the hull of a circle at u = 0 and a circle at u = length."""
    tilt = math.degrees(math.asin((radius0 - radius1) / length))
    edge = 90 - tilt
    return arc((length, 0), radius1, -edge, edge, steps) + arc((0, 0), radius0, edge, 360 - edge, steps)


def loft(sections, axis="z"):
    """Joins sections (height along the axis, ring of (u, v)); a ring of one point is a pole.

    (u, v) are the two axes after `axis`: x -> (y, z), y -> (z, x), z -> (x, y). Open ends are closed flat.
    """
    turn = "zyx".index(axis)
    vertices, faces, before = [], [], None
    for height, ring in sections:
        start = len(vertices)
        for u, v in ring:
            point = (u, v, height)
            vertices.append(point[turn:] + point[:turn] if axis != "z" else point)
        now = list(range(start, len(vertices)))
        faces += cap(now[::-1]) if before is None else band(before, now)
        before = now
    return Mesh(vertices, faces + cap(before))


def cap(ring):
    return [(ring[0], ring[i], ring[i + 1]) for i in range(1, len(ring) - 1)]


def band(low, high):
    """Triangles between two rings of equal size, one of which may be a pole."""
    n = max(len(low), len(high))
    if len(low) == 1:
        return [(low[0], high[(i + 1) % n], high[i]) for i in range(n)]
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces.append((low[i], low[j], high[i] if len(high) > 1 else high[0]))
        if len(high) > 1:
            faces.append((low[j], high[j], high[i]))
    return faces


def revolve(profile, n, axis="z"):
    """Turns a profile of (radius, height) about the axis; radius 0 makes a pole."""
    return loft([(height, superellipse(radius, radius, n) if radius > 0 else [(0.0, 0.0)])
                 for radius, height in profile], axis)


def bevelled(outline, low, high, bevel, steps=2, axis="z"):
    """Extrudes outline(inset) from low to high with edges rounded over `bevel`."""
    insets = [math.radians(75 * i / steps) for i in range(steps + 1)]
    edge = [(bevel * (1 - math.cos(t)), bevel * (1 - math.sin(t) / math.sin(insets[-1]))) for t in insets]
    return loft([(low + depth, outline(inset)) for inset, depth in reversed(edge)]
                + [(high - depth, outline(inset)) for inset, depth in edge], axis)


def rounded_box(half_u, half_v, low, high, radius, steps=2, axis="z"):
    """A box of |u| <= half_u, |v| <= half_v, low..high along the axis, with rounded edges and flat faces."""
    return bevelled(lambda inset: rounded_rectangle(half_u - inset, half_v - inset, radius - inset, steps),
                    low, high, radius, steps, axis)


def capsule(radius0, radius1, length, n=16, steps=4, axis="z"):
    """The hull of a ball at the origin and a ball at `length` along the axis."""
    tilt = math.degrees(math.asin((radius0 - radius1) / length))
    low = arc((0, 0), radius0, -90, tilt, steps)
    high = arc((0, length), radius1, tilt, 90, steps)
    profile = [(0.0, low[0][1])] + low[1:] + high[:-1] + [(0.0, high[-1][1])]
    return revolve(profile, n, axis)


def ellipsoid(a, b, c, n=16, steps=8):
    """Half axes a, b, c along x, y, z."""
    sections = [(c * s, superellipse(a * r, b * r, n)) for r, s in arc((0, 0), 1, -90, 90, steps)[1:-1]]
    return loft([(-c, [(0.0, 0.0)])] + sections + [(c, [(0.0, 0.0)])])


def bar(start, end, half_u, half_v, power=4.0, n=12):
    """A straight bar between two points whose end faces lie level (a car's pillar, a table's leg)."""
    ring = superellipse(half_u, half_v, n, power)
    return loft([(p[2], moved(ring, p[0], p[1])) for p in sorted((start, end), key=lambda p: p[2])])


def moved(ring, u, v):
    return [(point[0] + u, point[1] + v) for point in ring]


def translated(mesh, x, y, z):
    return Mesh([(p[0] + x, p[1] + y, p[2] + z) for p in mesh.vertices], mesh.faces)


def mirrored_y(mesh):
    return Mesh([(x, -y, z) for x, y, z in mesh.vertices], [(a, c, b) for a, b, c in mesh.faces])


def write_obj(path, mesh):
    lines = ["v %.6g %.6g %.6g" % point for point in mesh.vertices]
    lines += ["f %d %d %d" % tuple(i + 1 for i in face) for face in mesh.faces]
    path.write_text("\n".join(lines) + "\n")
