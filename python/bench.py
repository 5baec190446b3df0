"""What a call from Python costs beyond C++: python python/bench.py

is_free is also timed by build/bin/is_free_bench, if it is built. The ball over a floor is the cheapest
model there is: next to nothing but the call is left.
"""

import pathlib
import statistics
import subprocess
import tempfile
import timeit

import mujoco

import mjcf_pdg

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = ROOT / "build" / "bin" / "is_free_bench"
BALL = """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 1"><joint type="slide" axis="0 0 1"/><geom size="0.1"/></body></worldbody></mujoco>"""


def microseconds(function, calls: int | None = None) -> float:
    """The median of eleven runs, per call [µs]."""
    if calls is None:
        calls = 1 + int(0.02 / (timeit.timeit(function, number=100) / 100))
    return 1e6 * statistics.median(timeit.repeat(function, number=calls, repeat=11)) / calls


def in_cpp(path: pathlib.Path) -> str:
    if not PROGRAM.exists():
        return "-"
    return subprocess.run([PROGRAM, path], capture_output=True, text=True, check=True).stdout.split()[-1]


def main() -> None:
    print(f"{'[µs]':8} {'is_free':>9} {'in C++':>9} {'of a list':>10} {'solve, free':>12} {'Solver()':>9}")
    with tempfile.TemporaryDirectory() as folder:
        ball = pathlib.Path(folder) / "ball.xml"
        ball.write_text(BALL)
        models = ROOT / "models"
        paths = [ball, *(models / name for name in ("puma/puma_car.xml", "hand/hand_bottle.xml", "figure/figure_bench.xml"))]
        for path in paths:
            model = mujoco.MjModel.from_xml_path(str(path))
            q = (model.key_qpos[0] if model.nkey else model.qpos0).copy()
            values = q.tolist()
            solver = mjcf_pdg.Solver(model)
            print(
                f"{path.stem.split('_')[0]:8} {microseconds(lambda: solver.is_free(q)):9.2f} {in_cpp(path):>9} "
                f"{microseconds(lambda: solver.is_free(values)):10.2f} {microseconds(lambda: solver.solve(q)):12.2f} "
                f"{microseconds(lambda: mjcf_pdg.Solver(model), 2):9.0f}"
            )


if __name__ == "__main__":
    main()
