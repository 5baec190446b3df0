"""Repairs every keyframe of a model: python repair_keyframes.py [MODEL.xml]"""

import pathlib
import sys

import mujoco

import mjcf_pdg

MODELS = pathlib.Path(__file__).resolve().parents[2] / "models"


def main() -> None:
    path = sys.argv[1] if len(sys.argv) > 1 else MODELS / "puma" / "puma_car.xml"
    model = mujoco.MjModel.from_xml_path(str(path))
    results = mjcf_pdg.solve(model, model.key_qpos, threads=2)
    for key in range(model.nkey):
        name = model.key(key).name or f"key {key}"
        moved = f"moved {1e3 * results.rms[key]:7.1f} mm (rms)"
        print(f"{name:24} {results.status[key]:12} {moved}  {results.reason[key]}")
    model.key_qpos[results.free] = results.q[results.free]


if __name__ == "__main__":
    main()
