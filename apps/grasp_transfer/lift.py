"""The lift test: a hand that stands still about a vessel closes, rises and waits. It is the same for every grasp."""

import dataclasses

import mujoco
import numpy as np

from scene import HAND_NQ

CLOSE, RAISE, WAIT = 0.5, 1.0, 0.5  # the fingers close; the arm rises; it stands still [s]
LIFT = 0.10  # how far the arm rises [m]
SQUEEZE = {"mcp": 0.25, "pip": 0.125, "dip": 0.05, "ip": 0.1}  # by which the drives (2 N m/rad) close each joint [rad]
RISEN = 0.8 * LIFT  # a vessel that rises by less has slipped or fallen
PIERCED = 0.001  # what squeezed contacts do not reach (0.005 mm at the end): a finger is in the wall [m]
FRAMES_PER_SECOND = 50  # that are kept


@dataclasses.dataclass
class Lift:
    q: np.ndarray  # (frames, nq)
    rise: float  # of the vessel's centre of mass [m]
    slip: float  # how far that moved against the palm while the arm rose [m]
    tilt: float  # of the vessel's axis at the end [degrees]
    overlap: float  # the deepest of hand and vessel at the end [m]
    force: float  # the largest sum of the normal forces on the vessel [N]

    @property
    def risen(self) -> bool:
        """And still in the hand: one that was thrown may be up as well, metres away."""
        return self.rise > RISEN and self.slip < LIFT

    @property
    def pierced(self) -> bool:
        return self.overlap >= PIERCED

    @property
    def holds(self) -> bool:
        """The vessel is up, and outside the fingers."""
        return self.risen and not self.pierced


def lift(model: mujoco.MjModel, q: np.ndarray) -> Lift:
    """Of a scene.for_lift, from a pose q (HAND_NQ,) of the hand; nothing moves at the start, the vessel stands."""
    data = mujoco.MjData(model)
    data.qpos[:HAND_NQ] = q
    vessel = model.body("vessel").id
    closed, risen, end = (round(t / model.opt.timestep) for t in (CLOSE, CLOSE + RAISE, CLOSE + RAISE + WAIT))
    frames, force = [], 0.0
    mujoco.mj_kinematics(model, data)
    start = data.xipos[vessel].copy()
    data.ctrl[:] = data.qpos[7:HAND_NQ]
    data.mocap_quat[0] = q[3:7]
    for k in range(end):
        if k < closed:
            squeeze(model, data, min(1.0, 2 * k / closed))
        share = np.clip((k - closed) / (risen - closed), 0.0, 1.0)
        data.mocap_pos[0] = q[:3] + [0.0, 0.0, LIFT * share * share * (3 - 2 * share)]
        mujoco.mj_step(model, data)
        force = max(force, force_on(model, data, vessel))
        if k == closed:
            before = seen_from_palm(model, data, vessel)
        if k % round(1 / (FRAMES_PER_SECOND * model.opt.timestep)) == 0:
            frames.append(data.qpos.copy())
    slip = float(np.linalg.norm(seen_from_palm(model, data, vessel) - before))
    rise = float(data.xipos[vessel][2] - start[2])
    tilt = float(np.degrees(np.arccos(np.clip(data.xmat[vessel][8], -1.0, 1.0))))
    return Lift(np.array(frames), rise, slip, tilt, deepest_overlap(model, data, vessel), force)


def squeeze(model: mujoco.MjModel, data: mujoco.MjData, share: float) -> None:
    """Constant torques: each flexing drive's target goes ahead of its joint. Where they are at last, they stay."""
    for k in range(model.nu):
        ahead = SQUEEZE.get(model.actuator(k).name.split("_")[1])
        if ahead is not None:
            data.ctrl[k] = data.qpos[7 + k] + share * ahead


def on_vessel(model: mujoco.MjModel, data: mujoco.MjData, vessel: int) -> np.ndarray:
    """(ncon,) of bool: contacts of the vessel with the hand or the table."""
    return (model.geom_bodyid[data.contact.geom] == vessel).any(axis=1)


def force_on(model: mujoco.MjModel, data: mujoco.MjData, vessel: int) -> float:
    """The sum of normal forces [N]: of an elliptic cone the first row, where the contact has rows."""
    rows = data.contact.efc_address[on_vessel(model, data, vessel)]
    return float(np.sum(data.efc_force[rows[rows >= 0]]))


def seen_from_palm(model: mujoco.MjModel, data: mujoco.MjData, vessel: int) -> np.ndarray:
    """The vessel's centre of mass in the palm's frame."""
    palm = model.body("palm").id
    return data.xmat[palm].reshape(3, 3).T @ (data.xipos[vessel] - data.xpos[palm])


def deepest_overlap(model: mujoco.MjModel, data: mujoco.MjData, vessel: int) -> float:
    with_hand = (model.geom_bodyid[data.contact.geom] != 0).all(axis=1) & on_vessel(model, data, vessel)
    return float(max(0.0, np.max(-data.contact.dist[with_hand], initial=0.0)))
