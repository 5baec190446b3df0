"""The hand of models/hand and a vessel on the table: as PDg sees them, and as they are simulated."""

import dataclasses
import pathlib

import mujoco
import numpy as np

from vessels import Vessel, pieces, triangles

HAND = pathlib.Path(__file__).resolve().parents[2] / "models" / "hand" / "hand_bottle.xml"
FINGERS = ("index", "middle", "ring", "little", "thumb")
HAND_NQ = 26  # the palm's pose (7) and 19 hinges in the order of their drives; they come first in qpos
TOUCHING = 0.001  # a finger nearer than this is in contact [m]

IMPRATIO = 10.0  # MuJoCo advises elliptic cones and a large impratio against creep in grasps.

WELD = [0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0]  # origin on origin, axes along axes (mjEQ_WELD)


@dataclasses.dataclass(frozen=True)
class Contacts:
    """Stoneware is hard and bounces; MuJoCo's default contacts are soft and swallow what an overlap has stored."""

    # How fast what touches would swing [rad/s]: docs/grasps.md computes it for plastic on a thin wall of stoneware.
    # Fingers then press 0.005 mm into the cup, by MuJoCo's default up to 2 mm into a wall of 3.
    frequency: float = 2000.0
    # A dropped ball keeps half of its speed (tested); floor tiles of stoneware must give a steel ball 0.55 at least
    # (ISO 10545-5 has the test).
    damping_ratio: float = 0.23

    @property
    def solref(self) -> list[float]:
        return [1 / (self.frequency * self.damping_ratio), self.damping_ratio]

    @property
    def timestep(self) -> float:
        """A twenty-fifth of a free swing [s]."""
        return 0.25 / self.frequency


def hand() -> mujoco.MjSpec:
    spec = mujoco.MjSpec.from_file(str(HAND))
    spec.delete(spec.body("bottle"))
    for mesh in [mesh for mesh in spec.meshes if mesh.name.startswith("bottle")]:
        spec.delete(mesh)
    for key in list(spec.keys):
        spec.delete(key)
    return spec


def for_repair(vessel: Vessel) -> mujoco.MjModel:
    """The vessel stands still and is the triangles of its surface, which the model marks as exact."""
    spec = hand()
    vertices, faces = triangles(vessel)
    spec.add_mesh(name="vessel", uservert=vertices.ravel(), userface=faces.ravel())
    body = spec.worldbody.add_body(name="vessel")
    body.add_geom(name="vessel", type=mujoco.mjtGeom.mjGEOM_MESH, meshname="vessel", material="glass")
    spec.add_text(name="mjcf_pdg.exact_mesh", data="vessel")
    return spec.compile()


def for_lift(vessel: Vessel, contacts: Contacts = Contacts()) -> mujoco.MjModel:
    """The vessel is free, of convex pieces; an arm, a mocap body welded to the palm, carries the hand."""
    spec = hand()
    spec.option.timestep, spec.option.impratio = contacts.timestep, IMPRATIO
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    palm = spec.body("palm")
    spec.worldbody.add_body(name="arm", mocap=True, pos=palm.pos, quat=palm.quat)
    weld = spec.add_equality(type=mujoco.mjtEq.mjEQ_WELD, name1="arm", name2="palm", objtype=mujoco.mjtObj.mjOBJ_BODY)
    weld.data = WELD
    body = spec.worldbody.add_body(name="vessel")
    body.add_freejoint(name="vessel")
    for k, vertices in enumerate(pieces(vessel)):
        spec.add_mesh(name=f"piece{k}", uservert=vertices.ravel())
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"piece{k}", material="glass", density=vessel.density)
    model = spec.compile()
    model.geom_solref[:] = contacts.solref
    return model


def finger_of(model: mujoco.MjModel, geom: int) -> str | None:
    part = model.geom(geom).name.split("_")[0]
    return part if part in FINGERS else None


def touching_fingers(model: mujoco.MjModel, q: np.ndarray) -> set[str]:
    """The fingers within TOUCHING of the vessel of a for_lift model, or in it, at a pose q (HAND_NQ,) of the hand."""
    data = mujoco.MjData(model)
    data.qpos[:HAND_NQ] = q
    mujoco.mj_kinematics(model, data)
    vessel = np.flatnonzero(model.geom_bodyid == model.body("vessel").id)
    fingers = set()
    for geom in range(model.ngeom):
        finger = finger_of(model, geom)
        if finger and finger not in fingers:
            if any(mujoco.mj_geomDistance(model, data, geom, piece, 1.0, None) < TOUCHING for piece in vessel):
                fingers.add(finger)
    return fingers
