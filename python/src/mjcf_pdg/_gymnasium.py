"""Resets of MuJoCo environments that do not penetrate: the extra mjcf-pdg[gymnasium]."""

import typing

import gymnasium
import mujoco

from mjcf_pdg._functions import Solver, SolveOptions


class RepairOnReset(gymnasium.Wrapper, gymnasium.utils.RecordConstructorArgs):
    """Moves the state after each reset to the nearest free configuration.

    For environments whose `unwrapped` has `model` and `data`, as gymnasium's MujocoEnv. Velocities
    stay. The observation is asked for anew by `unwrapped._get_obs()` where there is one, so that
    wrappers that change observations belong around this one. What cannot be freed stays as the
    environment has made it. info["mjcf_pdg"] has `status` and `sigma` [m²], as in Result.

    Takes the environment and the options of `solve`.
    """

    def __init__(self, env: gymnasium.Env, **options: typing.Unpack[SolveOptions]) -> None:
        gymnasium.utils.RecordConstructorArgs.__init__(self, **options)
        gymnasium.Wrapper.__init__(self, env)
        while isinstance(env, gymnasium.Wrapper):
            if isinstance(env, gymnasium.ObservationWrapper):
                raise ValueError(f"wrap RepairOnReset in {type(env).__name__}, which changes observations, not around it")
            env = env.env
        inner: typing.Any = env
        self._options = options
        self._solver = Solver(inner.model, **options)

    def reset(
        self, *, seed: int | None = None, options: dict[str, typing.Any] | None = None
    ) -> tuple[typing.Any, dict[str, typing.Any]]:
        observation, info = self.env.reset(seed=seed, options=options)
        inner: typing.Any = self.unwrapped
        if inner.model is not self._solver.model:  # some environments make their model anew
            self._solver = Solver(inner.model, **self._options)
        result = self._solver.solve(inner.data)
        if result.status == "solved":
            inner.data.qpos[:] = result.q
            mujoco.mj_forward(inner.model, inner.data)
            if hasattr(inner, "_get_obs"):
                observation = inner._get_obs()
        return observation, info | {"mjcf_pdg": {"status": result.status, "sigma": result.sigma}}
