"""The collision-free MuJoCo configuration nearest to one that penetrates.

    import mujoco
    import mjcf_pdg

    model = mujoco.MjModel.from_xml_path("robot.xml")
    result = mjcf_pdg.solve(model, qpos)      # result.q is free if result.status says so
"""

import typing

from mjcf_pdg import _libmujoco

_libmujoco.share()

from mjcf_pdg._answers import Contact, Gradient, Motion, Result, Results, Verdict  # noqa: E402
from mjcf_pdg._core import __version__  # noqa: E402
from mjcf_pdg._functions import (  # noqa: E402
    Solver,
    Tracker,
    audit,
    check_motion,
    gradient,
    object_norm,
    solve,
    verify,
)
from mjcf_pdg._view import View, view  # noqa: E402

if typing.TYPE_CHECKING:
    from mjcf_pdg._gymnasium import RepairOnReset

__all__ = [
    "Contact",
    "Gradient",
    "Motion",
    "Result",
    "Results",
    "Solver",
    "Tracker",
    "Verdict",
    "View",
    "__version__",
    "audit",
    "check_motion",
    "gradient",
    "object_norm",
    "solve",
    "verify",
    "view",
]


def __getattr__(name: str) -> typing.Any:
    if name == "RepairOnReset":  # here and not above: gymnasium is an extra
        from mjcf_pdg._gymnasium import RepairOnReset

        return RepairOnReset
    raise AttributeError(f"module 'mjcf_pdg' has no attribute '{name}'")
