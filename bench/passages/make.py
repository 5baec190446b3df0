"""Makes narrow passages of known width, a model a family, each with a motion through it that shows it to be one.

    python3 bench/passages/make.py --slack 0.03 --folder DIR
    python3 bench/passages/make.py --slack 0.03 --folder DIR --only coin20,arm6_plate

`check.py` looks at these motions, `plan_bench --scene FILE,FILE` plans.

DIR/NAME.xml has the keyframes start and goal, on two sides of a wall; DIR/NAME.witness.csv is a motion from one to the other, a
configuration (qpos) a line, to be joined by straight motions. The opening is 1 + slack times as wide as what must pass at least: with
a slack above 0 the witness is free, below 0 there is no way, and start and goal are free all the same. It needs mujoco and numpy.

Why there is none: a ball inside the body is as wide as the opening would have to be, and its central disc must go through (bars, coins,
plates, pegs, prisms, keys, hands); or the body is once wholly inside a tunnel, as wide as that (..._tunnel); or see `bent` and `make_corner`.
"""
import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "models"))

from mesh_tools import superellipse  # noqa: E402
from scene_tools import radians, text  # noqa: E402
from arms import hand, hook, make_arm, on_stick, two_slots  # noqa: E402
from scenes import make_corner_bar, make_corner_half_disc, make_gates, make_gripper, make_one, make_pair, make_snake  # noqa: E402
from shapes import (  # noqa: E402
    INFINITE, bent, box, coin, cylinder, flat, flat_ell, planar, plate, prism, prism_in_hole, profile, rectangle, straight, tube)

# Bodies, openings and arms that several families have.
TEE = [box(0.4, 0.08, 0.2), box(0.08, 0.3, 0.2, (0, 0.19, 0))]
ELL = [box(0.3, 0.08, 0.2, (0.11, 0, 0)), box(0.08, 0.3, 0.2, (0, 0.11, 0))]
YOU = [*ELL, box(0.08, 0.3, 0.2, (0.22, 0.11, 0))]
SQUARE = rectangle(0.1, 0.1)
YOU_FLAT = [box(0.36, 0.06, 0.03, (0, -0.12, 0)), *[box(0.06, 0.3, 0.03, (x, 0, 0)) for x in (-0.15, 0.15)]]
PLUS = [(-0.03, 0.03, -0.1, 0.1), (-0.1, 0.1, -0.03, 0.03)]
KEYHOLE = [(-0.05, 0.05, -0.05, 0.05), (-0.012, 0.012, -0.14, 0.05)]
ARM4, ARM5, ARM6, ARM7 = (0.1, 0.4, 0.35), (0.1, 0.4, 0.35, 0.1), (0.1, 0.4, 0.2, 0.2, 0.1), (0.1, 0.2, 0.2, 0.2, 0.2, 0.1)
ARM6_GOAL, ARM7_GOAL = (20, -50, 90, 30, -50, 10), (20, -40, 30, 80, 20, -50, 10)

# What makes each, and what that needs besides name and slack.
FAMILIES = {
    # The plane.
    "bar3": (make_one, "planar", planar([box(0.3, 0.1, 0.2)], 0.03)),
    "bar6": (make_one, "planar", planar([box(0.6, 0.1, 0.2)], 0.03)),
    "bar12": (make_one, "planar", planar([box(1.2, 0.1, 0.2)], 0.05)),
    "bar4_deep": (make_one, "planar", planar([box(0.4, 0.1, 0.2)], 0.4)),
    "bar12_deep": (make_one, "planar", planar([box(1.2, 0.1, 0.2)], 0.6)),
    "disc": (make_one, "planar", straight([cylinder(0.2, 0.2, "z")], 0.1, rectangle(0.2, INFINITE), 0.2)),
    "triangle": (make_one, "planar", planar([prism(superellipse(0.2, 0.2, 3), 0.2, "z")], 0.05)),
    "wedge": (make_one, "planar", planar([prism([(0, 0), (0.5, 0), (0.1, 0.15)], 0.2, "z")], 0.05)),
    "ell_tunnel": (make_one, "planar", planar(ELL)),
    "tee_tunnel": (make_one, "planar", planar(TEE)),
    "you_tunnel": (make_one, "planar", planar(YOU)),
    "cross_tunnel": (make_one, "planar", planar([box(0.4, 0.08, 0.2), box(0.08, 0.4, 0.2)])),
    "ell": (make_one, "planar", bent((0.3, 0.3), (1,), 0.06, 0.03)),
    "zed": (make_one, "planar", bent((0.25, 0.25, 0.25), (1, -1), 0.06, 0.03)),
    "stairs": (make_one, "planar", bent((0.2, 0.2, 0.2, 0.2, 0.2), (1, -1, 1, -1), 0.05, 0.02)),
    "gates": (make_gates, planar([box(0.5, 0.1, 0.2)], 0.05), 0.8, 0.4),
    "corner_bar3": (make_corner_bar, 0.3, 0.1),
    "corner_bar8": (make_corner_bar, 0.8, 0.1),
    "corner_sofa": (make_corner_half_disc, 0.2),
    # Space.
    "peg": (make_one, "space", straight([box(0.4, 0.1, 0.1)], 0.05, SQUARE, 0.1)),
    "peg_free": (make_one, "free", straight([box(0.4, 0.1, 0.1)], 0.2, SQUARE, 0.1)),
    "peg_deep": (make_one, "space", straight([box(0.4, 0.1, 0.1)], 0.5, SQUARE, 0.1)),
    "brick": (make_one, "free", straight([box(0.3, 0.15, 0.1)], 0.1, rectangle(0.15, 0.1), 0.1)),
    "rod": (make_one, "space", prism_in_hole(16, 0.05, 0.4, 0.1, cylinder(0.1, 0.4, "x"))),
    "prism3": (make_one, "space", prism_in_hole(3, 0.05, 0.4, 0.05)),
    "prism5": (make_one, "free", prism_in_hole(5, 0.05, 0.3, 0.1)),
    "prism6_deep": (make_one, "free", prism_in_hole(6, 0.05, 0.3, 0.3)),
    "coin10": (make_one, "space", coin(0.4, 0.04, 0.05)),
    "coin20": (make_one, "space", coin(0.4, 0.02, 0.05)),
    "coin40": (make_one, "free", coin(0.4, 0.01, 0.05)),
    "coin80": (make_one, "free", coin(0.4, 0.005, 0.02)),
    "coin20_deep": (make_one, "free", coin(0.4, 0.02, 0.3)),
    "plate": (make_one, "space", plate(0.5, 0.4, 0.02, 0.05)),
    "plate_deep": (make_one, "free", plate(0.5, 0.3, 0.03, 0.4)),
    "cross_flat": (make_one, "free", flat([box(0.4, 0.08, 0.04), box(0.08, 0.4, 0.04)], 0.42, 0.04, 0.05)),
    "ell_flat": (make_one, "space", flat(flat_ell(0.4, 0.3, 0.08, 0.04), 0.56, 0.04, 0.05)),
    "tee_flat": (make_one, "free", flat([box(0.4, 0.06, 0.03), box(0.06, 0.4, 0.03, (0.17, 0, 0))], 0.42, 0.03, 0.1)),
    "you_flat": (make_one, "space", flat(YOU_FLAT, 0.33, 0.03, 0.05)),
    "plus_key": (make_one, "space", profile(PLUS, 0.3, 0.1)),
    "key": (make_one, "free", profile(KEYHOLE, 0.3, 0.1)),
    "ell_hole": (make_one, "free", bent((0.3, 0.3), (1,), 0.06, 0.03, 0.06)),
    "zed_hole": (make_one, "space", bent((0.25, 0.25, 0.25), (1, -1), 0.06, 0.03, 0.06)),
    "stairs_hole": (make_one, "free", bent((0.2, 0.2, 0.2, 0.2), (1, -1, 1), 0.05, 0.02, 0.05)),
    "tube": (make_one, "free", tube(0.03, 0.2, 120, 0.02)),
    # Arms.
    "arm3_blade": (make_arm, "zzz", (0.4, 0.35), (40, -70, 60), on_stick(planar([box(0.15, 0.03, 0.2)], 0.03))),
    "arm3_two": (make_arm, "zzz", (0.4, 0.35), (60, -70, 10), two_slots(on_stick(planar([box(0.1, 0.04, 0.2)], 0.03)), 0.25)),
    "arm4_hook": (make_arm, "zzzz", (0.45, 0.4, 0.3), (80, -90, -60, 40), hook()),
    "arm4_flat": (make_arm, "zyyy", ARM4, (20, -50, 80, -20), hand(0.12, 0.1, 0.03, 0.03)),
    "arm5_blade": (make_arm, "zyyyx", ARM5, (-30, -40, 80, -60, 20), hand(0.15, 0.12, 0.01, 0.02)),
    "arm5_peg": (make_arm, "zyyyx", ARM5, (30, -60, 90, -10, 60), hand(0.12, 0.05, 0.05, 0.1)),
    "arm6_plate": (make_arm, "zyyxyx", ARM6, ARM6_GOAL, hand(0.15, 0.15, 0.02, 0.03)),
    "arm6_ell": (make_arm, "zyyxyx", ARM6, ARM6_GOAL, on_stick(flat(flat_ell(0.15, 0.12, 0.04, 0.03), 0.22, 0.03, 0.03))),
    "arm6_two": (make_arm, "zyyxyx", ARM6, ARM6_GOAL, two_slots(hand(0.12, 0.1, 0.03, 0.03), 0.25)),
    "arm6_odd": (make_arm, "zyxyzx", ARM6, (20, -50, 10, 50, -60, 0), hand(0.12, 0.1, 0.03, 0.03)),
    "arm7_peg": (make_arm, "zyxyxyx", ARM7, ARM7_GOAL, hand(0.15, 0.06, 0.06, 0.1)),
    "arm7_blade": (make_arm, "zyxyxyx", ARM7, ARM7_GOAL, hand(0.15, 0.12, 0.015, 0.03)),
    "arm7_two": (make_arm, "zyxyxyx", ARM7, ARM7_GOAL, two_slots(hand(0.12, 0.1, 0.03, 0.02), 0.25)),
    # Several bodies.
    "rover3_window": (make_arm, "yyy", (0.35, 0.3), (-60, 90, -30), hand(0.12, 0.1, 0.05, 0.05), True),
    "rover4_blade": (make_arm, "yyyx", (0.35, 0.3, 0.1), (-60, 90, -30, 40), hand(0.15, 0.12, 0.015, 0.03), True),
    "rover_hook": (make_arm, "zzz", (0.3, 0.3), (50, -40, -20), hook(), True),
    "pair": (make_pair, "planar", planar([box(0.4, 0.1, 0.2)], 0.05), False),
    "pair_swap": (make_pair, "planar", planar([box(0.3, 0.15, 0.2)], 0.1), True),
    "pair_free": (make_pair, "free", straight([box(0.3, 0.1, 0.1)], 0.1, SQUARE, 0.1), False),
    "snake4": (make_snake, "planar", planar([box(0.2, 0.08, 0.2)], 0.05), 4, {"axis": (0, 0, 1), "range": radians(-120, 120)}, 35),
    "snake6_deep": (make_snake, "planar", planar([box(0.2, 0.08, 0.2)], 0.5), 6, {"axis": (0, 0, 1), "range": radians(-120, 120)}, 30),
    "snake3_ball": (make_snake, "space", straight([box(0.2, 0.1, 0.1)], 0.05, SQUARE, 0.1), 3, {"type": "ball"}, (0, 40, 20)),
    "snake5_ball": (make_snake, "free", straight([box(0.2, 0.1, 0.1)], 0.3, SQUARE, 0.1), 5, {"type": "ball"}, (0, 30, 15)),
    "screen": (make_snake, "free", plate(0.25, 0.3, 0.02, 0.05), 3, {"axis": (0, 1, 0), "range": radians(-150, 150)}, 70),
    "gripper": (make_gripper, "space", 0.2),
}

COMMENT = """
A narrow passage: {name}. Made by bench/passages/make.py; change that, not this.

Units: m, kg, s, rad. Where it is narrow the opening must be at least {least} m wide for the body to pass; it is {width} m, {share} times that.
"""


def write(name, folder, slack):
    make, *arguments = FAMILIES[name]
    scene, poses, least = make(name, slack, *arguments)
    scene.folder = folder
    scene.key("start", poses[0])
    scene.key("goal", poses[-1])
    scene.write(COMMENT.format(name=name, least=round(least, 6), width=round(least * (1 + slack), 6), share=round(1 + slack, 6)))
    lines = [text(scene.qpos("witness", pose).values()).replace(" ", ",") for pose in poses]
    (folder / f"{name}.witness.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(usage=argparse.SUPPRESS, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slack", type=float, default=0.03, help="by which openings are wider than what must pass, a share of that")
    parser.add_argument("--folder", type=Path, required=True, help="where they are written")
    parser.add_argument("--only", help="names of families, with commas")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for family in options.only.split(",") if options.only else FAMILIES:
        write(family, options.folder, options.slack)
