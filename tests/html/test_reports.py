"""Reports in a browser: every control does what it says, on a desk and on a phone, and nothing is loaded or complained of."""

import hashlib
import io
import itertools
import json
import shlex
import subprocess
from collections import Counter

import pytest
from conftest import PROGRAM, ROOT, SIZES
from PIL import Image, ImageChops, ImageStat

COMMANDS = ["solve", "check", "motion", "audit", "regress", "plan"]


def alike(first: bytes, second: bytes) -> bool:
    """Whether two pictures differ by no more than where the browser rounds half pixels; another view differs by 10 and more."""
    difference = ImageChops.difference(*(Image.open(io.BytesIO(one)).convert("L") for one in (first, second)))
    return ImageStat.Stat(difference).mean[0] < 3


def answer(reports, command: str) -> str:
    """What a command of a page says, run where the reports were made."""
    assert command.startswith("mjcf-pdg ")
    folder = next(iter(reports.values())).parent
    command = command.replace("mjcf-pdg", shlex.quote(PROGRAM), 1)
    return subprocess.run(["sh", "-c", command], cwd=folder, capture_output=True, text=True, timeout=120).stdout


def facts(reader) -> dict[str, str]:
    return dict(line.split("\t") for line in reader.texts("#facts tr"))


def alike_numbers(shown: str, value: float) -> bool:
    return float(shown) == pytest.approx(value, rel=1e-3, abs=1e-300)  # four digits


def skip_what_is_not_built(name: str) -> None:
    if name == "plan" and " plan " not in subprocess.run([PROGRAM, "--help"], capture_output=True, text=True).stdout:
        pytest.skip("a build without OMPL has no plan")


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", COMMANDS)
def test_a_report_opens_and_fits(open_report, name, size):
    skip_what_is_not_built(name)
    reader = open_report(name, size)
    reader.screenshot("opened")
    assert reader.page.inner_text("#title")
    assert reader.page.evaluate("document.documentElement.scrollWidth") == SIZES[size][0]
    assert len(set(Image.open(io.BytesIO(reader.scene())).convert("RGB").getdata())) > 50  # something is drawn
    assert reader.texts("#facts tr")
    assert reader.page.inner_text("#command").startswith("mjcf-pdg ")
    assert "MuJoCo" in reader.page.inner_text("#versions")


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["solve", "motion", "plan"])
def test_the_slider_goes_from_what_was_given_to_the_end(open_report, name, size):
    skip_what_is_not_built(name)
    reader = open_report(name, size)
    end, words, moved = reader.scene(), reader.page.inner_text("#frame"), reader.texts("#joints tr")
    reader.page.focus("#slider")
    reader.page.keyboard.press("Home")
    given = reader.scene()
    assert given != end
    assert reader.page.inner_text("#frame") != words
    assert reader.page.get_attribute("#slider", "aria-valuetext") == reader.page.inner_text("#frame")
    assert reader.texts("#joints tr") != moved
    reader.page.keyboard.press("ArrowRight")
    assert reader.page.input_value("#slider") == "1"
    reader.page.keyboard.press("End")
    assert reader.page.inner_text("#frame") == words
    assert reader.texts("#joints tr") == moved
    assert reader.scene() == end


def test_an_iteration_of_the_plot_leads_to_its_place(open_report):
    reader = open_report("solve")
    reader.page.locator("#sigma .reachable").first.click(force=True)
    assert "step" in reader.page.inner_text("#frame")
    assert reader.page.get_attribute("#sigma .shown", "visibility") == "visible"
    reader.screenshot("iteration")


def choose(reader, row: int) -> None:
    reader.page.click(f"#rows tr[data-index='{row}']")
    reader.page.wait_for_function(f"document.body.dataset.row === '{row}'")


def heights(reader) -> list[float]:
    """How high the line of each joint is where the slider is, the second number of a point counting downwards."""
    place = int(reader.page.input_value("#slider"))
    lines = reader.page.locator("#joint-lines .joint").evaluate_all("lines => lines.map((line) => line.getAttribute('points'))")
    return [-float(line.split()[place].split(",")[1]) for line in lines]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["solve", "motion", "plan"])
def test_lines_of_joints_follow_their_sigma_along_the_slider(open_report, name, size):
    skip_what_is_not_built(name)
    reader = open_report(name, size)
    page = reader.page
    if name == "solve":
        choose(reader, 8)  # nine joints move
    names = reader.texts("#joint-names span")
    assert 1 <= len(names) <= 5 and names == reader.texts("#joints tr td:first-child")[: len(names)]
    page.focus("#slider")
    for _ in range(3):
        sigma = [float(cell) for cell in reader.texts("#joints tr td:nth-child(3)")][: len(names)]
        drawn = heights(reader)
        assert len(drawn) == len(names)
        for a in range(len(names)):
            assert all(drawn[a] >= drawn[b] for b in range(len(names)) if sigma[a] >= sigma[b])
        page.keyboard.press("ArrowLeft")
    width = page.locator("#joint-lines").bounding_box()["width"]
    page.click("#joint-lines", position={"x": 0.5 * (62 + width - 8), "y": 20})  # between the axes' ends
    last = int(page.get_attribute("#slider", "max"))
    assert abs(int(page.input_value("#slider")) - last / 2) <= 1
    assert page.get_attribute("#joint-lines .shown", "visibility") == "visible"
    assert page.locator("#joint-lines text").first.evaluate("text => text.getBoundingClientRect().height") > 10  # readable
    reader.screenshot("lines")


@pytest.mark.parametrize("name", ["solve", "motion", "plan"])
def test_sigma_of_joints_comes_again_from_the_command_beside_it(open_report, reports, name):
    skip_what_is_not_built(name)
    reader = open_report(name)
    if name == "solve":
        choose(reader, 8)
    reader.page.focus("#slider")
    for _ in range(2):
        parts = json.loads(answer(reports, reader.page.inner_text("#norm") + " --json -"))["parts"]
        again = {part["name"]: part["sigma"] for part in parts}
        cells = [line.split("\t") for line in reader.texts("#joints tr")]
        assert all(alike_numbers(cell[2], again[cell[0]]) for cell in cells) and cells
        reader.page.keyboard.press("ArrowLeft")


def test_what_a_solve_found_comes_again_from_the_command_beside_it(open_report, reports):
    reader = open_report("solve")
    choose(reader, 8)
    again = json.loads(answer(reports, reader.page.inner_text("#command")))
    found = facts(reader)
    for name, value in [("√σ, how far (rms), mm", 1e3 * again["sigma"] ** 0.5), ("σ, m²", again["sigma"]),
                        ("no free configuration is nearer than, mm", 1e3 * again["sigma_lower_bound"] ** 0.5),
                        ("depth as given, mm", -1e3 * again["depth_in"]), ("smallest distance now, mm", 1e3 * again["min_distance"]),
                        ("iterations", again["iterations"]), ("collision queries", again["collision_queries"])]:
        assert alike_numbers(found[name], value), name
    for table, contacts in (("contacts_in", again["contacts_in"]), ("contacts", again["contacts"])):
        depths = [float(cell) for cell in reader.texts(f"#{table} td:nth-child(3)")]
        assert depths == pytest.approx([-1e3 * contact["distance"] for contact in contacts], rel=1e-3) and depths
    trace = (reports["solve"].parent / "search.jsonl").read_text().splitlines()
    iterations = [record["sigma"] for record in map(json.loads, trace) if "step" in record]
    titles = reader.page.locator("#sigma circle title").evaluate_all("all => all.map((title) => title.textContent)")
    assert len(titles) == len(iterations) > 50
    assert all(alike_numbers(title.split("sigma ")[1].split()[0], sigma) for title, sigma in zip(titles, iterations))


def test_what_a_check_or_a_path_found_comes_again(open_report, reports):
    reader = open_report("check")
    again = json.loads(answer(reports, reader.page.inner_text("#command")))
    assert alike_numbers(facts(reader)["smallest distance, mm"], 1e3 * again["min_distance"])
    assert len(reader.texts("#contacts_in tr")) == len(again["contacts"]) > 0
    reader = open_report("motion")
    again = json.loads(answer(reports, reader.page.inner_text("#command")))
    assert alike_numbers(facts(reader)["free up to t"], again["t"])
    skip_what_is_not_built("plan")
    reader = open_report("plan")
    again = json.loads(answer(reports, reader.page.inner_text("#command")))
    assert alike_numbers(facts(reader)["length (Σ√σ), mm"], 1e3 * again["length"])
    assert facts(reader)["collision queries"] == str(again["collision_queries"])
    edges = [line.split("\t") for line in reader.texts("#row-tables section:first-child tbody tr")]
    assert [cells[3] for cells in edges] == [str(edge["poses"]) for edge in again["edges"]] and edges
    assert all(alike_numbers(cells[1], 1e3 * edge["length"]) for cells, edge in zip(edges, again["edges"]))


def test_a_regression_comes_again_with_the_options_of_its_suite(open_report, reports):
    reader = open_report("regress")
    words = shlex.split(reader.page.inner_text("#command"))
    assert "armature\t0.5" in reader.texts("#row-tables tr")
    for option, value in [("--armature", "0.5"), ("--tolerance", "1e-05"), ("--movable", "ball"), ("--allow", "sphere,wall=0.002")]:
        assert words[words.index(option) + 1] == value
    assert "--exact-mesh" not in words
    again = json.loads(answer(reports, reader.page.inner_text("#command")))
    assert alike_numbers(facts(reader)["σ, m²"], again["sigma"]) and again["sigma"] > 1e-4
    assert alike_numbers(facts(reader)["depth as given, mm"], -1e3 * again["depth_in"])
    parts = json.loads(answer(reports, reader.page.inner_text("#norm") + " --json -"))
    assert alike_numbers(facts(reader)["σ, m²"], parts["sigma"])
    rows = [json.loads(line) for line in answer(reports, reader.page.inner_text("#again")).splitlines()]
    assert rows[0]["sigma"] == again["sigma"] and rows[0]["change"] == "sigma_up"
    assert reader.page.inner_text("#row-tables pre") == reader.page.inner_text("#page-tables pre") == reader.page.inner_text("#again")
    compared = dict(line.split("\t", 1) for line in reader.texts("#row-tables tbody tr"))
    assert compared["collision queries"] == f'{rows[0]["golden"]["queries"]}\t{rows[0]["queries"]}'
    assert compared["status"] == f'{rows[0]["golden"]["status"]}\t{rows[0]["status"]}'


def test_a_frame_of_a_trajectory_comes_again_from_the_command_beside_it(open_report, reports):
    reader = open_report("clip")
    for frame in (0, 4):
        choose(reader, frame)
        again = json.loads(answer(reports, reader.page.inner_text("#command")))
        assert again["index"] == frame
        assert alike_numbers(facts(reader)["σ, m²"], again["sigma"]) and again["sigma"] > 0
        assert facts(reader)["collision queries"] == str(again["collision_queries"])
    choose(reader, 6)  # all of them
    assert reader.page.inner_text("#title") == "all frames"
    frames = [float(cell) for cell in reader.texts("#rows tr td:nth-child(4)")]
    assert frames[-1] == max(frames) > 0
    assert len(answer(reports, reader.page.inner_text("#command")).splitlines()) == 6


def test_plots_are_as_wide_as_the_window_leaves_room(open_report):
    reader = open_report("solve")
    first = reader.page.get_attribute("#joint-lines", "viewBox")
    reader.page.set_viewport_size({"width": 390, "height": 844})
    reader.settle()
    assert reader.page.get_attribute("#joint-lines", "viewBox") != first
    assert reader.page.evaluate("document.documentElement.scrollWidth") == 390
    assert reader.page.get_attribute("#joint-lines .shown", "visibility") == "visible"


def test_an_edge_of_a_path_leads_to_its_place(open_report):
    skip_what_is_not_built("plan")
    reader = open_report("plan")
    end = reader.scene()
    reader.page.click("#row-tables tbody tr:nth-child(2)")
    assert reader.page.inner_text("#frame").startswith("edge 2 of")
    assert reader.scene() != end


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["solve", "check", "audit"])
def test_the_camera_goes_to_a_contact(open_report, name, size):
    reader = open_report(name, size)
    before = reader.scene()
    reader.page.click("#contacts_in tr:first-child")
    assert "chosen" in reader.page.get_attribute("#contacts_in tr:first-child", "class")
    there = reader.scene()
    assert not alike(there, before)
    reader.screenshot("contact")
    reader.page.keyboard.press("f")
    assert alike(reader.scene(), before)
    reader.page.focus("#contacts_in tr:first-child")
    reader.page.keyboard.press("Enter")
    assert alike(reader.scene(), there)


@pytest.mark.parametrize("size", SIZES)
def test_rows_are_filtered_sorted_and_stepped_through(open_report, size):
    reader = open_report("solve", size)
    page = reader.page
    assert page.inner_text("#count") == "15 of 15"
    page.keyboard.press("/")
    page.keyboard.type("own solved")
    assert page.inner_text("#count") == "3 of 15"
    assert all("own" in name for name in reader.texts("#rows tr .name"))
    page.keyboard.press("Escape")
    page.fill("#filter", "")
    page.select_option("#sort", label="depth mm, largest first")
    depths = [float(depth) for depth in reader.texts("#rows tr td:nth-child(4)")]
    assert depths == sorted(depths, reverse=True) and depths[0] > 0
    page.click("#rows tr:nth-child(2)")
    page.wait_for_function("document.body.dataset.row === document.querySelector('#rows tr:nth-child(2)').dataset.index")
    title = page.inner_text("#title")
    page.keyboard.press("n")
    page.wait_for_function("title => document.getElementById('title').textContent !== title", arg=title)
    assert page.locator("#rows tr.chosen").count() == 1
    assert "chosen" in page.get_attribute("#rows tr:nth-child(3)", "class")
    reader.screenshot("sorted")


def test_thumbnails_are_drawn_and_the_scene_stays(open_report):
    reader = open_report("solve")
    scene = reader.scene()
    # Until that of the fourth row has a colour, and the view is as it was.
    reader.page.wait_for_function("""() => {
      const canvas = document.querySelectorAll('canvas.thumb')[3];
      return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some(Boolean);
    }""")
    assert reader.scene() == scene


def test_thousands_of_rows_are_listed_as_they_are_scrolled_to(open_report):
    reader = open_report("many")
    page = reader.page
    assert page.inner_text("#count") == "3000 of 3000"
    assert page.locator("#rows tr").count() == 100
    page.evaluate("document.getElementById('list').scrollTop = 1e6")
    page.wait_for_function("document.getElementById('rows').children.length > 100")
    page.fill("#filter", "row2999")
    assert page.locator("#rows tr").count() == 1
    page.click("#rows tr")
    page.wait_for_function("document.body.dataset.row === '2999'")
    assert page.inner_text("#title").startswith("row2999")


def test_dark_and_light(open_report):
    reader = open_report("solve")
    page = reader.page
    colour = "getComputedStyle(document.body).backgroundColor"
    light, scene = page.evaluate(colour), reader.scene()
    page.keyboard.press("d")
    assert page.get_attribute("html", "data-theme") == "dark"
    assert page.evaluate(colour) != light and reader.scene() != scene
    reader.screenshot("dark")
    page.click("#dark")
    assert page.evaluate(colour) == light and reader.scene() == scene


@pytest.mark.parametrize("key", ["g", "s"])
def test_what_was_given_is_hidden_or_beside(open_report, key):
    reader = open_report("solve")
    before = reader.scene()
    reader.page.keyboard.press(key)
    assert reader.scene() != before
    reader.screenshot({"g": "alone", "s": "beside"}[key])
    reader.page.keyboard.press(key)
    assert reader.scene() == before


def colours_of(reader) -> dict[str, int]:
    """How many pixels are clearly orange, and how many clearly blue."""
    pixels = Image.open(io.BytesIO(reader.scene())).convert("RGB").getdata()
    return {"orange": sum(r > b + 50 for r, g, b in pixels), "blue": sum(b > r + 30 for r, g, b in pixels)}


@pytest.mark.parametrize("name", ["inside", "touching"])
def test_what_lies_in_an_obstacle_is_seen_through_it(open_report, name):
    if name == "inside":
        skip_what_is_not_built("plan")
    reader = open_report(name)
    reader.page.keyboard.press("Home")
    colours = colours_of(reader)
    reader.screenshot("inside")
    if name == "inside":
        assert colours["blue"] > 1000
    else:
        assert colours["orange"] > 1000


def test_arrows_of_the_answer_are_there_at_the_answer_alone(open_report):
    reader = open_report("displacement")
    page = reader.page
    assert reader.texts("#contacts tr")
    page.keyboard.press("g")
    page.click("#contacts tr:first-child")
    page.keyboard.press("Home")
    page.click("#contacts tr:first-child")
    assert page.input_value("#slider") == page.get_attribute("#slider", "max")
    reader.screenshot("contact")


def test_axes_of_sigma_say_what_is_there(open_report):
    for name in ("solve", "displacement"):
        reader = open_report(name)
        left = reader.page.locator("#sigma").bounding_box()["x"]
        titles = reader.page.locator("#sigma circle title").evaluate_all("all => all.map((title) => title.textContent)")
        sigmas = [float(title.split("sigma ")[1].split()[0]) for title in titles]
        labels = reader.page.locator("#sigma text[text-anchor=end]")
        ends = [float(text) for text in labels.all_text_contents()[:-1]]  # the last is of iterations
        assert ends[0] == pytest.approx(max(sigmas), rel=0.06)
        assert all(1e-16 * max(sigmas) < end <= 1.06 * max(sigmas) for end in ends)
        assert all(label.bounding_box()["x"] >= left for label in labels.all())


def test_numbers_are_not_broken(open_report):
    reader = open_report("solve")
    number = reader.page.locator("#facts td.number")
    assert number.count() > 5
    assert set(number.evaluate_all("all => all.map((cell) => getComputedStyle(cell).whiteSpace)")) == {"nowrap"}
    assert all(len(text) <= 10 for text in number.all_inner_texts())


def test_what_collides_is_shown_instead(open_report):
    reader = open_report("check")
    before = reader.scene()
    reader.page.keyboard.press("c")
    assert reader.page.is_checked("#colliding")
    reader.page.keyboard.press("c")
    assert reader.scene() == before


def test_what_overlaps_is_seen_though_mujoco_hides_it(open_report):
    reader = open_report("hidden")
    colours = Counter(Image.open(io.BytesIO(reader.scene())).convert("RGB").getdata())
    assert sum(n for (r, g, b), n in colours.items() if r > b + 50) > 1000  # the pads, orange
    assert sum(n for (r, g, b), n in colours.items() if g > r + 40 and g > b + 40) > 1000  # through the green shell
    reader.screenshot("opened")
    reader.page.keyboard.press("c")
    only = Counter(Image.open(io.BytesIO(reader.scene())).convert("RGB").getdata())
    assert not any(g > r + 40 and g > b + 40 for r, g, b in only)


def test_regress_says_what_changed(open_report):
    reader = open_report("regress")
    assert reader.page.inner_text("#title").endswith("sigma up")
    assert "Against the golden result" in reader.page.inner_text("#row-tables")
    assert "Queries of each model" in reader.page.inner_text("#page-tables")
    assert reader.page.inner_text("#again") == "mjcf-pdg regress suite.json --json -"
    reader.page.fill("#filter", "gone")
    reader.page.click("#rows tr")
    reader.page.wait_for_selector("#nothing:visible")  # this row has no pose
    reader.page.focus("#rows tr")
    for key in ["ArrowRight", "End", "f", "s", "s", "g", "g", "c", "c"]:
        reader.page.keyboard.press(key)
    reader.page.fill("#filter", "leg")
    reader.page.click("#rows tr")
    reader.page.wait_for_selector("#nothing", state="hidden")
    assert "leg.xml" in reader.page.inner_text("#model")


def test_a_link_says_where_to_begin(open_report, reports):
    reader = open_report("solve")
    reader.page.goto("about:blank")
    reader.page.goto(f"file://{reports['solve']}#row=3&frame=0")
    reader.page.wait_for_selector("body[data-ready]")
    assert reader.page.inner_text("#title").startswith("reach_through_window")
    assert reader.page.inner_text("#frame") == "as given"


def mean(image: Image.Image, mask: list[bool]) -> tuple[float, ...]:
    pixels = [pixel for pixel, inside in zip(image.getdata(), mask) if inside]
    assert len(pixels) > 500
    return tuple(sum(channel) / len(pixels) for channel in zip(*pixels))


# Of 255; two neighbouring shades of the same body differ by some 20.
@pytest.mark.parametrize("deficiency", ["deuteranopia", "tritanopia"])
def test_before_and_after_are_told_apart_by_everybody(open_report, deficiency):
    reader = open_report("solve")
    reader.page.keyboard.press("s")
    seen = Image.open(io.BytesIO(reader.scene())).convert("RGB")
    orange = [r > b + 60 for r, g, b in seen.getdata()]
    blue = [b > r + 40 for r, g, b in seen.getdata()]
    session = reader.page.context.new_cdp_session(reader.page)
    session.send("Emulation.setEmulatedVisionDeficiency", {"type": deficiency})
    image = Image.open(io.BytesIO(reader.scene())).convert("RGB")
    assert ImageChops.difference(seen, image).getbbox()
    before, after = mean(image, orange), mean(image, blue)
    reader.screenshot(deficiency)
    assert max(abs(a - b) for a, b in zip(before, after)) > 60


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("deficiency", ["none", "deuteranopia", "protanopia", "tritanopia"])
def test_lines_of_joints_are_told_apart_by_everybody(open_report, deficiency, theme):
    reader = open_report("solve")
    choose(reader, 8)  # nine joints move
    if theme == "dark":
        reader.page.keyboard.press("d")
    session = reader.page.context.new_cdp_session(reader.page)
    session.send("Emulation.setEmulatedVisionDeficiency", {"type": deficiency})
    colours = []
    for sample in reader.page.locator("#joint-names svg").all():
        pixels = Counter(Image.open(io.BytesIO(sample.screenshot())).convert("RGB").getdata()).most_common(2)
        colours.append(pixels[1][0])  # the background is the first
    assert len(colours) == 5
    for a, b in itertools.combinations(colours, 2):
        assert max(abs(x - y) for x, y in zip(a, b)) > 50, (a, b)
    dashes = reader.page.locator("#joint-lines .joint").evaluate_all("lines => lines.map((line) => getComputedStyle(line).strokeDasharray)")
    assert len(set(dashes)) == 5  # and without any colour


def test_the_bundle_is_made_of_these_sources():
    web = ROOT / "apps/html/web"
    names = ["package.json", *sorted(path.name for path in web.glob("*.js") if path.name != "bundle.js")]
    sources = hashlib.sha256(b"".join((web / name).read_bytes() for name in names)).hexdigest()
    assert (web / "bundle.js").read_text().splitlines()[0] == f"// sources: {sources}", "run apps/html/web/make_bundle.sh"
