"""A second of MuJoCo from one pose, held there by servos as a puppet is by its strings."""

import copy
import dataclasses

import mujoco
import numpy as np

import mjcf_pdg

SECONDS = 1.0

# By how much a servo gives under the whole weight of what it carries: of a joint that turns [rad], and of a sliding
# joint or a free body [m]. With half to four times the stiffness poses at rest stay so (docs/physics.md).
TURN_SAG, SLIDE_SAG = 0.02, 0.001

# The time constant of contacts: the shortest that MuJoCo allows (its refsafe), in time steps of the model, and no
# longer than its default [s].
SHORTEST, DEFAULT = 2, 0.02
STEPS_PER_CONTACT_TIME = 5  # of the simulation, at least

FREE, SLIDE = mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_SLIDE


@dataclasses.dataclass(frozen=True)
class Conditions:
    contact_time: float | None = None  # [s]; None: by the rule above
    gains: float = 1.0  # of the servos of hinges, balls and slides, over those of `servo`
    free_bodies_held: bool = True
    weightless: bool = False


@dataclasses.dataclass
class Run:
    """A second of simulation, step by step; infinities from where MuJoCo gave up."""

    timestep: float  # [s]
    q: np.ndarray  # (steps + 1, nq), fewer where MuJoCo gave up
    force: np.ndarray  # (steps,) sum of all contacts' normal forces over body weight
    speed: np.ndarray  # (steps,) of the fastest body's centre of mass [m/s]
    energy: np.ndarray  # (steps,) kinetic, of gravity and of servos, over that at the start [J]
    displacement: float  # √σ from the first pose to the last [m]
    overlap: float  # of the deepest contact at the end [m]


def moving(model: mujoco.MjModel) -> np.ndarray:
    """(nbody,) of bool: what joints can move, neither furniture nor what a mocap body carries."""
    return model.body_treeid >= 0


def body_weight(model: mujoco.MjModel) -> float:
    """Of all that moves [N]."""
    return float(np.sum(model.body_mass[moving(model)]) * np.linalg.norm(model.opt.gravity))


def prepared(model: mujoco.MjModel, conditions: Conditions) -> mujoco.MjModel:
    """A copy with the contacts and flags of a run, without actuators, springs and mocap ties of its own."""
    model = copy.copy(model)
    contact_time = conditions.contact_time or min(SHORTEST * model.opt.timestep, DEFAULT)
    model.geom_solref[:] = model.pair_solref[:] = [contact_time, 1.0]  # damped critically
    model.opt.timestep = min(model.opt.timestep, contact_time / STEPS_PER_CONTACT_TIME)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST  # stable however stiff servos are
    disable, enable = mujoco.mjtDisableBit, mujoco.mjtEnableBit
    model.opt.disableflags &= ~int(disable.mjDSBL_SPRING | disable.mjDSBL_DAMPER | disable.mjDSBL_REFSAFE)
    model.opt.disableflags |= int(disable.mjDSBL_ACTUATION)
    model.opt.enableflags &= ~int(enable.mjENBL_OVERRIDE)
    model.opt.enableflags |= int(enable.mjENBL_ENERGY)
    if conditions.weightless:
        model.opt.disableflags |= int(disable.mjDSBL_GRAVITY)
    model.tendon_stiffness[:] = model.jnt_stiffness[:] = 0.0
    model.eq_active0[[e for e in range(model.neq) if driven_by_mocap(model, e)]] = 0
    return model


def driven_by_mocap(model: mujoco.MjModel, e: int) -> bool:
    """Whether the equality constraint ties something to a mocap body: so users drive a robot, which is held here."""
    if mujoco.mjtObj(model.eq_objtype[e]) == mujoco.mjtObj.mjOBJ_BODY:
        bodies = np.array([model.eq_obj1id[e], model.eq_obj2id[e]])
    elif mujoco.mjtObj(model.eq_objtype[e]) == mujoco.mjtObj.mjOBJ_SITE:
        bodies = model.site_bodyid[[model.eq_obj1id[e], model.eq_obj2id[e]]]
    else:
        return False
    return bool(np.any(model.body_mocapid[bodies] >= 0))


def hold(model: mujoco.MjModel, data: mujoco.MjData, conditions: Conditions) -> None:
    """Springs, damped critically, that draw every joint to where it is in `data`, whose positions are known."""
    model.qpos_spring[:] = data.qpos
    for j, kind in enumerate(map(mujoco.mjtJoint, model.jnt_type)):
        scale = float(conditions.free_bodies_held) if kind == FREE else conditions.gains
        model.jnt_stiffness[j] = scale * servo(model, data, j)
        for dof in np.flatnonzero(model.dof_jntid == j):
            model.dof_damping[dof] += 2 * np.sqrt(model.jnt_stiffness[j] * inertia(model, data, dof))


def servo(model: mujoco.MjModel, data: mujoco.MjData, j: int) -> float:
    """Stiffness of a joint's servo [N/m or N m/rad]; of a free body as many N m/rad as N/m, MuJoCo has one number.

    A joint that turns is taken to carry the weight at the root mean square distance of its mass from the anchor, since
    gravity's lever is never longer.
    """
    body = model.jnt_bodyid[j]
    carried = [b for b in range(model.nbody) if is_below(model, b, body)]
    mass = model.body_mass[carried]
    weight = float(np.sum(mass) * np.linalg.norm(model.opt.gravity))
    if mujoco.mjtJoint(model.jnt_type[j]) in (FREE, SLIDE):
        return weight / SLIDE_SAG
    squares = np.sum((data.xipos[carried] - data.xanchor[j]) ** 2, axis=1)
    own = np.sum(model.body_inertia[carried], axis=1) / 2  # of a body's points about its centre of mass
    lever = np.sqrt((mass @ squares + np.sum(own)) / max(np.sum(mass), np.finfo(float).tiny))
    return weight * float(lever) / TURN_SAG


def is_below(model: mujoco.MjModel, body: int, root: int) -> bool:
    while body > root:
        body = model.body_parentid[body]
    return body == root


def inertia(model: mujoco.MjModel, data: mujoco.MjData, dof: int) -> float:
    """Of what the degree of freedom moves, at the pose [kg or kg m²]."""
    unit, row = np.zeros(model.nv), np.zeros(model.nv)
    unit[dof] = 1.0
    mujoco.mj_mulM(model, data, row, unit)
    return float(row[dof])


def simulate(
    model: mujoco.MjModel, q: np.ndarray, mocap: tuple[np.ndarray, np.ndarray], conditions: Conditions
) -> Run:
    """Of a `prepared` model, from rest; `mocap` are positions and quaternions of its mocap bodies."""
    model, weight = copy.copy(model), body_weight(model)
    data = mujoco.MjData(model)
    data.qpos[:] = q
    data.mocap_pos[:], data.mocap_quat[:] = mocap
    mujoco.mj_forward(model, data)
    hold(model, data, conditions)
    mujoco.mj_forward(model, data)
    start = float(np.sum(data.energy))
    steps = round(SECONDS / model.opt.timestep)
    path = [q]
    force, speed, energy = np.full((3, steps), np.inf)
    for k in range(steps):
        mujoco.mj_step(model, data)
        if gave_up(data):
            return Run(model.opt.timestep, np.array(path), force, speed, energy, np.inf, np.inf)
        force[k] = normal_force(model, data) / weight
        mujoco.mj_forward(model, data)  # positions, velocities and energy at the end of the step
        speed[k] = fastest_body(model, data)
        energy[k] = float(np.sum(data.energy)) - start
        path.append(data.qpos.copy())
    displacement = float(np.sqrt(mjcf_pdg.object_norm(model, q, data.qpos)))
    overlap = max(0.0, -min(data.contact.dist, default=0.0))
    return Run(model.opt.timestep, np.array(path), force, speed, energy, displacement, overlap)


def gave_up(data: mujoco.MjData) -> bool:
    """It has burst beyond what MuJoCo can compute, which begins anew then."""
    kinds = mujoco.mjtWarning
    return any(data.warning[kind].number for kind in (kinds.mjWARN_BADQPOS, kinds.mjWARN_BADQVEL, kinds.mjWARN_BADQACC))


def normal_force(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """The sum over all contacts [N]."""
    total, wrench = 0.0, np.zeros(6)
    for k in range(data.ncon):
        mujoco.mj_contactForce(model, data, k, wrench)
        total += wrench[0]
    return total


def fastest_body(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Speed of its centre of mass [m/s]."""
    velocity, fastest = np.zeros(6), 0.0  # rotation first
    for body in np.flatnonzero(moving(model)):
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
        fastest = max(fastest, float(np.linalg.norm(velocity[3:])))
    return fastest
