#!/usr/bin/env python3
"""Draws the table of `rigid_tables_bench --parts triangles`, given on standard input, as a picture.

    build/bin/rigid_tables_bench --parts triangles | python3 bench/plot_triangle_cost.py docs/triangle_cost.png

Needs matplotlib (`pip install matplotlib==3.9.2`).
"""
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot

SERIES = {  # column of the table (triangle_cost.cc): legend, its unit in microseconds
    2: ("distance, 5 cm apart", 1),
    3: ("the same, after a query 1 mm away", 1),
    4: ("distance, 0.1 mm apart", 1),
    6: ("is it free? 0.1 mm apart", 1),
    7: ("does it overlap? 5 mm deep", 1),
    10: ("solve, effort fast", 1000),
}
DISTANCES = (2, 3, 4)


def main():
    rows = [line.split() for line in sys.stdin]
    rows = [row for row in rows if row and row[0].isdigit()]
    triangles = [int(row[0]) for row in rows]
    figure, (costs, distances) = pyplot.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for column, (label, unit) in SERIES.items():
        values = [unit * float(row[column]) for row in rows]
        costs.loglog(triangles, values, "o-", label=label)
        if column in DISTANCES:
            distances.semilogx(triangles, values, "o-")
    costs.set_title("Two torus knots, medians")
    distances.set_title("Linear scale: a straight line is logarithmic")
    for axes in (costs, distances):
        axes.set_xlabel("triangles of each mesh")
        axes.set_ylabel("µs")
        axes.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=3, fontsize=9)
    figure.savefig(sys.argv[1], dpi=110)


if __name__ == "__main__":
    main()
