"""What stands between a planner and position servos at 1 kHz: nothing, a repair in every tick, a filter by others.

A filter is called with the targets as a configuration (nq,) and the simulation, and returns the configuration that the
servos are to reach; `control` says what they are sent for that.
"""

import argparse

import mujoco
import numpy as np

import mjcf_pdg
from governor import Governor, levers
from robot import TIMESTEP, Robot, carrier, moves


class Filter:
    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        self.robot = robot

    def control(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        """What the servos are sent so that they reach `q`, the last answer."""
        return q[self.robot.qpos]


class Raw(Filter):
    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        return q


def body_of(model: mujoco.MjModel, geom: str) -> str:
    """By a geom's name, or BODY/geomN where it has none."""
    try:
        return model.body(int(model.geom(geom).bodyid[0])).name
    except KeyError:
        return geom.rpartition("/")[0]


def scene_options(model: mujoco.MjModel, robot: Robot, clearance: float) -> dict:
    """Only the robot's joints may move; what it grasps or stands beside is where the simulation has it.

    Pairs that no servo parts, as the fingers of a gripper, do not count, and what is nearer than the clearance at home
    need not be farther apart.
    """
    name = lambda body: model.body(body).name  # noqa: E731
    jointed = {int(b) for b in model.jnt_bodyid}
    fixed = [name(b) for b in jointed - set(robot.bodies) if moves(model, b, robot.bodies)]
    named = [b for b in range(1, model.nbody) if model.body_geomnum[b] and name(b)]
    exclude = [
        (name(a), name(b))
        for a in named
        for b in named
        if a < b and model.body_weldid[a] != model.body_weldid[b]
        and carrier(model, a, robot.bodies) == carrier(model, b, robot.bodies)
    ]  # fmt: skip
    options = {"movable": [name(b) for b in robot.bodies], "fixed": fixed or None, "exclude": exclude,
               "equality": "ignore"}  # fmt: skip
    allow: dict[tuple[str, str], float] = {}
    for contact in mjcf_pdg.verify(model, robot.home, **options, clearance=clearance).contacts:
        bodies = body_of(model, contact.geom1), body_of(model, contact.geom2)
        if 0.0 < contact.distance < clearance:
            allow[bodies] = max(allow.get(bodies, 0.0), clearance - contact.distance)
    return options | {"allow": allow, "clearance": clearance}


class Solve(Filter):
    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        super().__init__(model, robot, arguments)
        self.solver = mjcf_pdg.Solver(model, **scene_options(model, robot, arguments.clearance))
        self.asked = mujoco.MjData(model)

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        self.asked.qpos[:] = q
        result = self.solver.solve(self.asked)
        return result.q if result.free else q


class Tracker(Filter):
    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        super().__init__(model, robot, arguments)
        self.tracker = self.tracker_with(model, arguments.clearance, arguments.steps)
        self.last = robot.home

    def tracker_with(self, model: mujoco.MjModel, clearance: float, steps: float, gain: float = 0.05) -> mjcf_pdg.Tracker:
        options = scene_options(model, self.robot, clearance)
        tracker = mjcf_pdg.Tracker(model, max_step=steps * self.robot.fastest_step, switch_gain=gain, **options)
        tracker.reset(self.robot.home)
        return tracker

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        result = self.tracker.step(q, data)
        if result.free:
            self.last = result.q
        return self.last


class Shaped(Tracker):
    """A tracker that keeps a cushion beyond the clearance, a reference model, and the tracker that keeps the clearance.

    The first answers turn sharp corners where contacts begin and end. The reference model, a critically damped low-pass
    of the second order, rounds them; where that cuts a corner by more than the cushion, the second tracker repairs it.
    The servos are told the speed and the weight that they will meet, so that they neither lag nor sag.
    """

    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        super().__init__(model, robot, arguments)
        # No faster than the targets themselves: what it catches up with, the reference model must slow down again.
        self.far_tracker = self.tracker_with(model, arguments.clearance + arguments.cushion, 1.0)
        self.far = robot.home
        self.bandwidth = arguments.bandwidth
        self.reference = robot.home[robot.qpos]
        self.speed = np.zeros_like(self.reference)
        self.sent = self.reference  # the answer before

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        self.sent = self.last[self.robot.qpos]
        result = self.far_tracker.step(q, data)
        if result.free:
            self.far = result.q
        self.follow(self.far[self.robot.qpos])
        shaped = q.copy()
        shaped[self.robot.qpos] = self.reference
        return super().__call__(shaped, data)

    def follow(self, target: np.ndarray) -> None:
        """A tick of the reference model, exact while the target stands."""
        behind = self.reference - target
        rate = self.speed + self.bandwidth * behind
        decay = np.exp(-self.bandwidth * TIMESTEP)
        self.reference = target + (behind + rate * TIMESTEP) * decay
        self.speed = (self.speed - self.bandwidth * rate * TIMESTEP) * decay

    def control(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        robot = self.robot
        speed = (q[robot.qpos] - self.sent) / TIMESTEP
        weight = (data.qfrc_bias - data.qfrc_passive)[robot.dofs]
        return q[robot.qpos] + (robot.resistance * speed + weight) / robot.stiffness


class Governed(Tracker):
    def __init__(self, model, robot, arguments):
        super().__init__(model, robot, arguments)
        cushion = arguments.cushion
        self.far_tracker = self.tracker_with(model, arguments.clearance + cushion, arguments.far_steps, arguments.gain)
        self.guard = mjcf_pdg.Solver(model, **scene_options(model, robot, arguments.clearance + 0.5 * cushion))
        self.far = robot.home
        self.governor = Governor(robot, levers(model, robot), cushion, arguments.bandwidth,
            arguments.acceleration*robot.hardest, arguments.speed * robot.fastest_step / TIMESTEP, arguments.looks, self.is_free)
        self.model = model
        self.repaired = 0

    def is_free(self, servos):
        self.asked[self.robot.qpos] = servos
        return self.guard.is_free(self.asked)

    def __call__(self, q, data):
        ahead = q.copy()
        ahead[self.robot.qpos] = self.governor.lead(q[self.robot.qpos])
        result = self.far_tracker.step(ahead, data)
        if result.free:
            self.far = result.q
        self.asked = q.copy()
        x, self.v, self.a = self.governor.step(self.far[self.robot.qpos].copy())
        shaped = q.copy()
        shaped[self.robot.qpos] = x
        out = super().__call__(shaped, data)
        if np.abs(out[self.robot.qpos]-x).max() > 1e-9: self.repaired += 1
        return out

    def control(self, q, data):
        robot = self.robot
        weight = (data.qfrc_bias - data.qfrc_passive)[robot.dofs]
        acc = np.zeros(self.model.nv); acc[robot.dofs] = self.a
        force = np.zeros(self.model.nv)
        mujoco.mj_mulM(self.model, data, force, acc)
        return q[robot.qpos] + (robot.resistance * self.v + weight + force[robot.dofs]) / robot.stiffness


class Mink(Filter):
    """https://github.com/kevinzakka/mink: a quadratic program a tick, with limits on how fast pairs come nearer."""

    GAIN, DETECTION = 0.85, 0.01  # mink's own defaults

    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        import mink

        super().__init__(model, robot, arguments)
        self.mink = mink
        self.configuration = mink.Configuration(model, robot.home)
        self.task = mink.PostureTask(model, cost=1.0)
        collides = [g for g in range(model.ngeom) if model.geom_contype[g] | model.geom_conaffinity[g]]
        links = [g for g in collides if moves(model, int(model.geom_bodyid[g]), robot.bodies)]
        avoid = mink.CollisionAvoidanceLimit(
            model,
            [(links, collides)],
            gain=self.GAIN,
            minimum_distance_from_collisions=arguments.clearance,
            collision_detection_distance=self.DETECTION,
        )
        self.limits = [mink.ConfigurationLimit(model), avoid]
        frozen = sorted(set(range(model.nv)) - set(robot.dofs.tolist()))
        self.constraints = [mink.DofFreezingTask(model, dof_indices=frozen)] if frozen else None

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        now = q.copy()
        now[self.robot.qpos] = self.configuration.q[self.robot.qpos]
        self.configuration.update(now)
        self.task.set_target(q)
        try:
            velocity = self.mink.solve_ik(
                self.configuration, [self.task], TIMESTEP, "daqp", limits=self.limits, constraints=self.constraints
            )
        except self.mink.NoSolutionFound:
            return now
        self.configuration.integrate_inplace(velocity, TIMESTEP)
        return self.configuration.q.copy()


class MinkTuned(Mink):
    GAIN, DETECTION = 0.5, 0.05


FILTERS = {"raw": Raw, "solve": Solve, "tracker": Tracker, "shaped": Shaped, "governed": Governed, "mink": Mink, "mink-tuned": MinkTuned}
