"""Repairs millions of stored configurations on the workers of a Ray cluster: grasps, resets, poses.

    python cluster_repair.py MODEL.xml ROWS.npy OUT [--rows-per-shard 1000] [--options '{"effort": "fast"}']

ROWS.npy is a float64 array (n, nq). When all is done the folder OUT has q.npy (n, nq), status.npy (n,)
and sigma.npy (n,) [m²], in the order of the rows. Until then it has a file for each shard that is done,
so that a run that was interrupted goes on where it was. All workers must see MODEL, ROWS and OUT.

Each row is in the output exactly once, whatever dies: a shard's file has its number in its name and
appears whole, by renaming; a shard that is solved twice, because a worker died between writing and
telling, becomes the same file, for the same row gives the same bytes; and the output is put together
from one file of each number.
"""

import argparse
import hashlib
import json
import logging
import os
import pathlib
import sys
import typing

import mujoco
import numpy as np

import mjcf_pdg

FIELDS = ("q", "status", "sigma")


def write_whole(path: pathlib.Path, write: typing.Callable[[typing.BinaryIO], None]) -> None:
    """Writes a file that is never seen in parts, and may be written by several processes at once."""
    part = path.with_name(f"{path.name}.{os.uname().nodename}.{os.getpid()}.part")
    with part.open("wb") as file:
        write(file)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)


class Plan(typing.NamedTuple):
    """What a run does, the same for all workers."""

    model: str
    rows: str
    out: str
    count: int
    rows_per_shard: int
    options: dict[str, typing.Any]

    @property
    def shards(self) -> int:
        return -(-self.count // self.rows_per_shard)

    def shard(self, number: int) -> pathlib.Path:
        return pathlib.Path(self.out) / f"shard-{number:08}.npz"

    def bounds(self, number: int) -> tuple[int, int]:
        begin = number * self.rows_per_shard
        return begin, min(begin + self.rows_per_shard, self.count)

    def fingerprint(self) -> dict[str, typing.Any]:
        """What must be the same where a run goes on."""
        digest = hashlib.sha256(pathlib.Path(self.model).read_bytes()).hexdigest()
        stat = os.stat(self.rows)
        rows = {"rows": self.rows, "bytes": stat.st_size, "mtime_ns": stat.st_mtime_ns}
        return {"model": digest, **rows, "rows_per_shard": self.rows_per_shard, "options": self.options}


class RepairShard:
    """A worker: has the model, and is called with numbers of shards."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.model = mujoco.MjModel.from_xml_path(plan.model)

    def __call__(self, batch: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        solved = [self.repair(int(number)) for number in batch["id"]]
        return {"id": batch["id"], "free": np.array(solved)}

    def repair(self, number: int) -> int:
        """Solves a shard and writes its file; returns how many rows are free."""
        begin, end = self.plan.bounds(number)
        rows = np.array(np.load(self.plan.rows, mmap_mode="r")[begin:end])
        try:
            results = mjcf_pdg.solve(self.model, rows, report_lower_bound=False, report_distances_to=0.0, **self.plan.options)
        except ValueError as error:
            raise ValueError(f"rows {begin} to {end - 1}: {error}") from error
        fields = {"q": results.q, "status": results.status.astype("U12"), "sigma": results.sigma}
        write_whole(self.plan.shard(number), lambda file: np.savez(file, **fields))
        return int(results.free.sum())


def missing_shards(plan: Plan) -> list[int]:
    return [number for number in range(plan.shards) if not plan.shard(number).exists()]


def run_on_ray(plan: Plan, worker: type[RepairShard] = RepairShard) -> None:
    """Solves the shards that are missing, each by one of as many workers as the cluster has CPUs."""
    import ray

    numbers = missing_shards(plan)
    if not numbers:
        return
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # Ray would tell its makers
    if not ray.is_initialized():  # the cluster of RAY_ADDRESS, or else one of this machine's cores
        ray.init(include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR)
    logging.getLogger("ray.data").setLevel(logging.WARNING)
    context = ray.data.DataContext.get_current()
    context.enable_progress_bars = sys.stderr.isatty()
    workers = min(len(numbers), max(1, int(ray.cluster_resources().get("CPU", 1))))
    shards = ray.data.from_items([{"id": number} for number in numbers], override_num_blocks=len(numbers))
    done = shards.map_batches(
        worker,
        fn_constructor_args=(plan,),
        batch_size=1,
        compute=ray.data.ActorPoolStrategy(size=workers),
        num_cpus=1,
    )  # A worker that dies is started again, and what it was at is done again: Ray Data's default.
    for _ in done.iter_batches(batch_size=None):
        pass


def merge(plan: Plan) -> dict[str, np.ndarray]:
    """Puts the output together from the shards, in order, and removes them. Returns it, mapped."""
    out = pathlib.Path(plan.out)
    parts = {name: out / f"{name}.npy.part" for name in FIELDS}
    arrays = {}
    for number in range(plan.shards):
        begin, end = plan.bounds(number)
        with np.load(plan.shard(number)) as shard:
            for name in FIELDS:
                values = shard[name]
                if len(values) != end - begin:
                    raise ValueError(f"{plan.shard(number)} has {len(values)} rows instead of {end - begin}")
                if name not in arrays:
                    shape = (plan.count, *values.shape[1:])
                    arrays[name] = np.lib.format.open_memmap(parts[name], "w+", values.dtype, shape)
                arrays[name][begin:end] = values
    for name, array in arrays.items():
        array.flush()
        parts[name].replace(out / f"{name}.npy")
    for number in range(plan.shards):
        plan.shard(number).unlink()
    return arrays


def make_plan(arguments: argparse.Namespace) -> Plan:
    """Checks what can be checked before any work. Raises ValueError and OSError."""
    model = mujoco.MjModel.from_xml_path(arguments.model)
    options = json.loads(arguments.options)
    mjcf_pdg.Solver(model, **options)
    rows = np.load(arguments.rows, mmap_mode="r")
    if rows.ndim != 2 or rows.shape[1] != model.nq or rows.dtype != np.float64:
        raise ValueError(f"{arguments.rows} is {rows.dtype} {rows.shape}, the model needs float64 (n, {model.nq})")
    if len(rows) == 0 or arguments.rows_per_shard < 1:
        raise ValueError("there must be at least one row, and one row per shard")
    paths = [str(pathlib.Path(path).resolve()) for path in (arguments.model, arguments.rows, arguments.out)]
    return Plan(*paths, len(rows), arguments.rows_per_shard, options)


def begin(plan: Plan) -> bool:
    """Makes the folder, or finds the one of the same run. Returns whether all has been done already."""
    out = pathlib.Path(plan.out)
    out.mkdir(parents=True, exist_ok=True)
    noted = out / "plan.json"
    if noted.exists():
        if json.loads(noted.read_text()) != plan.fingerprint():
            raise ValueError(f"{out} is of another run: other rows, model, options or rows per shard")
    else:
        write_whole(noted, lambda file: file.write(json.dumps(plan.fingerprint()).encode()))
    return all((out / f"{name}.npy").exists() for name in FIELDS)


def repair(plan: Plan, worker: type[RepairShard] = RepairShard) -> np.ndarray:
    """Runs, or goes on with, a plan. Returns the statuses (n,)."""
    if not begin(plan):
        run_on_ray(plan, worker)
        merge(plan)
    return np.load(pathlib.Path(plan.out) / "status.npy")


def main() -> int:
    parser = argparse.ArgumentParser(
        usage=argparse.SUPPRESS, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("model", help="an MJCF file")
    parser.add_argument("rows", help="a .npy file, float64 (n, nq)")
    parser.add_argument("out", help="a folder: new, or that of a run that was interrupted")
    parser.add_argument("--rows-per-shard", type=int, default=1000, help="what a worker solves at a time (default 1000)")
    parser.add_argument("--options", default="{}", help="options of mjcf_pdg.solve, as JSON")
    try:
        plan = make_plan(parser.parse_args())
        status = repair(plan)
    except (ValueError, TypeError, OSError) as error:
        print("cluster_repair: error:", str(error).splitlines()[-1], file=sys.stderr)
        return 2
    names, counts = np.unique(status, return_counts=True)
    print(f"{len(status)} rows: " + ", ".join(f"{count} {name}" for name, count in zip(names, counts)))
    return 0 if "unsolved" not in names else 3


if __name__ == "__main__":
    sys.exit(main())
