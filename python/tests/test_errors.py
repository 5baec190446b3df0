"""Bad models and configurations are refused, and nothing crashes."""

import mujoco
import numpy as np
import pytest
from conftest import BALL

import mjcf_pdg

# Each function with a configuration of the ball, and the name that its messages give it.
CALLS = {
    "solve": lambda m, q: mjcf_pdg.solve(m, q),
    "Solver.solve": lambda m, q: mjcf_pdg.Solver(m).solve(q),
    "Solver.is_free": lambda m, q: mjcf_pdg.Solver(m).is_free(q),
    "Solver.set_hint": lambda m, q: mjcf_pdg.Solver(m).set_hint(q),
    "object_norm q0": lambda m, q: mjcf_pdg.object_norm(m, q, [0.0]),
    "object_norm q1": lambda m, q: mjcf_pdg.object_norm(m, [0.0], q),
    "verify": lambda m, q: mjcf_pdg.verify(m, q),
    "verify q_in": lambda m, q: mjcf_pdg.verify(m, [0.0], q_in=q),
    "check_motion q0": lambda m, q: mjcf_pdg.check_motion(m, q, [0.0]),
    "check_motion q1": lambda m, q: mjcf_pdg.check_motion(m, [0.0], q),
    "Tracker.step": lambda m, q: mjcf_pdg.Tracker(m).step(q),
    "Tracker.reset": lambda m, q: mjcf_pdg.Tracker(m).reset(q),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS.keys())
@pytest.mark.parametrize("q", [
    [], [0.0, 0.0], 0.0, [[[0.0]]], np.empty((0,)), [float("nan")], [float("inf")], [1e300],
    [[0.0, 0.0]], [[0.0], [0.0, 1.0]],
])
def test_bad_configurations_are_value_errors(ball, call, q):
    with pytest.raises(ValueError):
        call(ball, q)


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS.keys())
@pytest.mark.parametrize("q", [
    [1j], np.array([1j]), ["0.0"], "0", b"0", {}, object(), [object()], np.array(["2020-01-01"], "datetime64[D]"),
    np.zeros(1, "f8,f8"),
])
def test_what_is_no_array_of_real_numbers_is_a_type_error(ball, call, q):
    with pytest.raises(TypeError):
        call(ball, q)


def test_messages_say_the_shape_that_is_needed(puma):
    with pytest.raises(ValueError, match=r"qpos has the shape \(3,\), the model needs \(9,\)"):
        mjcf_pdg.solve(puma, [0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match=r"qpos has the shape \(2, 3\), the model needs \(n, 9\)"):
        mjcf_pdg.solve(puma, np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"q1 has the shape \(1, 9\), the model needs \(9,\)"):
        mjcf_pdg.object_norm(puma, np.zeros(9), np.zeros((1, 9)))


def test_a_bad_row_says_its_number(ball):
    with pytest.raises(ValueError, match="row 1: "):
        mjcf_pdg.solve(ball, [[0.0], [float("nan")]])


@pytest.mark.parametrize("model", [None, 1, "robot.xml", object(), mujoco.MjModel, mujoco.MjSpec()])
def test_another_model_is_a_type_error(model):
    for call in (
        lambda: mjcf_pdg.solve(model, [0.0]), lambda: mjcf_pdg.solve(model, [[0.0]]), lambda: mjcf_pdg.Solver(model),
        lambda: mjcf_pdg.object_norm(model, [0.0], [0.0]), lambda: mjcf_pdg.verify(model, [0.0]),
        lambda: mjcf_pdg.check_motion(model, [0.0], [0.0]), lambda: mjcf_pdg.audit(model),
    ):
        with pytest.raises(TypeError, match="mujoco.MjModel"):
            call()


def test_models_that_hold_nan_are_value_errors():
    for field, words in (
        ("body_mass", "mass of body 'world'"), ("geom_size", "size of geom 'floor'"), ("jnt_axis", "axis of joint 'up'")
    ):
        model = mujoco.MjModel.from_xml_string(BALL)
        getattr(model, field)[:] = np.nan
        with pytest.raises(ValueError, match=f"the {words} is not usable"):
            mjcf_pdg.solve(model, [-0.95])


def test_data_must_be_of_the_same_model(ball):
    other = mujoco.MjModel.from_xml_string(BALL)
    with pytest.raises(ValueError, match="another mujoco.MjModel"):
        mjcf_pdg.Solver(ball).solve(mujoco.MjData(other))


def test_models_that_are_not_supported_are_named():
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody>
      <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" radius=".01" dim="2"/>
      <body><joint type="slide"/><geom size=".1"/></body></worldbody></mujoco>""")
    with pytest.raises(ValueError, match="cloth"):
        mjcf_pdg.solve(model, model.qpos0)
    with pytest.raises(ValueError, match="method paper"):
        coupled = mujoco.MjModel.from_xml_string("""<mujoco><worldbody>
          <body><joint name="a"/><geom size=".1"/></body></worldbody>
          <equality><joint joint1="a"/></equality></mujoco>""")
        mjcf_pdg.solve(coupled, [1.0], method="paper")


def test_errors_inside_mujoco_are_its_own_exception_and_end_nothing():
    # Too little memory for mj_forward, which the audit calls for keyframes.
    balls = "".join(f'<body pos="{i / 20} 0 .05"><freejoint/><geom size=".1"/></body>' for i in range(12))
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><size memory="20K"/>
    <asset><hfield name="hills" nrow="20" ncol="20" size="1 1 .1 .1"/></asset>
    <worldbody><geom type="hfield" hfield="hills"/>{balls}</worldbody></mujoco>""")
    for _ in range(3):
        with pytest.raises(mujoco.FatalError, match="out of memory, stack overflow"):
            mjcf_pdg.audit(model)
    with pytest.raises(mujoco.FatalError):  # the package's own errors are as before
        mujoco.mj_forward(model, mujoco.MjData(model))
    assert mjcf_pdg.solve(model, model.qpos0, effort="fast").status == "solved"


def test_a_model_without_joints_does_not_crash():
    model = mujoco.MjModel.from_xml_string('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>')
    for q in ([], np.empty((2, 0)), np.empty((0, 0))):
        try:
            results = mjcf_pdg.solve(model, q)
        except ValueError:
            continue
        assert np.all(results.free)


def test_budgets_are_checked(ball):
    solver = mjcf_pdg.Solver(ball)
    with pytest.raises(ValueError, match="the budget of queries must not be negative"):
        solver.set_budget(queries=-1)
    with pytest.raises(ValueError, match="the budget of seconds must not be negative"):
        solver.set_budget(seconds=float("nan"))
    with pytest.raises(TypeError):
        solver.set_budget(queries=1.5)


@pytest.mark.parametrize("options", [{"samples": 0}, {"tolerance": -1.0}])
def test_audits_with_bad_options_are_value_errors(ball, options):
    with pytest.raises(ValueError):
        mjcf_pdg.audit(ball, **options)


def test_an_unmade_solver_is_refused():
    solver = mjcf_pdg.Solver.__new__(mjcf_pdg.Solver)
    with pytest.raises(TypeError), pytest.warns(RuntimeWarning, match="uninitialized"):
        solver.is_free([0.0])


def test_models_and_data_that_were_never_made_are_refused(ball):
    for call in (mjcf_pdg.Solver, mjcf_pdg.audit, lambda model: mjcf_pdg.solve(model, [0.0])):
        with pytest.raises(ValueError, match="MjModel was never made"):
            call(mujoco.MjModel.__new__(mujoco.MjModel))  # mujoco itself crashes when it is asked for nq
    with pytest.raises(ValueError, match="MjData was never made"):
        mjcf_pdg.Solver(ball).solve(mujoco.MjData.__new__(mujoco.MjData))
