"""Options do what they say on the command line; bad ones are refused in the library's words."""

import inspect
import re
import typing

import mujoco
import numpy as np
import pytest

import mjcf_pdg

DEFAULTS = {
    "movable": "", "metric": "sequential", "tolerance": 1e-6, "clearance": 0.0, "rest": 0.0, "method": "auto",
    "effort": "default", "trajectory": False, "seed": 0, "exact_mesh": False, "without": [], "root": None,
    "time_limit": None, "mocap_pos": None, "mocap_quat": None, "report_contacts": True,
    "report_lower_bound": True, "report_distances_to": 1.0, "threads": 1, "progress": False,
}


def test_defaults_are_those_of_the_command_line(puma):
    q = puma.key("arm_through_roof").qpos
    options = {name: value for name, value in DEFAULTS.items() if name != "movable"}
    assert mjcf_pdg.solve(puma, q, **options).q.tobytes() == mjcf_pdg.solve(puma, q).q.tobytes()


def test_every_option_is_explained_and_typed():
    """The names stand in the module's table, in the type stubs and in the docstring: none may lack one."""
    with pytest.raises(ValueError, match="no option 'efort'") as error:
        mjcf_pdg.solve(mujoco.MjModel.from_xml_string("<mujoco/>"), [], efort=1)
    known = re.search(r"options: (.*)\)", str(error.value)).group(1).split(", ")
    assert set(known) == set(typing.get_type_hints(mjcf_pdg._functions.SolveOptions))
    explained = re.findall(r"^ {2}([a-z_, ]+):", inspect.getdoc(mjcf_pdg.solve), re.MULTILINE)
    assert set(known) <= {name for names in explained for name in names.split(", ")}


def test_clearance_rest_and_tolerance_move_the_answer(ball):
    assert mjcf_pdg.solve(ball, [-1.0], clearance=0.05).q == pytest.approx([-0.85], abs=1e-5)
    (q,) = mjcf_pdg.solve(ball, [-1.0], tolerance=0.01).q
    assert -0.91 <= q < -0.901
    assert mjcf_pdg.solve(ball, [-1.0], rest=0.2).status == "already_free"
    assert mjcf_pdg.solve(ball, [-1.0], rest=0.05).status == "solved"


def test_movable_freezes_all_else(puma):
    q = puma.key("arm_through_roof").qpos
    whole, arm = mjcf_pdg.solve(puma, q), mjcf_pdg.solve(puma, q, movable="link1")
    assert np.any(whole.q[:2] != q[:2])
    assert np.array_equal(arm.q[:2], q[:2]) and arm.sigma >= whole.sigma
    for same in (["link1"], ("link1",), "link1,link2", ["link1", "link2"]):
        assert mjcf_pdg.solve(puma, q, movable=same).q.tobytes() == arm.q.tobytes()


def test_effort_method_seed_and_without_change_the_search(puma):
    q = puma.key("arm_deep_in_tail").qpos
    default = mjcf_pdg.solve(puma, q)
    assert mjcf_pdg.solve(puma, q, effort="fast").queries < default.queries
    assert mjcf_pdg.solve(puma, q, effort="max").queries > default.queries
    assert mjcf_pdg.solve(puma, q, method="paper").queries != default.queries
    assert mjcf_pdg.solve(puma, q, seed=2**64 - 1).queries != default.queries
    without = mjcf_pdg.solve(puma, q, without=[default.start])
    assert without.start != default.start


def test_exact_meshes_are_not_their_hulls():
    # One mesh of two tetrahedra, which leave the middle free, and a ball there.
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    vertices = [(x + shift, y, z) for shift in (-3, 3) for x, y, z in corners]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    faces += [tuple(4 + corner for corner in face) for face in faces]
    numbers = lambda rows: " ".join(str(x) for row in rows for x in row)
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
    <asset><mesh name="two" vertex="{numbers(vertices)}" face="{numbers(faces)}"/></asset>
    <worldbody><geom type="mesh" mesh="two"/><body><freejoint/><geom size=".1"/></body></worldbody></mujoco>""")
    q = model.qpos0
    assert not mjcf_pdg.verify(model, q) and mjcf_pdg.verify(model, q, exact_mesh=True)
    assert mjcf_pdg.solve(model, q).status == "solved"
    assert mjcf_pdg.solve(model, q, exact_mesh=True).status == "already_free"


def test_pairs_are_excluded_allowed_or_fixed(ball):
    assert mjcf_pdg.solve(ball, [-1.0], exclude=[("ball", "floor")]).status == "already_free"
    assert mjcf_pdg.solve(ball, [-1.0], exclude=["ball,floor"]).status == "already_free"
    allowed = mjcf_pdg.solve(ball, [-1.0], allow={("ball", "floor"): 0.02})
    assert allowed.q == pytest.approx([-0.92], abs=1e-5) and allowed.contacts_kept == 1
    assert mjcf_pdg.solve(ball, [-1.0], ignore_permanent=True).status == "solved"
    for bad in ({"exclude": ["ball"]}, {"exclude": [("ball", "nobody")]}, {"allow": {("ball", "floor"): -1.0}},
                {"fixed": "ball"}):
        with pytest.raises(ValueError):
            mjcf_pdg.solve(ball, [-1.0], **bad)
    for bad in ({"exclude": "ball,floor"}, {"allow": 1.0}, {"allow": {("ball", "floor"): "deep"}}):
        with pytest.raises(TypeError):
            mjcf_pdg.solve(ball, [-1.0], **bad)


def test_equality_constraints_are_held_or_ignored():
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody>
      <body><joint name="a" type="slide"/><geom size=".1"/></body>
      <body pos="1 0 0"><joint name="b" type="slide"/><geom size=".1"/></body></worldbody>
      <equality><joint joint1="a" joint2="b"/></equality></mujoco>""")
    held = mjcf_pdg.solve(model, [0.0, 0.4])
    assert held.status == "solved" and held.equality_residual <= 1e-6
    assert held.equality_residual_in == pytest.approx(0.4) and held.q == pytest.approx([0.2, 0.2], abs=1e-4)
    assert mjcf_pdg.verify(model, [0.0, 0.4]).equality_residual == pytest.approx(0.4)
    assert mjcf_pdg.solve(model, [0.0, 0.4], equality="ignore").status == "already_free"
    assert mjcf_pdg.solve(model, [[0.0, 0.4]]).equality_residual_in == pytest.approx([0.4])


def test_what_is_not_asked_for_is_not_reported(ball):
    result = mjcf_pdg.solve(ball, [-1.0], report_contacts=False)
    assert result.contacts_in == [] and result.q == mjcf_pdg.solve(ball, [-1.0]).q
    assert mjcf_pdg.solve(ball, [0.0], report_distances_to=0.5).min_distance == pytest.approx(0.5)


def test_a_time_limit_ends_the_search(puma):
    q = puma.key("cart_inside_car").qpos
    hurried = mjcf_pdg.solve(puma, q, effort="max", time_limit=1e-3)
    patient = mjcf_pdg.solve(puma, q, effort="max", time_limit=1e7)
    assert hurried.queries < 0.5 * patient.queries
    assert patient.q.tobytes() == mjcf_pdg.solve(puma, q, effort="max").q.tobytes()


@pytest.mark.parametrize("options, words", [
    ({"clearence": 0.1}, "no option 'clearence' (options: movable, fixed, exclude"),
    ({"clearance": -1.0}, "clearance must lie between 0 and 1000 m"),
    ({"clearance": float("nan")}, "clearance must lie between 0 and 1000 m"),
    ({"tolerance": 0.0}, "tolerance must lie between 1e-12 and 1 m"),
    ({"rest": float("inf")}, "rest must lie between 0 and 1000 m"),
    ({"time_limit": 0.0}, "the time limit must be positive"),
    ({"report_distances_to": -1.0}, "report_distances_to must lie between 0 and 1000 m"),
    ({"effort": "slow"}, "effort: 'slow' is none of fast|default|max"),
    ({"method": "Paper"}, "method: 'Paper' is none of auto|paper"),
    ({"metric": ""}, "metric: '' is none of sequential|displacement"),
    ({"seed": -1}, "seed: -1 is not within 0 and 2^64 - 1"),
    ({"seed": 2**64}, "is not within 0 and 2^64 - 1"),
    ({"movable": "nobody"}, "nobody"),
    ({"movable": ["ball", ""]}, "movable: empty name"),
    ({"root": "nobody"}, "nobody"),
    ({"root": ""}, "root: empty body name"),
    ({"without": ["nothing"]}, "nothing"),
    ({"mocap_pos": [[0.0, 0.0, 0.0]]}, "mocap_pos has 3 values, the model needs 0"),
    ({"threads": 0}, "threads: 0 is not a whole number that is at least 1 and at most 1024"),
    ({"threads": 1025}, "threads: 1025 is not"),
])
@pytest.mark.parametrize("q", [[0.0], [[0.0], [0.0]]])
def test_bad_values_are_value_errors(ball, q, options, words):
    with pytest.raises(ValueError) as error:
        mjcf_pdg.solve(ball, q, **options)
    assert words in str(error.value)


@pytest.mark.parametrize("options", [
    {"rest": "1"}, {"clearance": [1.0]}, {"tolerance": 1j}, {"seed": 1.5}, {"seed": "1"},
    {"exact_mesh": 1}, {"trajectory": "yes"}, {"effort": 3}, {"root": 7}, {"movable": 7}, {"movable": [7]},
    {"movable": {"ball"}}, {"without": 1.0}, {"threads": 1.5}, {"mocap_pos": "x"}, {"mocap_pos": [1j]},
])
def test_values_of_another_type_are_type_errors(ball, options):
    with pytest.raises(TypeError):
        mjcf_pdg.solve(ball, [0.0], **options)


@pytest.mark.parametrize("call", [
    lambda m: mjcf_pdg.verify(m, [0.0], effort="fast"),
    lambda m: mjcf_pdg.verify(m, [0.0], threads=2),
    lambda m: mjcf_pdg.check_motion(m, [0.0], [0.0], seed=1),
    lambda m: mjcf_pdg.object_norm(m, [0.0], [0.0], clearance=0.1),
    lambda m: mjcf_pdg.Solver(m, threads=2),
])
def test_options_of_another_function_are_refused(ball, call):
    with pytest.raises(ValueError, match="no option '"):
        call(ball)


def test_margins_are_kept_or_counted():
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><geom type="plane" size="1 1 1"/>
      <body><joint type="slide" axis="0 0 1"/><geom size=".1" margin=".01"/></body></worldbody></mujoco>""")
    assert mjcf_pdg.verify(model, [0.105]).pushed_pairs == 1
    assert mjcf_pdg.solve(model, [0.05]).pushed_pairs == 1
    kept = mjcf_pdg.solve(model, [0.05], clearance="model")
    assert kept.pushed_pairs == 0 and kept.q == pytest.approx([0.11], abs=1e-5)
    with pytest.raises(ValueError, match="clearance: 'much' is none of model"):
        mjcf_pdg.solve(model, [0.05], clearance="much")


def test_armature_weighs_joints():
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><body><joint armature=".4"/>
      <inertial mass="2" pos=".5 0 0" diaginertia=".1 .1 .1"/></body></worldbody></mujoco>""")
    chord = 4 * np.sin(0.35) ** 2 / 2  # over the mass
    for armature, inertia in [(0, 0.6), (0.2, 0.8), ("model", 1.0)]:
        sigma = mjcf_pdg.object_norm(model, [0], [0.7], armature=armature)
        assert sigma == pytest.approx(inertia * chord)
    for bad in [-1, "heavy"]:
        with pytest.raises(ValueError, match="armature"):
            mjcf_pdg.object_norm(model, [0], [0.7], armature=bad)


def test_flags_of_the_model_are_honoured_when_asked():
    model = mujoco.MjModel.from_xml_string("""<mujoco><option><flag contact="disable"/></option>
      <worldbody><geom type="plane" size="1 1 1"/>
      <body><joint type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody></mujoco>""")
    assert mjcf_pdg.solve(model, [0.05]).status == "solved"
    assert mjcf_pdg.solve(model, [0.05], flags="model").status == "already_free"


def test_flexes_are_left_out_when_asked():
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><geom type="plane" size="1 1 1"/>
      <body><joint type="slide" axis="0 0 1"/><geom size=".1"/></body>
      <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" dim="2" mass="1">
      <edge equality="true"/></flexcomp></worldbody></mujoco>""")
    with pytest.raises(ValueError, match="cloth"):
        mjcf_pdg.solve(model, model.qpos0)
    assert mjcf_pdg.solve(model, model.qpos0, flex="ignore").status == "solved"


def test_tendon_limits_are_held_when_asked():
    kite = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><site name="a"/>
      <body><joint type="slide" axis="1 0 0"/><geom size=".1"/><site name="b"/></body></worldbody>
      <tendon><spatial limited="true" range="0 1"><site site="a"/><site site="b"/></spatial></tendon></mujoco>""")
    assert mjcf_pdg.solve(kite, [1.5]).status == "already_free"
    result = mjcf_pdg.solve(kite, [1.5], tendon_limits="hold")
    assert result.status == "solved" and result.q == pytest.approx([1.0], abs=2e-6)
    assert result.tendon_excess_in == pytest.approx(0.5) and result.tendon_excess <= 1e-6
    rows = mjcf_pdg.solve(kite, [[1.5], [0.5]], tendon_limits="hold")
    assert rows.tendon_excess_in == pytest.approx([0.5, 0.0])
    verdict = mjcf_pdg.verify(kite, [1.5], tendon_limits="hold")
    assert not verdict and verdict.tendon_excess == pytest.approx(0.5)
    with pytest.raises(ValueError, match="tendon_limits"):
        mjcf_pdg.solve(kite, [1.5], tendon_limits="some")
