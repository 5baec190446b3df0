"""Reports of every command, and a browser that looks at them."""

import io
import json
import os
import pathlib
import subprocess

import pytest
from PIL import Image, ImageChops, ImageStat
from playwright.sync_api import Page, sync_playwright

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["MJCF_PDG_CLI"]
PLUGINS = next(pathlib.Path(os.environ.get("MuJoCo_ROOT", ROOT / "build/_mujoco")).glob("**/libsdf_plugin.so")).parent
SCREENSHOTS = pathlib.Path(os.environ["MJCF_PDG_SCREENSHOTS"])
SIZES = {"desk": (1280, 960), "phone": (390, 844)}

# What Chromium says of its own software renderer is no fault of a page.
RENDERER = "GPU stall due to ReadPixels"

BALL_AND_WALL = """<mujoco><worldbody>
  <geom name="wall" type="box" size="1 1 .1"/>
  <body name="ball" pos="0 0 .15">
    <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>
    <geom name="sphere" size=".1"/>
  </body></worldbody></mujoco>"""


# What is seen does not collide, and what collides is not seen: as in most robots' models.
SHELL_AND_PADS = """<mujoco><worldbody>
  <geom name="floor" type="plane" size="2 2 .1"/>
  <body name="foot" pos="0 0 .09">
    <freejoint/>
    <geom name="shell" type="box" size=".2 .1 .1" contype="0" conaffinity="0" rgba="0 .6 0 1"/>
    <geom name="front" type="sphere" size=".05" pos=".15 0 -.05" group="3"/>
    <geom name="back" type="sphere" size=".05" pos="-.15 0 -.05" group="3"/>
  </body></worldbody></mujoco>"""


# What is seen is large, and what collides is small, as the feet of some humanoids.
TOES = """<mujoco><worldbody>
  <geom name="floor" type="plane" size="2 2 .1" rgba=".5 .5 .5 1"/>
  <body pos="0 0 .1"><freejoint/>
    <geom type="box" size=".2 .1 .1" contype="0" conaffinity="0" rgba=".5 .5 .5 1"/>
    <geom name="toe" type="sphere" size=".01" pos=".15 0 -.1" group="3"/>
  </body></worldbody></mujoco>"""


# A rod that fits nowhere between floor and roof.
CAGE = """<mujoco><worldbody>
  <geom name="floor" type="box" size="1 1 .5"/><geom name="roof" type="box" size="1 1 .5" pos="0 0 1.15"/>
  <body name="rod" pos="0 0 .57">
    <joint name="h" type="hinge" axis="0 1 0" range="-10 10"/><joint name="z" type="slide" axis="0 0 1" range="-.2 .2"/>
    <geom name="rod" size=".1"/><geom type="capsule" size=".02 .1" euler="0 90 0"/>
  </body></worldbody></mujoco>"""


# A ball in a room: from each side a wall is before it.
ROOM = """<mujoco><worldbody>
  <geom type="box" size="1 .02 1.5" pos="0 -1 .5"/><geom type="box" size="1 .02 1.5" pos="0 1 .5"/>
  <geom type="box" size=".02 1 1.5" pos="-1 0 .5"/><geom type="box" size=".02 1 1.5" pos="1 0 .5"/>
  <body pos="0 0 .1">
    <joint type="slide" axis="0 1 0" range="-.5 .5" limited="true"/><geom name="ball" size=".1"/>
  </body></worldbody></mujoco>"""


def run(folder: pathlib.Path, *arguments: str, exits: int) -> None:
    done = subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == exits, done.stderr


@pytest.fixture(scope="session")
def reports(tmp_path_factory) -> dict[str, pathlib.Path]:
    """A report by name, made when it is asked for."""
    folder = tmp_path_factory.mktemp("reports")
    (folder / "models").symlink_to(ROOT / "models")
    (folder / "ball.xml").write_text(BALL_AND_WALL)
    (folder / "ball_in_wall.xml").write_text(BALL_AND_WALL.replace('size="1 1 .1"', 'size=".3 .3 .1" rgba=".5 .5 .5 1"').replace(
        'name="x" type', 'name="x" limited="true" range="-1 1" type').replace('name="z" type', 'name="z" limited="true" range="-1 1" type'))
    (folder / "many.csv").write_text("".join(f"{k % 50 / 100} {-k % 7 / 100}\n" for k in range(3000)))
    (folder / "clip.csv").write_text("".join(f"{k / 100} -.0{k}\n" for k in range(6)))
    options = {"armature": 0.5, "tolerance": 1e-5, "movable": ["ball"], "allow": [["sphere", "wall", 0.002]], "exact_mesh": False}
    (folder / "suite.json").write_text(json.dumps({"version": 1, "options": {"armature": 2}, "cases": [
        {"model": "ball.xml", "configurations": ["qpos0", {"random": 5, "seed": 1}], "options": options},
        {"model": "models/loops/leg.xml"}]}))
    # A golden result that is nearer than any answer, a regression, and one of a model that is gone.
    (folder / "suite.golden.json").write_text(json.dumps({"version": 1, "rows": [
        {"model": "ball.xml", "row": "qpos0", "status": "solved", "sigma": 1e-6, "queries": 1},
        {"model": "gone.xml", "row": "qpos0", "status": "solved", "sigma": 1e-6, "queries": 1}]}))
    (folder / "shell.xml").write_text(SHELL_AND_PADS)
    (folder / "cage.xml").write_text(CAGE)
    (folder / "room.xml").write_text(ROOM)
    (folder / "toes.xml").write_text(TOES)
    # Row 0 as golden, row 1 worse, row 2 of another model new and not to be solved.
    (folder / "two.csv").write_text("0 0\n0 -.05\n")
    (folder / "one.csv").write_text("0.1 0.02\n")
    cases = [{"model": "ball.xml", "configurations": [{"file": "two.csv"}]}, {"model": "cage.xml", "configurations": [{"file": "one.csv"}]}]
    (folder / "worse.json").write_text(json.dumps({"version": 1, "cases": cases}))
    golden = [{"model": "ball.xml", "row": f"two.csv row {row}", "status": "solved", "sigma": sigma, "queries": 99} for row, sigma in ((0, 0.04), (1, 1e-6))]
    (folder / "worse.golden.json").write_text(json.dumps({"version": 1, "rows": golden}))
    (folder / "sinks.csv").write_text("".join(f"0.1 {z}\n" for z in (0, 0.01, 0.02)))
    (folder / "more.json").write_text(json.dumps({"version": 1, "cases": [{"model": "ball.xml", "configurations": ["qpos0"]}]}))
    puma, zeros = "models/puma/puma_car.xml", "0 0 0 0 0 0 0 0 0"
    commands = {
        "solve": (["solve", puma], 0),
        "check": (["check", "models/hand/hand_bottle.xml", "--key", "home", "--key", "tight_grasp"], 3),
        "motion": (["check", puma, "--motion", "--from", zeros, "--to", "1" + zeros[1:]], 3),
        "audit": (["audit", "models/figure/figure_bench.xml", "--samples", "50"], 3),
        "regress": (["regress", "suite.json"], 3),
        "plan": (["plan", "models/placement/placement.xml", "--start", "start", "--goal", "goal"], 0),
        "hidden": (["check", "shell.xml"], 3),
        "displacement": (["solve", "ball.xml", "--qpos", "0 0", "--metric", "displacement"], 0),
        "inside": (["plan", "ball_in_wall.xml", "--start", "0 -.15", "--goal", "0 .3"], 0),
        "inside_at_last": (["plan", "ball_in_wall.xml", "--start", "0 .3", "--goal", "0 -.15"], 0),
        "motion_from_inside": (["check", "ball.xml", "--motion", "--from", "0 -.05", "--to", ".9 .8"], 3),
        "motion_to_limit": (["check", puma, "--motion", "--from", zeros, "--to", zeros[:-1] + "9"], 3),
        "in_a_room": (["plan", "room.xml", "--start", "-.3", "--goal", ".3"], 0),
        "worse": (["regress", "worse.json"], 3),
        "toes": (["check", "toes.xml"], 3),
        "two_suites": (["regress", "suite.json", "more.json", "--plugin-dir", str(PLUGINS)], 3),
        "sinks": (["solve", "cage.xml", "--qpos-file", "sinks.csv", "--trajectory"], 3),
        "stuck": (["solve", "cage.xml", "--qpos", "0.1 0.02"], 3),
        "touching": (["check", "ball_in_wall.xml", "--qpos", "0 -.15"], 3),
        "clip": (["solve", "ball.xml", "--qpos-file", "clip.csv", "--trajectory"], 0),
        "many": (["solve", "ball.xml", "--qpos-file", "many.csv", "--threads", "2"], 0),
    }

    class Reports(dict):
        def __missing__(self, name: str) -> pathlib.Path:
            arguments, exits = commands[name]
            run(folder, *arguments, "--html", f"{name}.html", exits=exits)
            self[name] = folder / f"{name}.html"
            return self[name]

    return Reports()


@pytest.fixture(scope="session")
def browser():
    arguments = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=os.environ["MJCF_PDG_CHROMIUM"], args=arguments)
        yield chromium
        chromium.close()


class Reader:
    """Somebody who reads a report."""

    def __init__(self, page: Page, name: str):
        self.page, self.name = page, name
        self.faults: list[str] = []
        page.on("console", lambda message: message.type in ("error", "warning") and self.note(message.text))
        page.on("pageerror", lambda error: self.note(str(error)))
        page.on("request", lambda request: request.url.startswith(("file:", "data:", "blob:", "about:")) or self.note(request.url))

    def note(self, words: str) -> None:
        if RENDERER not in words:
            self.faults.append(words)

    def settle(self) -> None:
        """Waits until what was asked for is drawn."""
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def scene(self) -> bytes:
        self.page.evaluate("scrollTo(0, 0)")
        self.settle()
        return self.page.locator("#canvas").screenshot()

    def screenshot(self, of: str) -> None:
        self.settle()
        SCREENSHOTS.mkdir(exist_ok=True)
        self.page.screenshot(path=SCREENSHOTS / f"{self.name}-{of}.png")

    def texts(self, selector: str) -> list[str]:
        return self.page.locator(selector).all_inner_texts()


@pytest.fixture
def open_report(browser, reports):
    """open_report(name, size): a reader for whom it is open; at the end nothing must have gone wrong."""
    readers = []

    def open_one(name: str, size: str = "desk") -> Reader:
        width, height = SIZES[size]
        page = browser.new_page(viewport={"width": width, "height": height})
        reader = Reader(page, f"{name}-{size}")
        readers.append(reader)
        page.goto(f"file://{reports[name]}")
        page.wait_for_selector("body[data-ready]")
        return reader

    yield open_one
    for reader in readers:
        assert reader.faults == []
        reader.page.close()


def alike(first: bytes, second: bytes) -> bool:
    """Whether two pictures differ by no more than where the browser rounds half pixels; another view differs by 10 and more."""
    difference = ImageChops.difference(*(Image.open(io.BytesIO(one)).convert("L") for one in (first, second)))
    return ImageStat.Stat(difference).mean[0] < 3


def facts(reader) -> dict[str, str]:
    return dict(line.split("\t") for line in reader.texts("#facts tr"))


def skip_what_is_not_built(name: str) -> None:
    if name == "plan" and " plan " not in subprocess.run([PROGRAM, "--help"], capture_output=True, text=True).stdout:
        pytest.skip("a build without OMPL has no plan")


def choose(reader, row: int) -> None:
    reader.page.click(f"#rows tr[data-index='{row}']")
    reader.page.wait_for_function(f"document.body.dataset.row === '{row}'")
