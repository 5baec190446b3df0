"""What a call costs beyond the library's own work: python python/bench.py

The C++ side is timed by the program itself where it tells (Result.seconds), and by a loop of is_free on
the cheapest model there is, a ball over a floor, where next to nothing but the call is left.
"""

import pathlib
import statistics
import timeit

import mujoco
import numpy as np

import mjcf_pdg

MODELS = pathlib.Path(__file__).resolve().parents[1] / "models"
BALL = """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 1"><joint type="slide" axis="0 0 1"/><geom size="0.1"/></body></worldbody></mujoco>"""


def microseconds(function, number: int) -> float:
    """The median of eleven runs of `number` calls, per call [µs]."""
    return 1e6 * statistics.median(timeit.repeat(function, number=number, repeat=11)) / number


def main() -> None:
    ball = mujoco.MjModel.from_xml_string(BALL)
    q = np.zeros(1)
    solver = mjcf_pdg.Solver(ball)
    print(f"ball    is_free, float64 array  {microseconds(lambda: solver.is_free(q), 20000):7.2f} µs")
    print(f"ball    is_free, list           {microseconds(lambda: solver.is_free([0.0]), 20000):7.2f} µs")
    print(f"ball    solve                   {microseconds(lambda: solver.solve(q), 2000):7.2f} µs")
    for name in ("puma/puma_car", "hand/hand_bottle", "figure/figure_bench"):
        model = mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml"))
        solver = mjcf_pdg.Solver(model)
        home = model.key("home").qpos.copy()
        print(f"{name.split('/')[0]:7} is_free at home         {microseconds(lambda: solver.is_free(home), 200):7.2f} µs")
        make = microseconds(lambda: mjcf_pdg.Solver(model), 3)
        print(f"{name.split('/')[0]:7} making a Solver         {make:7.0f} µs")


if __name__ == "__main__":
    main()
