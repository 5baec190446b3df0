"""Makes figure_stairs.xml and walk.csv: the figure, stairs, and a walk that was meant for a ramp. Run it without arguments."""
import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "figure")]

from make_figure_bench import HIP, UPRIGHT, add_figure, both
from scene_tools import Scene, element

COMMENT = """
The figure of ../figure and stairs of {steps} steps. Made by make_figure_stairs.py; change that, not this.

Units: m, kg, s, rad. Figure: 1.74 m, 73 kg, {links} links, 41 DoF, {figure} triangles; its meshes are those of ../figure/assets.
Stairs: boxes, {rise} m high and {run} m deep each, {width} m wide; fixed; floor z = 0. walk.csv: {frames} frames of a walk up a ramp
of the same slope, so that feet and shanks cut through the steps.
"""

STEPS, RISE, RUN, WIDTH, FIRST = 5, 0.16, 0.29, 1.0, 0.35  # FIRST: where the first step begins
FRAMES, FRAMES_A_STEP = 60, 12  # of the clip; of it while the pelvis moves by RUN


def leg(side, phase):
    """One leg of the gait; at phase 0 it is farthest in front, then it stands, from pi on it swings."""
    hip = -22 - 24 * math.cos(phase)
    knee = 22 + 8 * math.cos(phase) + 46 * max(0, -math.sin(phase))
    ankle = max(-25, min(20, -hip - knee))  # the sole level, as far as that goes
    return {f"{side}_hip": (0, hip, 0), f"{side}_knee": knee, f"{side}_ankle": (0, ankle, 0)}


def pose(frame):
    phase = math.pi * frame / FRAMES_A_STEP
    x = RUN * frame / FRAMES_A_STEP
    ramp = RISE * max(0, min(STEPS, (x - FIRST) / RUN + 0.5))
    swing = 18 * math.cos(phase)
    return {"pelvis": (x, 0, HIP - 0.075 + ramp, *UPRIGHT), **leg("left", phase), **leg("right", phase + math.pi),
            "left_shoulder": (0, swing, 0), "right_shoulder": (0, -swing, 0), **both("elbow", 25)}


def main():
    scene = Scene("figure_stairs", HERE, assets_of="figure")
    for name, rgba in [("skin", (0.88, 0.68, 0.55, 1)), ("shirt", (0.30, 0.50, 0.72, 1)),
                       ("trousers", (0.25, 0.27, 0.34, 1)), ("shoe", (0.35, 0.22, 0.15, 1)), ("stone", (0.66, 0.65, 0.62, 1))]:
        scene.material(name, rgba, 0.2, 0.3)
    scene.stage(camera_pos=(1.2, -4.2, 1.6), camera_xyaxes=(1, 0, 0, 0, 0.2, 0.98), look_at=(0.8, 0, 0.9), extent=1.5, tile=0.3)
    pelvis = add_figure(scene)
    stairs = element(scene.world, "body", name="stairs", pos=(FIRST, 0, 0))
    for i in range(STEPS):
        half = ((STEPS - i) * RUN / 2 + 0.3, WIDTH / 2, RISE / 2)  # the last one is a landing
        element(stairs, "geom", name=f"step{i + 1}", type="box", size=half, pos=(i * RUN + half[0], 0, (i + 0.5) * RISE),
                material="stone")
    scene.key("home", {"pelvis": (-0.2, 0, HIP, *UPRIGHT)})
    links, triangles = scene.count(pelvis)
    scene.write(COMMENT.format(links=links, figure=triangles, steps=STEPS, rise=RISE, run=RUN, width=WIDTH, frames=FRAMES))
    rows = [sum(map(list, scene.qpos(f"frame {k}", pose(k)).values()), []) for k in range(FRAMES)]
    (HERE / "walk.csv").write_text("".join(",".join(f"{value:.5g}" for value in row) + "\n" for row in rows))


if __name__ == "__main__":
    main()
