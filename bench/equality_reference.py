#!/usr/bin/env python3
"""Answers on equality constraints beside those of a general solver: σ of mjcf_pdg over the least σ that SLSQP finds.

    pip install . scipy && python3 bench/equality_reference.py models/loops/*.xml --count 12

SLSQP (scipy) minimizes the mean squared displacement (--metric displacement, computed here anew) over dq, subject to MuJoCo's own signed distances and residuals, from many
starts: q_in, noise around it of growing width, and noise around our answer. A point of it counts if mjcf_pdg.verify calls
it free. Half of the inputs are random inside the joint limits, so that they violate the constraints; the other half are
answers of that kind, moved along the constraints until they overlap.
"""

import argparse
import copy
import pathlib
import statistics

import mjcf_pdg
import mujoco
import numpy as np
from scipy import optimize

FREE, HINGE, SLIDE = (int(t) for t in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE))
FREE_SPREAD = (0.05, 0.1)  # of a free body in a random pose [m, half rad]


class Problem:
    """The constraints of a model at q_in ⊕ dq, by MuJoCo alone."""

    def __init__(self, model):
        self.model = model
        self.data = mujoco.MjData(model)
        self.pairs = [(a, b) for a in range(model.ngeom) for b in range(a + 1, model.ngeom) if self.kept(a, b)]
        self.residual_model = copy.copy(model)
        self.residual_model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT

        # Rows that never change (of a planar loop, those across its plane) make SLSQP's equations singular.
        random = np.random.default_rng(0)
        self.rows = slice(None)
        seen = np.array([self.residuals(random_pose(model, random)) for _ in range(10)])
        self.rows = np.ptp(seen, axis=0) > 1e-9

    def kept(self, a, b):
        m = self.model
        if not (m.geom_contype[a] & m.geom_conaffinity[b] or m.geom_contype[b] & m.geom_conaffinity[a]):
            return False
        one, other = m.body_weldid[m.geom_bodyid[a]], m.body_weldid[m.geom_bodyid[b]]
        if one == other or (m.body_dofnum[one] == 0 and m.body_dofnum[other] == 0):
            return False
        up = lambda body: m.body_weldid[m.body_parentid[body]]
        if one != 0 and other != 0 and (up(one) == other or up(other) == one):
            return False
        bodies = sorted((int(m.geom_bodyid[a]), int(m.geom_bodyid[b])))
        return (bodies[0] << 16) + bodies[1] not in set(m.exclude_signature.tolist())

    def moved(self, q_in, dq):
        q = q_in.copy()
        mujoco.mj_integratePos(self.model, q, dq, 1.0)
        return q

    def sigma(self, q0, q1):
        """The mean squared displacement of the mass that can move [m²]."""
        m, poses = self.model, []
        for q in (q0, q1):
            self.data.qpos[:] = q
            mujoco.mj_kinematics(m, self.data)
            poses.append((self.data.xipos.copy(), self.data.ximat.reshape(-1, 3, 3).copy()))
        (c0, R0), (c1, R1) = poses
        moves = m.body_weldid != 0
        mass = m.body_mass * moves
        # About the centre of mass: the integral of x² over the mass, from the moments of inertia.
        second = (0.5 * m.body_inertia.sum(axis=1, keepdims=True) - m.body_inertia) * moves[:, None]
        turned = ((R1 - R0) ** 2).sum(axis=1)
        return float((mass @ ((c1 - c0) ** 2).sum(axis=1) + (second * turned).sum()) / mass.sum())

    def distances(self, q):
        self.data.qpos[:] = q
        mujoco.mj_kinematics(self.model, self.data)
        return np.array([mujoco.mj_geomDistance(self.model, self.data, a, b, 1.0, None) for a, b in self.pairs])

    def residuals(self, q):
        self.data.qpos[:] = q
        mujoco.mj_fwdPosition(self.residual_model, self.data)
        return self.data.efc_pos[: self.data.ne][self.rows].copy()

    def limits(self, q):
        m, inside = self.model, []
        for j in range(m.njnt):
            if m.jnt_limited[j] and m.jnt_type[j] in (HINGE, SLIDE):
                value = q[m.jnt_qposadr[j]]
                inside += [value - m.jnt_range[j, 0], m.jnt_range[j, 1] - value]
        return np.array(inside)


def random_pose(model, random):
    q = model.qpos0.copy()
    for j in range(model.njnt):
        at = model.jnt_qposadr[j]
        if model.jnt_type[j] == FREE:
            q[at : at + 3] += random.uniform(-FREE_SPREAD[0], FREE_SPREAD[0], 3)
            q[at + 4 : at + 7] = random.uniform(-FREE_SPREAD[1], FREE_SPREAD[1], 3)
            continue
        low, high = model.jnt_range[j] if model.jnt_limited[j] else (-1.5, 1.5)
        q[at] = random.uniform(low, high)
    mujoco.mj_normalizeQuat(model, q)
    return q


def inputs(model, count, random):
    """Random poses, and poses on the constraints that overlap or are free."""
    contactless = copy.copy(model)
    contactless.geom_contype[:] = contactless.geom_conaffinity[:] = 0
    while count > 0:
        q = random_pose(model, random)
        if count % 2:
            on = mjcf_pdg.solve(contactless, q)
            if on.status == "unsolved":
                continue
            q = on.q
        if mjcf_pdg.verify(model, q):
            continue
        count -= 1
        yield q


def minimize(problem, q_in, start):
    """The point that SLSQP reaches from dq = start."""
    square = lambda dq: 1e3 * problem.sigma(q_in, problem.moved(q_in, dq))
    constraints = [
        {"type": "ineq", "fun": lambda dq: problem.distances(problem.moved(q_in, dq))},
        {"type": "eq", "fun": lambda dq: problem.residuals(problem.moved(q_in, dq))},
    ]
    if problem.limits(q_in).size:
        constraints.append({"type": "ineq", "fun": lambda dq: problem.limits(problem.moved(q_in, dq))})
    found = optimize.minimize(square, start, method="SLSQP", constraints=constraints,
                              options={"maxiter": 150, "ftol": 1e-10})
    return problem.moved(q_in, found.x) if np.all(np.isfinite(found.x)) else q_in


def difference(model, q0, q1):
    dq = np.zeros(model.nv)
    mujoco.mj_differentiatePos(model, dq, 1.0, q0, q1)
    return dq


def reference(problem, q_in, ours, starts, random):
    """The least σ of a free point that SLSQP reaches, infinite if there is none."""
    model = problem.model
    to_ours = difference(model, q_in, ours)
    best = np.inf
    for k in range(starts):
        noise = random.normal(size=model.nv) * 0.02 * 2.0 ** (k // 4)
        q = minimize(problem, q_in, noise if k % 2 == 0 else to_ours + noise)
        if mjcf_pdg.verify(model, q, tolerance=2e-6):
            best = min(best, problem.sigma(q_in, q))
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=12, help="inputs of a model")
    parser.add_argument("--starts", type=int, default=12, help="of SLSQP for an input")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    all_ratios = []
    print("model                 inputs  solved  σ/best median    p95  worst  found by SLSQP")
    for path in arguments.models:
        model = mujoco.MjModel.from_xml_path(str(path))
        problem, random = Problem(model), np.random.default_rng(arguments.seed)
        ratios, solved, found = [], 0, 0
        for q_in in inputs(model, arguments.count, random):
            ours = mjcf_pdg.solve(model, q_in, metric="displacement")
            assert np.isclose(ours.sigma, problem.sigma(q_in, ours.q), rtol=1e-6)
            solved += ours.status != "unsolved"
            best = reference(problem, q_in, ours.q, arguments.starts, random)
            found += np.isfinite(best)
            if ours.status != "unsolved":
                ratios.append(ours.sigma / min(best, ours.sigma))
        all_ratios += ratios
        print(f"{path.stem:20s} {arguments.count:7d} {solved:7d} {statistics.median(ratios):14.4f} "
              f"{np.quantile(ratios, 0.95):6.3f} {max(ratios):6.3f} {found:10d}", flush=True)
    print(f"{'all':20s} {len(all_ratios):7d} {'':7s} {statistics.median(all_ratios):14.4f} "
          f"{np.quantile(all_ratios, 0.95):6.3f} {max(all_ratios):6.3f}")


if __name__ == "__main__":
    main()
