import math
from collections.abc import Callable

import mujoco
import numpy as np

from robot import TIMESTEP, Robot


def levers(model: mujoco.MjModel, robot: Robot) -> np.ndarray:
    """(pairs, servos): a row times how far the servos move bounds what two geoms can move against each other [m/rad or 1].

    Rows are of pairs of branches of the tree of bodies, and of a branch and the world.
    """
    reach: dict[int, float] = {}  # from a body's origin to the farthest point that it carries
    for body in range(model.nbody - 1, 0, -1):
        geoms = range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body])
        far = [float(np.linalg.norm(model.geom_pos[g])) + float(model.geom_rbound[g]) for g in geoms]
        joints = range(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body])
        slides = [np.abs(model.jnt_range[j]).max() for j in joints if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_SLIDE]
        below = [reach[c] + float(np.linalg.norm(model.body_pos[c])) for c in reach if model.body_parentid[c] == body]
        reach[body] = max(far + below, default=0.0) + float(sum(slides))
    lever = np.ones(len(robot.dofs))
    for k, dof in enumerate(robot.dofs):
        joint = int(model.dof_jntid[dof])
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
            lever[k] = reach[int(model.jnt_bodyid[joint])] + float(np.linalg.norm(model.jnt_pos[joint]))
    branches: set[tuple[bool, ...]] = {(False,) * len(lever)}
    for body in range(1, model.nbody):
        above = set()
        while body:
            above.add(body)
            body = int(model.body_parentid[body])
        branches.add(tuple(int(model.dof_bodyid[d]) in above for d in robot.dofs))
    between = {tuple(np.not_equal(a, b)) for a in branches for b in branches}
    rows = np.array(sorted(between), dtype=float) * lever
    return rows[[not any((other >= row).all() and (other > row).any() for other in rows) for row in rows]]


class Governor:
    GRID = 128
    def __init__(self, robot, lever, cushion, bandwidth, acceleration, speed, looks, is_free):
        self.w = bandwidth
        self.a_max = acceleration
        self.v_max = speed
        self.lever, self.cushion, self.looks, self.is_free = lever, cushion, looks, is_free
        n = len(robot.qpos)
        self.s = robot.home[robot.qpos].copy()
        self.x = np.zeros(n)      # q - s
        self.c = np.zeros(n)      # v + w x
        self.r_last = self.s.copy()
        self.rv = np.zeros(n); self.ra = np.zeros(n)
        self.points = np.zeros((2048, n)); self.first = self.last = 0
        self.mode = 0
        self.plan = None
        # until exp(-wt)(1+wt) is 1e-4
        u = np.linspace(0.0, 1.0, self.GRID)
        self.grid = 12.0 / self.w * u * u
        self.decay = np.exp(-self.w * self.grid)
        self.stat = dict(tries=0, fails=0, accepted=0, accel=0, modes=np.zeros(16,int), samples=0, mod2=np.zeros(16,int))

    def state(self, t):
        e = math.exp(-self.w * t)
        x = (self.x + self.c * t) * e
        c = self.c * e   # v + w x = c e^{-wt}
        return x, c

    def within(self, x, c):
        """Per joint: acceleration and speed stay within their limits from state (x, c) on."""
        w = self.w
        with np.errstate(divide='ignore', invalid='ignore'):
            ta = np.where(c != 0, 3/w - x/c, -1.0)
            tv = np.where(c != 0, 2/w - x/c, -1.0)
        ta = np.where(ta > 0, ta, np.inf); tv = np.where(tv > 0, tv, np.inf)
        a = np.maximum(np.abs(w*w*x - 2*w*c), np.abs(w*c)*np.exp(-w*ta))
        v = np.maximum(np.abs(c - w*x), np.abs(c)*np.exp(-w*tv))
        return (a <= self.a_max) & (v <= self.v_max)

    SHARES = np.append(0.8**np.arange(0, 16), 0.0)[:, None]
    def step(self, r, feed_v=None):
        if self.first == self.last or np.abs(self.points[self.last-1]-r).max() > 0.01:
            if self.last == len(self.points):
                keep = min(self.last - self.first, len(self.points)//2)
                self.points[:keep] = self.points[self.last-keep:self.last].copy()
                self.first, self.last = 0, keep
            self.points[self.last] = r
            self.last += 1
        self.advance_plan(r)
        self.x, self.c = self.state(TIMESTEP)
        return self.s + self.x, self.c - self.w*self.x, self.w*self.w*self.x - 2*self.w*self.c

    TAU = 0.02
    def lead(self, r):
        raw = (r - self.r_last)/TIMESTEP
        self.r_last = r
        d = (raw - self.rv)/self.TAU
        self.rv = self.rv + d*TIMESTEP
        self.ra = self.ra + (np.clip(d, -self.a_max, self.a_max) - self.ra)*TIMESTEP/self.TAU
        v = self.rv + self.TAU*self.ra
        return r + 2/self.w*v + self.ra/self.w**2

    def candidate(self, mode, r, ahead):
        """target and what becomes of the trail if it's accepted"""
        if mode < 4: return self.s + 0.5**mode*(r - self.s), mode == 0
        i = (self.last - self.first) >> (mode - 3)
        return self.points[self.first + i], False

    def modes(self):
        return 4 + max(1, (self.last - self.first).bit_length())

    def begin(self, r):
        """a new candidate"""
        self.stat['tries'] += 1
        K = self.plan_K if hasattr(self, 'plan_K') else 2
        for attempt in range(3):
            t = K*TIMESTEP
            x, c = self.state(t)
            target, reached = self.candidate(self.mode, r, t)
            ds = self.SHARES*(target - self.s)
            ok = self.within(x - ds, c - self.w*ds)
            best = np.argmax(ok, axis=0)
            ds = np.where(ok.any(axis=0), ds[best, np.arange(len(x))], 0.0)
            k = int(best.max() > 0)
            if not ds.any():
                self.stat['accel'] += 1
                return None
            x, c = x - ds, c - self.w*ds
            s = self.s + ds
            Q = (x[None] + c[None]*self.grid[:,None])*self.decay[:,None]
            moved = (np.abs(np.diff(Q, axis=0)) @ self.lever.T).max(axis=1)
            cum = np.concatenate([[0], np.cumsum(moved)])
            pieces = (cum/self.cushion).astype(int)
            picks = np.flatnonzero(np.diff(pieces)) + 0
            picks = np.append(picks[picks>0], self.GRID-1)
            need = math.ceil(len(picks)/self.looks)
            if need <= K:
                self.stat['samples'] += len(picks)
                if k > 0: reached = False
                return dict(K=K, s=s, x=x, c=c, Q=Q[picks]+s, left=len(picks), reached=reached, age=0)
            K = need + 1
        return None

    def advance_plan(self, r):
        looks = self.looks
        begun = False
        while looks > 0:
            if self.plan is None:
                if begun: break
                begun = True
                self.plan = self.begin(r)
                if self.plan is None:
                    self.mode = (self.mode + 1) % self.modes()
                    break
            p = self.plan
            while looks > 0 and p['left'] > 0:
                looks -= 1
                p['left'] -= 1
                if not self.is_free(p['Q'][p['left']]):
                    self.stat['fails'] += 1
                    self.stat['mod2'][min(self.mode,15)] += 1
                    self.plan = None
                    self.mode = (self.mode + 1) % self.modes()
                    break
            if self.plan is not None and p['left'] == 0: break
        p = self.plan
        if p is None: return
        if p['age'] == p['K']:
            assert p['left'] == 0
            self.plan_K = max(1, math.ceil(0.5*p['K']))
            near = np.abs(self.points[self.first:self.last] - p['s']) @ self.lever.T
            self.first += int(np.argmin(near.max(axis=1)))
            self.s, self.x, self.c = p['s'], p['x'], p['c']
            self.stat['accepted'] += 1
            self.stat['modes'][min(self.mode,15)] += 1
            self.mode = 0 if self.mode < 4 else self.mode - 1
            self.plan = None
        else:
            p['age'] += 1
