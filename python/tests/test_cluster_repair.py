"""apps/cluster_repair: a million rows on a Ray cluster, here a few on this machine's cores, where Ray is installed."""

import os
import pathlib
import subprocess
import sys

import mujoco
import numpy as np
import pytest

import mjcf_pdg

pytest.importorskip("ray", reason="pip install 'ray[data]'")

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "apps" / "cluster_repair"
MODEL = FOLDER.parents[1] / "models" / "puma" / "puma_car.xml"
PER_SHARD = 20

# A worker that ends its own process once: in shard 3 before it has written its file, in shard 5 after that.
DRIVER = """
import argparse, os, pathlib, signal, sys
import cluster_repair
import ray

class Dies(cluster_repair.RepairShard):
    def repair(self, number):
        if number == 3:
            self.die_once(number)
        free = super().repair(number)
        if number == 5:
            self.die_once(number)
        return free

    def die_once(self, number):
        mark = pathlib.Path(self.plan.out, f"died-{number}")
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)

model, rows, out = sys.argv[1:]
plan = cluster_repair.make_plan(argparse.Namespace(
    model=model, rows=rows, out=out, rows_per_shard=%d, options='{"effort": "fast"}'))
os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
print(len(cluster_repair.repair(plan, Dies)))
""" % PER_SHARD


def run(*arguments: str) -> subprocess.CompletedProcess:
    path = os.pathsep.join(filter(None, (str(FOLDER), os.environ.get("PYTHONPATH"))))
    environment = os.environ | {"PYTHONPATH": path}
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, env=environment)


@pytest.fixture(scope="module")
def rows(tmp_path_factory) -> pathlib.Path:
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    rng = np.random.default_rng(0)
    key = model.key("cart_in_running_board").qpos
    path = tmp_path_factory.mktemp("rows") / "rows.npy"
    np.save(path, key + rng.normal(0.0, 0.01, (190, model.nq)))  # the last shard is half full
    return path


def test_every_row_is_there_once_although_workers_die(rows, tmp_path):
    out = tmp_path / "out"
    done = run("-c", DRIVER, str(MODEL), str(rows), str(out))
    assert done.returncode == 0, done.stderr
    assert (out / "died-3").exists() and (out / "died-5").exists()
    plain = mjcf_pdg.solve(mujoco.MjModel.from_xml_path(str(MODEL)), np.load(rows), threads=2, effort="fast")
    assert np.load(out / "q.npy").tobytes() == plain.q.tobytes()
    assert np.load(out / "status.npy").tolist() == plain.status.tolist()
    assert np.load(out / "sigma.npy").tobytes() == plain.sigma.tobytes()
    assert not list(out.glob("shard-*")), "the shards are gone"
    # Asked again, it has nothing to do; asked for something else, it refuses.
    command = [str(FOLDER / "cluster_repair.py"), str(MODEL), str(rows), str(out), "--rows-per-shard", str(PER_SHARD)]
    again = run(*command, "--options", '{"effort": "fast"}')
    assert again.returncode == 0 and again.stdout.startswith("190 rows: "), again.stderr
    other = run(*command)
    assert other.returncode == 2 and "is of another run" in other.stderr


def test_bad_input_is_refused_before_any_work(rows, tmp_path):
    command = [str(FOLDER / "cluster_repair.py"), str(MODEL)]
    np.save(tmp_path / "short.npy", np.zeros((3, 2)))
    for arguments, words in (
        ([str(tmp_path / "short.npy"), str(tmp_path / "out")], "the model needs float64 (n, 9)"),
        ([str(rows), str(tmp_path / "out"), "--options", '{"efort": 1}'], "no option 'efort'"),
        ([str(tmp_path / "none.npy"), str(tmp_path / "out")], "none.npy"),
    ):
        refused = run(*command, *arguments)
        assert refused.returncode == 2 and words in refused.stderr and len(refused.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()
