"""bench/passages: what shows a passage to be one is free, and collides where the opening is too narrow."""

import pathlib
import subprocess
import sys

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "bench" / "passages"


def run(script, *arguments):
    return subprocess.run([sys.executable, FOLDER / script, *map(str, arguments)], capture_output=True, text=True)


@pytest.mark.parametrize("slack, hits", [(0.01, False), (-0.02, True)])
def test_witnesses_are_what_they_show(tmp_path, slack, hits):
    assert run("make.py", "--slack", slack, "--folder", tmp_path).returncode == 0
    right = run("check.py", tmp_path, *(["--hit"] if hits else []))
    assert right.returncode == 0, right.stdout
    assert int(right.stdout.split()[0]) > 60
    wrong = run("check.py", tmp_path, *([] if hits else ["--hit"]))
    assert wrong.returncode == 1
