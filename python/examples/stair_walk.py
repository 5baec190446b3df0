"""A walk up stairs that sinks in by 2 cm, freed with its frames weighed against each other (smooth=W).

    python3 stair_walk.py [--smooth W] [--write FOLDER]

Each frame alone is the nearest free one; then one optimum is followed from frame to frame; with smooth the whole clip is
solved together. Printed are for each: frames that are free, how far feet that stand are off the ground, and how
fast joints become beside the clip's own fastest. --write leaves walk.xml and walk.npy for the command line.
"""

import argparse
import pathlib

import mujoco
import numpy as np

import mjcf_pdg

FRAMES, RATE = 240, 60.0  # [frames], [1/s]
SINK = 0.02  # [m]
TREAD, RISE, STAIRS = 0.30, 0.15, 8  # [m], [m], steps
THIGH, SHANK, ANKLE = 0.42, 0.42, 0.08  # lengths; the ankle's height over the sole [m]
HIPS = 0.80  # height of the hips over the mean of the feet, low enough that no leg is ever stretched [m]
STEP_TIME, FIRST_X = 0.5, -0.45  # of one foot [s], where the feet stand first [m]


def make_model() -> str:
    """A humanoid of capsules with box feet, before stairs."""
    legs = "".join(
        f"""<body name="{side}_thigh" pos="0 {y} 0"><joint name="{side}_hip" axis="0 1 0"/>
        <joint name="{side}_hip_x" axis="1 0 0" range="-.6 .6"/><geom type="capsule" fromto="0 0 -.08 0 0 -{THIGH - 0.06}" size=".06"/>
        <body name="{side}_shank" pos="0 0 -{THIGH}"><joint name="{side}_knee" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 -.05 0 0 -{SHANK - 0.05}" size=".045"/>
        <body name="{side}_foot" pos="0 0 -{SHANK}"><joint name="{side}_ankle" axis="0 1 0" range="-1 1"/>
        <joint name="{side}_ankle_x" axis="1 0 0" range="-.4 .4"/>
        <geom name="{side}_foot" type="box" pos=".04 0 -{ANKLE - 0.02}" size=".1 .045 .02"/></body></body></body>"""
        for side, y in (("left", 0.11), ("right", -0.11))
    )
    arms = "".join(
        f"""<body pos="0 {y} .45"><joint name="{side}_shoulder" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 -.04 0 0 -.26" size=".04"/><body pos="0 0 -.3">
        <joint name="{side}_elbow" axis="0 1 0"/><geom type="capsule" fromto="0 0 -.04 0 0 -.22" size=".035"/></body></body>"""
        for side, y in (("left", 0.24), ("right", -0.24))
    )
    stairs = "".join(
        f'<geom name="stair{k}" type="box" pos="{(k + 0.5) * TREAD} 0 {(k + 1) * RISE / 2}" '
        f'size="{TREAD / 2} .6 {(k + 1) * RISE / 2}"/>'
        for k in range(STAIRS)
    )
    return f"""<mujoco model="stair walk"><compiler angle="radian"/><visual><global offwidth="1200"/></visual>
    <worldbody><light pos="0 -3 4"/><geom name="floor" type="plane" size="4 4 .1"/>{stairs}
    <body name="torso"><freejoint/><geom type="capsule" fromto="0 -.06 0 0 .06 0" size=".1"/>
    <geom type="capsule" fromto="0 0 .15 0 0 .4" size=".12"/><geom type="sphere" pos="0 0 .68" size=".11"/>
    {legs}{arms}</body></worldbody></mujoco>"""


def ground(x: float) -> float:
    """Height of the stairs [m]."""
    return RISE * float(np.clip(np.floor(x / TREAD) + 1, 0, STAIRS))


def footfalls(first: int) -> list[tuple[float, float]]:
    """Where a foot stands, one after the other: on every second tread [m, m]."""
    middles = [(k + 0.5) * TREAD - 0.04 for k in range(-1, STAIRS)]
    return [(FIRST_X, 0.0), *((x, ground(x + 0.04)) for x in middles[first::2])]


def feet_at(t: float) -> list[tuple[float, float, bool]]:
    """Of either foot: where its sole is, and whether it stands."""
    feet = []
    for side in (0, 1):
        falls = footfalls(side)
        # It swings in every second step.
        swings = (t / STEP_TIME - side) / 2.0
        k = int(np.floor(max(swings, 0.0)))
        share = np.clip(2.0 * (swings - k), 0.0, 1.0) if swings > 0.0 else 0.0
        k = min(k, len(falls) - 1)
        (x0, z0), (x1, z1) = falls[k], falls[min(k + 1, len(falls) - 1)]
        s = share * share * (3.0 - 2.0 * share)
        lift = 0.12 * np.sin(np.pi * share) ** 2 if x1 > x0 else 0.0
        rise = np.clip(2.0 * s, 0.0, 1.0) if z1 > z0 else s
        rise = rise * rise * (3.0 - 2.0 * rise)
        feet.append((x0 + s * (x1 - x0), z0 + rise * (z1 - z0) + lift, share in (0.0, 1.0)))
    return feet


def leg(dx: float, dz: float) -> tuple[float, float]:
    """Hip and knee for an ankle at (dx, -dz) from the hip: the law of cosines."""
    reach = min(np.hypot(dx, dz), 0.999 * (THIGH + SHANK))
    knee = np.pi - np.arccos((THIGH**2 + SHANK**2 - reach**2) / (2.0 * THIGH * SHANK))
    lean = np.arccos((THIGH**2 + reach**2 - SHANK**2) / (2.0 * THIGH * reach))
    return -np.arctan2(dx, dz) - lean, knee


def make_clip(model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
    """The frames (FRAMES, nq), and which feet stand in them (FRAMES, 2)."""
    clip = np.tile(model.qpos0, (FRAMES, 1))
    times = np.arange(FRAMES) / RATE
    feet = [feet_at(t) for t in times]
    middle = np.array([[np.mean([f[0] for f in pair]), np.mean([f[1] for f in pair])] for pair in feet])
    kernel = np.hanning(31) / np.sum(np.hanning(31))
    hips = np.column_stack([np.convolve(np.pad(m, 15, mode="edge"), kernel, mode="valid") for m in middle.T])
    hips[:, 1] += HIPS
    address = {model.joint(j).name: model.jnt_qposadr[j] for j in range(model.njnt)}
    for q, pair, (x, z), t in zip(clip, feet, hips, times):
        q[:3] = x, 0.0, z - SINK
        for side, (foot_x, foot_z, _) in zip(("left", "right"), pair):
            hip, knee = leg(foot_x - x, z - foot_z - ANKLE)
            q[address[f"{side}_hip"]], q[address[f"{side}_knee"]] = hip, knee
            q[address[f"{side}_ankle"]] = -hip - knee
        swing = 0.4 * np.sin(np.pi * t / STEP_TIME)
        q[address["left_shoulder"]], q[address["right_shoulder"]] = swing, -swing
        q[address["left_elbow"]] = q[address["right_elbow"]] = -0.5
    return clip, np.array([[foot[2] for foot in pair] for pair in feet])


def speeds(model: mujoco.MjModel, clip: np.ndarray) -> np.ndarray:
    """The fastest root translation [m/s], root rotation and hinge [rad/s] of a clip."""
    v = np.zeros((len(clip) - 1, model.nv))
    for k in range(len(clip) - 1):
        mujoco.mj_differentiatePos(model, v[k], 1.0 / RATE, clip[k], clip[k + 1])
    root = [np.linalg.norm(v[:, :3], axis=1).max(), np.linalg.norm(v[:, 3:6], axis=1).max()]
    return np.array([*root, np.abs(v[:, 6:]).max()])


def off_the_ground(model: mujoco.MjModel, clip: np.ndarray, stands: np.ndarray) -> float:
    """The largest distance from the ground of a foot that stands [m]."""
    data = mujoco.MjData(model)
    worlds = [g for g in range(model.ngeom) if model.geom_bodyid[g] == 0]
    worst = 0.0
    for q, standing in zip(clip, stands):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        for side in np.flatnonzero(standing):
            foot = model.geom(("left", "right")[side] + "_foot").id
            worst = max(worst, min(mujoco.mj_geomDistance(model, data, g, foot, 1.0, None) for g in worlds))
    return worst


def show(name: str, model: mujoco.MjModel, results, clip: np.ndarray, stands: np.ndarray) -> bool:
    solver = mjcf_pdg.Solver(model)
    free = sum(solver.is_free(q) for q in results.q)
    own = speeds(model, clip)
    ratio = np.max(speeds(model, results.q)[[0, 2]] / own[[0, 2]])
    off = off_the_ground(model, results.q, stands)
    colliding = results.queries[results.status == "solved"]
    print(f"{name:12} {free:4} of {len(clip)} solved and free  {1e3 * off:6.2f} mm off the ground  {ratio:5.2f} times the speed  "
          f"{1e3 * np.mean(results.rms):5.2f} mm (rms)  queries {np.median(colliding):.0f} median, "
          f"{np.quantile(colliding, 0.99):.0f} p99, {np.sum(results.queries)} in all")  # fmt: skip
    return free == len(clip) and off < 0.005 and ratio <= 1.5


def main() -> None:
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__.splitlines()[0])
    parser.add_argument("--smooth", type=float, default=10.0, metavar="W")
    parser.add_argument("--write", type=pathlib.Path, metavar="FOLDER")
    arguments = parser.parse_args()
    model = mujoco.MjModel.from_xml_string(make_model())
    clip, stands = make_clip(model)
    if arguments.write:
        (arguments.write / "walk.xml").write_text(make_model())
        np.save(arguments.write / "walk.npy", clip)
    solver = mjcf_pdg.Solver(model)
    print(f"{sum(not solver.is_free(q) for q in clip)} of {len(clip)} frames collide, the clip's fastest: "
          f"root {speeds(model, clip)[0]:.2f} m/s, hinge {speeds(model, clip)[2]:.2f} rad/s")  # fmt: skip
    show("each alone", model, mjcf_pdg.solve(model, clip), clip, stands)
    show("followed", model, mjcf_pdg.solve(model, clip, trajectory=True), clip, stands)
    smooth = mjcf_pdg.solve(model, clip, trajectory=True, smooth=arguments.smooth)
    if not show(f"smooth={arguments.smooth:g}", model, smooth, clip, stands):
        raise SystemExit("the smoothed walk is not free, not on the ground, or too fast")


if __name__ == "__main__":
    main()
