"""Resets of a Gymnasium environment at random poses, none of which penetrates."""

import pathlib

import numpy as np

import mjcf_pdg

try:
    import gymnasium
    from gymnasium.envs.mujoco import MujocoEnv
except ImportError as error:
    print(f"skipped: {error} (pip install 'mjcf-pdg[gymnasium]')")
    raise SystemExit(0)

MODEL = pathlib.Path(__file__).resolve().parents[2] / "models" / "puma" / "puma_car.xml"


class PumaAtRandom(MujocoEnv):
    """A Puma beside a car, which begins each episode somewhere about a keyframe that reaches into the car."""

    metadata = {"render_modes": [], "render_fps": 100}

    def __init__(self) -> None:
        space = gymnasium.spaces.Box(-np.inf, np.inf, (9,), np.float64)
        super().__init__(str(MODEL), frame_skip=5, observation_space=space)

    def _get_obs(self) -> np.ndarray:
        return self.data.qpos.copy()

    def reset_model(self) -> np.ndarray:
        reach = self.model.key("reach_through_window").qpos
        self.set_state(self.np_random.normal(reach, 0.1), self.init_qvel)  # [m] and [rad]
        return self._get_obs()

    def step(self, action: np.ndarray) -> tuple:
        self.do_simulation(action, self.frame_skip)
        return self._get_obs(), 0.0, False, False, {}


def main() -> None:
    env = mjcf_pdg.RepairOnReset(PumaAtRandom(), effort="fast")
    for seed in range(10):
        observation, info = env.reset(seed=seed)
        repair = info["mjcf_pdg"]
        free = bool(mjcf_pdg.verify(env.unwrapped.model, observation))
        moved = 1e3 * repair["sigma"] ** 0.5
        print(f"reset {seed}  {repair['status']:12}  moved {moved:7.1f} mm (rms)  free: {free}")


if __name__ == "__main__":
    main()
