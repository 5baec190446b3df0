"""Rows per second of cluster_repair.py beside those of mjcf_pdg.solve with threads, on the same cores.

    python throughput.py [--rows 10000] [--rounds 2]

The workers are started before the clock: what is compared is what a run of hours does. Both are timed in turn.
"""

import argparse
import os
import pathlib
import tempfile
import time

import mujoco
import numpy as np
import ray
from cluster_repair import Plan, merge, run_on_ray

import mjcf_pdg

MODEL = pathlib.Path(__file__).resolve().parents[2] / "models" / "hand" / "hand_bottle.xml"


def sample_grasps(model: mujoco.MjModel, count: int) -> np.ndarray:
    """Grasps (count, nq) about the keyframe: fingers bent and the palm moved at random."""
    rng = np.random.default_rng(0)
    grasps = np.tile(model.key("gentle_grasp").qpos, (count, 1))
    grasps[:, :3] += rng.normal(0.0, 0.003, (count, 3))  # the palm's place [m]
    grasps[:, 7:] += rng.normal(0.0, 0.05, (count, model.nq - 7))  # the fingers' angles [rad]
    return grasps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=10000)
    parser.add_argument("--rounds", type=int, default=2)
    arguments = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    rows = sample_grasps(model, arguments.rows)
    cores = len(os.sched_getaffinity(0))
    ray.init(num_cpus=cores, include_dashboard=False, log_to_driver=False)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "rows.npy")
        np.save(path, rows)
        for round_ in range(arguments.rounds):
            begin = time.perf_counter()
            results = mjcf_pdg.solve(model, rows, threads=cores, report_lower_bound=False, report_distances_to=0.0)
            plain = time.perf_counter() - begin
            plan = Plan(str(MODEL), str(path), folder, len(rows), 500, {})
            begin = time.perf_counter()
            run_on_ray(plan)
            on_ray = time.perf_counter() - begin
            same = merge(plan)["q"].tobytes() == results.q.tobytes()
            print(
                f"round {round_}: {cores} cores, plain {len(rows) / plain:.0f} rows/s, Ray {len(rows) / on_ray:.0f} rows/s, "
                f"ratio {plain / on_ray:.3f}, the same answers: {same}",
                flush=True,
            )


if __name__ == "__main__":
    main()
