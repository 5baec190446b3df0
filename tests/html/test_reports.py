"""Reports in a browser: every control does what it says, on a desk and on a phone, and nothing is loaded or complained of."""

import hashlib
import io
import itertools
from collections import Counter

import pytest
from conftest import ROOT, SIZES, choose, skip_what_is_not_built
from PIL import Image, ImageChops

COMMANDS = ["solve", "check", "motion", "audit", "regress", "plan"]


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
    reader.page.focus("#slider")
    reader.page.keyboard.press("End")  # a motion opens where it is stopped
    end, words, moved = reader.scene(), reader.page.inner_text("#frame"), reader.texts("#joints tr")
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


def test_a_link_may_lead_to_any_row_and_frame(open_report, reports):
    reader = open_report("many")
    page = reader.page
    for link, row in (("row=2345&frame=50%", "2345"), ("row=7&frame=x%", "7")):
        page.goto("about:blank")
        page.goto(f"file://{reports['many']}#{link}")
        page.wait_for_selector("body[data-ready]")
        assert page.get_attribute("body", "data-row") == row
        assert page.get_attribute("#rows tr.chosen", "data-index") == row


def test_frames_that_are_not_solved_are_told_of_at_once(open_report):
    reader = open_report("sinks")
    page = reader.page
    assert page.inner_text("#title") == "all frames"
    assert page.inner_text("#reason") == "row0: not solved, and 2 more. The list of rows says why."
    assert page.inner_text("#frame") == "row0: not solved"
    assert "not solved\t3" in reader.texts("#facts tr")


def test_a_heading_sorts_and_says_so(open_report):
    reader = open_report("solve")
    page = reader.page
    assert page.locator("#list-head [aria-sort]").all_inner_texts() == ["row"]
    page.click("#list-head th:nth-child(4)")
    depths = [float(depth) for depth in reader.texts("#rows tr td:nth-child(4)")]
    assert depths == sorted(depths, reverse=True) and depths[0] > 0
    assert page.locator("#list-head [aria-sort=descending]").all_inner_texts() == ["depth mm"]
    page.focus("#list-head th:nth-child(3)")
    page.keyboard.press("Enter")
    names = reader.texts("#rows tr .name div:first-child")
    assert names == sorted(names) and len(names) == 15
    assert page.locator("#list-head [aria-sort=ascending]").all_inner_texts() == ["name and status"]


def test_every_command_has_a_button_that_copies_it(open_report):
    reader = open_report("regress")
    page = reader.page
    assert page.locator("pre").count() == page.locator("pre + .copy").count() > 4
    page.evaluate("Object.defineProperty(navigator, 'clipboard', {value: {writeText: (words) => { window.copied = words; }}})")
    page.click("#row-tables pre + .copy")
    assert page.evaluate("copied") == page.inner_text("#row-tables pre")
    assert page.inner_text("#row-tables pre + .copy") == "copied"


def test_names_are_broken_between_their_words(open_report):
    reader = open_report("check", "phone")
    cells = reader.page.locator("#contacts_in td:nth-child(-n+2)")
    broken = cells.evaluate_all("""all => all.flatMap((cell) => [...cell.childNodes].filter((part) => part.nodeType === 3).filter((part) => {
      const range = document.createRange();
      range.selectNodeContents(part);
      return range.getClientRects().length > 1;
    }).map((part) => part.textContent))""")
    assert cells.count() > 3 and broken == []


def test_a_report_opens_at_the_first_row_that_is_bad_news(open_report):
    reader = open_report("worse")
    page = reader.page
    assert page.inner_text("#title") == "two.csv row 1: solved, sigma up"
    assert page.inner_text("#count-wrong") == ", 1 stands out"
    page.select_option("#sort", label="what stands out first")
    assert reader.texts("#rows .name div:first-child")[0] == "two.csv row 1"
    page.fill("#filter", "unsolved")
    assert reader.texts("#rows .status") == ["unsolved, new"]


def test_rows_of_two_suites_are_told_apart(open_report):
    reader = open_report("two_suites")
    page = reader.page
    page.fill("#filter", "qpos0 ball of suite.json")
    assert page.inner_text("#count").startswith("1 of")
    page.fill("#filter", "qpos0 ball of more.json")
    assert page.inner_text("#count").startswith("1 of")
    page.click("#rows tr")
    page.wait_for_function("document.getElementById('model').textContent.endsWith(' of more.json')")
    assert {"ball.xml of suite.json", "ball.xml of more.json"} < set(reader.texts("#page-tables td:first-child"))
    assert "--plugin-dir" in page.inner_text("#command") and "--plugin-dir" in page.inner_text("#norm")


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
