"""Rows per second of cluster_repair.py beside those of mjcf_pdg.solve with threads, on the same cores.

    python throughput.py [--rows 10000] [--rounds 2]

Both are timed in turn, for all rows and for a quarter of them: from the difference, what each further row costs, as in a run of
hours, without the start of Ray's workers. On a machine that others use, too, wall times say little: processor time, of all
processes of Ray, stands beside them.
"""

import argparse
import os
import pathlib
import tempfile
import threading
import time
import typing

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


class ProcessorTime:
    """User and system time of all processes below this one [s], looked at until it is stopped."""

    def __init__(self) -> None:
        self._first: dict[int, float] = {}
        self._last: dict[int, float] = {}
        self._stop = threading.Event()
        self._look()
        self._first = dict(self._last)
        self._thread = threading.Thread(target=self._watch)
        self._thread.start()

    def _look(self) -> None:
        parents, times = {}, {}
        for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = stat.read_text().rpartition(")")[2].split()
            except OSError:  # it has ended
                continue
            pid = int(stat.parent.name)
            parents[pid] = int(fields[1])
            times[pid] = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        for pid in times:
            above = pid
            while above in parents and above != os.getpid():
                above = parents[above]
            if above == os.getpid():
                self._last[pid] = times[pid]

    def _watch(self) -> None:
        while not self._stop.wait(0.2):
            self._look()

    def stop(self) -> float:
        self._stop.set()
        self._thread.join()
        self._look()
        return sum(time - self._first.get(pid, 0.0) for pid, time in self._last.items())


class Cost(typing.NamedTuple):
    """Wall time and processor time [s]."""

    wall: float
    work: float


def timed(function: typing.Callable[[], typing.Any]) -> tuple[typing.Any, Cost]:
    begin, work = time.perf_counter(), ProcessorTime()
    answer = function()
    return answer, Cost(time.perf_counter() - begin, work.stop())


def compare(model: mujoco.MjModel, rows: np.ndarray, cores: int) -> tuple[Cost, Cost]:
    """What the rows cost in plain threads and on Ray. The answers must be the same."""
    options = {"report_lower_bound": False, "report_distances_to": 0.0}
    results, plain = timed(lambda: mjcf_pdg.solve(model, rows, threads=cores, **options))
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "rows.npy")
        np.save(path, rows)
        plan = Plan(str(MODEL), str(path), folder, len(rows), 250, {})
        _, on_ray = timed(lambda: run_on_ray(plan))
        assert merge(plan)["q"].tobytes() == results.q.tobytes()
    return plain, on_ray


def main() -> None:
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__)
    parser.add_argument("--rows", type=int, default=10000)
    parser.add_argument("--rounds", type=int, default=2)
    arguments = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    rows = sample_grasps(model, arguments.rows)
    cores = len(os.sched_getaffinity(0))
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    ray.init(num_cpus=cores, include_dashboard=False, log_to_driver=False)
    compare(model, rows[:250], cores)  # the first of Ray's workers take longest to start
    for round_ in range(arguments.rounds):
        few, many = (compare(model, rows[:count], cores) for count in (len(rows) // 4, len(rows)))
        wall, work = (
            (many[0][kind] - few[0][kind]) / (many[1][kind] - few[1][kind]) for kind in (0, 1)
        )
        start = few[1].work - (many[1].work - few[1].work) / 3.0
        print(
            f"round {round_}: {cores} cores, {len(rows)} rows: plain {many[0].wall:.1f} s, Ray {many[1].wall:.1f} s; "
            f"Ray's throughput over plain, per further row: {wall:.3f} by wall time, {work:.3f} by processor time; "
            f"Ray's start: {start:.1f} s of processor time",
            flush=True,
        )


if __name__ == "__main__":
    main()
