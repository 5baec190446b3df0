"""What the functions of this package return: data classes of plain values and numpy arrays."""

import dataclasses
import typing

import numpy as np


@dataclasses.dataclass(frozen=True, eq=False)
class Contact:
    """A pair of geoms that overlap, touch or are nearer than required."""

    geom1: str | int
    """The geom's name, or its id if it has none."""
    geom2: str | int
    normal: np.ndarray
    """(3,) Unit vector from geom 1 to geom 2, in world axes."""
    position: np.ndarray
    """(3,) Midpoint of the two witness points [m]."""
    distance: float
    """Signed, negative for an overlap [m]."""


@dataclasses.dataclass(frozen=True, eq=False)
class Result:
    """The nearest free configuration that was found for one configuration q_in."""

    status: str
    """"already_free" (q is q_in bit for bit), "solved" (q is free, verified) or "unsolved" (q is the
    least penetrating configuration found)."""
    q_in: np.ndarray
    """(nq,) The configuration that was given."""
    q: np.ndarray
    """(nq,) The configuration, in MuJoCo's qpos layout."""
    sigma: float
    """Object norm between q_in and q [m²]."""
    rms: float
    """√sigma: the root-mean-square distance that the mass moves [m]."""
    sigma_lower_bound: float
    """Proven: no free configuration has a smaller sigma [m²]."""
    depth_in: float
    """The smallest signed distance of a pair at q_in, negative for an overlap [m]."""
    min_distance: float
    """The same at q [m]."""
    limit_excess_in: float
    """The largest violation of a joint limit by q_in [rad or m]."""
    equality_residual_in: float
    """The largest violation of a held equality constraint by q_in [m or rad]."""
    equality_residual: float
    """The same by q."""
    tendon_excess_in: float
    """How far a tendon is outside its range at q_in, with tendon_limits="hold" [m]."""
    tendon_excess: float
    """The same at q."""
    contacts_kept: int
    """Of the contacts at q_in, those whose geoms are still within 1 mm of each other at q."""
    pushed_pairs: int
    """Pairs nearer at q than their margin in the model, on which MuJoCo still pushes."""
    switched: bool
    """Of a Tracker: the answer has left its optimum for another."""
    under_way: bool
    """Of a Tracker with max_step or certify_motion: the answer is one of several on the way to another optimum, to a
    free command, or to its own optimum, behind which it lags."""
    certified: bool
    """That q is free rests on signed distances: no SDF geom is in the scene."""
    proven: bool
    """sigma is within 1 % of its lower bound."""
    start: str
    """The start of the search that won; "none" is q_in itself."""
    cause: str
    """Why it is unsolved: "budget", "permanent", "frozen", "equality", "not_verified" or
    "not_found"; else empty."""
    reason: str
    """The same in words."""
    iterations: int
    """Local steps of all starts."""
    queries: int
    """Collision queries: each is one configuration, all pairs."""
    seconds: float
    """Wall time of the solve with its final verification [s]."""
    contacts_in: list[Contact]
    """The contacts at q_in, deepest first."""
    contacts: list[Contact]
    """The contacts at q, deepest first."""

    @property
    def free(self) -> bool:
        """Whether q is free."""
        return self.status != "unsolved"


@dataclasses.dataclass(frozen=True, eq=False)
class Results:
    """The results of n configurations: the fields of Result but for contacts, as arrays."""

    status: np.ndarray
    """(n,) of text."""
    q_in: np.ndarray
    """(n, nq)."""
    q: np.ndarray
    """(n, nq)."""
    sigma: np.ndarray
    """(n,) [m²]."""
    rms: np.ndarray
    """(n,) [m]."""
    sigma_lower_bound: np.ndarray
    """(n,) [m²]."""
    depth_in: np.ndarray
    """(n,) [m]."""
    min_distance: np.ndarray
    """(n,) [m]."""
    limit_excess_in: np.ndarray
    """(n,) [rad or m]."""
    equality_residual_in: np.ndarray
    """(n,) [m or rad]."""
    equality_residual: np.ndarray
    """(n,) [m or rad]."""
    tendon_excess_in: np.ndarray
    """(n,) [m]."""
    tendon_excess: np.ndarray
    """(n,) [m]."""
    certified: np.ndarray
    """(n,) of bool."""
    proven: np.ndarray
    """(n,) of bool."""
    start: np.ndarray
    """(n,) of text."""
    cause: np.ndarray
    """(n,) of text, empty where solved."""
    reason: np.ndarray
    """(n,) of text, empty where solved."""
    iterations: np.ndarray
    """(n,) of int."""
    queries: np.ndarray
    """(n,) of int."""
    seconds: np.ndarray
    """(n,) [s]."""

    @property
    def free(self) -> np.ndarray:
        """(n,) of bool: whether each row of q is free."""
        return self.status != "unsolved"

    def __len__(self) -> int:
        return len(self.status)

    def to_pandas(self) -> typing.Any:
        """A pandas.DataFrame with a row for each configuration; its columns q_in and q have arrays (nq,)."""
        import pandas

        columns = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        columns["q_in"], columns["q"] = list(self.q_in), list(self.q)
        return pandas.DataFrame(columns)


@dataclasses.dataclass(frozen=True, eq=False)
class Gradient:
    """How a result changes with q_in: `dsigma, dq = gradient` takes the two apart.

    Changes of configurations are in MuJoCo's tangent space (nv): [m] or [rad] by degree of freedom,
    the three of a ball joint in the body frame; mj_integratePos applies them.
    """

    sigma: np.ndarray | None
    """(nv,) The derivative of sigma by q_in [m² per m or rad]; None for an unsolved result. Of n
    results (n, nv), with NaN for None."""
    q: np.ndarray | None
    """(nv, nv) q moves by this matrix times the move of q_in; None where there is no such matrix: the
    result is unsolved or no local optimum, the optimum is not one point, or what touches is a triangle
    mesh, an SDF or a height field. Of n results (n, nv, nv), with NaN for None."""
    active_set_changes: bool | np.ndarray
    """A small change of q_in changes which contacts and limits hold q: these are the derivatives of
    one side. Also true where the answer is no local optimum. Of n results (n,)."""

    def __iter__(self) -> typing.Iterator[np.ndarray | None]:
        return iter((self.sigma, self.q))


@dataclasses.dataclass(frozen=True, eq=False)
class Verdict:
    """What the verifier says of a configuration. True if it is free."""

    free: bool
    certified: bool
    """Every pair has a signed distance: no SDF geom."""
    min_distance: float
    """The smallest signed distance of a pair, cut off 1 m beyond the clearance [m]."""
    limit_excess: float
    """The largest violation of a joint limit [rad or m]."""
    equality_residual: float
    """The largest violation of a held equality constraint [m or rad]."""
    tendon_excess: float
    """How far a tendon is outside its range, with tendon_limits="hold" [m]."""
    pushed_pairs: int
    """Pairs nearer than their margin in the model, on which MuJoCo pushes although they are apart."""
    contacts: list[Contact]
    """Pairs that are nearer than the tolerance or than required, deepest first."""
    reason: str
    """What is not free, in words."""

    def __bool__(self) -> bool:
        return self.free


@dataclasses.dataclass(frozen=True, eq=False)
class Motion:
    """How far a motion is free, and what ends it. True if it is free all the way."""

    outcome: str
    """"free", "contact", "start_in_collision", "limit" or "budget"."""
    t: float
    """The motion is free from 0 to t; 1 is its end."""
    q: np.ndarray
    """(nq,) The configuration at t."""
    certified: bool
    """That it is free up to t is proven, not sampled."""
    pairs: list[tuple[str | int, str | int]]
    """The geoms in the way, by name or else id."""
    joint: str | None
    """The joint that reaches its limit."""
    poses: int
    """Configurations at which the model was posed."""
    distance_queries: int
    """Signed distances that were measured, of one pair each."""

    def __bool__(self) -> bool:
        return self.outcome == "free"


def _contacts(fields: dict) -> dict:
    for name in ("contacts_in", "contacts"):
        if name in fields:
            fields[name] = [Contact(**contact) for contact in fields[name]]
    return fields


def result(fields: dict) -> Result:
    return Result(**_contacts(fields))


def verdict(fields: dict) -> Verdict:
    return Verdict(**_contacts(fields))
