"""gradient: shapes, what there is none of, and differences of re-solved answers."""

import mujoco
import numpy as np
import pytest
from conftest import BALL

import mjcf_pdg


def test_a_ball_in_a_floor_stays_on_it(ball):
    result = mjcf_pdg.solve(ball, [-0.95])
    gradient = mjcf_pdg.gradient(ball, result)
    dsigma, dq = gradient
    assert dsigma.shape == (1,) and dq.shape == (1, 1)
    assert dsigma[0] == pytest.approx(-0.1, abs=1e-5) and dq[0, 0] == pytest.approx(0.0, abs=1e-8)
    assert gradient.active_set_changes is False


def test_what_is_free_moves_along(ball):
    gradient = mjcf_pdg.gradient(ball, mjcf_pdg.solve(ball, [0.0]))
    assert gradient.sigma.tolist() == [0.0] and gradient.q.tolist() == [[1.0]] and not gradient.active_set_changes
    assert mjcf_pdg.gradient(ball, mjcf_pdg.solve(ball, [-0.9 + 1e-6])).active_set_changes


def test_what_is_unsolved_has_none():
    model = mujoco.MjModel.from_xml_string(BALL.replace('axis="0 0 1"', 'axis="0 0 1" range="-2 -1"'))
    dsigma, dq = mjcf_pdg.gradient(model, mjcf_pdg.solve(model, [-1.5]))
    assert dsigma is None and dq is None


def test_rows_are_those_of_single_results(puma):
    results = mjcf_pdg.solve(puma, puma.key_qpos, threads=2)
    rows = mjcf_pdg.gradient(puma, results, threads=2)
    assert rows.sigma.shape == (len(results), puma.nv) and rows.q.shape == (len(results), puma.nv, puma.nv)
    solver = mjcf_pdg.Solver(puma)
    for key in range(puma.nkey):
        one = mjcf_pdg.gradient(puma, solver.solve(puma.key_qpos[key]))
        assert one.sigma.tobytes() == rows.sigma[key].tobytes()
        assert one.active_set_changes == rows.active_set_changes[key]
        if one.q is None:
            assert np.isnan(rows.q[key]).any() and one.active_set_changes
        else:
            assert one.q.tobytes() == rows.q[key].tobytes()


def test_answers_change_as_the_gradient_says(puma):
    """By solves alone: their answers lie within some 1e-4 of the optimum, so the steps are large."""
    rng = np.random.default_rng(0)
    solver = mjcf_pdg.Solver(puma)
    compared = 0
    for _ in range(40):
        key = puma.key_qpos[rng.integers(puma.nkey)]
        q_in = key + rng.normal(0.0, 0.05, puma.nq)  # no quaternions: nq is nv
        result = solver.solve(q_in)
        gradient = mjcf_pdg.gradient(puma, result)
        if result.status != "solved" or gradient.active_set_changes or result.rms < 1e-3:
            continue
        step = 1e-3 * result.rms * rng.normal(size=puma.nv)
        two = [solver.solve(q_in + side * step) for side in (1.0, -1.0)]
        moved = [solved.q - result.q - side * gradient.q @ step for solved, side in zip(two, (1.0, -1.0))]
        if np.abs(moved).max() > 10.0 * np.abs(step).max():
            continue  # one of them is at another optimum
        compared += 1
        change = two[0].sigma - two[1].sigma
        scale = 2.0 * np.linalg.norm(gradient.sigma) * np.linalg.norm(step)
        assert abs(change - 2.0 * gradient.sigma @ step) < 0.05 * scale
    assert compared >= 10


def test_bad_input_is_refused(ball):
    result = mjcf_pdg.solve(ball, [-0.95])
    with pytest.raises(ValueError, match="rest"):
        mjcf_pdg.gradient(ball, result, rest=0.001)
    with pytest.raises(ValueError, match="no option 'nothing'"):
        mjcf_pdg.gradient(ball, result, nothing=1)
    with pytest.raises(TypeError, match="must be a Result"):
        mjcf_pdg.gradient(ball, [-0.9])
    with pytest.raises(ValueError, match="threads"):
        mjcf_pdg.gradient(ball, result, threads=0)
    other = mujoco.MjModel.from_xml_string("<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>")
    with pytest.raises(ValueError, match="the model needs"):
        mjcf_pdg.gradient(other, result)
