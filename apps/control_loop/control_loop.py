#!/usr/bin/env python3
"""A servo at 1 kHz whose position targets run into obstacles and into the robot itself: raw, repaired and filtered.

    pip install . matplotlib && python3 apps/control_loop/control_loop.py models/puma/puma_car.xml --png puma.png

Every joint that has a position actuator follows a sinusoid through obstacles, which are put where the robot comes by.
Each tick's targets go to the servos as they are (raw), through a solve (solve), through a Tracker (tracker), through
two of them with a reference governor between that bounds accelerations (governed), or through the collision avoidance
of mink (mink, as documented; mink-tuned; both need `pip install mink daqp`). MuJoCo simulates each of them from the same
start; what it measures is printed as a table, and written as CSV and PNG where asked for.
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
from filters import FILTERS, scene_options
from robot import RAMP, SCALARS, TIMESTEP, Robot, carrier, load

LATE = 1e-3  # a tick that takes longer misses its deadline [s]
# The raw command moves freely from so long after its last contact and its last target that is not free [s].
SETTLED = 0.25


@dataclasses.dataclass
class Tick:
    time: float  # [s]
    command_free: bool
    answer_free: bool  # what went to the servos
    error: float  # √σ from the targets to where the robot is after the tick [m]
    depth: float  # of the deepest contact with the robot in the simulation [m]
    force: float  # the largest normal force of such a contact [N]
    # The largest change of a servo's joint's speed, over the timestep [rad/s² or m/s²]. MuJoCo's qacc is not that: its
    # implicit integrators apply the servos' damping afterwards.
    qacc: float
    seconds: float  # that the filter took, of processor time


def contacts_of_robot(model: mujoco.MjModel, data: mujoco.MjData, carriers: np.ndarray) -> tuple[float, float]:
    """The deepest contact [m] and the largest normal force [N] between geoms that servos move against each other."""
    depth = force = 0.0
    wrench = np.zeros(6)
    for k in range(data.ncon):
        contact = data.contact[k]
        if carriers[contact.geom1] == carriers[contact.geom2]:
            continue
        mujoco.mj_contactForce(model, data, k, wrench)
        depth, force = max(depth, -contact.dist), max(force, wrench[0])
    return depth, force


def see(model: mujoco.MjModel, data: mujoco.MjData, seen: mujoco.MjData) -> None:
    """What filters are told of the simulation: its joints put inside their ranges, which MuJoCo holds softly.

    A finger without a servo that is 1e-5 rad beyond its limit would make whatever the servos do count as not free.
    """
    seen.qpos[:] = data.qpos
    for joint in range(model.njnt):
        if model.jnt_limited[joint] and model.jnt_type[joint] in SCALARS:
            at = model.jnt_qposadr[joint]
            seen.qpos[at] = np.clip(seen.qpos[at], *model.jnt_range[joint])
    seen.mocap_pos[:], seen.mocap_quat[:] = data.mocap_pos, data.mocap_quat
    seen.eq_active[:] = data.eq_active


def simulate(model: mujoco.MjModel, robot: Robot, name: str, arguments: argparse.Namespace) -> list[Tick]:
    options = scene_options(model, robot, 0.0)
    free = mjcf_pdg.Solver(model, **options)
    repair = FILTERS[name](model, robot, arguments)
    norm = {"movable": options["movable"], "fixed": options["fixed"]}
    carriers = np.array([carrier(model, int(b), robot.bodies) for b in model.geom_bodyid])
    data = mujoco.MjData(model)
    data.qpos[:] = robot.home
    seen = mujoco.MjData(model)
    ticks = []
    for k in range(arguments.ticks):
        t = k * TIMESTEP
        see(model, data, seen)
        q_command = seen.qpos.copy()
        q_command[robot.qpos] = robot.targets(t)
        begin = time.thread_time()
        q = repair(q_command, seen)
        seconds = time.thread_time() - begin
        data.ctrl[robot.actuators] = repair.control(q, data)
        speed = data.qvel[robot.dofs]
        mujoco.mj_step(model, data)
        depth, force = contacts_of_robot(model, data, carriers)
        error = np.nan
        if k % arguments.error_every == 0:
            reached = q_command.copy()
            reached[robot.qpos] = data.qpos[robot.qpos]
            error = np.sqrt(mjcf_pdg.object_norm(model, q_command, reached, **norm))
        qacc = float(np.max(np.abs(data.qvel[robot.dofs] - speed))) / TIMESTEP
        ticks.append(Tick(t, free.is_free(q_command), free.is_free(q), error, depth, force, qacc, seconds))
    return [tick for tick in ticks if tick.time > RAMP]


def free_acceleration(raw: list[Tick]) -> float:
    """The 99th percentile of `qacc` where the raw command moves freely; 1 if it never does."""
    quiet, since = [], 0
    for tick in raw:
        since = since + 1 if tick.command_free and tick.force == 0.0 else 0
        if since * TIMESTEP > SETTLED:
            quiet.append(tick.qacc)
    return float(np.quantile(quiet, 0.99)) if quiet else 1.0


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
    colours = dict(zip(FILTERS, ["#D55E00", "#999999", "#0072B2", "#009E73", "#E69F00", "#CC79A7"]))
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
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__.splitlines()[0])
    parser.add_argument("model", help="MJCF with position actuators")
    parser.add_argument("--filters", default="raw,solve,tracker", help=f"of {','.join(FILTERS)}")
    parser.add_argument("--ticks", type=int, default=10000, help="at 1 kHz")
    parser.add_argument("--obstacles", type=int, default=8)
    parser.add_argument("--amplitude", type=float, default=0.35, help="of the sinusoids, share of a joint's range")
    parser.add_argument("--clearance", type=float, default=0.002, help="that filters keep, for the servos' errors [m]")
    parser.add_argument("--steps", type=float, default=3.0, help="max_step over the targets' fastest step")
    parser.add_argument("--queries", type=int, default=12, help="of a tracker's tick, at most")
    parser.add_argument("--bandwidth", type=float, default=6.0, help="of governed: its reference model's poles [1/s]")
    parser.add_argument("--cushion", type=float, default=0.1,
                        help="of governed, beyond the clearance, share of a typical link's radius")  # fmt: skip
    parser.add_argument("--acceleration", type=float, default=0.9, help="of governed, over the targets' hardest")
    parser.add_argument("--looks", type=int, default=8, help="of governed: poses ahead that a tick asks about")
    parser.add_argument("--error-every", type=int, default=10, help="ticks between measurements of the error")
    parser.add_argument("--seed", type=int, default=0, help="of obstacles and sinusoids")
    parser.add_argument("--csv", help="every tick of every filter")
    parser.add_argument("--png", help="plots over time; needs matplotlib")
    arguments = parser.parse_args(argv)
    arguments.filters = arguments.filters.split(",")
    for name in arguments.filters:
        if name not in FILTERS:
            parser.error(f"--filters: '{name}' is none of {','.join(FILTERS)}")
    if arguments.error_every < 1:
        parser.error("--error-every: at least 1 is needed")
    fewest = round(RAMP / TIMESTEP) + arguments.error_every + 1
    if arguments.ticks < fewest:
        parser.error(f"--ticks: at least {fewest} are needed, of which those of the first {RAMP:g} s do not count")
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
    quiet_qacc = free_acceleration(runs["raw"])
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
