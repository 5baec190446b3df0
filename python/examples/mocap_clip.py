"""Frees the frames of a recorded motion, each with the frames before it as starts of its search."""

import pathlib

import mujoco
import numpy as np

import mjcf_pdg

MODEL = pathlib.Path(__file__).resolve().parents[2] / "models" / "figure" / "figure_bench.xml"


def make_clip(model: mujoco.MjModel, frames: int) -> np.ndarray:
    """A clip (frames, nq) as of a motion capture: from standing to sitting, sunk into the seat."""
    start, end = model.key("home").qpos, model.key("sunk_into_seat").qpos
    change = np.zeros(model.nv)
    mujoco.mj_differentiatePos(model, change, 1.0, start, end)
    clip = np.tile(start, (frames, 1))
    for frame, share in zip(clip, np.linspace(0.0, 1.0, frames)):
        mujoco.mj_integratePos(model, frame, change, share)
    return clip


def main() -> None:
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    clip = make_clip(model, 30)
    results = mjcf_pdg.solve(model, clip, trajectory=True)
    for frame in range(0, len(clip), 3):
        print(f"frame {frame:2}  {results.status[frame]:12}  moved {1e3 * results.rms[frame]:6.2f} mm (rms)")
    print(f"{np.sum(results.free)} of {len(clip)} frames are free, {1e3 * results.seconds.mean():.1f} ms a frame")


if __name__ == "__main__":
    main()
