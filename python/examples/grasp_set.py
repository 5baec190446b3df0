"""Cleans a set of sampled grasps: frees those that penetrate, drops those that had to move far."""

import pathlib

import mujoco
import numpy as np

import mjcf_pdg

MODEL = pathlib.Path(__file__).resolve().parents[2] / "models" / "hand" / "hand_bottle.xml"
FARTHEST = 0.002  # a grasp that moves more than this is another grasp [m, rms]


def sample_grasps(model: mujoco.MjModel, count: int, rng: np.random.Generator) -> np.ndarray:
    """Grasps (count, nq) about the keyframe: fingers bent and the palm moved at random."""
    grasps = np.tile(model.key("gentle_grasp").qpos, (count, 1))
    grasps[:, :3] += rng.normal(0.0, 0.003, (count, 3))  # the palm's place [m]
    grasps[:, 7:] += rng.normal(0.0, 0.05, (count, model.nq - 7))  # the fingers' angles [rad]
    return grasps


def main() -> None:
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    grasps = sample_grasps(model, 100, np.random.default_rng(0))
    results = mjcf_pdg.solve(model, grasps, threads=2, root="palm", progress=True)
    near = results.free & (results.rms < FARTHEST)
    print(f"{np.sum(results.status == 'already_free')} of {len(results)} grasps were free,")
    print(f"{np.sum(results.status == 'solved')} became free, {np.sum(~results.free)} did not;")
    print(f"{near.sum()} moved less than {1e3 * FARTHEST:.0f} mm (rms) and are kept,")
    print(f"the median of them {1e3 * np.median(results.rms[near]):.2f} mm")


if __name__ == "__main__":
    main()
