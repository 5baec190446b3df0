#!/usr/bin/env python3
"""What is each number of src/base/tuning.h worth? Halves and doubles each and solves the same problems again.

    python3 bench/sensitivity.py --build build                        # the project's own scenes
    python3 bench/sensitivity.py --build build --only descent my_robot.xml
    python3 bench/sensitivity.py --build build --json out.jsonl       # every number's runs, as lines

It builds solve_bench once more, in BUILD/sensitivity, with a tuning.h whose numbers come from the environment, and runs it
with one number changed at a time. A row tells, against the run with nothing changed (all but seconds the same on every
machine, however busy it is):

  ok       problems solved and verified, when that changes
  σ        mean over the problems of log(σ/σ of the unchanged run), in percent: above 0 is worse
  worse    problems whose σ is more than 1 % higher, and lower
  queries  sum over all problems, in percent
  lcp      sum of the steps of the LCP, in percent
"""
import argparse
import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TUNING = Path("base") / "tuning.h"
# Where a number acts decides the problems that are solved: hulls as they come, meshes as triangles, or method paper.
EXACT_MESHES = ("exact_meshes", "descent", "accuracy")
PAPER = ("paper", "bisection")
EXACT_SCENES = ["models/rigid/nut_on_bolt.xml", "models/rigid/ring_on_post.xml", "models/rigid/spoon_cup.xml"]

FROM_ENVIRONMENT = """
#include <cstdlib>
namespace mjcf_pdg::tuning {
inline double Tuned(const char* name, double value) {
  const char* given = std::getenv(name);
  return given ? std::atof(given) : value;
}
}  // namespace mjcf_pdg::tuning
"""


def code_of(header):
    """Without comments, a declaration a line."""
    return re.sub(r"(=|,)\n +", r"\1 ", re.sub(r"//[^\n]*", "", header))


def numbers(header):
    """{'namespace::kName': (type, text of its value)} of all scalars."""
    found = {}
    for space, body in re.findall(r"^namespace (\w+) \{\n(.*?)^\}", code_of(header), flags=re.S | re.M):
        for kind, declared in re.findall(r"inline constexpr ([\w:]+) ([^;\[]+);", body):
            for name, value in re.findall(r"(k\w+) = ([^,]+)", declared):
                found[f"{space}::{name}"] = (kind, value.strip())
    return found


def tunable(header):
    """The same header with every scalar taken from the environment, under the name namespace::kName."""
    out, space = [], ""
    for line in code_of(header).split("\n"):
        entered = re.match(r"namespace (\w+) \{", line)
        space = entered[1] if entered else space
        if "[]" not in line:
            line = line.replace("inline constexpr", "inline const")
            line = re.sub(r"(k[A-Z]\w*) = ([^,;]+)", lambda m: f'{m[1]} = Tuned("{space}::{m[1]}", {m[2]})', line)
        out.append(line)
    text = "\n".join(out)
    return text.replace("namespace mjcf_pdg::tuning {", FROM_ENVIRONMENT + "\nnamespace mjcf_pdg::tuning {", 1)


def build(like):
    """solve_bench with numbers from the environment."""
    folder = like / "sensitivity"
    header = folder / TUNING.name
    folder.mkdir(parents=True, exist_ok=True)
    text = tunable((ROOT / "src" / TUNING).read_text())
    if not header.exists() or header.read_text() != text:
        header.write_text(text)
    cache = (like / "CMakeCache.txt").read_text()
    kept = [f"-D{name}={value}" for name, value in
            re.findall(r"^(CMAKE_CXX_COMPILER|CMAKE_CXX_COMPILER_LAUNCHER|MJCF_PDG_CACHE_DIR):\w+=(.+)$", cache, flags=re.M)]
    # Included first, it keeps the tree's own header out by the include guard that both have.
    subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", "-DMJCF_PDG_BUILD_BENCH=ON",
                    f"-DCMAKE_CXX_FLAGS=-include {header}"] + kept, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", folder, "--parallel", str(os.cpu_count()), "--target", "solve_bench"], check=True, stdout=subprocess.DEVNULL)
    return folder / "bin" / "solve_bench"


def solve(binary, sets, changed):
    """The solves of all sets with the numbers of `changed` in the environment: [(status, verified, σ, queries, lcp)]."""
    solves = []
    for arguments in sets:
        out = binary.parent / f"solves.{os.getpid()}.jsonl"
        subprocess.run([binary, "--persistence", "0", "--json", out, *arguments], cwd=ROOT, check=True,
                       stdout=subprocess.DEVNULL, env=os.environ | changed)
        for line in out.read_text().splitlines():
            r = json.loads(line)
            solves.append((r["verified"], r["sigma"], r["collision_queries"], r["lcp_sweeps"]))
        out.unlink()
    return solves


def compare(before, after):
    ratios = [math.log(b[1] / a[1]) for a, b in zip(before, after) if a[0] and b[0] and a[1] > 0 and b[1] > 0]
    return {
        "ok": sum(b[0] for b in after) - sum(a[0] for a in before),
        "sigma": 100 * sum(ratios) / max(1, len(ratios)),
        "worse": sum(r > 0.01 for r in ratios),
        "better": sum(r < -0.01 for r in ratios),
        "queries": 100 * (sum(b[2] for b in after) / sum(a[2] for a in before) - 1),
        "lcp": 100 * (sum(b[3] for b in after) / max(1, sum(a[3] for a in before)) - 1),
    }


def values(kind, text):
    """Half and double of a number, as what the environment gets."""
    value = eval(text)  # our own header's arithmetic, such as 1.0 / 256.0
    if kind != "double":
        return [str(max(1, value // 2)), str(2 * value)]
    return [repr(0.5 * value), repr(2.0 * value)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", help="models besides the project's own three scenes")
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="a configured build, whose settings are taken")
    parser.add_argument("--count", type=int, default=60, help="random problems of each model")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="numbers whose namespace::kName contains this")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    binary = build(arguments.build.resolve())
    common = ["--count", str(arguments.count), "--seed", str(arguments.seed)]
    models = [str(Path(m).resolve()) for m in arguments.models]
    sets = {"hulls": [common, *([*common, model] for model in models)],
            "triangles": [[*common, "--exact-mesh", *EXACT_SCENES]],
            "paper": [["--count", str(arguments.count // 4), "--seed", str(arguments.seed), "--method", "paper"]]}
    unchanged = {name: solve(binary, of, {}) for name, of in sets.items()}
    for name, solves in unchanged.items():
        print(f"{name}: {len(solves)} problems, {sum(s[0] for s in solves)} solved, {sum(s[2] for s in solves)} queries, "
              f"{sum(s[3] for s in solves)} steps of the LCP")
    print(f"\n{'number':36} {'problems':9} {'value':>9} {'ok':>4} {'σ %':>7} {'worse':>5} {'better':>6} {'queries %':>9} {'lcp %':>7}")
    for name, (kind, text) in numbers((ROOT / "src" / TUNING).read_text()).items():
        space = name.split("::")[0]
        if arguments.only not in name or space == "budget":  # budgets of seconds do nothing without one
            continue
        kinds = ["paper"] if space in PAPER else ["triangles"] if space == "exact_meshes" else \
                ["hulls", "triangles"] if space in EXACT_MESHES else ["hulls"]
        for problems in kinds:
            for value in values(kind, text):
                row = compare(unchanged[problems], solve(binary, sets[problems], {name: value}))
                print(f"{name:36} {problems:9} {float(value):9.4g} {row['ok']:+4d} {row['sigma']:+7.2f} {row['worse']:5d} "
                      f"{row['better']:6d} {row['queries']:+9.1f} {row['lcp']:+7.1f}", flush=True)
                if arguments.json:
                    with arguments.json.open("a") as out:
                        out.write(json.dumps({"number": name, "problems": problems, "value": float(value), **row}) + "\n")


if __name__ == "__main__":
    sys.exit(main())
