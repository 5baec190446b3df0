"""Tracker follows commands, as the library's does, with obstacles from data."""

import mujoco
import numpy as np
import pytest

import mjcf_pdg

BOX = """<mujoco><worldbody><geom name="box" type="box" size=".5 .5 .5"/>
  <body name="post" mocap="true" pos="-.8 5 0"><geom size=".1"/></body>
  <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><geom size=".1"/></body>
  </worldbody></mujoco>"""


@pytest.fixture
def model():
    return mujoco.MjModel.from_xml_string(BOX)


def test_every_answer_is_free_and_near(model):
    tracker = mjcf_pdg.Tracker(model, switch_gain=0.1)
    switches = 0
    for x in np.linspace(-1, 1, 1001):
        result = tracker.step([x, -0.2])
        assert result.status in ("already_free", "solved")
        assert mjcf_pdg.verify(model, result.q).free
        assert result.rms <= max(0.0, min(0.6 - abs(x), 0.4)) / 0.9 + 0.01
        switches += result.switched
    assert switches == 2


def test_no_joint_moves_farther_than_max_step(model):
    tracker = mjcf_pdg.Tracker(model, max_step=0.01)
    tracker.reset([-1.0, 0.0])
    last = np.array([-1.0, 0.0])
    for _ in range(50):
        result = tracker.step([-1.0, 0.3])
        assert np.abs(result.q - last).max() <= 0.01 + 1e-12
        assert result.under_way == (last[1] != 0.3)
        last = result.q
    assert last == pytest.approx([-1.0, 0.3])


def test_obstacles_are_those_of_the_data(model):
    tracker = mjcf_pdg.Tracker(model)
    data = mujoco.MjData(model)
    command = [-0.8, 0.0]
    assert tracker.step(command, data).status == "already_free"
    for y in np.linspace(0.5, 0.1, 100):
        data.mocap_pos[0] = [-0.8, y, 0.0]
        result = tracker.step(command, data)
        assert result.status != "unsolved"
        assert np.hypot(*(result.q - [-0.8, y])) > 0.2 - 1e-5
    assert result.status == "solved"


def test_the_lower_bound_is_that_of_a_solve(model):
    tracker, usual = mjcf_pdg.Tracker(model, lower_bound=True), mjcf_pdg.Tracker(model)
    for x in np.linspace(-0.7, -0.5, 21):
        result = tracker.step([x, -0.2])
        assert result.sigma_lower_bound == mjcf_pdg.solve(model, [x, -0.2]).sigma_lower_bound
        assert np.array_equal(result.q, usual.step([x, -0.2]).q)
    assert np.sqrt(result.sigma_lower_bound) == pytest.approx(0.1, abs=1e-5)


def test_bad_options_and_commands_are_refused(model):
    with pytest.raises(ValueError, match="max_step must be positive"):
        mjcf_pdg.Tracker(model, max_step=0.0)
    with pytest.raises(ValueError, match="no option 'gain'"):
        mjcf_pdg.Tracker(model, gain=1.0)
    with pytest.raises(ValueError, match="qpos has the shape"):
        mjcf_pdg.Tracker(model).step([0.0])
    with pytest.raises(ValueError, match="no option 'max_step'"):
        mjcf_pdg.solve(model, [0.0, 0.0], max_step=1.0)
