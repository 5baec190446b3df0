#!/usr/bin/env python3
"""VAMP's planner beside ours, on a robot of VAMP's and the same problems: times, lengths, and how many paths are free.

    python3 bench/peers/vamp_bench.py --program build/bin/mjcf-pdg [--robot panda] [--problems 50] [--write FOLDER]

VAMP is no dependency of this project. It comes as sources and is compiled for the processor: pip install vamp-planner.
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import mujoco
import numpy as np

import mjcf_pdg

try:
    import vamp
except ImportError:
    sys.exit("vamp_bench.py needs VAMP: pip install vamp-planner")

from vamp_robot import Obstacles, deepest, measure, mjcf, place, spheres_of

TOLERANCE = 1e-6  # overlap that counts as free [m], as our programs' --tolerance
CLEAR = 0.005  # that starts and goals are at least apart from everything [m]
STEP = 1e-3  # of the dense look at a path [rad]
REPEATS = 3  # of each run; they are all the same: the shortest counts
AGREEMENT = 400  # random configurations a problem, at which yes and no are compared


def random_obstacles(balls, boxes, rng):
    """Within reach of the arm, but none where its base is."""

    def around(count):
        angle, far = rng.uniform(-np.pi, np.pi, count), rng.uniform(0.35, 0.75, count)
        return np.stack([far * np.cos(angle), far * np.sin(angle), rng.uniform(0.0, 1.0, count)], axis=1)

    return Obstacles(around(balls), rng.uniform(0.05, 0.12, balls), around(boxes), rng.uniform(0.03, 0.12, (boxes, 3)),
                     rng.uniform(-np.pi, np.pi, (boxes, 3)))


def environment_of(obstacles):
    environment = vamp.Environment()
    for center, radius in zip(obstacles.center, obstacles.radius):
        environment.add_sphere(vamp.Sphere(center.tolist(), float(radius)))
    for center, euler, half in zip(obstacles.box_center, obstacles.box_euler, obstacles.box_half):
        environment.add_cuboid(vamp.Cuboid(center.tolist(), euler.tolist(), half.tolist()))
    return environment


def densely(path):
    """Configurations along the path, STEP apart."""
    parts = [a + np.linspace(0, 1, 2 + int(np.linalg.norm(b - a) / STEP))[:, None] * (b - a) for a, b in zip(path, path[1:])]
    return np.concatenate(parts)


def deepest_along(robot, obstacles, path):
    q = densely(path)
    return max(deepest(robot, obstacles, rows).max() for rows in np.array_split(q, 1 + len(q) // 2000))


def random_problem(robot, balls, boxes, rng):
    """Obstacles, a start and a goal that are free, and between them something in the straight line's way."""
    while True:
        obstacles = random_obstacles(balls, boxes, rng)
        q = rng.uniform(robot.low, robot.high, (200, len(robot.low))).astype(np.float32).astype(float)
        free = q[deepest(robot, obstacles, q) < -CLEAR]
        if len(free) >= 2 and deepest_along(robot, obstacles, free[:2]) > CLEAR:
            return obstacles, free[0], free[1]


def agreement(robot, module, obstacles, model, rng):
    """How often VAMP, our IsFree and the spheres in double precision say the same; the depths at which they do not."""
    q = rng.uniform(robot.low, robot.high, (AGREEMENT, len(robot.low))).astype(np.float32)
    environment, solver = environment_of(obstacles), mjcf_pdg.Solver(model)
    depth = deepest(robot, obstacles, q.astype(float))
    exact = depth <= TOLERANCE
    theirs = np.array([module.validate(row, environment) for row in q])
    ours = np.array([solver.is_free(row) for row in q.astype(float)])
    return {"free": exact, "vamp": depth[theirs != exact], "ours": depth[ours != exact]}


def plan_vamp(module, planner, settings, start, goal, environment):
    """(path or None, seconds) as it is found, and once more as VAMP's simplify leaves it."""
    found, best, shorter = None, [np.inf, np.inf], None
    for _ in range(REPEATS):
        rng = module.halton()
        found = planner(start.astype(np.float32), goal.astype(np.float32), environment, settings[0], rng)
        best[0] = min(best[0], 1e-9 * found.nanoseconds)
        if found.solved:
            shorter = module.simplify(found.path, environment, settings[1], rng)
            best[1] = min(best[1], 1e-9 * shorter.nanoseconds)
    if not found.solved:
        return (None, best[0]), (None, best[0])
    return (found.path.numpy().astype(float), best[0]), (shorter.path.numpy().astype(float), sum(best))


def plan_ours(program, scene, planner, seed):
    """(path or None, seconds). Without the start of the process, and without loading the model."""
    command = [program, "plan", scene, "--start", "start", "--goal", "goal", "--planner", planner, "--seed", str(seed),
               "--json", "-"]
    lines = []
    for _ in range(REPEATS):
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode not in (0, 3):
            sys.exit(run.stderr)
        lines.append(json.loads(run.stdout.splitlines()[-1]))
    path = np.array(lines[0]["path"]) if lines[0]["found"] else None
    return path, 1e-6 * min(line["time_us"] for line in lines)


def prove(model, path):
    """(whether every edge is proven free, seconds), without what a model's tables take, which each call makes anew."""
    edges = list(zip(path, path[1:]))
    begin = time.perf_counter()
    free = all([mjcf_pdg.check_motion(model, a, b) for a, b in edges])
    middle = time.perf_counter()
    for a, _ in edges:
        mjcf_pdg.check_motion(model, a, a)
    return free, 2 * middle - begin - time.perf_counter()


def row(name, runs, robot):
    """`runs`: (obstacles, model, path or None, seconds) by problem."""
    found = [run for run in runs if run[2] is not None]
    seconds = np.array([run[3] for run in runs])
    depth = np.array([deepest_along(robot, run[0], run[2]) for run in found])
    length = [sum(np.sqrt(mjcf_pdg.object_norm(run[1], a, b)) for a, b in zip(run[2], run[2][1:])) for run in found]
    proofs = [prove(run[1], run[2]) for run in found]
    print(f"{name:14} {len(found):3}/{len(runs):<3} {1e3 * np.median(seconds):10.3f} {1e3 * np.quantile(seconds, 0.95):10.3f} "
          f"{np.median([len(run[2]) for run in found]):6.0f} {np.median(length):9.3f} {(depth > TOLERANCE).sum():9} "
          f"{1e3 * max(depth.max(), 0):8.3f} {sum(proof[0] for proof in proofs):7} "
          f"{1e3 * np.median([proof[1] for proof in proofs]):9.1f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="mjcf-pdg", help="our command line program")
    parser.add_argument("--robot", default="panda", choices=vamp.robots)
    parser.add_argument("--problems", type=int, default=50)
    parser.add_argument("--balls", type=int, default=8, help="obstacles of a problem")
    parser.add_argument("--boxes", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1, help="of the problems")
    parser.add_argument("--planner", default="birrt,birrt-r,birrt-pdg", help="ours")
    parser.add_argument("--write", help="keep the problems' MJCF in this folder, for plan_bench --scene")
    options = parser.parse_args()
    module, planner, *settings = vamp.configure_robot_and_planner_with_kwargs(options.robot, "rrtc")
    rng = np.random.default_rng(options.seed)
    robot = measure(module, rng)
    q = rng.uniform(robot.low, robot.high, (AGREEMENT, len(robot.low))).astype(np.float32)
    off = place(robot, q.astype(float)) - np.array([spheres_of(module, row)[:, :3] for row in q])
    print(f"{options.robot}: {len(robot.low)} joints, {len(robot.radius)} spheres, {len(robot.pairs)} pairs of them; centres are "
          f"within {1e6 * np.abs(off).max():.1f} µm of VAMP's")
    folder = Path(options.write or tempfile.mkdtemp(prefix="vamp_bench_"))
    folder.mkdir(parents=True, exist_ok=True)
    problems, said = [], []
    for k in range(options.problems):
        obstacles, start, goal = random_problem(robot, options.balls, options.boxes, rng)
        scene = folder / f"{options.robot}{k}.xml"
        scene.write_text(mjcf(robot, obstacles, {"start": start, "goal": goal}))
        model = mujoco.MjModel.from_xml_path(str(scene))
        problems.append((obstacles, start, goal, scene, model))
        said.append(agreement(robot, module, obstacles, model, rng))
    said = {key: np.concatenate([each[key] for each in said]) for key in said[0]}
    print(f"{len(said['free'])} random configurations, {said['free'].mean():.0%} free; of them the spheres in double precision have "
          f"another answer than VAMP at {len(said['vamp'])}, than ours at {len(said['ours'])}")
    for who in ("vamp", "ours"):
        if len(said[who]):
            print(f"  {who}, where they overlap by {np.round(1e6 * said[who], 2)} µm")
    print(f"{'planner':14} {'found':>7} {'ms median':>10} {'ms 95 %':>10} {'points':>6} {'length m':>9} {'not free':>9} "
          f"{'mm deep':>8} {'proven':>7} {'ms proof':>9}")
    plans = [plan_vamp(module, planner, settings, start, goal, environment_of(obstacles))
             for obstacles, start, goal, _, _ in problems]
    for which, name in enumerate(["VAMP rrtc", "VAMP simplify"]):
        row(name, [(p[0], p[4], *plan[which]) for p, plan in zip(problems, plans)], robot)
    for ours in options.planner.split(","):
        row(ours, [(p[0], p[4], *plan_ours(options.program, str(p[3]), ours, k)) for k, p in enumerate(problems)], robot)


if __name__ == "__main__":
    main()
