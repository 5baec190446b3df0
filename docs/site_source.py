#!/usr/bin/env python3
"""Copies the documents to build/site-source as the site's generator wants them, with the reports of docs/gallery.md.

    docs/site_source.py [--program build/bin/mjcf-pdg] [--update]

Folders stay as they are, so that links lead where they led. The commands of the gallery are run as docs/check.py runs them; under
each block come links to its report and its motion. Pictures of poses are drawn by solve --png, motions by --animation, a path's
picture in the report, where there is a headless Chromium. --update renews the pictures in docs/gallery/, where README.md and readers of the repository see them.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import check
from latex2mathml.converter import convert

ROOT = pathlib.Path(__file__).resolve().parents[1]
SOURCE = ROOT / "build/site-source"
GALLERY = "docs/gallery"  # of pictures and reports
GALLERY_LINK = "gallery/"  # to there, from docs/gallery.md
# Blocks with commands; those marked `downloads` are run here alone, as they need a network, which making the site needs anyway.
BLOCK = re.compile(r"^```console(?: downloads)?\n(.*?)^```$", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\]\(([^)\s#]+)")
CODE = re.compile(r"(^```.*?^```$|`[^`\n]*`)", re.DOTALL | re.MULTILINE)
SIZE = (1280, 800)  # pixels of a picture of a report


def pages_and_files() -> list[pathlib.Path]:
    """README.md, and whatever it leads to from page to page, relative to the root."""
    found, ahead = [], [pathlib.Path("README.md")]
    while ahead:
        path = ahead.pop()
        if path in found:
            continue
        found.append(path)
        if path.suffix == ".md":
            links = [link for link in LINK.findall((ROOT / path).read_text()) if not link.startswith("http")]
            ahead += [pathlib.Path(os.path.normpath(path.parent / link)) for link in links]
    return sorted(found)


def with_mathml(text: str) -> str:
    """$...$ and $$...$$ outside of code become MathML, which browsers draw themselves."""
    parts = CODE.split(text)
    for k in range(0, len(parts), 2):
        parts[k] = re.sub(r"\$\$(.+?)\$\$", lambda match: convert(match[1], display="block"), parts[k], flags=re.DOTALL)
        # A line that began with <math> would be a block of its own.
        parts[k] = re.sub(r"\$([^$\n]+)\$", lambda match: f"<span>{convert(match[1])}</span>", parts[k])
    return "".join(parts)


def page(text: str) -> str:
    named = re.sub(r"^```(\w+) ([\w.]+)$", r'```\1 title="\2"', text, flags=re.MULTILINE)
    return with_mathml(named)


def photograph(report: pathlib.Path, picture: pathlib.Path) -> None:
    chromium = os.environ.get("MJCF_PDG_CHROMIUM") or shutil.which("chromium-headless-shell") or shutil.which("chromium")
    if not chromium:
        return
    flags = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars"]
    subprocess.run([chromium, *flags, f"--screenshot={picture}", f"--window-size={SIZE[0]},{SIZE[1]}",
                    "--virtual-time-budget=10000", f"file://{report}#frame=50%"], check=True, capture_output=True, timeout=120)


def gallery(text: str, program: pathlib.Path) -> str:
    """The page of the gallery with what its commands wrote, which is put beside it."""
    draws = "--png" in subprocess.run([program, "solve", "--help"], capture_output=True, text=True, check=True).stdout
    target = SOURCE / GALLERY
    target.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        environment = check.prepare(folder, program, text) | {"PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_ROOT_USER_ACTION": "ignore"}

        def run(match: re.Match) -> str:
            before = set(folder.iterdir())
            block = match[1]
            if draws:
                png = "" if "--trajectory" in block else r" --png \2.png"
                block = re.sub(r"( solve [^$]* --html )(\w+)\.html", rf"\1\2.html --animation \2.gif{png}", block)
                block = re.sub(r"( plan .* --html )(\w+)\.html", r"\1\2.html --animation \2.gif", block)
            _, faults = check.run_block(block, name, environment)
            if faults:
                sys.exit("\n".join(["docs/gallery.md:", *faults]))
            shown = match[0]
            for report in sorted(set(folder.glob("*.html")) - before):
                picture, motion = report.with_suffix(".png"), report.with_suffix(".gif")
                if f"{GALLERY_LINK}{picture.name}" in text and not picture.exists():
                    photograph(report, picture)
                for made in (report, picture, motion):
                    if made.exists():
                        shutil.copy(made, target)
                shown += f"\n\n[Open its report]({GALLERY_LINK}{report.name})"
                if motion.exists() and f"{GALLERY_LINK}{motion.name}" not in text:
                    shown += f", [see its motion]({GALLERY_LINK}{motion.name})"
            return shown

        return BLOCK.sub(run, text).replace("```console downloads", "```console")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/bin/mjcf-pdg")
    parser.add_argument("--update", action="store_true")
    arguments = parser.parse_args()
    shutil.rmtree(SOURCE, ignore_errors=True)
    for path in pages_and_files():
        (SOURCE / path).parent.mkdir(parents=True, exist_ok=True)
        if path.suffix != ".md":
            shutil.copy(ROOT / path, SOURCE / path)
            continue
        text = (ROOT / path).read_text()
        if path.name == "gallery.md":
            text = gallery(text, arguments.program.resolve())
        (SOURCE / path).write_text(page(text))
    if arguments.update:
        for picture in (ROOT / GALLERY).iterdir():
            shutil.copy(SOURCE / GALLERY / picture.name, picture)


if __name__ == "__main__":
    main()
