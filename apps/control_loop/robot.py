"""A robot with position servos among obstacles, and the sinusoids that its joints are to follow."""

import argparse

import mujoco
import numpy as np

TIMESTEP = 1e-3  # [s]
RAMP = 1.0  # the targets leave the home configuration within this time, which no number counts [s]
SCALARS = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))


class Robot:
    """The joints with position actuators, their sinusoids, and what stays where it is."""

    def __init__(self, model: mujoco.MjModel, amplitude: float, rng: np.random.Generator):
        self.home = (model.key_qpos[0] if model.nkey else model.qpos0).copy()
        self.actuators = [a for a in range(model.nu) if self._is_servo(model, a)]
        if not self.actuators:
            raise ValueError("the model has no position actuators on hinges or slides")
        joints = [int(model.actuator_trnid[a, 0]) for a in self.actuators]
        self.qpos = np.array([model.jnt_qposadr[j] for j in joints])
        self.dofs = np.array([model.jnt_dofadr[j] for j in joints])
        self.bodies = sorted({int(model.jnt_bodyid[j]) for j in joints})
        low, high = np.array([self._range(model, j) for j in joints]).T
        self.reach = amplitude * np.minimum(high - low, np.pi)
        self.middle = np.clip(self.home[self.qpos], low + self.reach, np.maximum(low, high - self.reach))
        self.frequency = rng.uniform(0.1, 0.4, len(joints))  # [Hz]
        self.phase = rng.uniform(0.0, 2.0 * np.pi, len(joints))
        # What a servo pushes with [N m or N]: stiffness · (target - joint) - resistance · speed.
        self.stiffness = model.actuator_gainprm[self.actuators, 0]
        self.resistance = -model.actuator_biasprm[self.actuators, 2]
        self.fastest_step = 2.0 * np.pi * float(np.max(self.frequency * self.reach)) * TIMESTEP
        self.hardest = float(np.max((2.0 * np.pi * self.frequency) ** 2 * self.reach))  # acceleration of the targets

    @staticmethod
    def _is_servo(model: mujoco.MjModel, a: int) -> bool:
        on_joint = model.actuator_trntype[a] == int(mujoco.mjtTrn.mjTRN_JOINT)
        kp = model.actuator_gainprm[a, 0]
        is_position = kp > 0.0 and model.actuator_biasprm[a, 1] == -kp
        return bool(on_joint and is_position and model.jnt_type[model.actuator_trnid[a, 0]] in SCALARS)

    @staticmethod
    def _range(model: mujoco.MjModel, j: int) -> tuple[float, float]:
        return tuple(model.jnt_range[j]) if model.jnt_limited[j] else (-1.5, 1.5)

    def targets(self, t: float) -> np.ndarray:
        """Of the servos at a time [s]."""
        wave = self.middle + self.reach * np.sin(2.0 * np.pi * self.frequency * t + self.phase)
        share = min(1.0, t / RAMP)
        return (1.0 - share) * self.home[self.qpos] + share * wave


def load(path: str, arguments: argparse.Namespace) -> tuple[mujoco.MjModel, Robot]:
    """The model with obstacles around, its base held where it is: welded if it floats, braked if it stands on wheels."""
    spec = mujoco.MjSpec.from_file(path)
    model = spec.compile()
    rng = np.random.default_rng(arguments.seed)
    robot = Robot(model, arguments.amplitude, rng)
    for joint in base_joints(model, robot.bodies):
        at = robot.home[model.jnt_qposadr[joint] :]
        if model.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_FREE):
            weld = spec.add_equality(type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY)
            weld.name1, weld.name2 = "world", model.body(int(model.jnt_bodyid[joint])).name
            weld.data[:11] = [0, 0, 0, *at[:7], 1]
        elif model.jnt_type[joint] in SCALARS:
            brake = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT, objtype=mujoco.mjtObj.mjOBJ_JOINT)
            brake.name1 = model.joint(joint).name
            brake.data[0] = at[0] - model.qpos0[model.jnt_qposadr[joint]]
    add_obstacles(spec, model, robot, arguments.obstacles, rng)
    spec.option.timestep = TIMESTEP
    return spec.compile(), robot


def base_joints(model: mujoco.MjModel, bodies: list[int]) -> list[int]:
    """The joints without servos between the world and the first of `bodies` on each way."""
    base: set[int] = set()
    for body in bodies:
        above = int(model.body_parentid[body])
        while above and above not in bodies:
            base.add(above)
            above = int(model.body_parentid[above])
    return [j for j in range(model.njnt) if int(model.jnt_bodyid[j]) in base]


def add_obstacles(spec, model: mujoco.MjModel, robot: Robot, count: int, rng: np.random.Generator) -> None:
    """Balls, boxes and capsules where some link comes by, none where the robot is at home."""
    data = mujoco.MjData(model)
    collides = (model.geom_contype | model.geom_conaffinity) != 0
    links = [g for g in range(model.ngeom) if collides[g] and moves(model, int(model.geom_bodyid[g]), robot.bodies)]
    robot.size = float(np.mean(model.geom_rbound[links]))
    radius = 0.5 * robot.size
    data.qpos[:] = robot.home
    mujoco.mj_kinematics(model, data)
    home = data.geom_xpos[links].copy()
    made = 0
    for _ in range(100 * count):
        if made == count:
            return
        data.qpos[robot.qpos] = robot.targets(rng.uniform(RAMP, 10.0))
        mujoco.mj_kinematics(model, data)
        link = links[rng.integers(len(links))]
        place = data.geom_xpos[link] + rng.uniform(-1.0, 1.0, 3) * model.geom_rbound[link]
        if np.min(np.linalg.norm(home - place, axis=1) - model.geom_rbound[links]) < 2.0 * radius:
            continue
        kind = (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CAPSULE)[made % 3]
        spec.worldbody.add_geom(type=kind, pos=place, size=radius * rng.uniform(0.5, 1.0, 3), contype=1, conaffinity=1)
        made += 1


def carrier(model: mujoco.MjModel, body: int, bodies: list[int]) -> int:
    """The first of `bodies` on the way from a body to the world; 0 if there is none.

    What two bodies of the same carrier do to each other, no joint of `bodies` changes.
    """
    while body and body not in bodies:
        body = int(model.body_parentid[body])
    return body


def moves(model: mujoco.MjModel, body: int, bodies: list[int]) -> bool:
    return carrier(model, body, bodies) != 0
