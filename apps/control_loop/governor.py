"""A reference governor: turns where a robot should be, which may jump, into a motion of bounded speed and acceleration.

Source: Garone, Di Cairano & Kolmanovsky, Reference and command governors for systems with constraints: A survey on
theory and applications (Automatica 75, 2017): a setpoint goes towards the target as far as the motion that it causes,
predicted until it rests, keeps all constraints; what was admissible stays so.
Differs from it: each joint's part of the setpoint's step is cut for itself, but on the last attempt; a prediction is
looked at in several ticks and begins when that is done; where the straight way is blocked, the setpoint goes along a
trail of earlier targets, whose nearest is the last attempt.
"""

import dataclasses
import math
from collections.abc import Callable

import mujoco
import numpy as np

from robot import TIMESTEP, Robot


def levers(model: mujoco.MjModel, robot: Robot) -> np.ndarray:
    """(pairs, servos): a row times how far the servos move bounds how far two geoms move against each other [m].

    A row is of two branches of the tree of bodies, or of one and the world: only joints of one of the two part them. An
    entry is the farthest distance from the joint to what it carries, however that is bent [m/rad], or 1 for a slide.
    """
    reach: dict[int, float] = {}  # from a body's frame to the farthest point that it carries [m]
    for body in range(model.nbody - 1, 0, -1):
        geoms = np.arange(model.body_geomnum[body]) + model.body_geomadr[body]
        own = [float(np.linalg.norm(model.geom_pos[g]) + model.geom_rbound[g]) for g in geoms]
        below = [far + float(np.linalg.norm(model.body_pos[b])) for b, far in reach.items()
                 if model.body_parentid[b] == body]  # fmt: skip
        joints = np.arange(model.body_jntnum[body]) + model.body_jntadr[body]
        slides = [float(np.abs(model.jnt_range[j]).max()) for j in joints if is_slide(model, j)]
        reach[body] = max(own + below, default=0.0) + sum(slides)
    joints = [int(j) for j in model.dof_jntid[robot.dofs]]
    lever = [1.0 if is_slide(model, j) else reach[int(model.jnt_bodyid[j])] + float(np.linalg.norm(model.jnt_pos[j]))
             for j in joints]  # fmt: skip
    branches = {tuple(carries(model, int(b), body) for b in model.jnt_bodyid[joints]) for body in range(model.nbody)}
    rows = np.array(sorted({tuple(np.not_equal(a, b)) for a in branches for b in branches})) * lever
    return rows[[not any((other >= row).all() and (other > row).any() for other in rows) for row in rows]]


def is_slide(model: mujoco.MjModel, joint: int) -> bool:
    return bool(model.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_SLIDE))


def carries(model: mujoco.MjModel, above: int, body: int) -> bool:
    while body and body != above:
        body = int(model.body_parentid[body])
    return body == above


@dataclasses.dataclass(frozen=True)
class Limits:
    bandwidth: float  # the reference model's poles [1/s]
    acceleration: float  # of a joint [rad/s² or m/s²]
    speed: float  # of a joint [rad/s or m/s]
    gap: float  # how far two geoms may move against each other between poses that are looked at [m]
    looks: int  # configurations that are looked at in a tick, at most


@dataclasses.dataclass
class Candidate:
    """A setpoint's next place, which it takes in so many ticks if all poses of the motion from then on are free."""

    setpoint: np.ndarray
    offset: np.ndarray
    rate: np.ndarray
    poses: np.ndarray  # (left to look at, servos), the last is looked at first
    ticks: int
    age: int = 0


class Governor:
    """Its reference model, critically damped, is at setpoint + (offset + rate·t)·exp(-bandwidth·t) in t seconds.

    That motion is looked at until it rests before a setpoint is taken, at poses no farther apart than about `gap`, but
    at no more than GRID of them. If `is_free` keeps half of the gap, what lies between is free, too, where so many are
    enough, and the robot may rest at any time. Obstacles stand meanwhile: what moves is for a tracker behind.
    """

    GRID = 128  # times at which a predicted motion is known, closer where it is fast
    SETTLED = 12.0  # it rests when so many time constants are over: (1 + 12)·exp(-12) is 8e-5
    SHARES = np.append(0.8 ** np.arange(16), 0.0)[:, np.newaxis]  # of a joint's step to the target that are tried
    STRAIGHT = 4  # attempts at the straight way, each half as far
    TRAIL = 2048  # earlier targets that are known
    SMOOTH = 0.02  # time constant for the command's speed and acceleration [s]

    def __init__(self, home: np.ndarray, lever: np.ndarray, limits: Limits, is_free: Callable[[np.ndarray], bool]):
        self.lever, self.limits, self.is_free = lever, limits, is_free
        self.setpoint = home.copy()
        self.offset, self.rate = np.zeros_like(home), np.zeros_like(home)
        self.command, self.command_speed, self.command_acceleration = home.copy(), self.offset, self.offset
        self.trail, self.first, self.last = np.zeros((self.TRAIL, len(home))), 0, 0
        self.attempt = 0  # which target is tried, see _target
        self.candidate: Candidate | None = None
        self.ticks = 1  # that the next candidate may take
        self.times = np.linspace(0.0, 1.0, self.GRID)[:, np.newaxis] ** 2 * self.SETTLED / limits.bandwidth
        self.decay = np.exp(-limits.bandwidth * self.times)

    def lead(self, command: np.ndarray) -> np.ndarray:
        """Where the setpoint would have to be for the model to be at a command that goes on as it does."""
        raw = (command - self.command) / TIMESTEP
        self.command = command.copy()
        change = (raw - self.command_speed) / self.SMOOTH
        self.command_speed = self.command_speed + change * TIMESTEP
        bounded = np.clip(change, -self.limits.acceleration, self.limits.acceleration)
        self.command_acceleration = self.command_acceleration + (bounded - self.command_acceleration) * (
            TIMESTEP / self.SMOOTH
        )
        speed = self.command_speed + self.SMOOTH * self.command_acceleration
        w = self.limits.bandwidth
        return command + 2.0 / w * speed + self.command_acceleration / w**2

    def step(self, target: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A tick towards a free target that moves without jumps: position, speed and acceleration of the servos."""
        self._remember(target)
        self._look(target)
        self.offset, self.rate = self._in(TIMESTEP)
        w = self.limits.bandwidth
        speed = self.rate - w * self.offset
        return self.setpoint + self.offset, speed, w**2 * self.offset - 2.0 * w * self.rate

    def _in(self, seconds: float) -> tuple[np.ndarray, np.ndarray]:
        """Offset and rate then."""
        decay = math.exp(-self.limits.bandwidth * seconds)
        return (self.offset + self.rate * seconds) * decay, self.rate * decay

    def _remember(self, target: np.ndarray) -> None:
        apart = 4.0 * self.limits.speed * TIMESTEP
        if self.first < self.last and np.abs(self.trail[self.last - 1] - target).max() <= apart:
            return
        if self.last == self.TRAIL:
            kept = min(self.last - self.first, self.TRAIL // 2)
            self.trail[:kept] = self.trail[self.last - kept :].copy()
            self.first, self.last = 0, kept
        self.trail[self.last] = target
        self.last += 1

    def _target(self, target: np.ndarray) -> np.ndarray:
        """The target, points on the straight way there, and then ever earlier ones of the trail."""
        if self.attempt < self.STRAIGHT:
            return self.setpoint + 0.5**self.attempt * (target - self.setpoint)
        return self.trail[self.first + ((self.last - self.first) >> (self.attempt - self.STRAIGHT + 1))]

    def _attempts(self) -> int:
        return self.STRAIGHT + (self.last - self.first).bit_length()

    def _next_attempt(self) -> None:
        self.candidate = None
        self.attempt = (self.attempt + 1) % self._attempts()

    def _look(self, target: np.ndarray) -> None:
        """Goes on with the candidate, or begins one, and takes it when its time has come."""
        if self.candidate is None:
            self.candidate = self._propose(self._target(target))
            if self.candidate is None:
                return self._next_attempt()
        candidate = self.candidate
        for _ in range(min(self.limits.looks, len(candidate.poses))):
            pose, candidate.poses = candidate.poses[-1], candidate.poses[:-1]
            if not self.is_free(pose):
                return self._next_attempt()
        if candidate.age == candidate.ticks:
            self._take(candidate)
        candidate.age += 1

    def _take(self, candidate: Candidate) -> None:
        self.setpoint, self.offset, self.rate = candidate.setpoint, candidate.offset, candidate.rate
        apart = np.abs(self.trail[self.first : self.last] - self.setpoint) @ self.lever.T
        self.first += int(np.argmin(apart.max(axis=1)))
        self.attempt = 0
        self.ticks = max(1, candidate.ticks // 2)
        self.candidate = None

    def _propose(self, target: np.ndarray) -> Candidate | None:
        """The largest step of the setpoint that the limits allow; None if that is none, or takes too many looks."""
        for _ in range(3):
            offset, rate = self._in(self.ticks * TIMESTEP)
            steps = self.SHARES * (target - self.setpoint)
            allowed = self._within_limits(offset - steps, rate - self.limits.bandwidth * steps)
            # To the trail's nearest the straight way is short and often free, where one that is cut joint by joint is
            # not: then all joints take the same share.
            if self.attempt == self._attempts() - 1:
                allowed = np.repeat(allowed.all(axis=1, keepdims=True), len(target), axis=1)
            step = np.where(allowed.any(axis=0), steps[np.argmax(allowed, axis=0), np.arange(len(target))], 0.0)
            if not step.any():
                return None
            offset, rate, setpoint = offset - step, rate - self.limits.bandwidth * step, self.setpoint + step
            poses = setpoint + self._poses(offset, rate)
            if len(poses) <= self.ticks * self.limits.looks:
                return Candidate(setpoint, offset, rate, poses, self.ticks)
            self.ticks = 1 + math.ceil(len(poses) / self.limits.looks)
        return None

    def _within_limits(self, offset: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Whether a joint's acceleration and speed stay there; each has one extremum beside that at the beginning."""
        w = self.limits.bandwidth
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.where(rate != 0.0, offset / rate, np.inf)  # of which the extrema are so long before
        fastest, hardest = 2.0 / w - turn, 3.0 / w - turn  # [s]
        later = lambda t: np.where(t > 0.0, np.exp(-w * np.maximum(t, 0.0)), 0.0)  # noqa: E731
        speed = np.maximum(np.abs(rate - w * offset), np.abs(rate) * later(fastest))
        acceleration = np.maximum(np.abs(w**2 * offset - 2.0 * w * rate), w * np.abs(rate) * later(hardest))
        return (speed <= self.limits.speed) & (acceleration <= self.limits.acceleration)

    def _poses(self, offset: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Of a motion, relative to the setpoint, as many as the gap asks for, the last one at rest."""
        motion = (offset + rate * self.times) * self.decay
        moved = np.cumsum((np.abs(np.diff(motion, axis=0)) @ self.lever.T).max(axis=1))
        ends = np.flatnonzero(np.diff(np.floor(moved / self.limits.gap), prepend=0.0))
        return np.append(motion[ends], np.zeros((1, motion.shape[1])), axis=0)
