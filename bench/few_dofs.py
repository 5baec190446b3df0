#!/usr/bin/env python3
"""Problems of one to three degrees of freedom: how often effort max proves its answer, and what default misses.

    pip install . && python3 bench/few_dofs.py --count 200 --seed 1

Random bodies of two geoms a link, on slides, hinges or a ball, among eight fixed geoms. With so few degrees of freedom
effort max looks at all of joint space (src/bound/joint_boxes.h), so that its σ is the least there is where the bracket
is closed. What is printed, by kind of joints: inputs that penetrate and are solved; of these, how many brackets are
closed to 1 % and 5 %; queries, median and most; and σ of efforts fast and default over that of max, p95 and worst.
"""

import argparse
import math
import random
import statistics

import mjcf_pdg
import mujoco

SLIDES = [f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1")]
TYPES = ("sphere", "capsule", "box", "cylinder", "ellipsoid")


def numbers(values):
    return " ".join(f"{value:.9g}" for value in values)


def geom(draw, size, spread):
    sizes = [size * draw.uniform(0.5, 1.5) for _ in range(3)]
    place = [draw.uniform(-spread, spread) for _ in range(3)]
    turn = [draw.gauss(0, 1) for _ in range(4)]
    return f'<geom type="{draw.choice(TYPES)}" size="{numbers(sizes)}" pos="{numbers(place)}" quat="{numbers(turn)}"/>'


def chain(draw, joints_of_links):
    opened = ""
    for joints in joints_of_links:
        place = [draw.uniform(-0.2, 0.2) for _ in range(3)]
        opened += f'<body pos="{numbers(place)}">{joints}{geom(draw, 0.1, 0.1)}{geom(draw, 0.1, 0.1)}'
    return opened + "</body>" * len(joints_of_links)


def hinge(draw, attributes=""):
    return f'<joint axis="{numbers([draw.gauss(0, 1) for _ in range(3)])}" {attributes}/>'


KINDS = {
    "slide": lambda draw: [SLIDES[0]],
    "slide, hinge": lambda draw: [SLIDES[2] + hinge(draw)],
    "two hinges": lambda draw: [hinge(draw), hinge(draw, 'range="-1.5 2" limited="true"')],
    "three slides": lambda draw: ["".join(SLIDES)],
    "two slides, hinge": lambda draw: [SLIDES[0] + SLIDES[1] + hinge(draw)],
    "three hinges": lambda draw: [hinge(draw), hinge(draw), hinge(draw, 'range="-1.5 2" limited="true"')],
    "ball": lambda draw: ['<joint type="ball"/>'],
}


def model(draw, kind):
    fixed = "".join(geom(draw, 0.1, 0.5) for _ in range(8))
    moving = chain(draw, KINDS[kind](draw))
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><worldbody>{fixed}{moving}</worldbody></mujoco>'
    )


def measure(kind, count, seed):
    draw = random.Random(f"{seed} {kind}")
    closed, queries, ratios = [], [], {"fast": [], "default": []}
    for _ in range(count):
        scene = model(draw, kind)
        best = mjcf_pdg.solve(scene, scene.qpos0, effort="max")
        if best.status != "solved":
            continue
        closed.append(best.sigma / best.sigma_lower_bound if best.sigma_lower_bound > 0 else math.inf)
        queries.append(best.queries)
        for effort, values in ratios.items():
            other = mjcf_pdg.solve(scene, scene.qpos0, effort=effort)
            values.append(other.sigma / best.sigma if other.status == "solved" else math.inf)
    within = [sum(ratio <= limit for ratio in closed) for limit in (1.01, 1.05)]
    line = f"{kind:18} {len(closed):6} {within[0]:5} {within[1]:5} {statistics.median(queries):8.0f} {max(queries):8}"
    for values in ratios.values():
        values.sort()
        line += f" {values[math.ceil(0.95 * len(values)) - 1]:7.3f} {values[-1]:7.3f}"
    print(line, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100, help="models of each kind")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print(f"{'joints':18} solved  1 %   5 %  queries     most    fast           default")
    for kind in KINDS:
        measure(kind, arguments.count, arguments.seed)


if __name__ == "__main__":
    main()
