#!/usr/bin/env python3
"""Moves grasps to new cups: as they are, and freed by PDg; a lift in MuJoCo tells which of them hold.

    pip install . matplotlib pillow pyopengl
    python3 apps/grasp_transfer/grasp_transfer.py --cups 50 --seed 1

database.json has grasps of the hand of models/hand on cups and bottles. For each new cup, generated from the seed, the
grasp of the most similar vessel is moved over (Tang and Kim, Sec. 6.3, Fig. 10e), where it overlaps with the cup;
mjcf_pdg.solve finds the nearest pose that does not. Both poses go through the same lift (lift.py). What is measured is
printed as a table, and written as CSV, PNG (plot) and GIF (animation) where asked for.
"""

import argparse
import concurrent.futures
import csv
import dataclasses
import functools
import importlib
import json
import pathlib
import sys
import time
from collections.abc import Iterable
from concurrent.futures.process import BrokenProcessPool

import mujoco
import numpy as np

import mjcf_pdg

from lift import Lift, lift
from scene import FINGERS, Contacts, for_lift, for_repair, touching_fingers
from vessels import Vessel, difference, excess, random_cup

DATABASE = pathlib.Path(__file__).resolve().parent / "database.json"
ALLOWED = 3e-5  # how deep fingers may press into the cup, as they do in the lift: 0.005 mm, 0.2 while they close [m]
PAPER_MS = 148  # a pose of a hand and a cup (Sec. 6.3), on another machine
RUNS = ("raw", "repaired")


@dataclasses.dataclass
class Grasp:
    vessel: Vessel
    q: np.ndarray  # (HAND_NQ,), free, the fingers touch


def read_database() -> list[Grasp]:
    grasps = []
    for entry in json.loads(DATABASE.read_text()):
        vessel = Vessel(entry["kind"], tuple(map(tuple, entry["profile"])), entry["wall"])
        grasps.append(Grasp(vessel, np.array(entry["q"])))
    return grasps


def most_similar(database: list[Grasp], cup: Vessel, any_width: bool) -> tuple[Grasp, bool]:
    """By vessels.difference, of those nowhere wider than the cup, if there are any: PDg opens hands, but closes none.

    The second: whether there are.
    """
    narrower = [grasp for grasp in database if excess(grasp.vessel, cup) <= 0.0]
    choice = database if any_width or not narrower else narrower
    return min(choice, key=lambda grasp: difference(grasp.vessel, cup)), bool(narrower)


def allowed(model: mujoco.MjModel) -> dict[tuple[str, str], float]:
    """The option `allow`: every segment of a finger may press into the vessel."""
    bodies = [model.body(b).name for b in range(model.nbody)]
    return {(name, "vessel"): ALLOWED for name in bodies if name.split("_")[0] in FINGERS}


@dataclasses.dataclass
class Transfer:
    cup: Vessel
    source: Vessel  # the database's vessel whose grasp is moved over
    has_narrower: bool  # the database has a vessel that is nowhere wider than the cup
    result: mjcf_pdg.Result
    milliseconds: float  # of processor time, of the repair
    fingers: dict[str, set[str]]  # in contact, by run
    lifts: dict[str, Lift]  # by run


def transfer(database: list[Grasp], any_width: bool, contacts: Contacts, cup: Vessel) -> Transfer:
    grasp, has_narrower = most_similar(database, cup, any_width)
    model, simulated = for_repair(cup), for_lift(cup, contacts)
    solver = mjcf_pdg.Solver(model, exact_mesh=True, root="palm", allow=allowed(model))
    started = time.process_time()
    result = solver.solve(grasp.q)
    milliseconds = 1e3 * (time.process_time() - started)
    poses = dict(zip(RUNS, (grasp.q, result.q)))
    fingers = {run: touching_fingers(simulated, q) for run, q in poses.items()}
    lifts = {run: lift(simulated, q) for run, q in poses.items()}
    return Transfer(cup, grasp.vessel, has_narrower, result, milliseconds, fingers, lifts)


# What is written.

HEADING = [
    "cup", "radius mm", "height mm", "like", "unlike mm", "status", "depth mm", "sigma m^2", "rms mm", "ms",
    "run", "fingers", "rise mm", "slip mm", "tilt deg", "overlap mm", "force N", "holds",
]  # fmt: skip


def depth(t: Transfer) -> float:
    """Of the overlap of the grasp as moved over [m]."""
    return max(0.0, -t.result.depth_in)


def rows(number: int, t: Transfer) -> list[list[str]]:
    radius = max(r for r, _ in t.cup.profile)
    lines = []
    for run, made in t.lifts.items():
        unlike = difference(t.source, t.cup)
        about = [str(number), f"{1e3 * radius:.1f}", f"{1e3 * t.cup.height:.1f}", t.source.kind, f"{1e3 * unlike:.1f}"]
        repair = [t.result.status, f"{1e3 * depth(t):.1f}", f"{t.result.sigma:.3g}", f"{1e3 * t.result.rms:.2f}"]
        way = [f"{1e3 * made.rise:.0f}", f"{1e3 * made.slip:.0f}", f"{made.tilt:.0f}"]
        contact = [f"{1e3 * made.overlap:.3f}", f"{made.force:.0f}", "yes" if made.holds else "no"]
        lines.append([*about, *repair, f"{t.milliseconds:.0f}", run, str(len(t.fingers[run])), *way, *contact])
    return lines


def table(lines: list[list[str]]) -> str:
    lines = [HEADING, *lines]
    widths = [max(len(cells[k]) for cells in lines) for k in range(len(HEADING))]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(cells, widths)) for cells in lines)


def summary(transfers: list[Transfer]) -> str:
    results = [t.result for t in transfers]
    colliding = [t for t in transfers if t.result.status != "already_free"]
    unsolved = sum(result.status == "unsolved" for result in results)
    narrower, bottles = sum(t.has_narrower for t in transfers), sum(t.source.kind == "bottle" for t in transfers)
    lines = [
        f"{len(transfers)} cups, {narrower} of which have a vessel that is nowhere wider; {bottles} grasps are of "
        f"bottles; {len(colliding)} collide as moved over, {unsolved} of them unsolved"
    ]
    for run in RUNS:
        lifts = [t.lifts[run] for t in transfers]
        force = np.array([each.force for each in lifts])
        risen = [each for each in lifts if each.risen]
        of_colliding = sum(t.lifts[run].risen for t in colliding)
        tilt = f"tilted by {np.median([each.tilt for each in risen]):.0f} degrees (median); " if risen else ""
        lines.append(
            f"{run:>8}  in contact {np.mean([len(t.fingers[run]) for t in transfers]):.1f} of 5 fingers; "
            f"lifted {len(risen)} ({of_colliding} of those that collide), of these pierced "
            f"{sum(each.pierced for each in risen)}; {tilt}"
            f"hold {sum(each.holds for each in lifts)}; force median {np.median(force):.3g}, most {force.max():.3g} N"
        )
    kept, touched = (sum(len(t.fingers["raw"] & t.fingers[run]) for t in colliding) for run in ("repaired", "raw"))
    if colliding:
        rms = 1e3 * np.array([t.result.rms for t in colliding])
        times = np.array([t.milliseconds for t in colliding])
        lines.append(
            f"repairs keep {kept} of {touched} fingers in contact; "
            f"√σ median {np.median(rms):.2f}, most {rms.max():.2f} mm"
        )
        lines.append(
            f"a repair takes {times.mean():.0f} ms of processor time, median {np.median(times):.0f} "
            f"(Tang and Kim, on their machine: {PAPER_MS} ms)"
        )
    return "\n".join(lines)


# Colours that a deuteranope tells apart (Okabe and Ito).
COLOURS = {"raw": "#D55E00", "repaired": "#009E73"}


def plot(path: str, transfers: list[Transfer]) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axis = pyplot.subplots(figsize=(8, 5), layout="constrained")
    for run in RUNS:
        for holds, marker in ((True, "o"), (False, "x")):
            chosen = [t for t in transfers if t.lifts[run].holds == holds]
            points = [(1e3 * depth(t), t.lifts[run].force) for t in chosen]
            label = f"{run}, {'holds' if holds else 'does not hold'}"
            axis.scatter(*np.reshape(points, (-1, 2)).T, color=COLOURS[run], marker=marker, label=label)
    axis.set(xlabel="overlap of the grasp as moved over [mm]", ylabel="largest contact force [N]", yscale="log")
    axis.legend()
    figure.savefig(path, dpi=100)


def animate(path: str, t: Transfer) -> None:
    """Both lifts side by side."""
    from PIL import Image

    model = for_lift(t.cup)
    columns = []
    for run in RUNS:
        colour = [int(COLOURS[run][k : k + 2], 16) / 255 for k in (1, 3, 5)]
        hand = (model.geom_bodyid != 0) & (model.geom_bodyid != model.body("vessel").id)
        model.geom_matid[hand], model.geom_rgba[hand] = -1, [*colour, 1]
        data, frames = mujoco.MjData(model), []
        camera = mujoco.MjvCamera()
        camera.lookat[:], camera.distance, camera.azimuth, camera.elevation = (0, 0, 0.11), 0.45, 150, -20
        with mujoco.Renderer(model, 360, 320) as renderer:
            for q in t.lifts[run].q[::2]:
                data.qpos[:] = q
                mujoco.mj_forward(model, data)
                renderer.update_scene(data, camera)
                frames.append(renderer.render().copy())
        columns.append(frames)
    images = [Image.fromarray(np.hstack(both)).quantize(96) for both in zip(*columns)]
    images[0].save(path, save_all=True, append_images=images[1:], duration=80, loop=0)


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__.splitlines()[0])
    parser.add_argument("--cups", type=int, default=50, help="how many new cups (default 50)")
    parser.add_argument("--seed", type=int, default=1, help="of the new cups (default 1)")
    parser.add_argument("--any-width", action="store_true", help="the most similar vessel, wider than the cup or not")
    frequency, damping = Contacts.frequency, Contacts.damping_ratio
    parser.add_argument("--frequency", type=float, default=frequency, help=f"of contacts [rad/s] ({frequency:g})")
    parser.add_argument("--damping-ratio", type=float, default=damping, help=f"of contacts ({damping})")
    parser.add_argument("--csv", help="the table")
    parser.add_argument("--png", help="contact force over depth of the overlap; needs matplotlib")
    gif = "the two lifts of the cup whose raw grasp presses hardest; needs pillow and pyopengl"
    parser.add_argument("--gif", help=f"{gif} (and without a display MUJOCO_GL=egl)")
    arguments = parser.parse_args(argv)
    if arguments.cups < 1 or arguments.seed < 0:
        parser.error("--cups: at least 1; --seed: at least 0")
    if not 100.0 <= arguments.frequency <= 1e5:
        parser.error("--frequency: from 100 to 100000 rad/s")
    if not 0.0 < arguments.damping_ratio <= 10.0:
        parser.error("--damping-ratio: above 0 and at most 10")
    for option in ("csv", "png", "gif"):
        path = getattr(arguments, option) and pathlib.Path(getattr(arguments, option))
        if path and (path.suffix != f".{option}" or not path.resolve().parent.is_dir()):
            parser.error(f"--{option}: a file in a folder that exists, whose name ends with .{option}")
    return arguments


def shown(transfers: Iterable[Transfer], count: int) -> Iterable[Transfer]:
    """With a bar on terminals, where tqdm is installed."""
    try:
        import tqdm
    except ImportError:
        return transfers
    return tqdm.tqdm(transfers, total=count, desc="lifting", unit="cup", disable=None)


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        for needed in ["matplotlib"] * bool(arguments.png) + ["PIL", "OpenGL"] * bool(arguments.gif):
            importlib.import_module(needed)  # what is missing is told before any work
        rng = np.random.default_rng([1, arguments.seed])  # the database's vessels have other streams: [0, k]
        cups = [random_cup(rng) for _ in range(arguments.cups)]
        contacts = Contacts(arguments.frequency, arguments.damping_ratio)
        transfer_to = functools.partial(transfer, read_database(), arguments.any_width, contacts)
        with concurrent.futures.ProcessPoolExecutor() as pool:
            transfers = list(shown(pool.map(transfer_to, cups), len(cups)))
        lines = [line for number, each in enumerate(transfers) for line in rows(number, each)]
        print(table(lines))
        print(summary(transfers))
        if arguments.csv:
            with open(arguments.csv, "w", newline="") as file:
                csv.writer(file).writerows([HEADING, *lines])
        if arguments.png:
            plot(arguments.png, transfers)
        if arguments.gif:
            animate(arguments.gif, max(transfers, key=lambda each: each.lifts["raw"].force))
    except (OSError, ValueError, ImportError, mujoco.FatalError, BrokenProcessPool) as error:
        print(f"grasp_transfer.py: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("grasp_transfer.py: interrupted", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
