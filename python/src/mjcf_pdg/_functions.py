"""The functions of the package and its class Solver."""

import operator
import typing

import mujoco
import numpy as np
import numpy.typing as npt

from mjcf_pdg import _answers, _core
from mjcf_pdg._answers import Gradient, Motion, Result, Results, Verdict

MAX_THREADS = 1024


class _SceneOptions(typing.TypedDict, total=False):
    movable: str | typing.Sequence[str] | None
    fixed: str | typing.Sequence[str] | None


class NormOptions(_SceneOptions, total=False):
    metric: typing.Literal["sequential", "displacement"]
    root: str | None
    armature: float | typing.Literal["model"]


class VerifyOptions(_SceneOptions, total=False):
    exclude: typing.Sequence[str | tuple[str, str]] | None
    allow: dict[str | tuple[str, str], float] | None
    ignore_permanent: bool
    equality: typing.Literal["hold", "all", "ignore"]
    tendon_limits: typing.Literal["ignore", "hold"]
    flags: typing.Literal["all", "model"]
    flex: typing.Literal["refuse", "ignore"]
    exact_mesh: bool
    tolerance: float
    clearance: float | typing.Literal["model"]
    rest: float
    mocap_pos: npt.ArrayLike | None
    mocap_quat: npt.ArrayLike | None


class SolveOptions(NormOptions, VerifyOptions, total=False):
    method: typing.Literal["auto", "paper"]
    effort: typing.Literal["fast", "default", "max"]
    seed: int
    trajectory: bool
    time_limit: float | None
    without: str | typing.Sequence[str] | None
    report_contacts: bool
    report_lower_bound: bool
    report_distances_to: float


class RowOptions(SolveOptions, total=False):
    smooth: float


class TrackOptions(SolveOptions, total=False):
    queries: int
    switch_gain: float
    max_step: float
    certify_motion: bool
    lower_bound: bool


class Solver(_core.Solver):
    """Finds nearest free configurations of one model, as control loops do: what it needs is made once.

    Takes a mujoco.MjModel, which must not change as long as the solver lives and is kept alive by it,
    and the options of `solve`. The model and data are never written to. Several threads may call one
    solver; they then wait for each other. For speed, give each thread a solver of its own.
    """

    def __init__(self, model: mujoco.MjModel, **options: typing.Unpack[SolveOptions]) -> None:
        super().__init__(model, **options)

    def solve(self, qpos: npt.ArrayLike | mujoco.MjData) -> Result:
        """Solves for a configuration qpos (nq,), or for the qpos of a mujoco.MjData of the model.

        The mocap poses of the data are those of the obstacles, and stay so for later solves. Not
        finding a free configuration is no error: see Result.status.
        """
        return _answers.result(self._solve(qpos))


class Tracker(_core.Tracker):
    """The nearest free configuration of one command after another, for control loops.

    Takes a mujoco.MjModel, which must not change as long as the tracker lives, the options of `solve`
    (contacts, distances and lower bounds are reported only if asked for) and:

      queries: most collision queries of a step, default 12.
      switch_gain: another optimum is taken if the root of its sigma is smaller by this share, default
        0.05.
      max_step: no joint moves farther in a step [rad or m]; default: any distance.
      certify_motion: the straight motion from each answer to the next is proven free, and cut short
        where it is not.
      lower_bound: sigma_lower_bound is computed in every step whose command is not free, for a query
        more; report_lower_bound asks for the first step's alone.
    """

    def __init__(self, model: mujoco.MjModel, **options: typing.Unpack[TrackOptions]) -> None:
        super().__init__(model, **options)

    def step(self, qpos: npt.ArrayLike, data: mujoco.MjData | None = None) -> Result:
        """A free configuration near the command qpos (nq,).

        If the last answer is still free, so is this one. Obstacles (mocap bodies, frozen joints) are as
        in `data` if it is given. The first step, unless reset came before, solves as Solver does.
        """
        return _answers.result(self._step(qpos, data))


def _thread_count(threads: int) -> int:
    count = operator.index(threads)
    if not 1 <= count <= MAX_THREADS:
        raise ValueError(f"threads: {count} is not a whole number that is at least 1 and at most {MAX_THREADS}")
    return count


def _progress_bar(rows: int, progress: bool) -> typing.Any:
    if not progress:
        return None
    try:
        import tqdm.auto
    except ImportError:
        return None
    return tqdm.auto.tqdm(total=rows, desc="solving", unit="row")


def _solve_rows(
    model: mujoco.MjModel, rows: np.ndarray, threads: int, progress: bool, options: dict[str, typing.Any]
) -> Results:
    bar = _progress_bar(len(rows), progress)
    if bar is None:
        return Results(**_core.solve_rows(model, rows, threads, None, **options))
    with bar:
        return Results(**_core.solve_rows(model, rows, threads, lambda done: bar.update(done - bar.n), **options))


@typing.overload
def solve(
    model: mujoco.MjModel,
    qpos: typing.Sequence[float],
    *,
    threads: int = 1,
    progress: bool = False,
    **options: typing.Unpack[SolveOptions],
) -> Result: ...


@typing.overload
def solve(
    model: mujoco.MjModel,
    qpos: npt.ArrayLike,
    *,
    threads: int = 1,
    progress: bool = False,
    **options: typing.Unpack[RowOptions],
) -> typing.Any: ...


def solve(model, qpos, *, threads=1, progress=False, **options):
    """Finds the nearest collision-free configuration of each configuration in qpos.

    Args:
      model: mujoco.MjModel. It is never written to.
      qpos: configurations in MuJoCo's layout, [m] and [rad]: (nq,) gives a Result, (n, nq) gives
        Results. Anything that numpy makes a float64 array of.
      threads: rows that are solved at once, without the GIL. Rows do not depend on each other, and
        the answers not on the number of threads.
      progress: shows a progress bar over the rows, where tqdm is installed.
      movable: bodies (names in a sequence, or with commas in a text) whose own joints and subtrees
        may move; all else is frozen. Default: all.
      fixed: bodies whose own joints stay, whatever movable says.
      exclude: pairs of geoms or bodies whose overlaps do not count: ("cup", "finger") or "cup,finger".
      allow: how deep pairs may overlap [m], as {("cup", "finger"): 0.002}.
      ignore_permanent: pairs that overlap wherever the joints go do not count.
      equality: constraints that are held: "hold", all but welds and connects to mocap bodies, "all" or
        "ignore".
      tendon_limits: "hold" holds the length limits of tendons; default "ignore".
      flags: "model": what the model disables by <flag contact|limit|constraint> does not count;
        default "all", it counts.
      flex: "ignore" solves the rest of a model with flexes, which is refused otherwise.
      root: the body that is the root link of the norm. Default: the top body of each tree.
      armature: inertia that the norm adds to every hinge and ball [kg m²], and as a mass to every
        slide [kg], so that light links cost something; "model": each joint's own. Default: 0.
      exact_mesh: meshes collide as their triangles: those that the model marks, or all.
      metric: "sequential", the paper's norm, or "displacement", the true mean squared displacement.
      tolerance: overlap that still counts as free [m], default 1e-6.
      clearance: distance to keep between pairs that can move apart [m], default 0; "model": each
        pair's margin, within which MuJoCo pushes on it.
      rest: contacts of qpos no deeper than this may keep their depth [m], default 0.
      method: "auto", a search over many starts, or "paper", the paper's sequence of steps.
      effort: "fast", "default" or "max": how many starts are tried.
      seed: of the random starts; the same seed gives the same answer.
      trajectory: the rows are consecutive frames of one motion, through which one optimum is
        followed; they are solved by one thread. A Solver starts each from earlier answers instead.
      smooth: W, with trajectory and rows: the answers of all frames together minimize the sum of σ
        plus W times that of the changes from frame to frame. Default: 0, each is the nearest.
      time_limit: most time of a row, as on the command line in milliseconds [ms].
      without: starts and steps to leave out.
      mocap_pos, mocap_quat: poses of the mocap bodies, (nmocap, 3) [m] and (nmocap, 4) (w, x, y, z).
        Default: as in the model.
      report_contacts, report_lower_bound: whether Result.contacts_in and contacts, and
        sigma_lower_bound are computed; default True. What is not asked for saves time.
      report_distances_to: how far beyond the clearance depth_in and min_distance are measured [m],
        default 1.

    Raises:
      ValueError: for bad values, shapes and names, models that are not supported, unknown options.
      TypeError: for a model that is no mujoco.MjModel, and arrays that are not of real numbers.
    """
    threads = _thread_count(threads)
    rows = np.asarray(qpos)
    if rows.ndim != 2 and options.get("smooth") is not None:
        raise ValueError("smooth is for the frames of a trajectory, (n, nq)")
    if rows.ndim == 2:
        return _solve_rows(model, rows, threads, progress, options)
    return Solver(model, **options).solve(rows)


def gradient(
    model: mujoco.MjModel,
    result: Result | Results,
    *,
    threads: int = 1,
    **options: typing.Unpack[SolveOptions],
) -> Gradient:
    """How sigma and q of a result change with q_in: `dsigma, dq = gradient(model, result)`.

    The derivatives follow from the contacts and limits that hold q, at the local optimum close to
    result.q, to some 1e-6 of their size. See Gradient for shapes and units, and for where there are
    none. A joint of q_in that may not move counts, too: as the obstacle that it carries.

    Args:
      model: the model of the result.
      result: what solve or a solver returned, one or many.
      threads: rows of Results that are differentiated at once, without the GIL.
      options: those that the result was solved with; `rest` is refused.

    Raises:
      ValueError, TypeError: as solve.
    """
    threads = _thread_count(threads)
    many = isinstance(result, Results)
    if not many and not isinstance(result, Result):
        raise TypeError(f"result must be a Result or Results of this package, not {type(result).__name__}")
    q_in, q, status = (result.q_in, result.q, result.status) if many else ([result.q_in], [result.q], [result.status])
    fields = _core.gradient_rows(model, q_in, q, [str(name) for name in status], threads, **options)
    if many:
        return Gradient(**fields)
    sigma, matrix = (None if np.isnan(rows[0]).any() else rows[0] for rows in (fields["sigma"], fields["q"]))
    return Gradient(sigma, matrix, bool(fields["active_set_changes"][0]))


def object_norm(
    model: mujoco.MjModel, q0: npt.ArrayLike, q1: npt.ArrayLike, **options: typing.Unpack[NormOptions]
) -> float:
    """The object norm σ [m²] between two configurations (nq,); its root is an rms displacement.

    Options: movable, root, armature and metric, as in `solve`.
    """
    return _core.object_norm(model, q0, q1, **options)


def verify(
    model: mujoco.MjModel,
    qpos: npt.ArrayLike,
    *,
    q_in: npt.ArrayLike | None = None,
    **options: typing.Unpack[VerifyOptions],
) -> Verdict:
    """Decides whether a configuration qpos (nq,) is free, by code that the solver does not use.

    q_in (nq,) is the configuration whose contacts the option `rest` refers to; without it, none
    rests. Options: movable, exact_mesh, tolerance, clearance, rest, mocap_pos and mocap_quat, as in
    `solve`.
    """
    return _answers.verdict(_core.verify(model, qpos, q_in, **options))


def check_motion(
    model: mujoco.MjModel, q0: npt.ArrayLike, q1: npt.ArrayLike, **options: typing.Unpack[VerifyOptions]
) -> Motion:
    """Decides how far the straight motion from q0 to q1, both (nq,), is free: proven, not sampled.

    Hinges and slides change linearly; balls and free joints turn the short way at a constant rate.
    Options as in `verify`.
    """
    return Motion(**_core.check_motion(model, q0, q1, **options))


def audit(
    model: mujoco.MjModel,
    *,
    samples: int = 1000,
    seed: int = 0,
    tolerance: float = 1e-6,
    exact_mesh: bool = False,
) -> dict[str, typing.Any]:
    """What is wrong with a model: the fields of a line of `mjcf-pdg audit --json`.

    Args:
      samples: random configurations within limits that are looked at.
      seed: of these.
      tolerance: overlap that is none [m].
      exact_mesh: meshes collide as their triangles.

    Returns:
      model (its name), samples, pairs (list of geom1, geom2, class, share and count of samples,
      depth [m], deepest_in), never and never_share_below (how many pairs never overlapped, and how
      rarely they may), exclude (pairs of bodies that always overlap), keyframes (list of name, depth [m], limit_excess [rad or m],
      equality_residual [rad or m], force_over_weight), warnings.
    """
    return _core.audit(model, samples, seed, tolerance, exact_mesh)
