#!/usr/bin/env python3
"""A servo at 1 kHz whose position targets run into obstacles and into the robot itself: raw, repaired and filtered.

    pip install . matplotlib && python3 apps/control_loop/control_loop.py models/puma/puma_car.xml --png puma.png

Every joint that has a position actuator follows a sinusoid through obstacles, which are put where the robot comes by.
Each tick's targets go to the servos as they are (raw), through a solve (solve), through a Tracker (tracker), or through
the collision avoidance of mink (mink, as documented; mink-tuned; both need `pip install mink daqp`). MuJoCo simulates
each of them from the same start; what it measures is printed as a table, and written as CSV and PNG where asked for.
"""

import argparse
import csv
import dataclasses
import pathlib
import sys
import time

import mujoco
import numpy as np

import mjcf_pdg

TIMESTEP = 1e-3  # [s]
RAMP = 1.0  # the targets leave the home configuration within this time, which no number counts [s]
LATE = 1e-3  # a tick that takes longer misses its deadline [s]
SCALARS = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))


class Robot:
    """The joints with position actuators, their sinusoids, and what stays where it is."""

    def __init__(self, model: mujoco.MjModel, amplitude: float, rng: np.random.Generator):
        self.home = (model.key_qpos[0] if model.nkey else model.qpos0).copy()
        self.actuators = [a for a in range(model.nu) if self._is_servo(model, a)]
        if not self.actuators:
            raise ValueError("the model has no position actuators on hinges or slides")
        joints = [int(model.actuator_trnid[a, 0]) for a in self.actuators]
        self.qpos = np.array([model.jnt_qposadr[j] for j in joints])
        self.dofs = np.array([model.jnt_dofadr[j] for j in joints])
        self.bodies = sorted({int(model.jnt_bodyid[j]) for j in joints})
        low, high = np.array([self._range(model, j) for j in joints]).T
        self.reach = amplitude * np.minimum(high - low, np.pi)
        self.middle = np.clip(self.home[self.qpos], low + self.reach, np.maximum(low, high - self.reach))
        self.frequency = rng.uniform(0.1, 0.4, len(joints))  # [Hz]
        self.phase = rng.uniform(0.0, 2.0 * np.pi, len(joints))
        self.fastest_step = 2.0 * np.pi * float(np.max(self.frequency * self.reach)) * TIMESTEP

    @staticmethod
    def _is_servo(model: mujoco.MjModel, a: int) -> bool:
        on_joint = model.actuator_trntype[a] == int(mujoco.mjtTrn.mjTRN_JOINT)
        kp = model.actuator_gainprm[a, 0]
        is_position = kp > 0.0 and model.actuator_biasprm[a, 1] == -kp
        return bool(on_joint and is_position and model.jnt_type[model.actuator_trnid[a, 0]] in SCALARS)

    @staticmethod
    def _range(model: mujoco.MjModel, j: int) -> tuple[float, float]:
        return tuple(model.jnt_range[j]) if model.jnt_limited[j] else (-1.5, 1.5)

    def targets(self, t: float) -> np.ndarray:
        """Of the servos at a time [s]."""
        wave = self.middle + self.reach * np.sin(2.0 * np.pi * self.frequency * t + self.phase)
        share = min(1.0, t / RAMP)
        return (1.0 - share) * self.home[self.qpos] + share * wave


def load(path: str, arguments: argparse.Namespace) -> tuple[mujoco.MjModel, Robot]:
    """The model with obstacles around, and where its base floats, welded to where it is."""
    spec = mujoco.MjSpec.from_file(path)
    model = spec.compile()
    rng = np.random.default_rng(arguments.seed)
    robot = Robot(model, arguments.amplitude, rng)
    for body in {int(model.body_rootid[b]) for b in robot.bodies}:
        if model.body_jntnum[body] and model.jnt_type[model.body_jntadr[body]] == int(mujoco.mjtJoint.mjJNT_FREE):
            at = robot.home[model.jnt_qposadr[model.body_jntadr[body]] :][:7]
            weld = spec.add_equality(type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY)
            weld.name1, weld.name2 = model.body(body).name, "world"
            weld.data[:11] = [0, 0, 0, *at, 1]
    add_obstacles(spec, model, robot, arguments.obstacles, rng)
    spec.option.timestep = TIMESTEP
    return spec.compile(), robot


def add_obstacles(spec, model: mujoco.MjModel, robot: Robot, count: int, rng: np.random.Generator) -> None:
    """Balls, boxes and capsules where some link comes by, none where the robot is at home."""
    data = mujoco.MjData(model)
    collides = (model.geom_contype | model.geom_conaffinity) != 0
    links = [g for g in range(model.ngeom) if collides[g] and moves(model, int(model.geom_bodyid[g]), robot.bodies)]
    radius = 0.5 * float(np.mean(model.geom_rbound[links]))
    data.qpos[:] = robot.home
    mujoco.mj_kinematics(model, data)
    home = data.geom_xpos[links].copy()
    made = 0
    for _ in range(100 * count):
        if made == count:
            return
        data.qpos[robot.qpos] = robot.targets(rng.uniform(RAMP, 10.0))
        mujoco.mj_kinematics(model, data)
        link = links[rng.integers(len(links))]
        place = data.geom_xpos[link] + rng.uniform(-1.0, 1.0, 3) * model.geom_rbound[link]
        if np.min(np.linalg.norm(home - place, axis=1) - model.geom_rbound[links]) < 2.0 * radius:
            continue
        kind = (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CAPSULE)[made % 3]
        spec.worldbody.add_geom(type=kind, pos=place, size=radius * rng.uniform(0.5, 1.0, 3), contype=1, conaffinity=1)
        made += 1


def moves(model: mujoco.MjModel, body: int, bodies: list[int]) -> bool:
    while body:
        if body in bodies:
            return True
        body = int(model.body_parentid[body])
    return False


# Filters: called with the targets as a configuration (nq,) and the simulation; they return what goes to the servos.


class Raw:
    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        pass

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        return q


def scene_options(model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace) -> dict:
    """Only the robot's joints may move; what it grasps or stands beside is where the simulation has it."""
    servos = [model.body(b).name for b in robot.bodies]
    jointed = {int(b) for b in model.jnt_bodyid}
    fixed = [model.body(b).name for b in jointed - set(robot.bodies) if moves(model, b, robot.bodies)]
    return {"movable": servos, "fixed": fixed or None, "clearance": arguments.clearance, "equality": "ignore"}


class Solve:
    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        self.solver = mjcf_pdg.Solver(model, **scene_options(model, robot, arguments))
        self.asked = mujoco.MjData(model)

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        self.asked.qpos[:] = q
        result = self.solver.solve(self.asked)
        return result.q if result.free else q


class Tracker:
    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        step = arguments.steps * robot.fastest_step
        self.tracker = mjcf_pdg.Tracker(model, max_step=step, **scene_options(model, robot, arguments))
        self.tracker.reset(robot.home)
        self.last = robot.home

    def __call__(self, q: np.ndarray, data: mujoco.MjData) -> np.ndarray:
        result = self.tracker.step(q, data)
        if result.free:
            self.last = result.q
        return self.last


class Mink:
    """https://github.com/kevinzakka/mink: a quadratic program a tick, with limits on how fast pairs come nearer."""

    GAIN, DETECTION = 0.85, 0.01  # mink's own defaults

    def __init__(self, model: mujoco.MjModel, robot: Robot, arguments: argparse.Namespace):
        import mink

        self.mink, self.robot = mink, robot
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


FILTERS = {"raw": Raw, "solve": Solve, "tracker": Tracker, "mink": Mink, "mink-tuned": MinkTuned}


@dataclasses.dataclass
class Tick:
    time: float  # [s]
    command_free: bool
    answer_free: bool  # what went to the servos
    error: float  # √σ from the targets to what went to the servos [m]
    depth: float  # of the deepest contact with the robot in the simulation [m]
    force: float  # the largest normal force of such a contact [N]
    qacc: float  # largest of a servo's joint [rad/s² or m/s²]
    seconds: float  # that the filter took, of processor time


def contacts_of_robot(model: mujoco.MjModel, data: mujoco.MjData, is_link: np.ndarray) -> tuple[float, float]:
    """The deepest contact [m] and the largest normal force [N]."""
    depth = force = 0.0
    wrench = np.zeros(6)
    for k in range(data.ncon):
        contact = data.contact[k]
        if not (is_link[contact.geom1] or is_link[contact.geom2]):
            continue
        mujoco.mj_contactForce(model, data, k, wrench)
        depth, force = max(depth, -contact.dist), max(force, wrench[0])
    return depth, force


def simulate(model: mujoco.MjModel, robot: Robot, name: str, arguments: argparse.Namespace) -> list[Tick]:
    options = scene_options(model, robot, arguments)
    free = mjcf_pdg.Solver(model, **{**options, "clearance": 0.0})
    repair = FILTERS[name](model, robot, arguments)
    norm = {"movable": options["movable"], "fixed": options["fixed"]}
    is_link = np.array([moves(model, int(b), robot.bodies) for b in model.geom_bodyid])
    data = mujoco.MjData(model)
    data.qpos[:] = robot.home
    ticks = []
    for k in range(arguments.ticks):
        t = k * TIMESTEP
        q_command = data.qpos.copy()
        q_command[robot.qpos] = robot.targets(t)
        begin = time.thread_time()
        q = repair(q_command, data)
        seconds = time.thread_time() - begin
        data.ctrl[robot.actuators] = q[robot.qpos]
        mujoco.mj_step(model, data)
        depth, force = contacts_of_robot(model, data, is_link)
        error = np.sqrt(mjcf_pdg.object_norm(model, q_command, q, **norm)) if k % arguments.error_every == 0 else np.nan
        qacc = float(np.max(np.abs(data.qacc[robot.dofs])))
        ticks.append(Tick(t, free.is_free(q_command), free.is_free(q), error, depth, force, qacc, seconds))
    return [tick for tick in ticks if tick.time > RAMP]


def row(name: str, ticks: list[Tick], quiet_qacc: float) -> list[str]:
    def of(field: str) -> np.ndarray:
        return np.array([getattr(tick, field) for tick in ticks], dtype=float)

    seconds = 1e3 * of("seconds")
    return [
        name,
        f"{100 * of('answer_free').mean():.2f}",
        f"{1e3 * of('depth').max():.2f}",
        f"{of('force').max():.0f}",
        f"{1e3 * np.nanmean(of('error')):.2f}",
        f"{np.quantile(of('qacc'), 0.99) / quiet_qacc:.2f}",
        f"{np.median(seconds):.3f}",
        f"{np.quantile(seconds, 0.99):.3f}",
        f"{seconds.max():.2f}",
        f"{np.sum(seconds > 1e3 * LATE)}",
    ]


HEADING = ["filter", "free %", "depth mm", "force N", "error mm", "qacc p99", "ms p50", "ms p99", "ms max", "late"]


def table(rows: list[list[str]]) -> str:
    rows = [HEADING, *rows]
    widths = [max(len(cells[k]) for cells in rows) for k in range(len(HEADING))]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(cells, widths)) for cells in rows)


def write_csv(path: str, runs: dict[str, list[Tick]]) -> None:
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["filter", *(field.name for field in dataclasses.fields(Tick))])
        for name, ticks in runs.items():
            writer.writerows([name, *dataclasses.astuple(tick)] for tick in ticks)


def plot(path: str, title: str, runs: dict[str, list[Tick]]) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    panels = [("depth", 1e3, "deepest contact [mm]"), ("force", 1.0, "contact force [N]"),
              ("error", 1e3, "off the command, √σ [mm]"), ("seconds", 1e3, "tick [ms]")]  # fmt: skip
    figure, axes = pyplot.subplots(len(panels), 1, sharex=True, figsize=(10, 10), layout="constrained")
    # Colours that a deuteranope tells apart (Okabe and Ito).
    colours = dict(zip(FILTERS, ["#D55E00", "#999999", "#0072B2", "#E69F00", "#CC79A7"]))
    for axis, (field, unit, label) in zip(axes, panels):
        for name, ticks in runs.items():
            kept = [tick for tick in ticks if not np.isnan(getattr(tick, field))]
            axis.plot([tick.time for tick in kept], [unit * getattr(tick, field) for tick in kept],
                      label=name, color=colours[name], linewidth=0.9)  # fmt: skip
        axis.set_ylabel(label)
    axes[3].set_yscale("log")
    axes[3].axhline(1e3 * LATE, color="black", linewidth=0.5)
    axes[3].set_xlabel("time [s]")
    axes[0].legend(ncols=len(runs), loc="upper right")
    figure.suptitle(title)
    figure.savefig(path, dpi=100)


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", help="MJCF with position actuators")
    parser.add_argument("--filters", default="raw,solve,tracker", help=f"of {','.join(FILTERS)}")
    parser.add_argument("--ticks", type=int, default=10000, help="at 1 kHz")
    parser.add_argument("--obstacles", type=int, default=8)
    parser.add_argument("--amplitude", type=float, default=0.35, help="of the sinusoids, share of a joint's range")
    parser.add_argument("--clearance", type=float, default=0.002, help="that filters keep, for the servos' errors [m]")
    parser.add_argument("--steps", type=float, default=3.0, help="max_step over the targets' fastest step")
    parser.add_argument("--error-every", type=int, default=10, help="ticks between measurements of the error")
    parser.add_argument("--seed", type=int, default=0, help="of obstacles and sinusoids")
    parser.add_argument("--csv", help="every tick of every filter")
    parser.add_argument("--png", help="plots over time; needs matplotlib")
    arguments = parser.parse_args(argv)
    arguments.filters = arguments.filters.split(",")
    for name in arguments.filters:
        if name not in FILTERS:
            parser.error(f"--filters: '{name}' is none of {','.join(FILTERS)}")
    return arguments


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        model, robot = load(arguments.model, arguments)
        # Accelerations are told over those of the raw command while it is free.
        runs = {"raw": simulate(model, robot, "raw", arguments)}
        runs |= {n: simulate(model, robot, n, arguments) for n in arguments.filters if n != "raw"}
    except (ValueError, ImportError) as error:
        print(f"control_loop.py: {error}", file=sys.stderr)
        return 2
    quiet = [tick.qacc for tick in runs["raw"] if tick.command_free and tick.force == 0.0]
    quiet_qacc = float(np.quantile(quiet, 0.99)) if quiet else 1.0
    collide = sum(not tick.command_free for tick in runs["raw"])
    name = pathlib.Path(arguments.model).name
    print(f"{name}: {len(runs['raw'])} ticks, {collide} of whose commands collide")
    print(table([row(n, ticks, quiet_qacc) for n, ticks in runs.items()]))
    if arguments.csv:
        write_csv(arguments.csv, runs)
    if arguments.png:
        plot(arguments.png, name, runs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
