"""apps/control_loop: targets of servos that run into obstacles are repaired in every tick."""

import csv
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def run(*arguments):
    script = ROOT / "apps" / "control_loop" / "control_loop.py"
    return subprocess.run([sys.executable, script, *map(str, arguments)], capture_output=True, text=True, check=False)


def test_what_the_tracker_sends_to_the_servos_is_free(tmp_path):
    ticks = tmp_path / "ticks.csv"
    done = run(ROOT / "models/puma/puma_car.xml", "--ticks", 2800, "--obstacles", 12, "--csv", ticks, "--filters", "tracker")
    assert done.returncode == 0, done.stderr
    with open(ticks, newline="") as file:
        rows = list(csv.DictReader(file))
    raw, tracked = ([row for row in rows if row["filter"] == name] for name in ("raw", "tracker"))
    assert len(raw) == len(tracked) > 1700
    assert any(row["answer_free"] == "False" for row in raw)
    assert all(row["answer_free"] == "True" for row in tracked)
    assert any(float(row["error"]) > 0 for row in tracked)
    assert "tracker" in done.stdout and "100.00" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["nowhere.xml"], "nowhere.xml"),
        ([ROOT / "models/figure/figure_bench.xml"], "no position actuators"),
        ([ROOT / "models/puma/puma_car.xml", "--filters", "raw,magic"], "magic"),
    ],
)
def test_bad_input_is_one_clear_line(arguments, word):
    done = run(*arguments)
    assert done.returncode == 2
    assert word in done.stderr and "Traceback" not in done.stderr
