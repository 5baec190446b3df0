#!/usr/bin/env python3
"""What MuJoCo makes of the poses of a figure or robot: as sketched, where they collide, and repaired.

    pip install . matplotlib pillow pyopengl
    python3 apps/pose_for_physics/pose_for_physics.py models/figure/figure_bench.xml

Every keyframe is simulated for a second as it is and as mjcf_pdg.solve repairs it. A figure without muscles falls in a
heap from any pose, so servos hold it as in character animation, instead of the model's actuators: every joint is drawn
to its angle at the start, and the pelvis to its place and orientation, like a puppet's. Contacts are as hard as MuJoCo
allows at the model's own time step (--contact-time 0.02 has its default); everything else is as the model has it. With
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

SECONDS = 1.0
PAPER_MS = (85.2, 87.2)  # a pose, of two figures (Sec. 6.3)
MOST_WEIGHTS, FASTEST = 3.0, 0.5  # a pose at rest stays under both: force over body weight, speed of any body [m/s]

# By how much a servo gives under the whole weight of what it carries: of a joint that turns [rad], and of a sliding
# joint or a free body [m].
TURN_SAG, SLIDE_SAG = 0.02, 0.001
DAMPING = 0.1  # of joints that turn, over the stiffness [s]: as in DeepMimic (Peng et al., ACM TOG 37(4), 2018)

# Contacts are as hard as MuJoCo allows at the model's time step (its refsafe): time constant over time step.
HARDEST = 2
STEPS_PER_CONTACT_TIME = 5  # of the simulation at least, which is shorter than the model's step where that is not enough


def hold(model: mujoco.MjModel, gains: float, free_bodies_held: bool) -> None:
    """A `servo` in every joint, those of hinges, balls and slides times `gains`, instead of the model's actuators."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    for j in range(model.njnt):
        is_free = mujoco.mjtJoint(model.jnt_type[j]) == mujoco.mjtJoint.mjJNT_FREE
        stiffness, damping = servo(model, data, j)
        scale = float(free_bodies_held) if is_free else gains
        model.jnt_stiffness[j] = scale * stiffness
        model.dof_damping[model.dof_jntid == j] += scale * damping


def servo(model: mujoco.MjModel, data: mujoco.MjData, j: int) -> tuple[float, float]:
    """Stiffness [N/m or N m/rad] and damping [N s/m or N m s/rad] of a joint's servo; `data` is at qpos0."""
    body = model.jnt_bodyid[j]
    mass = float(model.body_subtreemass[body])
    weight = mass * float(np.linalg.norm(model.opt.gravity))
    if mujoco.mjtJoint(model.jnt_type[j]) in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_SLIDE):
        stiffness = weight / SLIDE_SAG  # of a free body as many N m/rad
        return stiffness, 2 * np.sqrt(mass * stiffness)
    lever = float(np.linalg.norm(data.subtree_com[body] - data.xanchor[j]))
    stiffness = weight * lever / TURN_SAG
    return stiffness, DAMPING * stiffness


@dataclasses.dataclass
class Run:
    """A second of simulation, step by step; infinities where MuJoCo gave up."""

    timestep: float  # [s]
    q: np.ndarray  # (steps + 1, nq), fewer where MuJoCo gave up
    force: np.ndarray  # (steps,) sum of all contacts' normal forces over body weight
    speed: np.ndarray  # (steps,) of the fastest body's centre of mass [m/s]
    energy: np.ndarray  # (steps,) kinetic, of gravity and of servos, over that at the start [J]
    displacement: float  # √σ from the first pose to the last [m]
    sunk: float  # deepest contact at the end [m]


def simulate(model: mujoco.MjModel, q: np.ndarray) -> Run:
    model.qpos_spring[:] = q  # where the servos draw to
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    weight = body_weight(model)
    start = float(np.sum(data.energy))
    steps = round(SECONDS / model.opt.timestep)
    path = [q]
    force, speed, energy = np.full((3, steps), np.inf)
    for k in range(steps):
        mujoco.mj_step(model, data)
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:  # it bursts beyond what MuJoCo can compute
            return Run(model.opt.timestep, np.array(path), force, speed, energy, np.inf, np.inf)
        force[k] = normal_force(model, data) / weight
        mujoco.mj_forward(model, data)  # positions, velocities and energy at the end of the step
        speed[k] = fastest_body(model, data)
        energy[k] = float(np.sum(data.energy)) - start
        path.append(data.qpos.copy())
    displacement = float(np.sqrt(mjcf_pdg.object_norm(model, q, data.qpos)))
    sunk = max(0.0, -min(data.contact.dist, default=0.0))
    return Run(model.opt.timestep, np.array(path), force, speed, energy, displacement, sunk)


def moving_mass(model: mujoco.MjModel) -> float:
    """Of the figure, without furniture [kg]."""
    return float(np.sum(model.body_mass[model.body_weldid != 0]))


def body_weight(model: mujoco.MjModel) -> float:
    """Of the figure [N]."""
    return moving_mass(model) * float(np.linalg.norm(model.opt.gravity))


def normal_force(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """The sum over all contacts [N]."""
    total, wrench = 0.0, np.zeros(6)
    for k in range(data.ncon):
        mujoco.mj_contactForce(model, data, k, wrench)
        total += wrench[0]
    return total


def fastest_body(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Speed of its centre of mass [m/s]."""
    velocity, fastest = np.zeros(6), 0.0  # rotation first
    for body in range(1, model.nbody):
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
        fastest = max(fastest, float(np.linalg.norm(velocity[3:])))
    return fastest


@dataclasses.dataclass
class Pose:
    model: str
    name: str
    depth: float  # of the sketch [m]
    rms: float  # √σ from the sketch to the repaired pose [m]
    status: str
    milliseconds: float  # of the repair
    runs: dict[str, Run]  # "sketched" (if it collides), "repaired"


def examine(path: str, model: mujoco.MjModel, key: int) -> Pose:
    q = model.key_qpos[key].copy()
    result = mjcf_pdg.solve(model, q)
    runs = {} if result.status == "already_free" else {"sketched": simulate(model, q)}
    runs["repaired"] = simulate(model, result.q)
    milliseconds = 1e3 * result.seconds
    depth = max(0.0, -result.depth_in)
    name = model.key(key).name or str(key)
    return Pose(pathlib.Path(path).stem, name, depth, result.rms, result.status, milliseconds, runs)


def load(path: str, arguments: argparse.Namespace) -> mujoco.MjModel:
    model = mujoco.MjModel.from_xml_path(path)
    if not model.nkey:
        raise ValueError(f"{path} has no keyframes")
    if not body_weight(model):
        raise ValueError(f"{path} has nothing that weighs: forces are measured in weights")
    hold(model, arguments.gains, not arguments.free_pelvis)
    contact_time = arguments.contact_time or HARDEST * model.opt.timestep
    model.geom_solref[:] = model.pair_solref[:] = [contact_time, 1.0]  # damped critically
    model.opt.timestep = min(model.opt.timestep, contact_time / STEPS_PER_CONTACT_TIME)
    model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    if arguments.weightless:
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    return model


def chosen_keys(model: mujoco.MjModel, names: list[str] | None) -> list[int]:
    return [k for k in range(model.nkey) if names is None or model.key(k).name in names]


def description(path: str, model: mujoco.MjModel) -> str:
    links = int(np.sum(model.body_weldid == np.arange(model.nbody))) - 1
    return (
        f"{pathlib.Path(path).stem}: {links} links, {model.nv} DoF, {moving_mass(model):.1f} kg; contacts of "
        f"{1e3 * model.geom_solref[0, 0]:g} ms, simulated in steps of {1e3 * model.opt.timestep:g} ms"
    )


# What is written.

HEADING = ["model", "pose", "run", "depth mm", "repair mm", "ms", "force/weight", "speed m/s", "energy J", "moved mm"]


def rows(pose: Pose) -> list[list[str]]:
    lines = []
    for name, run in pose.runs.items():
        of_repair = ["", ""] if name == "sketched" else [f"{1e3 * pose.rms:.1f}", f"{pose.milliseconds:.1f}"]
        depth = f"{1e3 * pose.depth:.1f}" if name == "sketched" else ""
        name = name if pose.status != "already_free" else "free"
        numbers = [f"{run.force.max():.2f}", f"{run.speed.max():.2f}", f"{max(0.0, run.energy.max()):.2f}"]
        lines.append([pose.model, pose.name, name, depth, *of_repair, *numbers, f"{1e3 * run.displacement:.1f}"])
    return lines


def table(lines: list[list[str]]) -> str:
    lines = [HEADING, *lines]
    widths = [max(len(cells[k]) for cells in lines) for k in range(len(HEADING))]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(cells, widths)) for cells in lines)


def rests(run: Run) -> bool:
    return bool(run.force.max() <= MOST_WEIGHTS and run.speed.max() <= FASTEST)


def summary(poses: list[Pose]) -> str:
    colliding = [pose for pose in poses if "sketched" in pose.runs]
    if not colliding:
        return "no pose collides"
    lines = [f"{len(colliding)} poses collide. At most {MOST_WEIGHTS:g} weights and {FASTEST:g} m/s:"]
    for name in ("sketched", "repaired"):
        runs = [pose.runs[name] for pose in colliding]
        force, speed, energy = np.array([[run.force.max(), run.speed.max(), run.energy.max()] for run in runs]).T
        lines.append(
            f"{name:>8}  {sum(map(rests, runs))}; force/weight least {force.min():.3g}, median {np.median(force):.3g}, most {force.max():.3g}, "
            f"{sum(force > MOST_WEIGHTS)} over the bound, {sum(force > 10 * MOST_WEIGHTS)} over ten times; "
            f"speed least {speed.min():.3g}, median {np.median(speed):.3g}, most {speed.max():.3g} m/s, "
            f"{sum(speed > FASTEST)} over the bound; "
            f"energy least {max(0.0, energy.min()):.3g}, most {max(0.0, energy.max()):.3g} J"
        )
    sunk = max(pose.runs["repaired"].sunk for pose in poses)
    lines.append(f"at the end of the repaired runs bodies are in each other by {1e3 * sunk:.3f} mm at most")
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


# Colours that a deuteranope tells apart (Okabe and Ito).
COLOURS = {"sketched": "#D55E00", "repaired": "#009E73"}


def plot(path: str, poses: list[Pose]) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    models = list(dict.fromkeys(pose.model for pose in poses))
    figure, axes = pyplot.subplots(
        2, len(models), sharex=True, sharey="row", squeeze=False, figsize=(6 * len(models), 7), layout="constrained"
    )
    panels = [("force", MOST_WEIGHTS, "contact force / weight"), ("speed", FASTEST, "fastest body [m/s]")]
    for column, model in enumerate(models):
        for axis, (field, bound, label) in zip(axes[:, column], panels):
            for pose in (pose for pose in poses if pose.model == model and "sketched" in pose.runs):
                for name, run in pose.runs.items():
                    values = getattr(run, field)
                    time = np.linspace(0.0, SECONDS, len(values))
                    axis.plot(time, np.maximum(values, 1e-2), color=COLOURS[name], linewidth=0.8)
            axis.axhline(bound, color="black", linewidth=0.8, linestyle="--")
            axis.set_yscale("log")
            if column == 0:
                axis.set_ylabel(label)
        axes[0, column].set_title(model)
        axes[1, column].set_xlabel("time [s]")
    lines = [pyplot.Line2D([], [], color=colour, label=name) for name, colour in COLOURS.items()]
    figure.legend(handles=lines, loc="outside upper right", ncols=len(lines))
    figure.savefig(path, dpi=100)


def animate(path: str, source: str, pose: Pose) -> None:
    """Both runs side by side, four times slower than life."""
    from PIL import Image

    per_second, slower, width, height = 50, 4, 400, 360
    columns = []
    for name, run in pose.runs.items():
        model = mujoco.MjModel.from_xml_path(source)
        colour = [int(COLOURS[name][k : k + 2], 16) / 255 for k in (1, 3, 5)]
        for geom in range(model.ngeom):
            if model.body_weldid[model.geom_bodyid[geom]] != 0:  # what moves
                model.geom_matid[geom] = -1
                model.geom_rgba[geom] = [*colour, 1]
        data = mujoco.MjData(model)
        camera = 0 if model.ncam else -1
        with mujoco.Renderer(model, height, width) as renderer:
            frames = []
            for q in run.q[:: round(1 / (per_second * run.timestep))]:
                data.qpos[:] = q
                mujoco.mj_forward(model, data)
                renderer.update_scene(data, camera)
                frames.append(renderer.render().copy())
        columns.append(frames)
    images = [Image.fromarray(np.hstack(both)).quantize(128) for both in zip(*columns)]
    images[0].save(path, save_all=True, append_images=images[1:], duration=1000 * slower // per_second, loop=0)


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="+", metavar="MODEL", help="MJCF of the figure with keyframes")
    parser.add_argument("--key", action="append", help="a keyframe; may be repeated (default: all)")
    parser.add_argument("--weightless", action="store_true", help="no gravity: the penetration alone")
    parser.add_argument("--free-pelvis", action="store_true", help="no servo at free bodies: unbalanced poses fall")
    parser.add_argument("--gains", type=float, default=1.0, help="of the joints' servos, over those described above")
    contact_time = f"time constant of contacts [s] (default: {HARDEST} time steps of the model; MuJoCo's is 0.02)"
    parser.add_argument("--contact-time", type=float, help=contact_time)
    parser.add_argument("--csv", help="the table")
    parser.add_argument("--png", help="force and speed over time; needs matplotlib")
    gif = "the sketch with the largest force and its repair, side by side; needs pillow and pyopengl"
    parser.add_argument("--gif", help=f"{gif} (and without a display MUJOCO_GL=egl)")
    arguments = parser.parse_args(argv)
    if not 0.0 <= arguments.gains < np.inf:
        parser.error("--gains: a finite number, at least 0")
    if arguments.contact_time is not None and not 1e-4 <= arguments.contact_time < np.inf:
        parser.error("--contact-time: a finite number, at least 0.0001")
    return arguments


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        for needed in ["matplotlib"] * bool(arguments.png) + ["PIL", "OpenGL"] * bool(arguments.gif):
            importlib.import_module(needed)  # what is missing is told before any work
        loaded = [(path, load(path, arguments)) for path in arguments.models]
        known = {model.key(k).name for _, model in loaded for k in range(model.nkey)}
        for name in arguments.key or []:
            if name not in known:
                raise ValueError(f"--key: no keyframe '{name}'")
        sources = [(path, model, k) for path, model in loaded for k in chosen_keys(model, arguments.key)]
        poses = [examine(*source) for source in sources]
        colliding = [(pose, path) for pose, (path, _, _) in zip(poses, sources) if "sketched" in pose.runs]
        lines = [line for pose in poses for line in rows(pose)]
        for source in loaded:
            print(description(*source))
        print(table(lines))
        print(summary(poses))
        if arguments.csv:
            write_csv(arguments.csv, lines)
        if arguments.png:
            plot(arguments.png, poses)
        if arguments.gif and colliding:
            pose, path = max(colliding, key=lambda both: both[0].runs["sketched"].force.max())
            animate(arguments.gif, path, pose)
    except (ValueError, ImportError, mujoco.FatalError) as error:
        print(f"pose_for_physics.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
