"""RepairOnReset."""

import mujoco
import numpy as np
import pytest
from conftest import BALL

import mjcf_pdg

gymnasium = pytest.importorskip("gymnasium")


class Balls(gymnasium.Env):
    """Begins at the heights that reset is told, with a velocity."""

    observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (1,), np.float64)
    action_space = gymnasium.spaces.Discrete(1)

    def __init__(self, xml: str = BALL) -> None:
        self.xml = xml
        self._load()

    def _load(self) -> None:
        self.model = mujoco.MjModel.from_xml_string(self.xml)
        self.data = mujoco.MjData(self.model)

    def _get_obs(self) -> np.ndarray:
        return self.data.xpos[1, 2:].copy()

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        if options.get("anew"):
            self._load()
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:], self.data.qvel[:] = options["height"], 3.0
        mujoco.mj_forward(self.model, self.data)
        return self._get_obs(), {"own": 1}


def test_resets_that_penetrate_are_moved_to_the_nearest_free_state():
    env = mjcf_pdg.RepairOnReset(Balls())
    observation, info = env.reset(options={"height": -1.0})
    assert observation == pytest.approx([0.1], abs=2e-6)  # the ball's centre, its radius over the floor
    assert env.unwrapped.data.qpos == pytest.approx([-0.9], abs=2e-6) and env.unwrapped.data.qvel == [3.0]
    assert info["own"] == 1 and info["mjcf_pdg"]["status"] == "solved"
    assert info["mjcf_pdg"]["sigma"] == pytest.approx(0.01, rel=1e-4)


def test_free_resets_are_left_alone():
    env = mjcf_pdg.RepairOnReset(Balls())
    observation, info = env.reset(options={"height": 0.25})
    assert observation == [1.25] and info["mjcf_pdg"] == {"status": "already_free", "sigma": 0.0}


def test_what_cannot_be_freed_stays():
    held_down = BALL.replace('axis="0 0 1"', 'axis="0 0 1" limited="true" range="-1.2 -1"')
    env = mjcf_pdg.RepairOnReset(Balls(held_down))
    assert mjcf_pdg.solve(env.unwrapped.model, [-1.15]).q > -1.15  # less deep, but not free
    _, info = env.reset(options={"height": -1.15})
    assert info["mjcf_pdg"]["status"] == "unsolved" and env.unwrapped.data.qpos == [-1.15]


def test_options_are_those_of_solve():
    env = mjcf_pdg.RepairOnReset(Balls(), clearance=0.2)
    assert env.reset(options={"height": -1.0})[0] == pytest.approx([0.3], abs=1e-5)
    with pytest.raises(ValueError, match="no option"):
        mjcf_pdg.RepairOnReset(Balls(), nothing=1)


def test_a_model_that_is_made_anew_is_seen():
    env = mjcf_pdg.RepairOnReset(gymnasium.wrappers.TimeLimit(Balls(), 10))
    for _ in range(3):
        assert env.reset(options={"height": -1.0, "anew": True})[0] == pytest.approx([0.1], abs=2e-6)


def test_observations_that_are_changed_below_are_refused():
    class Half(gymnasium.ObservationWrapper):
        def observation(self, observation):
            return 0.5 * observation

    with pytest.raises(ValueError, match="wrap RepairOnReset in Half"):
        mjcf_pdg.RepairOnReset(Half(Balls()))
    assert Half(mjcf_pdg.RepairOnReset(Balls())).reset(options={"height": -1.0})[0] == pytest.approx([0.05], abs=1e-6)


@pytest.mark.parametrize("name", ["Ant-v5", "Humanoid-v5", "Pusher-v5"])
def test_environments_of_gymnasium_are_wrapped(name):
    env = mjcf_pdg.RepairOnReset(gymnasium.make(name))
    observation, info = env.reset(seed=1)
    assert info["mjcf_pdg"]["status"] in ("already_free", "solved", "unsolved")
    assert observation.shape == env.observation_space.shape
    env.step(env.action_space.sample())
    env.close()
