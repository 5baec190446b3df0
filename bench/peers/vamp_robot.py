"""A robot of VAMP, measured: VAMP tells where a configuration's spheres are and which of them collide, and no more.

From that come the joints' axes, the spheres that each joint moves and the pairs that count, and from these the same robot as
MJCF and, in double precision, as the spheres of many configurations at once.
"""
from dataclasses import dataclass

import numpy as np

PAIR_SAMPLES = 10000  # random configurations that show which pairs of spheres VAMP asks about
TURN = 16  # angles a turn, at which an axis is measured


@dataclass
class Robot:
    names: list  # of joints
    low: np.ndarray  # (n,) [rad]
    high: np.ndarray
    axis: np.ndarray  # (n, 3), the world's, at q = 0
    point: np.ndarray  # (n, 3), on the axes
    body: np.ndarray  # (spheres,) 0: the base; j + 1: moves with joint j and those before it
    center: np.ndarray  # (spheres, 3), the world's, at q = 0
    radius: np.ndarray
    pairs: np.ndarray  # (pairs, 2), spheres


@dataclass
class Obstacles:
    center: np.ndarray  # (spheres, 3)
    radius: np.ndarray
    box_center: np.ndarray  # (boxes, 3)
    box_half: np.ndarray
    box_euler: np.ndarray  # about the world's x, then its y, then its z [rad]


def rotation(axis, angle):
    """(N,) angles about one axis: (N, 3, 3)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sin, cos = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + sin * cross + (1 - cos) * (cross @ cross)


def box_rotations(obstacles):
    """(boxes, 3, 3)."""
    x, y, z = (rotation(np.eye(3)[k], obstacles.box_euler[:, k]) for k in range(3))
    return z @ y @ x


def spheres_of(module, q):
    """(spheres, 4): centre and radius, VAMP's."""
    return np.array([(s.x, s.y, s.z, s.r) for s in module.fk(np.asarray(q, np.float32))], float)


def measure_axis(module, joint):
    """The axis, a point on it and which spheres it moves. All that move turn about it, so each one's mean is on it."""
    n = module.dimension()
    turn = np.array([spheres_of(module, np.eye(n)[joint] * a)[:, :3] for a in 2 * np.pi * np.arange(TURN) / TURN])
    mean = turn.mean(axis=0)
    arm = turn - mean
    moved = np.linalg.norm(arm[0], axis=1) > 1e-4
    normal = np.cross(arm, np.roll(arm, -1, axis=0))[:, moved].sum(axis=(0, 1))
    return normal / np.linalg.norm(normal), mean[moved].mean(axis=0), moved


def overlaps(center, radius, pairs):
    """(N, pairs): how deep two spheres overlap, negative: how far they are apart."""
    a, b = pairs[:, 0], pairs[:, 1]
    return radius[a] + radius[b] - np.linalg.norm(center[:, a] - center[:, b], axis=2)


def counted_pairs(module, robot, rng):
    """Pairs of spheres of two bodies that VAMP was once seen to report, but for those that overlapped and were not reported."""
    spheres = len(robot.radius)
    every = np.array([(a, b) for a in range(spheres) for b in range(a + 1, spheres)])
    reported, ignored = np.zeros(len(every), bool), np.zeros(len(every), bool)
    place = {tuple(pair): k for k, pair in enumerate(every)}
    for q in rng.uniform(robot.low, robot.high, (PAIR_SAMPLES, len(robot.low))).astype(np.float32):
        now = np.zeros(len(every), bool)
        now[[place[tuple(sorted(pair))] for pair in module.debug(q)[1]]] = True
        deep = overlaps(spheres_of(module, q)[None, :, :3], robot.radius, every)[0] > 1e-5
        reported |= now
        ignored |= deep & ~now
    if (reported & ignored).any():
        raise SystemExit("VAMP reports a pair of spheres at one configuration and not at another")
    bodies = np.sort(robot.body[every], axis=1)
    asked = {tuple(pair) for pair in bodies[reported]}
    return every[np.array([tuple(pair) in asked for pair in bodies]) & ~ignored]


def measure(module, rng):
    n = module.dimension()
    axes = [measure_axis(module, joint) for joint in range(n)]
    moved = np.array([axis[2] for axis in axes])  # (n, spheres)
    body = np.array([max(np.flatnonzero(column) + 1, default=0) for column in moved.T])
    rest = spheres_of(module, np.zeros(n))
    robot = Robot([str(name) for name in module.joint_names()], module.lower_bounds().astype(float),
                  module.upper_bounds().astype(float), np.array([a[0] for a in axes]), np.array([a[1] for a in axes]),
                  body, rest[:, :3], rest[:, 3], np.zeros((0, 2), int))
    robot.pairs = counted_pairs(module, robot, rng)
    return robot


def place(robot, q):
    """(N, spheres, 3): the centres at the configurations q (N, n)."""
    count = len(q)
    turned, shift = np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3))
    center = np.empty((count, len(robot.radius), 3))
    center[:, robot.body == 0] = robot.center[robot.body == 0]
    for joint, (axis, point) in enumerate(zip(robot.axis, robot.point)):
        turn = rotation(axis, q[:, joint])
        shift = np.einsum("nij,nj->ni", turned, point - turn @ point) + shift
        turned = turned @ turn
        own = robot.body == joint + 1
        center[:, own] = np.einsum("nij,sj->nsi", turned, robot.center[own]) + shift[:, None]
    return center


def deepest(robot, obstacles, q):
    """(N,): the deepest overlap at each of the configurations q (N, n) [m]; negative: how far all is apart."""
    center = place(robot, q)
    worst = overlaps(center, robot.radius, robot.pairs).max(axis=1)
    for at, radius in zip(obstacles.center, obstacles.radius):
        gap = np.linalg.norm(center - at, axis=2) - robot.radius - radius
        worst = np.maximum(worst, -gap.min(axis=1))
    for at, half, turned in zip(obstacles.box_center, obstacles.box_half, box_rotations(obstacles)):
        beyond = np.abs((center - at) @ turned) - half
        gap = np.linalg.norm(np.maximum(beyond, 0), axis=2) + np.minimum(beyond.max(axis=2), 0) - robot.radius
        worst = np.maximum(worst, -gap.min(axis=1))
    return worst


def mjcf(robot, obstacles, keys):
    """The robot and the obstacles, with {name: q} as keyframes. All frames are the world's at q = 0."""

    def text(values):
        return " ".join(f"{value:.17g}" for value in np.ravel(values))

    def geoms(body):
        return [f'<geom name="s{k}" size="{robot.radius[k]:.17g}" pos="{text(robot.center[k])}" conaffinity="0"/>'
                for k in np.flatnonzero(robot.body == body)]

    lines = ['<mujoco model="vamp"><compiler angle="radian" autolimits="true" eulerseq="XYZ"/><worldbody>', *geoms(0)]
    lines += [f'<geom name="ball{k}" size="{radius:.17g}" pos="{text(at)}" contype="0"/>'
              for k, (at, radius) in enumerate(zip(obstacles.center, obstacles.radius))]
    lines += [f'<geom name="box{k}" type="box" size="{text(half)}" pos="{text(at)}" euler="{text(euler)}" contype="0"/>'
              for k, (at, half, euler) in enumerate(zip(obstacles.box_center, obstacles.box_half, obstacles.box_euler))]
    for joint, name in enumerate(robot.names):
        lines += [f'<body name="link{joint + 1}"><joint name="{name}" axis="{text(robot.axis[joint])}" '
                  f'pos="{text(robot.point[joint])}" range="{text([robot.low[joint], robot.high[joint]])}"/>',
                  *geoms(joint + 1)]
    lines += ["</body>" * len(robot.names) + "</worldbody><contact>"]
    lines += [f'<pair geom1="s{a}" geom2="s{b}"/>' for a, b in robot.pairs]
    lines += ["</contact><keyframe>", *(f'<key name="{name}" qpos="{text(q)}"/>' for name, q in keys.items())]
    return "\n".join([*lines, "</keyframe></mujoco>", ""])
