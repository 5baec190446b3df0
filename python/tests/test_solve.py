"""What the functions return: values known in closed form, shapes, dtypes."""

import dataclasses
import pickle
import sys

import mujoco
import numpy as np
import pytest
from conftest import OVER_MOCAP

import mjcf_pdg

TOLERANCE = 1e-6  # overlap that counts as free [m]


def test_ball_in_the_floor_comes_out_by_its_depth(ball):
    result = mjcf_pdg.solve(ball, [-1.0])
    assert result.status == "solved" and result.free
    assert result.q == pytest.approx([-0.9], abs=2 * TOLERANCE)
    assert result.sigma == pytest.approx(0.01, rel=1e-4)
    assert result.rms == pytest.approx(0.1, rel=1e-4)
    assert result.sigma_lower_bound <= result.sigma and result.proven
    assert result.depth_in == pytest.approx(-0.1)
    assert result.min_distance == pytest.approx(0.0, abs=2 * TOLERANCE)
    assert result.certified and result.cause == "" and result.reason == ""
    assert result.queries > 0 and result.iterations > 0 and result.seconds > 0.0
    (contact,) = result.contacts_in
    assert (contact.geom1, contact.geom2) == ("floor", "sphere")
    assert contact.normal == pytest.approx([0.0, 0.0, 1.0])
    assert contact.distance == pytest.approx(-0.1)
    assert contact.position == pytest.approx([0.0, 0.0, -0.05])


def test_free_configuration_comes_back_bit_for_bit(ball):
    q = np.array([0.1 + 0.2])
    result = mjcf_pdg.solve(ball, q)
    assert result.status == "already_free" and result.start == "none"
    assert result.q.tobytes() == q.tobytes() and result.q is not q
    assert result.sigma == 0.0
    assert result.min_distance == pytest.approx(1.0)  # of 1.2 m: cut off one metre away


def test_rows_are_arrays_of_what_each_row_gives_alone(ball):
    q = np.array([[-1.0], [0.0], [-1.5]])
    results = mjcf_pdg.solve(ball, q, threads=2)
    assert len(results) == 3 and results.q.shape == (3, 1)
    assert results.free.tolist() == [True, True, True]
    assert results.status.tolist() == ["solved", "already_free", "solved"]
    for field in dataclasses.fields(mjcf_pdg.Results):
        column = getattr(results, field.name)
        assert isinstance(column, np.ndarray) and len(column) == 3, field.name
        if field.name == "seconds":
            continue
        for row in range(3):
            alone = getattr(mjcf_pdg.solve(ball, q[row]), field.name)
            assert np.array_equal(column[row], alone), field.name
    kinds = {f.name: getattr(results, f.name).dtype.kind for f in dataclasses.fields(results)}
    assert kinds["certified"] == kinds["proven"] == "b"
    assert kinds["iterations"] == kinds["queries"] == "i"
    assert {kinds[name] for name in ("q", "sigma", "rms", "depth_in", "min_distance", "seconds")} == {"f"}
    assert {kinds[name] for name in ("status", "start", "cause", "reason")} == {"U"}


def test_no_rows_are_no_results(ball):
    results = mjcf_pdg.solve(ball, np.empty((0, 1)))
    assert len(results) == 0 and results.q.shape == (0, 1) and results.status.shape == (0,)


@pytest.mark.parametrize("q", [
    [-1.0], (-1.0,), [-1], np.array([-1.0], np.float32), np.array([-1], np.int8), np.array([-1.0], ">f8"),
    np.array([-1.0, 7.0, 8.0])[::3], memoryview(np.array([-1.0])), np.array([-1.0], object),
])
def test_anything_that_numpy_makes_float64_of_is_a_configuration(ball, q):
    assert mjcf_pdg.solve(ball, q).q == mjcf_pdg.solve(ball, np.array([-1.0])).q


def test_rows_may_be_in_any_memory_order(puma):
    q = np.array(puma.key_qpos[1:5])
    wanted = mjcf_pdg.solve(puma, q).q.tobytes()
    assert mjcf_pdg.solve(puma, np.asfortranarray(q)).q.tobytes() == wanted
    assert mjcf_pdg.solve(puma, np.repeat(q, 2, axis=0)[::2]).q.tobytes() == wanted
    assert mjcf_pdg.solve(puma, q[::-1]).q[::-1].tobytes() == wanted
    assert mjcf_pdg.solve(puma, q.tolist(), threads=3).q.tobytes() == wanted


def test_unsolved_says_why():
    boxes = """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
    <body pos="0 0 .05"><joint type="slide" axis="1 0 0"/><geom name="box" type="box" size=".1 .1 .1"/></body>
    </worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(boxes)
    result = mjcf_pdg.solve(model, [0.0])
    assert result.status == "unsolved" and not result.free
    assert result.cause == "permanent" and "floor" in result.reason and "box" in result.reason
    results = mjcf_pdg.solve(model, [[0.0]])
    assert results.reason.tolist() == [result.reason] and not results.free.any()


def test_results_become_a_data_frame(ball):
    frame = mjcf_pdg.solve(ball, [[-1.0], [0.0]]).to_pandas()
    assert frame.status.tolist() == ["solved", "already_free"]
    assert frame.sigma[1] == 0.0 and frame.q[1].tolist() == [0.0]


def test_results_can_be_pickled(ball):
    result = pickle.loads(pickle.dumps(mjcf_pdg.solve(ball, [-1.0])))
    assert result.status == "solved" and result.contacts_in[0].geom1 == "floor"


def test_progress_is_shown_where_tqdm_is(ball, capsys, monkeypatch):
    mjcf_pdg.solve(ball, [[-1.0], [0.0]], progress=True)
    assert "2/2" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "tqdm", None)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    mjcf_pdg.solve(ball, [[-1.0], [0.0]], progress=True)
    assert capsys.readouterr().err == ""


def test_norm_of_a_slide_is_its_square(ball):
    assert mjcf_pdg.object_norm(ball, [0.0], [0.3]) == pytest.approx(0.09)
    assert mjcf_pdg.object_norm(ball, [0.0], [0.3], metric="displacement") == pytest.approx(0.09)


def test_norm_depends_on_metric_and_root(puma):
    q0, q1 = puma.key("home").qpos, puma.key("arm_through_roof").qpos
    sequential = mjcf_pdg.object_norm(puma, q0, q1)
    assert sequential != mjcf_pdg.object_norm(puma, q0, q1, metric="displacement")
    assert sequential != mjcf_pdg.object_norm(puma, q0, q1, root="link6")
    result = mjcf_pdg.solve(puma, q1)
    assert mjcf_pdg.object_norm(puma, q1, result.q) == pytest.approx(result.sigma, rel=1e-12)


def test_verdict_is_true_if_free(ball):
    free, not_free = mjcf_pdg.verify(ball, [-0.85]), mjcf_pdg.verify(ball, [-0.95])
    assert free and free.free and free.reason == "" and free.certified and free.contacts == []
    assert free.min_distance == pytest.approx(0.05)
    assert not not_free and "sphere" in not_free.reason and not_free.min_distance == pytest.approx(-0.05)
    assert [contact.distance for contact in not_free.contacts] == pytest.approx([-0.05])
    assert not mjcf_pdg.verify(ball, [-0.85], clearance=0.06)
    assert mjcf_pdg.verify(ball, [-0.95], tolerance=0.06)


def test_contacts_of_q_in_may_rest(ball):
    assert not mjcf_pdg.verify(ball, [-0.95], rest=0.1)
    assert mjcf_pdg.verify(ball, [-0.95], rest=0.1, q_in=[-0.95])


def test_motion_is_free_until_contact(ball):
    motion = mjcf_pdg.check_motion(ball, [0.0], [-1.8])
    assert motion.outcome == "contact" and not motion and motion.certified
    assert motion.t == pytest.approx(0.5, abs=1e-4) and motion.q == pytest.approx([-0.9], abs=2e-4)
    assert motion.pairs == [("floor", "sphere")] and motion.joint is None
    assert motion.poses > 0 and motion.distance_queries > 0
    assert mjcf_pdg.check_motion(ball, [0.0], [-0.8])
    assert mjcf_pdg.check_motion(ball, [-1.0], [0.0]).outcome == "start_in_collision"


def test_motion_names_the_joint_that_ends_it():
    limited = """<mujoco><worldbody><body><joint name="knee" range="-1 1" limited="true"/>
    <geom size=".1"/></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(limited.replace('range="-1 1"', 'range="-57.29577951308232 57.29577951308232"'))
    motion = mjcf_pdg.check_motion(model, [0.0], [2.0])
    assert motion.outcome == "limit" and motion.joint == "knee" and motion.t == pytest.approx(0.5)


def test_mocap_poses_are_those_of_the_obstacles():
    model = mujoco.MjModel.from_xml_string(OVER_MOCAP)
    assert mjcf_pdg.solve(model, [-1.0]).q == pytest.approx([-0.9], abs=2 * TOLERANCE)
    raised = mjcf_pdg.solve(model, [-1.0], mocap_pos=[[0.0, 0.0, 0.25]])
    assert raised.q == pytest.approx([-0.65], abs=2 * TOLERANCE)
    data = mujoco.MjData(model)
    data.qpos[:] = -1.0
    data.mocap_pos[0] = [0.0, 0.0, 0.125]
    assert mjcf_pdg.Solver(model).solve(data).q == pytest.approx([-0.775], abs=2 * TOLERANCE)
    assert data.qpos == [-1.0]


def test_audit_finds_what_is_wrong(ball):
    key = '<keyframe><key name="sunk" qpos="-1"/></keyframe></mujoco>'
    from conftest import BALL

    model = mujoco.MjModel.from_xml_string(BALL.replace("</mujoco>", key))
    report = mjcf_pdg.audit(model, samples=20)
    assert report["model"] == "ball" and report["samples"] == 20
    (pair,) = report["pairs"]
    assert (pair["geom1"], pair["geom2"], pair["class"]) == ("floor", "sphere", "default")
    assert [one["name"] for one in report["keyframes"]] == ["qpos0", "sunk"]
    assert report["keyframes"][1]["depth"] == pytest.approx(0.1)
    assert report["exclude"] == [] and report["never"] == 0


def test_models_with_mujocos_own_plugins_are_solved():
    # A ring 2 cm deep in the floor: a plugin, which mujoco loads when it is imported, has its SDF.
    ring = mujoco.MjModel.from_xml_string("""<mujoco><extension><plugin plugin="mujoco.sdf.torus">
      <instance name="ring"><config key="radius1" value=".35"/><config key="radius2" value=".15"/>
      </instance></plugin></extension><asset><mesh name="ring"><plugin instance="ring"/></mesh></asset>
      <worldbody><geom type="plane" size="2 2 1"/><body pos="0 0 .13"><joint type="slide" axis="0 0 1"/>
      <geom type="sdf" mesh="ring"><plugin instance="ring"/></geom></body></worldbody></mujoco>""")
    result = mjcf_pdg.solve(ring, [0.0])
    assert result.status == "solved" and result.q == pytest.approx([0.02], abs=1e-3)
