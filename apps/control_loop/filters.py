"""What stands between a planner and position servos at 1 kHz: nothing, a repair in every tick, a filter by others.

A filter is called with the targets as a configuration (nq,) and the simulation, and returns the configuration that the
servos are to reach; `control` says what they are sent for that.
"""

import argparse

import mujoco
import numpy as np

import mjcf_pdg
from governor import Governor, Limits, levers
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


def scene_options(model: mujoco.MjModel, robot: Robot, clearance: float, widest: float | None = None) -> dict:
    """Only the robot's joints may move; what it grasps or stands beside is where the simulation has it.

    Pairs that no servo parts, as the fingers of a gripper, do not count. Of the clearance, bodies that are near each
    other at home keep so much less that of the widest clearance of a filter they keep half of what they have there.
    """
    widest = widest or clearance
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
    for contact in mjcf_pdg.verify(model, robot.home, **options, clearance=2.0 * widest).contacts:
        bodies = body_of(model, contact.geom1), body_of(model, contact.geom2)
        if 0.0 < contact.distance < 2.0 * widest:
            share = contact.distance / (2.0 * widest)
            allow[bodies] = max(allow.get(bodies, 0.0), (1.0 - share) * clearance)
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
        self.widest = arguments.clearance + self.cushion(arguments)
        self.queries = arguments.queries
        self.tracker = self.tracker_with(model, arguments.clearance, arguments.steps)
        self.last = robot.home

    def cushion(self, arguments: argparse.Namespace) -> float:
        """What is kept beyond the clearance [m]."""
        return 0.0

    def tracker_with(self, model: mujoco.MjModel, clearance: float, steps: float) -> mjcf_pdg.Tracker:
        options = scene_options(model, self.robot, clearance, self.widest)
        max_step = steps * self.robot.fastest_step
        tracker = mjcf_pdg.Tracker(model, queries=self.queries, max_step=max_step, **options)
        tracker.reset(self.robot.home)
        return tracker

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        result = self.tracker.step(q, data)
        if result.free:
            self.last = result.q
        return self.last


class Governed(Tracker):
    """A tracker that keeps a cushion beyond the clearance, a governor, and the tracker that keeps the clearance.

    The first tracker is sent where the command leads; its answers turn sharp corners and swing. The governor follows
    them with the accelerations of the command, along motions that are free until they rest. The second tracker has work
    only where obstacles move. The servos are told the speed, the acceleration and the weight that they will meet.
    """

    FAR_STEPS = 2.0  # max_step of the first tracker, which leads, over the targets' fastest step

    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        super().__init__(model, robot, arguments)
        self.model = model
        cushion = self.cushion(arguments)
        self.far_tracker = self.tracker_with(model, self.widest, self.FAR_STEPS)
        between = arguments.clearance + 0.5 * cushion
        self.guard = mjcf_pdg.Solver(model, **scene_options(model, robot, between, self.widest))
        self.far, self.asked = robot.home, robot.home.copy()
        limits = Limits(
            bandwidth=arguments.bandwidth,
            acceleration=arguments.acceleration * robot.hardest,
            speed=robot.fastest_step / TIMESTEP,
            gap=cushion,
            looks=arguments.looks,
        )
        self.governor = Governor(robot.home[robot.qpos], levers(model, robot), limits, self.is_free)

    def cushion(self, arguments: argparse.Namespace) -> float:
        return arguments.cushion * self.robot.size

    def is_free(self, servos: np.ndarray) -> bool:
        self.asked[self.robot.qpos] = servos
        return self.guard.is_free(self.asked)

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        servos = self.robot.qpos
        self.asked = q.copy()
        self.asked[servos] = self.governor.lead(q[servos])
        result = self.far_tracker.step(self.asked, data)
        if result.free:
            self.far = result.q
        reference = q.copy()
        reference[servos], self.speed, self.acceleration = self.governor.step(self.far[servos])
        return super().__call__(reference, data)

    def control(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        robot = self.robot
        inertia, acceleration = np.zeros(self.model.nv), np.zeros(self.model.nv)
        acceleration[robot.dofs] = self.acceleration
        mujoco.mj_mulM(self.model, data, inertia, acceleration)
        force = (inertia + data.qfrc_bias - data.qfrc_passive)[robot.dofs]
        return q[robot.qpos] + (robot.resistance * self.speed + force) / robot.stiffness


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


FILTERS = {"raw": Raw, "solve": Solve, "tracker": Tracker, "governed": Governed, "mink": Mink, "mink-tuned": MinkTuned}
