#!/usr/bin/env python3
"""Runs the commands of the documents again and holds what they show against what comes out; looks where links lead.

    docs/check.py [--program build/bin/mjcf-pdg] [--update] [FILE.md ...]     # default: README.md and docs/*.md

Commands are the lines that begin with "$ " in blocks marked ```console. They run with sh, in a folder where `models` and
`python` are the project's, `mjcf-pdg` is the program and earlier blocks of the same document have left their files.
Numbers may differ by 1 % or, if small, by 0.001 (compilers round differently), and the last column of a table headed `time ms` by anything;
`...` at the end of a line stands for the rest of it, alone on a line for lines that are left out. `# exit N` at the end of a command is its
exit code, 0 if nothing is said. Blocks marked ```console downloads need a network; docs/make_site.sh runs them. A block marked with a file name behind its language (```xml arm.xml) is that file. --update writes into the documents what came out; blocks with `...` are left as they are.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
OPTIONAL = ("plan", "view")  # pages of commands that a build may lack
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"^```\w+ ([\w.]+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def same_word(shown: str, now: str) -> bool:
    if shown == now:
        return True
    parts = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?")
    if parts.sub("#", shown) != parts.sub("#", now):
        return False
    pairs = zip(map(float, parts.findall(shown)), map(float, parts.findall(now)))
    return all(abs(a - b) <= max(0.01 * max(abs(a), abs(b)), 0.001) for a, b in pairs)


def same_line(shown: str, now: str, timed: bool) -> bool:
    a, b = shown.split(), now.split()
    if a and a[-1] == "...":
        a, b = a[:-1], b[: len(a) - 1]
    if timed and a and b and re.fullmatch(r"[\d.e+-]+", a[-1]):
        a, b = a[:-1], b[:-1]
    return len(a) == len(b) and all(map(same_word, a, b))


def same_text(shown: list[str], now: list[str]) -> bool:
    """Whether every line that is shown has come out, in order, with nothing between but for `...`."""
    timed, place, skipping = False, 0, False
    for line in shown:
        if line.strip() == "...":
            skipping = True
            continue
        timed = (timed or line.endswith("time ms")) and bool(line.strip())
        while skipping and place < len(now) and not same_line(line, now[place], timed):
            place += 1
        if place == len(now) or not same_line(line, now[place], timed):
            return False
        place, skipping = place + 1, False
    return skipping or place == len(now)


def run_block(block: str, folder: str, environment: dict) -> tuple[str, list[str]]:
    """The block with what its commands give now, and what is wrong with it."""
    text, faults = "", []
    lines = block.splitlines()
    while lines:
        command = lines.pop(0)
        if not command.startswith("$ "):
            return block, [f"not a command: {command}"]
        while command.endswith("\\") and lines:
            command += "\n" + lines.pop(0)
        shown = []
        while lines and not lines[0].startswith("$ "):
            shown.append(lines.pop(0))
        done = subprocess.run(["sh", "-c", command[2:]], cwd=folder, env=environment, text=True, timeout=300,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        now = [line.rstrip() for line in done.stdout.splitlines()]
        expected = re.search(r"# exit (\d+)$", command)
        if done.returncode != int(expected.group(1) if expected else 0):
            faults.append(f"exit code {done.returncode}: {command}\n" + "\n".join(now[-5:]))
        if not same_text(shown, now):
            faults.append("\n".join(["shown:", *shown, "comes out:", *now]))
        kept = any(line.rstrip().endswith("...") for line in shown)
        text += "\n".join([command, *(shown if kept else now)]) + "\n"
    return text, faults


def anchors(path: pathlib.Path) -> set[str]:
    """The headings of a document as GitHub names them in links."""
    headings = re.findall(r"^#+ (.*)$", path.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def bad_links(path: pathlib.Path) -> list[str]:
    bad = []
    for link in re.findall(r"\]\(([^)\s]+)\)", path.read_text()):
        name, _, anchor = link.partition("#")
        target = path.parent / name if name else path
        if not link.startswith("http") and not (target.exists() and (not anchor or anchor in anchors(target))):
            bad.append(link)
    return bad


def prepare(folder: pathlib.Path, program: pathlib.Path, document: str) -> dict:
    """Makes the folder in which the commands of a document run, and returns their environment."""
    for name, target in (("models", ROOT / "models"), ("python", ROOT / "python"), ("bin/mjcf-pdg", program)):
        link = folder / name
        link.parent.mkdir(exist_ok=True)
        link.symlink_to(target)
    for name, text in FILE.findall(document):
        (folder / name).write_text(text)
    return os.environ | {"PATH": f"{folder}/bin:{os.environ['PATH']}"}


def check(path: pathlib.Path, program: pathlib.Path, update: bool) -> int:
    document, faults = path.read_text(), 0
    for link in bad_links(path):
        print(f"{path.relative_to(ROOT)}: leads nowhere: {link}", file=sys.stderr)
        faults += 1
    with tempfile.TemporaryDirectory() as folder:
        environment = prepare(pathlib.Path(folder), program, document)

        def replace(match: re.Match) -> str:
            nonlocal faults
            text, wrong = run_block(match.group(1), folder, environment)
            place = f"{path.relative_to(ROOT)}:{document[:match.start()].count(chr(10)) + 1}"
            for words in wrong:
                print(f"{place}: {words}", file=sys.stderr)
            faults += len(wrong)
            return f"```console\n{text}```"

        changed = BLOCK.sub(replace, document)
    if update and changed != document:
        path.write_text(changed)
    print(f"{path.relative_to(ROOT)}: {len(BLOCK.findall(document))} blocks, {faults} faults")
    return faults


def lacks(program: pathlib.Path, command: str) -> bool:
    return subprocess.run([program, command, "--help"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode != 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/bin/mjcf-pdg")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("documents", nargs="*", type=pathlib.Path)
    arguments = parser.parse_args()
    documents = arguments.documents or [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    for path in list(documents):
        if path.stem in OPTIONAL and lacks(arguments.program, path.stem):
            print(f"{path}: skipped, the program was built without {path.stem}")
            documents.remove(path)
    return 1 if sum(check(path.resolve(), arguments.program.resolve(), arguments.update) for path in documents) else 0


if __name__ == "__main__":
    sys.exit(main())
