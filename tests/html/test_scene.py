"""What the scene of a report shows, seen in its pixels: what overlaps, what moved, what is in the way, and where the camera stands."""

import io
from collections import Counter

import pytest
from conftest import SIZES, alike, skip_what_is_not_built
from PIL import Image


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["solve", "check", "audit"])
def test_the_camera_goes_to_a_contact(open_report, name, size):
    reader = open_report(name, size)
    before = reader.scene()
    reader.page.click("#contacts_in tr:first-child")
    assert "chosen" in reader.page.get_attribute("#contacts_in tr:first-child", "class")
    assert reader.page.input_value("#slider") == "0"  # where it overlaps
    there = reader.scene()
    assert not alike(there, before)
    reader.screenshot("contact")
    reader.page.keyboard.press("f")
    reader.page.keyboard.press("End")
    assert alike(reader.scene(), before)
    reader.page.focus("#contacts_in tr:first-child")
    reader.page.keyboard.press("Enter")
    assert alike(reader.scene(), there)


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


@pytest.mark.parametrize("name, key", [("inside", "Home"), ("inside_at_last", "End"), ("touching", "Home")])
def test_what_lies_in_an_obstacle_is_seen_through_it(open_report, name, key):
    if name != "touching":
        skip_what_is_not_built("plan")
    reader = open_report(name)
    reader.page.keyboard.press(key)
    colours = colours_of(reader)
    reader.screenshot("inside")
    assert colours["blue" if key == "End" else "orange"] > 1000


def test_what_cannot_be_repaired_stands_out_where_it_is(open_report):
    reader = open_report("stuck")
    assert reader.page.inner_text("#title").endswith("unsolved")
    assert colours_of(reader)["orange"] > 1000  # though the slider shows a search that moved it and gave up
    image = Image.open(io.BytesIO(reader.scene())).convert("RGB")
    pale = [k // image.width for k, (r, g, b) in enumerate(image.getdata()) if r > b + 50 and b > 80]
    full = [k // image.width for k, (r, g, b) in enumerate(image.getdata()) if r > b + 50 and b < 50]
    assert len(pale) > 1000 and len(full) > 1000 and sum(pale) / len(pale) < sum(full) / len(full)  # the roof is seen through, not the floor
    reader.screenshot("opened")


def test_contacts_of_a_goal_are_looked_at_where_the_slider_ends(open_report):
    skip_what_is_not_built("plan")
    reader = open_report("inside_at_last")
    reader.page.keyboard.press("Home")
    reader.page.click("#contacts_goal tr:first-child")
    assert reader.page.input_value("#slider") == reader.page.get_attribute("#slider", "max")
    depth, normal = reader.texts("#contacts_goal td:nth-child(3)")[0], reader.texts("#contacts_goal td:nth-child(4)")[0]
    assert (depth, normal) == ("200", "0.00 0.00 -1.00")
    reader.screenshot("contact")


def test_a_motion_that_starts_in_collision_opens_there(open_report):
    reader = open_report("motion_from_inside")
    assert reader.page.input_value("#slider") == "0"


def test_what_was_given_is_orange_at_its_end_of_the_slider_too(open_report):
    reader = open_report("displacement")
    reader.page.keyboard.press("g")
    assert colours_of(reader)["blue"] > 1000 > colours_of(reader)["orange"]
    reader.page.keyboard.press("Home")
    assert colours_of(reader)["orange"] > 1000 > colours_of(reader)["blue"]


def test_a_body_whose_feet_are_too_small_to_see_stands_out(open_report):
    reader = open_report("toes")
    pixels = Counter(Image.open(io.BytesIO(reader.scene())).convert("RGB").getdata())
    assert sum(n for (r, g, b), n in pixels.items() if r > b + 50) > 1000
    reader.screenshot("opened")


def test_an_arrow_leads_from_one_geom_to_the_other(open_report):
    """Of a ball 0.25 m deep in a wall: all of the arrow lies in the overlap."""
    reader = open_report("touching")
    image = Image.open(io.BytesIO(reader.scene())).convert("RGB")
    red = [k // image.width for k, colour in enumerate(image.getdata()) if colour == (0xD5, 0x5E, 0x00)]
    orange = [k // image.width for k, (r, g, b) in enumerate(image.getdata()) if r > b + 50]
    assert red and orange
    assert min(red) >= min(orange) - 3 and max(red) <= max(orange) + 3
    reader.screenshot("arrow")


def test_a_motion_opens_where_it_stops_and_shows_what_is_in_the_way(open_report):
    reader = open_report("motion")
    page = reader.page
    last = int(page.get_attribute("#slider", "max"))
    assert int(page.input_value("#slider")) == last - 1
    assert page.inner_text("#frame").endswith("where it stops")
    assert reader.texts("#contacts_stop tr td")[:2] == ["link3_forearm", "car_left_door"]
    assert colours_of(reader)["orange"] > 1000 and colours_of(reader)["blue"] > 1000  # what moved, and before
    page.keyboard.press("End")
    before = reader.scene()
    page.click("#contacts_stop tr")
    assert int(page.input_value("#slider")) == last - 1
    assert not alike(reader.scene(), before)
    reader.screenshot("contact")


def test_a_motion_that_a_limit_stops_names_the_joint(open_report):
    reader = open_report("motion_to_limit")
    assert "reaches its limit" in reader.page.inner_text("#reason")
    reader.page.keyboard.press("End")
    reader.page.click("#row-tables tbody tr")
    assert reader.page.inner_text("#frame").endswith("where it stops")


def test_a_wall_before_what_moves_is_seen_through(open_report):
    skip_what_is_not_built("plan")
    reader = open_report("in_a_room")
    assert colours_of(reader)["blue"] > 300
    reader.screenshot("opened")


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


def test_the_arrow_that_is_looked_at_stands_out(open_report):
    reader = open_report("hidden")

    def width() -> float:
        """From the leftmost to the rightmost pixel of an arrow that does not fade, as a share of the picture."""
        image = Image.open(io.BytesIO(reader.scene())).convert("RGB")
        columns = [k % image.width for k, colour in enumerate(image.getdata()) if colour == (0xD5, 0x5E, 0x00)]
        return (max(columns) - min(columns)) / image.width

    assert width() > 0.2  # both
    for contact in (1, 2):
        reader.page.click(f"#contacts_in tr:nth-child({contact})")
        reader.page.mouse.move(400, 400)
        for _ in range(8):  # away from it, until both are in sight
            reader.page.mouse.wheel(0, 200)
        reader.screenshot(f"arrow{contact}")
        assert 0 < width() < 0.04
    reader.page.keyboard.press("f")
    assert width() > 0.2
