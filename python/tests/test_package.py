"""The package as such: its names, its one libmujoco, its stubs, other versions of MuJoCo, the examples."""

import ast
import importlib.metadata
import os
import pathlib
import re
import shutil
import subprocess
import sys

import mujoco
import pytest

import mjcf_pdg
from mjcf_pdg import _core

NEEDS = {"jax_gradient": "jax", "torch_gradient": "torch"}  # examples that are not run without these
EXAMPLES = sorted((pathlib.Path(__file__).resolve().parents[1] / "examples").glob("*.py"))


def run(code: str, *arguments: str, **environment: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, env=os.environ | environment
    )


def test_names_are_those_that_other_programs_rely_on():
    functions = {"solve", "gradient", "object_norm", "verify", "check_motion", "audit", "view"}
    answers = {"Contact", "Gradient", "Motion", "Result", "Results", "Verdict"}
    assert set(mjcf_pdg.__all__) == functions | answers | {"Solver", "Tracker", "View", "__version__"}
    for name in (*functions, "Solver"):
        assert getattr(mjcf_pdg, name).__doc__
    methods = ("solve", "is_free", "set_hint", "set_budget", "reset")
    assert all(getattr(mjcf_pdg.Solver, name).__doc__ for name in methods)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        mjcf_pdg.nothing


def test_version_is_that_of_the_project():
    assert mjcf_pdg.__version__ == importlib.metadata.version("mjcf-pdg")


def test_stubs_name_what_there_is():
    folder = pathlib.Path(_core.__file__).parent
    assert (folder / "py.typed").exists()
    tree = ast.parse((folder / "_core.pyi").read_text())
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    defined = {node.name for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    defined |= {node.target.id for node in tree.body if isinstance(node, ast.AnnAssign)}
    assert defined == {name for name in vars(_core) if name == "__version__" or not name.startswith("__")}
    methods = {node.name for node in classes["Solver"].body if isinstance(node, ast.FunctionDef)}
    assert methods == {name for name in vars(_core.Solver) if name == "__init__" or not name.startswith("__")}


def test_the_process_has_one_libmujoco():
    code = "import mjcf_pdg; print(len({l.split()[-1] for l in open('/proc/self/maps') if 'libmujoco' in l}))"
    assert run(code).stdout == "1\n"


@pytest.mark.parametrize("version", ["3.3.7", "4.1.0", "4.10.0", "40.0.1"])
def test_another_mujoco_is_an_import_error_that_names_both(version):
    code = f"import mujoco; mujoco.mj_versionString = lambda: '{version}'; import mjcf_pdg"
    error = run(code).stderr.splitlines()[-1]
    assert error == f"ImportError: mjcf_pdg was built for MuJoCo 4.0.x, but the package mujoco is {version}"


def test_fcl_is_the_one_that_came_along():
    code = "import mjcf_pdg; print(*{l.split()[-1] for l in open('/proc/self/maps') if 'libfcl' in l})"
    fcl = pathlib.Path(run(code).stdout.strip())
    assert fcl.parent == pathlib.Path(mjcf_pdg.__file__).with_name("bundled")
    assert sorted(f.name for f in (fcl.parent / "licences").iterdir())


def test_a_second_libmujoco_is_not_loaded(tmp_path):
    loaded = pathlib.Path(mujoco._structs.__file__).with_name(f"libmujoco.so.{mujoco.mj_versionString()}")
    shutil.copy(loaded, tmp_path)
    code = f"import mujoco; mujoco._structs.__file__ = '{tmp_path}/_structs.so'; import mjcf_pdg"
    error = run(code).stderr.splitlines()[-1]
    assert error.startswith("ImportError: the package mujoco 4.0.") and str(tmp_path) in error


def test_the_version_that_is_let_in_is_the_one_it_was_built_for():
    from mjcf_pdg import _libmujoco

    major, minor = _libmujoco.VERSION.split(".")
    assert _core.mujoco_version // 1000 == 1000 * int(major) + int(minor)


def test_gymnasium_is_not_imported():
    assert run("import sys, mjcf_pdg; print('gymnasium' in sys.modules)").stdout == "False\n"
    missing = run("import sys; sys.modules['gymnasium'] = None; from mjcf_pdg import *; mjcf_pdg = sys.modules['mjcf_pdg']; "
                  "mjcf_pdg.RepairOnReset")
    assert missing.stderr.splitlines()[-1].startswith("ModuleNotFoundError: import of gymnasium halted")


def test_the_python_of_the_readme_runs():
    root = EXAMPLES[0].parents[2]
    (code,) = re.findall("```python\n(.*?)```", (root / "README.md").read_text(), re.DOTALL)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=root)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("solved 1.09") and "True (15, 9)" in done.stdout


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_examples_run(example):
    if example.stem in NEEDS:
        pytest.importorskip(NEEDS[example.stem])
    done = subprocess.run([sys.executable, example], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "skipped" not in done.stdout and "unsolved" not in done.stdout
    assert "solved" in done.stdout or "became free" in done.stdout


@pytest.mark.parametrize("stem, package", [("rl_resets", "gymnasium"), *NEEDS.items()])
def test_examples_are_skipped_without_their_package(stem, package):
    (example,) = (path for path in EXAMPLES if path.stem == stem)
    code = "import runpy, sys; sys.modules[sys.argv[2]] = None; runpy.run_path(sys.argv[1], run_name='__main__')"
    done = run(code, str(example), package)
    assert done.returncode == 0 and done.stdout.startswith("skipped: ")
