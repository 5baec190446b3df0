"""Numbers of a report come again from the commands that stand beside them."""

import json
import math
import shlex
import subprocess

import pytest
from conftest import PROGRAM, choose, facts, skip_what_is_not_built


def answer(reports, command: str) -> str:
    """What a command of a page says, run where the reports were made."""
    assert command.startswith("mjcf-pdg ")
    folder = next(iter(reports.values())).parent
    command = command.replace("mjcf-pdg", shlex.quote(PROGRAM), 1)
    return subprocess.run(["sh", "-c", command], cwd=folder, capture_output=True, text=True, timeout=120).stdout


def alike_numbers(shown: str, value: float) -> bool:
    """Whether this is the value to four digits, which pages show."""
    return float(shown) == float(f"{value:.4g}")


@pytest.mark.parametrize("name", ["solve", "motion", "plan"])
def test_sigma_of_joints_comes_again_from_the_command_beside_it(open_report, reports, name):
    skip_what_is_not_built(name)
    reader = open_report(name)
    if name == "solve":
        choose(reader, 8)
    reader.page.focus("#slider")
    for _ in range(2):
        parts = json.loads(answer(reports, reader.page.inner_text("#norm")))["parts"]
        again = {part["name"]: part for part in parts}
        cells = [line.split("\t") for line in reader.texts("#joints tr")]
        assert all(alike_numbers(sigma, again[name]["sigma"]) for name, _, sigma, _ in cells) and cells
        for name, moved, _, _ in cells:
            number, unit = moved.split()
            assert alike_numbers(number, again[name]["moved"] * {"mm": 1e3, "°": 180 / math.pi}[unit])
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
    trace = answer(reports, reader.page.inner_text("#trace")).splitlines()
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
    stop = json.loads(answer(reports, reader.page.inner_text("#stop")))["contacts"]
    cells = reader.texts("#contacts_stop td")
    assert [contact["geom1"] for contact in stop] == cells[::4] and [contact["geom2"] for contact in stop] == cells[1::4]
    assert alike_numbers(cells[2], -1e3 * stop[0]["distance"])
    reader = open_report("motion_to_limit")
    again = json.loads(answer(reports, reader.page.inner_text("#command")))
    joint, place = reader.texts("#row-tables tbody td")
    assert joint == again["joint"] and alike_numbers(place, again["qpos"][-1])
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
    parts = json.loads(answer(reports, reader.page.inner_text("#norm")))
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
