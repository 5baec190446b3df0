#!/usr/bin/env python3
"""Do the tests see errors? Plants one small error at a time in a copy of the tree, builds it and runs the tests.

    cmake --build build --target mutation_test                          # or, with other numbers:
    python3 tests/mutations/run.py --build build --count 60 --seed 1    # --list only shows what would be planted

The errors are lexical and drawn by the seed: a sign flipped, a comparison or a logical operator swapped, a term, a factor
or a statement dropped, a loop one too short or too late, min for max; as many in each of the stages below. For each:

  killed     a test failed, crashed or ran out of time
  survived   all tests passed, but an answer of a fixed set of solves changed: a test is missing (or the answer is as good)
  no effect  all tests passed and every answer is the same to the bit: the same program, or code that these solves and the
             tests do not reach; counted apart, and shown as well
  no build   the compiler refuses it (warnings count if they are errors in BUILD); another one is drawn instead

Exit code 0 if at least --least (95 %) of those that change anything are killed. A run of 60 takes an hour or two of two
cores, most of it for errors that survive; ccache makes the first build quick.
"""
import argparse
import difflib
import os
import random
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]

# Stage of the pipeline: its folders below src/. Those of the same names below tests/ are run first.
STAGES = {
    "norm": ["norm"],
    "contacts": ["collide"],
    "CCDg": ["ccd"],
    "LCP": ["optimize"],
    "verifier": ["verify"],
    "search": ["search"],
}
# Tests of what the stages do not take part in.
UNCONCERNED = ["apps", "import", "mesh"]

# Of the copy, in it: a compiler cache that looks at relative paths then knows most of it already.
BUILD = "build"
# What the program is asked for, with every unmutated answer the reference.
SOLVES = [
    ["solve", "models/puma/puma_car.xml"],
    ["solve", "models/hand/hand_bottle.xml"],
    ["solve", "models/figure/figure_bench.xml"],
    ["solve", "models/puma/puma_car.xml", "--method", "paper"],
    ["solve", "models/rigid/nut_on_bolt.xml", "--exact-mesh"],
    ["solve", "models/rigid/ring_on_post.xml", "--exact-mesh"],
    ["solve", "models/rigid/spoon_cup.xml", "--exact-mesh", "--trajectory"],
]

SWAPS = {
    "sign": [("+", "-"), ("-", "+"), ("+=", "-="), ("-=", "+=")],
    "comparison": [("<", ">"), (">", "<"), ("<=", ">"), (">=", "<"), ("<", "<="), (">", ">="), ("==", "!="), ("!=", "=="),
                   ("&&", "||"), ("||", "&&")],
}
WORDS = {
    "min/max": [("std::min(", "std::max("), ("std::max(", "std::min("), ("minCoeff(", "maxCoeff("),
                ("maxCoeff(", "minCoeff("), ("cwiseMin(", "cwiseMax("), ("cwiseMax(", "cwiseMin(")],
    "sign": [("return -", "return "), ("= -", "= "), ("(-", "(")],
    "off by one": [(" = 0; ", " = 1; "), (" + 1", ""), (" - 1", "")],
}


class Mutation(NamedTuple):
    stage: str
    kind: str
    path: str  # below the root
    begin: int
    end: int
    text: str  # instead of what is from begin to end

    def apply(self, source):
        return source[:self.begin] + self.text + source[self.end:]


# ---- What can be planted ----

def code_only(source):
    """The same length, with blanks for comments, strings, preprocessor lines and static_asserts."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group())
    skipped = (r'//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|^\s*#(?:[^\n]*\\\n)*[^\n]*'
               r"|static_assert\([^;]*;|^template <[^\n]*")
    return re.sub(skipped, blank, source, flags=re.S | re.M)


def end_of_operand(code, begin, operators):
    """Where an operand ends that starts at `begin`: at one of these or a separator outside its own brackets."""
    depth = 0
    for i in range(begin, len(code)):
        c = code[i]
        if c in "([{":
            depth += 1
        elif c in ")]}":
            depth -= 1
            if depth < 0:
                return i
        elif depth == 0 and (c in ",;\n" or (c == " " and code[i + 1] in operators)):
            return i
    return len(code)


def candidates(code):
    """(kind, begin, end, replacement) of everything that can be planted; `code` as from code_only."""
    for kind, swaps in SWAPS.items():
        for old, new in swaps:  # clang-format puts blanks around binary operators, none into templates
            for match in re.finditer(r"(?<= )" + re.escape(old) + r"(?=[ \n])", code):
                yield kind, match.start(), match.end(), new
    for kind, swaps in WORDS.items():
        for old, new in swaps:
            for match in re.finditer(re.escape(old) + (r"\b" if old[-1] == "1" else ""), code):
                yield kind, match.start(), match.end(), new
    for match in re.finditer(r" ([-+*]) (?=\S)", code):
        end = end_of_operand(code, match.end(), "-+<>=!&|?:" + ("*/" if match[1] == "*" else ""))
        if code[end:end + 1] != "\n":
            yield "dropped", match.start(), end, ""
    for match in re.finditer(r"^ +[\w.\[\]()>-]+ [-+*/|&]?= [^\n;]*;$", code, flags=re.M):  # no declarations
        yield "dropped", match.start(), match.end(), ""
    for match in re.finditer(r"(\w+) < ([^;\n]+)(?=; \+\+\1\))", code):
        yield "off by one", match.start(), match.end(), f"{match[1]} + 1 < {match[2]}"


def draw(tree, seed):
    """All mutations there are, one after the other: stages in turn, kinds at random."""
    rng = random.Random(seed)
    pools = {}
    for stage, folders in STAGES.items():
        kinds = {}
        for folder in folders:
            for path in sorted((tree / "src" / folder).rglob("*.cc")):
                for kind, begin, end, text in candidates(code_only(path.read_text())):
                    mutation = Mutation(stage, kind, str(path.relative_to(tree)), begin, end, text)
                    kinds.setdefault(kind, []).append(mutation)
        for pool in kinds.values():
            rng.shuffle(pool)
        pools[stage] = kinds
    while any(pools.values()):
        for kinds in pools.values():
            if not kinds:
                continue
            kind = rng.choice(sorted(kinds))
            yield kinds[kind].pop()
            if not kinds[kind]:
                del kinds[kind]


# ---- The private copy ----

def copy_tree(tree):
    """Files that git knows or would; those that are the same keep their times, so that a second run builds little."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                            capture_output=True, check=True).stdout.decode().split("\0")
    wanted = {name for name in listed if name and (ROOT / name).is_file()}
    for old in [p for p in tree.rglob("*") if p.is_file() and not p.is_relative_to(tree / BUILD)]:
        if str(old.relative_to(tree)) not in wanted:
            old.unlink()
    for name in wanted:
        source, target = ROOT / name, tree / name
        if target.exists() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)


def cached(build, *names):
    """-D arguments that repeat what an earlier configure found."""
    cache = (build / "CMakeCache.txt").read_text()
    found = [re.search(rf"^{name}:\w+=(.+)$", cache, flags=re.M) for name in names]
    return [f"-D{name}={match[1]}" for name, match in zip(names, found) if match]


class Copy:
    def __init__(self, work, like, jobs):
        self.tree, self.build, self.jobs = work, work / BUILD, jobs
        copy_tree(self.tree)
        subprocess.run(["cmake", "-S", self.tree, "-B", self.build, "-DMJCF_PDG_BUILD_BENCH=OFF", "-DMJCF_PDG_RENDER=OFF",
                        "-DMJCF_PDG_INSTALL=OFF",
                        "-DCMAKE_CXX_FLAGS=-D_GLIBCXX_ASSERTIONS"]  # as for the presets debug and sanitize: no reading past an end
                       + cached(like, "CMAKE_BUILD_TYPE", "CMAKE_CXX_COMPILER", "CMAKE_CXX_COMPILER_LAUNCHER",
                                "MJCF_PDG_WERROR", "MuJoCo_ROOT", "mujoco_DIR", "MJCF_PDG_CACHE_DIR"),
                       check=True, stdout=subprocess.DEVNULL)

    def make(self):
        """The end of what the compiler says if it refuses, else None."""
        run = subprocess.run(["cmake", "--build", self.build, "--parallel", str(self.jobs), "--target", "mjcf_pdg_tests"],
                             capture_output=True, text=True)
        return None if run.returncode == 0 else (run.stdout + run.stderr)[-2000:]

    def suites(self, folders):
        """Names of the test suites below tests/`folder`."""
        found = set()
        for folder in folders:
            for path in (self.tree / "tests" / folder).rglob("*_test.cc"):
                found |= set(re.findall(r"^(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),", path.read_text(), flags=re.M))
        return sorted(found)

    def test(self, suites, limit):
        """The first failure in words, or None. Shards run side by side until one fails."""
        names = ":".join(f"{suite}.*:*/{suite}.*:{suite}/*" for suite in suites)
        command = [self.build / "mjcf_pdg_tests", "--gtest_fail_fast", "--gtest_filter=" + names]
        logs = [self.build / f"shard{k}.log" for k in range(self.jobs)]
        shards = []
        for k, log in enumerate(logs):
            environment = os.environ | {"GTEST_TOTAL_SHARDS": str(self.jobs), "GTEST_SHARD_INDEX": str(k)}
            shards.append(subprocess.Popen(command, cwd=self.build, env=environment, stdin=subprocess.DEVNULL,
                                           stdout=log.open("w"), stderr=subprocess.STDOUT))
        failure, end = None, time.monotonic() + limit
        while failure is None and any(shard.poll() is None for shard in shards):
            time.sleep(0.05)
            if time.monotonic() > end:
                failure = "out of time"
            for shard, log in zip(shards, logs):
                if shard.poll():
                    failure = self.first_failure(log, shard.returncode)
        for shard, log in zip(shards, logs):
            if shard.poll() is None:
                shard.kill()
                shard.wait()
            elif shard.returncode != 0 and failure is None:
                failure = self.first_failure(log, shard.returncode)
        return failure

    @staticmethod
    def first_failure(log, code):
        text = log.read_text(errors="replace")
        failed, started = re.findall(r"\[  FAILED  \] (\S+)", text), re.findall(r"\[ RUN      \] (\S+)", text)
        return failed[0] if failed else f"exit code {code} in {started[-1] if started else 'start-up'}"

    def answers(self, limit):
        """What the program says to SOLVES, times aside; each line as text."""
        lines = []
        for arguments in SOLVES:
            try:
                run = subprocess.run([self.build / "bin" / "mjcf-pdg", *arguments, "--json", "-"], cwd=self.tree,
                                     capture_output=True, text=True, timeout=limit)
            except subprocess.TimeoutExpired:
                return ["out of time"]
            lines.append(f"exit {run.returncode}")
            lines += [re.sub(r'"time_us":[^,}]*', "", line) for line in run.stdout.splitlines()]
        return lines


# ---- The run ----

def judge(copy, mutation, reference):
    """(verdict, detail) of a mutation that is planted and built."""
    own = copy.suites(STAGES[mutation.stage])
    failure = copy.test(own, reference["limit"]) or copy.test(
        [suite for suite in reference["suites"] if suite not in own], reference["limit"])
    if failure:
        return "killed", failure
    same = copy.answers(reference["limit"]) == reference["answers"]
    return ("no effect", "") if same else ("survived", "an answer changed")


def try_mutation(copy, mutation, reference):
    path = copy.tree / mutation.path
    source = path.read_text()
    path.write_text(mutation.apply(source))
    try:
        if copy.make() is not None:
            return "no build", ""
        return judge(copy, mutation, reference)
    finally:
        path.write_text(source)


def difference(tree, mutation):
    before = (tree / mutation.path).read_text()
    lines = difflib.unified_diff(before.splitlines(), mutation.apply(before).splitlines(), mutation.path, mutation.path, "", "",
                                 2, "")
    return "\n".join(lines)


def where(tree, mutation):
    line = (tree / mutation.path).read_text().count("\n", 0, mutation.begin) + 1
    return f"{mutation.path}:{line} ({mutation.stage}: {mutation.kind})"


def take_reference(copy):
    """Unmutated everything passes; how long that takes bounds what is mutated."""
    refusal = copy.make()
    if refusal:
        sys.exit("The tree does not build:\n" + refusal)
    folders = [p.name for p in (copy.tree / "tests").iterdir() if p.is_dir() and p.name not in UNCONCERNED]
    suites, begin = copy.suites(folders), time.monotonic()
    failure = copy.test(suites, 3600.0)
    if failure:
        sys.exit(f"Without any mutation {failure} fails: nothing can be measured.")
    answers = copy.answers(3600.0)
    seconds = time.monotonic() - begin
    print(f"{len(suites)} suites pass in {seconds:.0f} s, {len(answers)} lines of answers", flush=True)
    return {"suites": suites, "answers": answers, "limit": 60.0 + 5.0 * seconds}


def report(tree, results, least):
    for verdict in ("survived", "no effect"):
        for mutation in results[verdict]:
            print(f"\n{verdict}: {where(tree, mutation)}\n{difference(tree, mutation)}")
    killed, survived = len(results["killed"]), len(results["survived"])
    share = killed / max(1, killed + survived)
    print(f"\nkilled {killed}, survived {survived}, no effect {len(results['no effect'])}, "
          f"not built {len(results['no build'])}: {100 * share:.1f} % of those that change anything are seen")
    return 0 if killed and share >= least else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="a configured build, whose settings are taken")
    parser.add_argument("--work", type=Path, help="where the copy is kept (BUILD/mutations)")
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--least", type=float, default=0.95, help="share that must be killed")
    parser.add_argument("--list", action="store_true", help="show the mutations and plant none")
    arguments = parser.parse_args()

    if arguments.list:
        for _, mutation in zip(range(arguments.count), draw(ROOT, arguments.seed)):
            print(f"{where(ROOT, mutation)}\n{difference(ROOT, mutation)}\n")
        return 0
    copy = Copy((arguments.work or arguments.build / "mutations").resolve(), arguments.build, arguments.jobs)
    reference = take_reference(copy)
    results = {verdict: [] for verdict in ("killed", "survived", "no effect", "no build")}
    done = 0
    for mutation in draw(copy.tree, arguments.seed):
        if done == arguments.count:
            break
        begin = time.monotonic()
        verdict, detail = try_mutation(copy, mutation, reference)
        results[verdict].append(mutation)
        done += verdict != "no build"
        print(f"[{done}/{arguments.count}] {verdict:9} {where(copy.tree, mutation)} {detail} {time.monotonic() - begin:.0f} s", flush=True)
    return report(copy.tree, results, arguments.least)


if __name__ == "__main__":
    sys.exit(main())
