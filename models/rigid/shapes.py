"""Closed, outward, manifold triangle meshes of our own, with the triangle counts of Tang & Kim's rigid benchmarks.

All are rings of points joined into a tube (2 n k triangles for k rings of n points), either between two poles or closed
into a torus. Metres. Standard library only.
"""
import math

import mesh_tools as mt

TAU = 2 * math.pi


# ---- Tubes ----

def tube(rings):
    """Joins rings of points, counter-clockwise seen from the far end; a ring of one point is a pole."""
    return _join(rings, closed=False)


def torus(rings):
    """The same without ends: the last ring is joined to the first."""
    return _join(rings, closed=True)


def _join(rings, closed):
    vertices, numbers = [], []
    for ring in rings:
        numbers.append(list(range(len(vertices), len(vertices) + len(ring))))
        vertices += ring
    followers = numbers[1:] + (numbers[:1] if closed else [])
    return mt.Mesh(vertices, [face for low, high in zip(numbers, followers) for face in mt.band(low, high)])


def turned(section, n):
    """A torus from closed sections section(angle) of (radius, height), counter-clockwise with the radius to the right."""
    rings = []
    for i in range(n):
        angle = TAU * i / n
        c, s = math.cos(angle), math.sin(angle)
        rings.append([(r * c, r * s, z) for r, z in reversed(section(angle))])
    return torus(rings)


def sweep(spine, section, n, k):
    """A tube along spine(t), t from 0 to 1, around points section(t) -> function of the angle -> (side, up, ahead)."""
    def frame(t):
        p, ahead = spine(t), [b - a for a, b in zip(spine(t - 1e-4), spine(t + 1e-4))]
        size = math.hypot(*ahead)
        ax, ay, az = (a / size for a in ahead)
        flat = math.hypot(ax, ay)  # the spine is nowhere vertical
        side = (-ay / flat, ax / flat, 0.0)
        up = (-az * side[1], az * side[0], ax * side[1] - ay * side[0])
        return p, side, up, (ax, ay, az)

    rings = [[spine(0.0)]]
    angles = [TAU * j / n for j in range(n)]
    for i in range(k):
        t = (i + 0.5) / k
        p, side, up, ahead = frame(t)
        place = section(t)
        ring = []
        for angle in angles:
            u, v, w = place(angle)
            ring.append(tuple(p[x] + u * side[x] + v * up[x] + w * ahead[x] for x in range(3)))
        rings.append(ring)
    return tube(rings + [[spine(1.0)]])


def resampled(points, count):
    """`count` points evenly along a polyline, both ends included."""
    lengths = [0.0]
    for a, b in zip(points, points[1:]):
        lengths.append(lengths[-1] + math.dist(a, b))
    result, piece = [], 0
    for i in range(count - 1):
        length = lengths[-1] * i / (count - 1)
        while piece < len(points) - 2 and lengths[piece + 1] < length:
            piece += 1
        share = (length - lengths[piece]) / (lengths[piece + 1] - lengths[piece])
        result.append(tuple(a + share * (b - a) for a, b in zip(points[piece], points[piece + 1])))
    return result + [points[-1]]


def interpolated(table, t):
    """Smoothly between the rows (t, value), value being a number."""
    for (t0, a), (t1, b) in zip(table, table[1:]):
        if t <= t1:
            share = (t - t0) / (t1 - t0)
            return a + (b - a) * share * share * (3 - 2 * share)
    return table[-1][1]


# ---- Man-made things ----

def l_shape(length=0.20, width=0.06, height=0.06):
    """20 triangles: an L of two arms, standing on z = 0."""
    outline = [(0, 0), (length, 0), (length, width), (width, width), (width, length), (0, length)]
    vertices = [(x, y, z) for z in (0.0, height) for x, y in outline]
    cap = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    faces = [(a, c, b) for a, b, c in cap] + [(a + 6, b + 6, c + 6) for a, b, c in cap]
    return mt.Mesh(vertices, faces + mt.band(list(range(6)), list(range(6, 12))))


def torus_knot(size=0.10, thickness=0.02, n=10, k=150):
    """3000 triangles: a trefoil around z."""
    def spine(t):
        u = TAU * t
        r = size * (1 + 0.4 * math.cos(3 * u))
        return r * math.cos(2 * u), r * math.sin(2 * u), 0.4 * size * math.sin(3 * u)

    rings = []
    for i in range(k):
        t = i / k
        p = spine(t)
        ahead = _unit([b - a for a, b in zip(spine(t - 1e-4), spine(t + 1e-4))])
        out = _unit([p[x] - ahead[x] * sum(a * b for a, b in zip(ahead, p)) for x in range(3)])
        side = [ahead[y] * out[z] - ahead[z] * out[y] for y, z in ((1, 2), (2, 0), (0, 1))]
        ring = []
        for j in range(n):
            c, s = thickness * math.cos(TAU * j / n), thickness * math.sin(TAU * j / n)
            ring.append(tuple(p[x] + c * out[x] + s * side[x] for x in range(3)))
        rings.append(ring)
    return torus(rings)


def _unit(v):
    size = math.hypot(*v)
    return [x / size for x in v]


def ring(radius=0.05, thickness=0.01, n=16, k=36):
    """1152 triangles: a torus around z."""
    return turned(lambda _: mt.moved(mt.superellipse(thickness, thickness, n), radius, 0), k)


def cup(radius=0.045, height=0.10, wall=0.004, n=20, k=25):
    """1000 triangles: thin-walled and open at the top; stands on z = 0."""
    foot, lip = 0.75 * radius, wall / 2
    outside = [(0, 0), (foot, 0), (0.97 * radius, 0.6 * height), (radius, height)]
    inside = [(radius - wall, height), (0.97 * radius - wall, 0.6 * height), (foot - wall, 2 * wall), (0, 2 * wall)]
    middle = [(radius - lip, height + lip)]
    profile = resampled(outside, 13) + middle + resampled(inside, 13)
    return mt.revolve(profile, n)


def pawn(height=0.10, n=10):
    """300 triangles: a chess piece, standing on z = 0."""
    profile = [(0, 0), (.34, 0), (.34, .07), (.27, .14), (.29, .18), (.17, .27), (.12, .42), (.11, .56), (.20, .60),
               (.11, .65), (.16, .71), (.19, .80), (.17, .89), (.12, .95), (.06, .985), (.03, .995), (0, 1)]
    return mt.revolve([(height * r, height * z) for r, z in profile], n)


def gear(radius=0.09, height=0.05, n=60):
    """2400 triangles, the "CAD part": a gear of twelve teeth with hub, web, rim and bore, around z."""
    half = height / 2
    bore, hub, web, rim = 0.22 * radius, 0.42 * radius, 0.18 * height, 0.72 * radius

    def section(angle):
        tooth = radius if (12 * angle / TAU) % 1 < 0.5 else 0.86 * radius
        upper = [(tooth, 0.0), (tooth, 0.6 * half), (tooth - 0.03 * radius, 0.75 * half), (rim + 0.01, 0.75 * half),
                 (rim, 0.70 * half), (rim, web), (hub + 0.004, web), (hub, web + 0.002), (hub, half), (bore, half)]
        lower = [(r, -z) for r, z in reversed(upper)]
        return upper[1:] + [(bore, 0.0)] + lower[:-1] + upper[:1]

    return turned(section, n)


def hammer(n=34):
    """1700 triangles: handle along z from 0, head along x; 25 rings of superellipses."""
    rows = [(0.000, .012, .010, 0, 2.4), (0.002, .016, .012, 0, 2.4), (0.010, .019, .014, 0, 2.4)]
    rows += [(0.010 + 0.024 * i, .017 - .004 * math.sin(math.pi * i / 8), .012, 0, 2.4) for i in range(1, 9)]
    rows += [(0.215, .013, .011, 0, 2.6), (0.222, .014, .012, 0, 3.0), (0.224, .040, .014, .002, 3.5),
             (0.226, .058, .017, .004, 4.0), (0.230, .061, .019, .005, 5.0)]
    rows += [(0.230 + 0.007 * i, .062, .020, .005, 6.0) for i in range(1, 5)]
    rows += [(0.262, .061, .019, .005, 5.0), (0.266, .058, .017, .004, 4.0), (0.268, .040, .014, .002, 3.5),
             (0.270, .018, .013, 0, 3.0), (0.274, .014, .010, 0, 2.4)]
    rings = [(z, mt.moved(mt.superellipse(a, b, n, power), x, 0)) for z, a, b, x, power in rows]
    return mt.loft([(0.0, [(0.0, 0.0)])] + rings + [(0.275, [(0.0, 0.0)])])


def spoon(length=0.126, n=10, k=67):
    """1340 triangles: along y, its bowl towards +y and hollow above; Izz is about ten times Iyy, as in Fig. 11."""
    half_width = [(0, .008), (.10, .012), (.50, .006), (.56, .008), (.66, .024), (.80, .036), (.92, .028), (1, .004)]
    thick = [(0, .003), (.55, .003), (.70, .0022), (1, .0018)]
    dip = [(0, 0), (.60, 0), (.82, .014), (1, .001)]

    def section(t):
        a, b, depth = (interpolated(table, t) for table in (half_width, thick, dip))

        def place(angle):
            u = math.cos(angle)
            return a * u, b * math.sin(angle) - depth * (1 - u * u), 0.0

        return place

    return sweep(lambda t: (0.0, length * (t - 0.5), 0.02 * (t - 0.5) ** 2), section, n, k)


def bolt(radius=0.012, pitch=0.008, depth=0.003, turns=6, n=24):
    """A helical thread along z from 0 over a round head below."""
    head = [(0.9 * radius * 2, -0.012), (radius * 2, -0.010), (radius * 2, -0.002), (0.9 * radius * 2, -0.0)]
    rings = [[(0.0, 0.0, -0.012)]]
    rings += [[(r * math.cos(TAU * j / n), r * math.sin(TAU * j / n), z) for j in range(n)] for r, z in head]
    for i in range(8 * turns + 1):
        z = 1e-3 + pitch * i / 8
        rings.append([_on_thread(TAU * j / n, z, radius, pitch, depth) for j in range(n)])
    return tube(rings + [[(0.0, 0.0, rings[-1][0][2])]])


def nut(radius=0.012, pitch=0.008, depth=0.003, clearance=0.0006, height=0.016, n=48):
    """A hexagon that runs on bolt() with `clearance` all around; its lower face is z = 0."""
    def section(angle):
        flat = 1.75 * radius / math.cos((angle + TAU / 12) % (TAU / 6) - TAU / 12)
        steps = 16
        inner = []
        for i in range(steps + 1):
            z = height * (1 - i / steps)
            x, y, _ = _on_thread(angle, z, radius + clearance, pitch, depth)
            inner.append((math.hypot(x, y), z))
        return [(flat, 0.0), (flat, height)] + inner

    return turned(section, n)


def _on_thread(angle, z, radius, pitch, depth):
    phase = (z / pitch - angle / TAU) % 1
    r = radius - depth * abs(2 * phase - 1)
    return r * math.cos(angle), r * math.sin(angle), z


def ball(radius=0.03, n=24, k=12):
    """A sphere: 2 n k triangles."""
    return mt.revolve([(0.0, -radius)] + [(radius * math.sin(math.pi * (i + 0.5) / k),
                                           -radius * math.cos(math.pi * (i + 0.5) / k)) for i in range(k)]
                      + [(0.0, radius)], n)


def post(radius=0.02, height=0.15, n=24):
    """A rod on a round foot, standing on z = 0."""
    return mt.revolve([(0, 0), (3 * radius, 0), (3 * radius, 0.01), (radius, 0.015), (radius, height - 0.003),
                       (radius - 0.003, height), (0, height)], n)


def box(x, y, z):
    """12 triangles, centred, half sizes."""
    return mt.loft([(-z, [(x, -y), (x, y), (-x, y), (-x, -y)]), (z, [(x, -y), (x, y), (-x, y), (-x, -y)])])


# ---- Organic things ----

def bumpy_sphere(radius=0.08, n=50, k=29):
    """2900 triangles: bumps all over."""
    def place(polar, angle):
        r = radius * (1 + 0.12 * math.sin(6 * polar) * math.sin(polar) * math.cos(7 * angle))
        return r * math.sin(polar) * math.cos(angle), r * math.sin(polar) * math.sin(angle), -r * math.cos(polar)

    rings = [[place(math.pi * (i + 0.5) / k, TAU * j / n) for j in range(n)] for i in range(k)]
    return tube([[(0.0, 0.0, -radius)]] + rings + [[(0.0, 0.0, radius)]])


class Limb:
    """A bump at (t, angle) of a sweep, `width` of it in t and `spread` in angle, pulled out by (side, up, ahead)."""

    def __init__(self, t, angle, width, spread, pull):
        self.t, self.angle, self.width, self.spread, self.pull = t, math.radians(angle), width, spread, pull


def both_sides(t, angle, width, spread, pull):
    return [Limb(t, angle, width, spread, pull), Limb(t, 180 - angle, width, spread, (-pull[0], *pull[1:]))]


def creature(spine, girth, limbs, skin, n, k):
    """A body of radius girth(t) along a spine with limbs and a skin(t, angle) that adds to the radius by its share."""
    def section(t):
        radius = interpolated(girth, t)
        near = []
        for limb in limbs:
            weight = math.exp(-((t - limb.t) / limb.width) ** 2)
            if weight > 1e-4:
                near.append((limb, weight))

        def place(angle):
            r = radius * (1 + skin(t, angle))
            u, v, w = r * math.cos(angle), r * math.sin(angle), 0.0
            for limb, weight in near:
                away = (angle - limb.angle + math.pi) % TAU - math.pi
                pull = weight * math.exp(-(away / limb.spread) ** 2)
                u += pull * limb.pull[0]
                v += pull * limb.pull[1]
                w += pull * limb.pull[2]
            return u, v, w

        return place

    return sweep(spine, section, n, k)


def bunny(n=200, k=100):
    """40000 triangles: haunches, forelegs, head and two ears, from the tail at -x to the nose."""
    def spine(t):
        return 0.20 * (t - 0.5), 0.0, 0.05 * t * t

    girth = [(0, .012), (.06, .035), (.30, .062), (.55, .052), (.68, .036), (.82, .044), (.95, .026), (1, .008)]
    limbs = (both_sides(.84, 68, .030, .16, (.012, .085, -.030))       # ears
             + both_sides(.28, -25, .10, .45, (.022, -.012, .0))       # haunches
             + both_sides(.38, -62, .05, .26, (.012, -.040, .030))     # hind feet
             + both_sides(.62, -65, .04, .24, (.008, -.050, .012))     # forelegs
             + [Limb(.04, 75, .03, .5, (0, .02, -.02))])               # tail

    def skin(t, angle):
        return 0.012 * math.sin(90 * t) * math.sin(22 * angle)

    return creature(spine, girth, limbs, skin, n, k)


def dragon(n=100, k=870):
    """174000 triangles: a winding body with a row of spines, four legs, wings, horns and a scaly skin."""
    def spine(t):
        return 0.50 * (t - 0.5), 0.045 * math.sin(2.6 * math.pi * t), 0.03 * math.sin(math.pi * t) + 0.05 * t ** 4

    girth = [(0, .002), (.25, .014), (.45, .034), (.60, .036), (.75, .020), (.84, .017), (.90, .026), (.97, .016),
             (1, .006)]
    limbs = (both_sides(.46, -40, .018, .22, (.030, -.060, .0)) + both_sides(.66, -40, .016, .22, (.026, -.060, .012))
             + both_sides(.56, 45, .035, .12, (.090, .070, -.03)) + both_sides(.885, 62, .008, .18, (.010, .035, -.03)))

    def skin(t, angle):
        back = (angle - math.pi / 2 + math.pi) % TAU - math.pi
        spines = 0.55 * abs(math.sin(26 * math.pi * t)) ** 3 * math.exp(-(back / 0.16) ** 2) if abs(back) < 0.6 else 0.0
        return spines + 0.015 * math.sin(200 * math.pi * t) * math.cos(20 * angle)

    return creature(spine, girth, limbs, skin, n, k)
