"""Solver: what it keeps, what it forgets, threads, memory."""

import concurrent.futures
import gc
import os
import pathlib
import signal
import subprocess
import sys
import time

import mujoco
import numpy as np
import pytest
from conftest import BALL

import mjcf_pdg


def test_it_solves_configurations_and_data(puma):
    solver = mjcf_pdg.Solver(puma)
    data = mujoco.MjData(puma)
    mujoco.mj_resetDataKeyframe(puma, data, puma.key("arm_through_roof").id)
    before = data.qpos.tobytes() + data.qvel.tobytes() + data.xpos.tobytes()
    from_data, from_qpos = solver.solve(data), solver.solve(data.qpos)
    assert from_data.status == "solved" and from_data.q.tobytes() == from_qpos.q.tobytes()
    assert data.qpos.tobytes() + data.qvel.tobytes() + data.xpos.tobytes() == before
    assert not solver.is_free(data.qpos) and solver.is_free(from_data.q)
    assert solver.model is puma


def test_it_keeps_the_model_alive():
    solver = mjcf_pdg.Solver(mujoco.MjModel.from_xml_string(BALL))
    gc.collect()
    waste = [mujoco.MjModel.from_xml_string(BALL) for _ in range(100)]  # would take the freed memory
    assert solver.solve([-1.0]).q == pytest.approx([-0.9], abs=2e-6)
    assert len(waste) == 100 and solver.model.nq == 1


def test_a_free_hint_is_kept_until_it_is_removed(puma):
    home, q = puma.key("home").qpos, puma.key("cart_inside_car").qpos
    solver = mjcf_pdg.Solver(puma)
    solver.set_budget(queries=3)
    alone = solver.solve(q)
    solver.set_hint(home)
    assert solver.solve(q).status == "solved"
    solver.reset()
    assert solver.solve(q).status == "solved"
    solver.set_hint(None)
    again = solver.solve(q)
    assert (again.status, again.cause) == (alone.status, alone.cause) == ("unsolved", "budget")
    solver.set_budget()
    assert solver.solve(q).status == "solved"


def test_reset_forgets_earlier_frames(puma):
    frames = np.linspace(puma.key("arm_through_roof").qpos, puma.key("arm_through_door").qpos, 5)
    solver = mjcf_pdg.Solver(puma, trajectory=True)
    first = [solver.solve(frame).q.tobytes() for frame in frames]
    solver.reset()
    assert [solver.solve(frame).q.tobytes() for frame in frames] == first


def test_rows_of_a_trajectory_are_followed_or_smoothed(puma):
    frames = np.linspace(puma.key("arm_through_roof").qpos, puma.key("arm_through_door").qpos, 40)
    rows = mjcf_pdg.solve(puma, frames, trajectory=True, threads=4)
    again = mjcf_pdg.solve(puma, frames, trajectory=True)
    assert rows.q.tobytes() == again.q.tobytes()
    assert rows.free.all() and np.median(rows.queries[rows.status == "solved"]) <= 8
    smooth = mjcf_pdg.solve(puma, frames, trajectory=True, smooth=20.0)
    assert smooth.free.all() and all(mjcf_pdg.verify(puma, q).free for q in smooth.q)
    change = lambda q: np.sum(np.diff(q, axis=0) ** 2)
    assert change(smooth.q) < change(rows.q) and np.sum(smooth.sigma) > np.sum(rows.sigma)


def test_smooth_is_for_frames_together(puma):
    frames = np.tile(puma.key("home").qpos, (2, 1))
    for options, words in (
        ({}, "smooth needs trajectory"), ({"trajectory": True, "method": "paper"}, "method auto"),
        ({"trajectory": True, "time_limit": 5.0}, "time limit"),
    ):
        with pytest.raises(ValueError, match=words):
            mjcf_pdg.solve(puma, frames, smooth=1.0, **options)
    for bad in (-1.0, float("nan"), 1e7):
        with pytest.raises(ValueError, match="smooth must lie between"):
            mjcf_pdg.solve(puma, frames, trajectory=True, smooth=bad)
    with pytest.raises(ValueError, match="frames of a trajectory"):
        mjcf_pdg.solve(puma, frames[0], trajectory=True, smooth=1.0)
    with pytest.raises(ValueError, match="no option 'smooth'"):
        mjcf_pdg.Solver(puma, smooth=1.0)


def test_eight_threads_may_share_a_solver(ball):
    solver = mjcf_pdg.Solver(ball)
    starts = np.linspace(-1.5, 0.5, 1000)
    wanted = [solver.solve([start]).q.tobytes() for start in starts]

    def work(thread: int) -> bool:
        return all(
            solver.solve([start]).q.tobytes() == answer and solver.is_free([start]) == (start > -0.9)
            for start, answer in zip(starts, wanted)
        )

    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert all(pool.map(work, range(8)))


def test_eight_threads_with_a_solver_each(puma):
    q = puma.key("cart_in_running_board").qpos
    wanted = mjcf_pdg.Solver(puma, effort="fast").solve(q).q.tobytes()

    def work(thread: int) -> int:
        solver = mjcf_pdg.Solver(puma, effort="fast")
        return sum(solver.solve(q).q.tobytes() == wanted for _ in range(1000))

    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert list(pool.map(work, range(8))) == [1000] * 8


def test_other_threads_run_during_a_solve(hand):
    q = np.tile(hand.key("palm_inside_bottle").qpos, (20, 1))
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        running = pool.submit(mjcf_pdg.solve, hand, q)
        ticks = 0
        while not running.done():
            time.sleep(0.001)
            ticks += 1
    assert running.result().free.all() and ticks > 20


# What is run in the background may have been told to ignore Ctrl-C, and its children inherit that.
LONG = f"""
import signal, mujoco, numpy, mjcf_pdg
signal.signal(signal.SIGINT, signal.default_int_handler)
model = mujoco.MjModel.from_xml_string('''{BALL}''')
print("begun", flush=True)
try:
    CALL
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.parametrize("call", [
    "mjcf_pdg.solve(model, numpy.full((5_000_000, 1), -1.0), threads=2)",
    "mjcf_pdg.audit(model, samples=1_000_000_000)",
])
def test_ctrl_c_ends_long_work(call):
    child = subprocess.Popen([sys.executable, "-c", LONG.replace("CALL", call)], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "begun\n"
    time.sleep(1.0)
    child.send_signal(signal.SIGINT)
    assert child.communicate(timeout=60)[0] == "interrupted\n" and child.returncode == 0


def resident_bytes() -> int:
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_calls_do_not_leak(ball):
    solver = mjcf_pdg.Solver(ball)
    q, rows = np.array([-1.0]), np.tile([[-1.0], [0.0]], (50, 1))

    def refused(function, *arguments, **options):
        try:
            function(*arguments, **options)
        except (ValueError, TypeError):
            return
        raise AssertionError("not refused")

    def calls(count: int) -> None:
        for _ in range(count):
            solver.is_free(q)
            solver.is_free([0.0])
            solver.set_hint(q)
            refused(solver.is_free, [0.0, 1.0])
            refused(solver.is_free, [1j])
        for _ in range(count // 10):
            solver.solve(q)
        for _ in range(count // 100):
            mjcf_pdg.solve(ball, rows, clearance=0.01)
            mjcf_pdg.verify(ball, q)
            mjcf_pdg.object_norm(ball, q, q)
            mjcf_pdg.check_motion(ball, q, q)
            refused(mjcf_pdg.solve, ball, q, nothing=1)
            refused(mjcf_pdg.solve, ball, rows, effort="slow")

    calls(2_000)  # what is allocated once
    gc.collect()
    before = resident_bytes()
    calls(100_000)
    gc.collect()
    assert resident_bytes() - before < 4 << 20  # 100 bytes a call or a row would be 10 MB
