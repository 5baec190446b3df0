"""Cups and bottles, generated from a seed: one solid each, as the triangles that PDg sees and as the convex pieces that
MuJoCo collides (it takes a mesh for its convex hull, and a cup's hull is full). Lengths are metres; a vessel stands on
z = 0, its axis is z."""

import dataclasses

import numpy as np

SIDES = 24  # of the polygon that stands for a circle: at a radius of 40 mm its sides are 0.3 mm inside the circle


@dataclasses.dataclass(frozen=True)
class Vessel:
    kind: str  # "cup", thin-walled and open at the top, or "bottle", full
    profile: tuple[tuple[float, float], ...]  # (radius, height) of the outside, from the foot up
    wall: float  # thickness, of a cup [m]; its bottom is twice as thick

    @property
    def height(self) -> float:
        return self.profile[-1][1]

    @property
    def density(self) -> float:
        """Stoneware; a bottle that is half full [kg/m³]."""
        return 2300.0 if self.kind == "cup" else 500.0


def random_cup(rng: np.random.Generator) -> Vessel:
    rim = rng.uniform(0.028, 0.046)
    height = rng.uniform(0.085, 0.13)
    foot, middle = rim * rng.uniform(0.65, 1.0), rng.uniform(0.35, 0.65)
    bulge = (1 - middle) * foot + middle * rim + rng.uniform(-0.002, 0.005)
    wall = rng.uniform(0.0025, 0.004)
    return rounded("cup", [(foot, 0.0), (bulge, middle * height), (rim, height)], wall)


def random_bottle(rng: np.random.Generator) -> Vessel:
    body, neck = rng.uniform(0.026, 0.042), rng.uniform(0.012, 0.016)
    shoulder = rng.uniform(0.10, 0.16)
    top = shoulder + rng.uniform(0.05, 0.09)
    slope = rng.uniform(0.015, 0.035)
    return rounded("bottle", [(body, 0.0), (body, shoulder), (neck, shoulder + slope), (neck, top)], 0.0)


def rounded(kind: str, profile: list[tuple[float, float]], wall: float) -> Vessel:
    """To a tenth of a millimetre, so that a vessel written down is the one that was drawn."""
    return Vessel(kind, tuple((round(r, 4), round(z, 4)) for r, z in profile), round(wall, 4))


def outside(vessel: Vessel, z: np.ndarray) -> np.ndarray:
    """Its radius at heights z; 0 above the top."""
    radii, heights = np.array(vessel.profile).T
    return np.interp(z, heights, radii, right=0.0)


def difference(a: Vessel, b: Vessel) -> float:
    """How unlike two vessels are: the rms difference of their outer radii over the taller one's height [m]."""
    z = np.linspace(0.0, max(a.height, b.height), 200)
    return float(np.sqrt(np.mean((outside(a, z) - outside(b, z)) ** 2)))


def excess(a: Vessel, b: Vessel) -> float:
    """By how much a is wider than b at most, over the height that both have [m]; negative: it is narrower."""
    z = np.linspace(0.0, min(a.height, b.height), 200)
    return float(np.max(outside(a, z) - outside(b, z)))


def ring(radius: float, z: float) -> np.ndarray:
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    return np.stack([radius * np.cos(angles), radius * np.sin(angles), np.full(SIDES, z)], axis=1)


def levels(vessel: Vessel) -> list[tuple[float, float]]:
    """(radius, height) of the outside where a cup's pieces meet: its profile and the top of its bottom."""
    if vessel.kind == "bottle":
        return list(vessel.profile)
    floor = 2 * vessel.wall
    return sorted([*vessel.profile, (float(outside(vessel, np.array(floor))), floor)], key=lambda level: level[1])


def triangles(vessel: Vessel) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) and faces (m, 3) of the whole solid, outward."""
    outline = levels(vessel)
    if vessel.kind == "cup":
        outline = outline + [(r - vessel.wall, z) for r, z in reversed(outline[1:])]
    n = SIDES
    vertices = [ring(r, z) for r, z in outline]
    poles = np.array([[0.0, 0.0, outline[0][1]], [0.0, 0.0, outline[-1][1]]])
    first, last = n * len(outline), n * len(outline) + 1
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces.append((first, j, i))
        for low in range(0, n * (len(outline) - 1), n):
            faces += [(low + i, low + j, low + n + j), (low + i, low + n + j, low + n + i)]
        top = n * (len(outline) - 1)
        faces.append((last, top + i, top + j))
    return np.concatenate([*vertices, poles]), np.array(faces)


def pieces(vessel: Vessel) -> list[np.ndarray]:
    """Vertices of the convex pieces whose union is the solid."""
    outline = levels(vessel)
    if vessel.kind == "bottle":
        return [np.concatenate([ring(*low), ring(*high)]) for low, high in zip(outline, outline[1:])]
    bottom = np.concatenate([ring(*outline[0]), ring(*outline[1])])
    staves = []
    for (r0, z0), (r1, z1) in zip(outline[1:], outline[2:]):
        rings = [ring(r, z) for r, z in ((r0, z0), (r1, z1), (r0 - vessel.wall, z0), (r1 - vessel.wall, z1))]
        staves += [np.concatenate([each[[i, (i + 1) % SIDES]] for each in rings]) for i in range(SIDES)]
    return [bottom, *staves]
