"""The Python of the documents runs: all blocks of a page after one another, in one namespace."""

import os
import re
import subprocess
import sys

import pytest
from conftest import MODELS

ROOT = MODELS.parent
PAGES = [ROOT / "docs" / name for name in ("python.md", "recipes.md", "mathematics.md")]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_python_of_a_page_runs(page):
    blocks = re.findall("^```python\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
    assert blocks
    done = subprocess.run([sys.executable, "-c", "\n".join(blocks)], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr


def test_what_the_python_page_shows_is_what_comes_out():
    text = (ROOT / "docs" / "python.md").read_text()
    code, shown = re.search("^```python\n(.*?)^```\n\n((?:    [^\n]*\n)+)", text, re.DOTALL | re.MULTILINE).groups()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    lines, now = ([line.split() for line in words.splitlines()] for words in (shown, done.stdout))
    for line in lines[-3:] + now[-3:]:
        line.pop()  # seconds
    assert now == lines
