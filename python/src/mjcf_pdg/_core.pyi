"""The extension module. Use mjcf_pdg instead."""

import typing

import mujoco
import numpy.typing as npt

__version__: str
mujoco_version: int

class Solver:
    def __init__(self, model: mujoco.MjModel, **options: typing.Any) -> None: ...
    @property
    def model(self) -> mujoco.MjModel:
        """The mujoco.MjModel that is solved for."""

    def _solve(self, qpos_or_data: npt.ArrayLike | mujoco.MjData) -> dict[str, typing.Any]: ...
    def is_free(self, qpos: npt.ArrayLike) -> bool:
        """Whether the verifier finds qpos (nq,) free. Nothing else is computed."""

    def set_hint(self, qpos: npt.ArrayLike | None) -> None:
        """Sets a configuration (nq,) that is known or hoped to be free, for all later solves; None
        removes it.

        It becomes a start of the search. If it is free, what a solve returns is free.
        """

    def set_budget(self, queries: int = 0, seconds: float = 0.0) -> None:
        """Limits what each later solve may cost: collision queries and seconds [s]; 0 is no bound.

        It takes the place of the option time_limit.
        """

    def reset(self) -> None:
        """Forgets every earlier solve, which matters with trajectory=True. Hint and budget stay."""

class Tracker:
    def __init__(self, model: mujoco.MjModel, **options: typing.Any) -> None: ...
    @property
    def model(self) -> mujoco.MjModel:
        """The mujoco.MjModel that is tracked in."""

    def _step(self, qpos: npt.ArrayLike, data: mujoco.MjData | None) -> dict[str, typing.Any]: ...
    def reset(self, qpos: npt.ArrayLike) -> None:
        """Says where the follower stands now, qpos (nq,): the next answer is sought from there."""

def solve_rows(
    model: mujoco.MjModel,
    qpos: npt.ArrayLike,
    threads: int,
    progress: typing.Callable[[int], typing.Any] | None,
    **options: typing.Any,
) -> dict[str, typing.Any]: ...
def gradient_rows(
    model: mujoco.MjModel,
    q_in: npt.ArrayLike,
    q: npt.ArrayLike,
    status: typing.Sequence[str],
    threads: int,
    **options: typing.Any,
) -> dict[str, typing.Any]: ...
def object_norm(model: mujoco.MjModel, q0: npt.ArrayLike, q1: npt.ArrayLike, **options: typing.Any) -> float: ...
def verify(
    model: mujoco.MjModel, qpos: npt.ArrayLike, q_in: npt.ArrayLike | None, **options: typing.Any
) -> dict[str, typing.Any]: ...
def check_motion(
    model: mujoco.MjModel, q0: npt.ArrayLike, q1: npt.ArrayLike, **options: typing.Any
) -> dict[str, typing.Any]: ...
def audit(
    model: mujoco.MjModel, samples: int, seed: int, tolerance: float, exact_mesh: bool
) -> dict[str, typing.Any]: ...
