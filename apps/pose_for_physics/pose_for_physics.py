#!/usr/bin/env python3
"""What MuJoCo makes of the poses of a figure or robot: as sketched, where they collide, and repaired.

    pip install . matplotlib pillow pyopengl
    python3 apps/pose_for_physics/pose_for_physics.py models/figure/figure_bench.xml

Every keyframe is simulated for a second as it is and as mjcf_pdg.solve repairs it. A figure without muscles falls in a
heap from any pose, so servos hold it as in character animation, instead of the model's actuators and springs: every
joint is drawn to its angle at the start, and the pelvis to its place and orientation, like a puppet's. Contacts have
the shortest time constant that MuJoCo allows at the model's own time step (--contact-time 0.02 has its default). With
--free-pelvis a pose has to be balanced by itself; --weightless shows what the penetration alone does. What is measured
is printed as a table, and written as CSV, PNG (plots) and GIF (animation) where asked for.
"""

import argparse
import csv
import dataclasses
import importlib
import pathlib
import sys

import mujoco
import numpy as np

import mjcf_pdg

from pictures import animate, plot
from simulation import SHORTEST, Conditions, Run, body_weight, moving, prepared, simulate

PAPER_MS = (85.2, 87.2)  # a pose, of two figures: Tang and Kim, "Interactive Generalized Penetration Depth", Sec. 6.3
MOST_WEIGHTS, FASTEST = 3.0, 0.5  # a pose at rest stays under both: force over body weight, speed of any body [m/s]


@dataclasses.dataclass
class Scene:
    path: str
    model: mujoco.MjModel  # as it is in the file
    simulated: mujoco.MjModel  # as it is simulated

    @property
    def name(self) -> str:
        return pathlib.Path(self.path).stem


@dataclasses.dataclass
class Pose:
    scene: Scene
    key: int
    depth: float  # of the sketch's overlap [m]
    rms: float  # √σ from the sketch to the repaired pose [m]
    status: str
    milliseconds: float  # of the repair
    runs: dict[str, Run]  # "sketched" (if geoms overlap), "repaired"

    @property
    def name(self) -> str:
        return self.scene.model.key(self.key).name or str(self.key)


def examine(scene: Scene, key: int, conditions: Conditions) -> Pose:
    model = scene.model
    q = model.key_qpos[key].copy()
    mocap = (model.key_mpos[key].reshape(-1, 3), model.key_mquat[key].reshape(-1, 4))
    # MuJoCo pushes as soon as geoms are nearer than their margins: the repair keeps those.
    result = mjcf_pdg.solve(model, q, mocap_pos=mocap[0], mocap_quat=mocap[1], clearance="model")
    depth = max(0.0, -result.depth_in)
    runs = {"sketched": simulate(scene.simulated, q, mocap, conditions)} if depth > 0.0 else {}
    runs["repaired"] = simulate(scene.simulated, result.q, mocap, conditions)
    return Pose(scene, key, depth, result.rms, result.status, 1e3 * result.seconds, runs)


def load(path: str, conditions: Conditions) -> Scene:
    model = mujoco.MjModel.from_xml_path(path)
    if not model.nkey:
        raise ValueError(f"{path} has no keyframes")
    off = model.opt.disableflags
    if not model.ngeom or off & mujoco.mjtDisableBit.mjDSBL_CONTACT:
        raise ValueError(f"{path} has no geoms, or disables contacts: nothing bursts")
    if not body_weight(model) or off & mujoco.mjtDisableBit.mjDSBL_GRAVITY:
        raise ValueError(f"{path} has nothing that moves, or no gravity: forces are measured in weights")
    return Scene(path, model, prepared(model, conditions))


def chosen_keys(model: mujoco.MjModel, names: list[str] | None) -> list[int]:
    return [k for k in range(model.nkey) if names is None or model.key(k).name in names]


def description(scene: Scene) -> str:
    model, simulated = scene.model, scene.simulated
    links = int(np.sum(moving(model) & (model.body_weldid == np.arange(model.nbody))))
    mass = float(np.sum(model.body_mass[moving(model)]))
    return (
        f"{scene.name}: {links} links, {model.nv} DoF, {mass:.1f} kg; contacts of "
        f"{1e3 * simulated.geom_solref[0, 0]:g} ms, simulated in steps of {1e3 * simulated.opt.timestep:g} ms"
    )


# What is written.

RUNS = ("sketched", "repaired")

HEADING = ["model", "pose", "run", "depth mm", "repair mm", "ms", "force/weight", "speed m/s", "energy J", "moved mm"]


def rows(pose: Pose) -> list[list[str]]:
    lines = []
    for name, run in pose.runs.items():
        of_repair = ["", ""] if name == "sketched" else [f"{1e3 * pose.rms:.1f}", f"{pose.milliseconds:.1f}"]
        depth = f"{1e3 * pose.depth:.1f}" if name == "sketched" else ""
        name = {"already_free": "free", "unsolved": "unsolved"}.get(pose.status, name) if of_repair[0] else name
        numbers = [f"{run.force.max():.2f}", f"{run.speed.max():.2f}", f"{max(0.0, run.energy.max()):.2f}"]
        lines.append([pose.scene.name, pose.name, name, depth, *of_repair, *numbers, f"{1e3 * run.displacement:.1f}"])
    return lines


def table(lines: list[list[str]]) -> str:
    lines = [HEADING, *lines]
    widths = [max(len(cells[k]) for cells in lines) for k in range(len(HEADING))]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(cells, widths)) for cells in lines)


def excess(run: Run) -> float:
    """Of force and speed, each over its bound, the greater: at most 1 for a pose that rests."""
    return float(max(run.force.max() / MOST_WEIGHTS, run.speed.max() / FASTEST))


def spread(values: np.ndarray) -> str:
    return f"least {values.min():.3g}, median {np.median(values):.3g}, most {values.max():.3g}"


def summary(poses: list[Pose]) -> str:
    colliding = [pose for pose in poses if "sketched" in pose.runs]
    if not colliding:
        return "in no pose do geoms overlap"
    depth = 1e3 * np.array([pose.depth for pose in colliding])
    lines = [
        f"{len(colliding)} poses in which geoms overlap: {spread(depth)} mm. "
        f"In the bounds of {MOST_WEIGHTS:g} weights and {FASTEST:g} m/s are:"
    ]
    for name in RUNS:
        runs = [pose.runs[name] for pose in colliding]
        force, speed, energy = np.array([[run.force.max(), run.speed.max(), run.energy.max()] for run in runs]).T
        over = np.array([excess(run) for run in runs])
        lines.append(
            f"{name:>8}  {sum(over <= 1.0)} of {len(runs)}; force/weight {spread(force)}, "
            f"{sum(force > MOST_WEIGHTS)} over the bound, {sum(force > 10 * MOST_WEIGHTS)} over ten times; "
            f"speed {spread(speed)} m/s, {sum(speed > FASTEST)} over the bound; "
            f"energy {spread(np.maximum(energy, 0.0))} J; the greater of force and speed over its bound {spread(over)}"
        )
    pressed = {name: sum(pose.runs[name].force[-1] > MOST_WEIGHTS for pose in colliding) for name in RUNS}
    overlap = {name: max(pose.runs[name].overlap for pose in colliding) for name in RUNS}
    lines.append(
        f"at the end {pressed['sketched']} sketched and {pressed['repaired']} repaired poses press with more than "
        f"{MOST_WEIGHTS:g} weights; geoms overlap by at most "
        f"{1e3 * overlap['sketched']:.3g} and {1e3 * overlap['repaired']:.3g} mm"
    )
    unsolved = sum(pose.status == "unsolved" for pose in colliding)
    times = np.array([pose.milliseconds for pose in colliding])
    lines.append(
        f"repair: mean {times.mean():.1f}, median {np.median(times):.1f} ms a pose, {unsolved} unsolved "
        f"(Tang and Kim, on their machine: {PAPER_MS[0]} and {PAPER_MS[1]} ms)"
    )
    return "\n".join(lines)


def write_csv(path: str, lines: list[list[str]]) -> None:
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([HEADING, *lines])


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="+", metavar="MODEL", help="MJCF of a figure or robot with keyframes")
    parser.add_argument("--key", action="append", help="a keyframe; may be repeated (default: all)")
    parser.add_argument("--weightless", action="store_true", help="no gravity: the penetration alone")
    parser.add_argument("--free-pelvis", action="store_true", help="no servo at free bodies: unbalanced poses fall")
    parser.add_argument("--gains", type=float, default=1.0, help="of the joints' servos, 2 for twice as stiff")
    contact_time = f"time constant of contacts [s] (default: {SHORTEST} time steps of the model; MuJoCo's is 0.02)"
    parser.add_argument("--contact-time", type=float, help=contact_time)
    parser.add_argument("--csv", help="the table")
    parser.add_argument("--png", help="force and speed over time; needs matplotlib")
    gif = "the sketch of which a body gets fastest and its repair, side by side; needs pillow and pyopengl"
    parser.add_argument("--gif", help=f"{gif} (and without a display MUJOCO_GL=egl)")
    arguments = parser.parse_args(argv)
    if not 0.0 <= arguments.gains < 1e6:
        parser.error("--gains: a number from 0 to a million")
    if arguments.contact_time is not None and not 1e-4 <= arguments.contact_time <= 1.0:
        parser.error("--contact-time: from 0.0001 to 1 s")
    for option in ("csv", "png", "gif"):
        path = getattr(arguments, option)
        if path and option != "csv" and pathlib.Path(path).suffix != f".{option}":
            parser.error(f"--{option}: the name of the file must end with .{option}")
        if path and not pathlib.Path(path).parent.is_dir():
            parser.error(f"--{option}: {path} is in no folder that exists")
    return arguments


def report(arguments: argparse.Namespace) -> None:
    for needed in ["matplotlib"] * bool(arguments.png) + ["PIL", "OpenGL"] * bool(arguments.gif):
        importlib.import_module(needed)  # what is missing is told before any work
    conditions = Conditions(
        arguments.contact_time, arguments.gains, not arguments.free_pelvis, weightless=arguments.weightless
    )
    scenes = [load(path, conditions) for path in arguments.models]
    known = {scene.model.key(k).name for scene in scenes for k in range(scene.model.nkey)}
    for name in arguments.key or []:
        if name not in known:
            raise ValueError(f"--key: no keyframe '{name}'")
    poses = [examine(scene, k, conditions) for scene in scenes for k in chosen_keys(scene.model, arguments.key)]
    colliding = [pose for pose in poses if "sketched" in pose.runs]
    lines = [line for pose in poses for line in rows(pose)]
    for scene in scenes:
        print(description(scene))
    print(table(lines))
    print(summary(poses))
    if arguments.csv:
        write_csv(arguments.csv, lines)
    if (arguments.png or arguments.gif) and not colliding:
        raise ValueError("no pose to draw: in none do geoms overlap")
    if arguments.png:
        plot(arguments.png, [(pose.scene.name, pose.runs) for pose in colliding], (MOST_WEIGHTS, FASTEST))
    if arguments.gif:
        fastest = max(colliding, key=lambda pose: pose.runs["sketched"].speed.max())
        animate(arguments.gif, fastest.scene.path, fastest.runs)


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        report(arguments)
    except (ValueError, ImportError, OSError, mujoco.FatalError) as error:
        print(f"pose_for_physics.py: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
