"""MuJoCo's passive viewer with the repaired configuration as a ghost."""

import copy
import threading
import types
import typing
import warnings

import mujoco
import numpy as np

from mjcf_pdg._answers import Result
from mjcf_pdg._functions import Tracker, TrackOptions

# As in the window of `mjcf-pdg view`: blue differs from orange for every kind of colour vision; a ghost that is not
# free is white.
_GUILTY = (0.95, 0.50, 0.05, 1.0)
_GHOST = (0.05, 0.30, 0.90, 0.6)
_UNFREE_GHOST = (0.95, 0.95, 0.95, 0.6)
# A geom of the ghost that is nearer to its place in the command than this share of the model's size is not drawn:
# surfaces that coincide flicker. What overlaps is drawn larger by the other one, in front of what the viewer draws.
_APART = 1e-3
_LARGER = 1.003


class GhostScene:
    """Writes the ghost of a repair, and what overlaps in the command, into a scene (MjvScene). Needs no window."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = copy.copy(model)  # its colours say what is drawn
        self._model.geom_matid[:] = -1
        self._command, self._ghost = mujoco.MjData(model), mujoco.MjData(model)
        self._unbounded = np.isin(model.geom_type, (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD))

    def draw(self, scene: mujoco.MjvScene, data: mujoco.MjData, result: Result) -> None:
        """Replaces the geoms of `scene`. `result` is the repair of the qpos of `data`, with its contacts_in."""
        scene.ngeom = 0
        if result.status == "already_free":
            return
        for pose, qpos in ((self._command, data.qpos), (self._ghost, result.q)):
            pose.qpos[:] = qpos
            pose.mocap_pos[:], pose.mocap_quat[:] = data.mocap_pos, data.mocap_quat
            mujoco.mj_kinematics(self._model, pose)
            mujoco.mj_comPos(self._model, pose)
        guilty = np.zeros(self._model.ngeom, dtype=bool)
        for contact in result.contacts_in:
            for geom in (contact.geom1, contact.geom2):
                guilty[self._model.geom(geom).id] = True
        self._add(scene, self._command, guilty & ~self._unbounded, _GUILTY)
        for geom in scene.geoms[: scene.ngeom]:
            geom.size *= _LARGER
        self._add(scene, self._ghost, self._moved(), _UNFREE_GHOST if result.status == "unsolved" else _GHOST)

    def _moved(self) -> np.ndarray:
        """Which geoms are elsewhere in the ghost than in the command."""
        moved = np.linalg.norm(self._ghost.geom_xpos - self._command.geom_xpos, axis=1)
        turned = np.linalg.norm(self._ghost.geom_xmat - self._command.geom_xmat, axis=1)
        far = moved + np.sqrt(2.0) * self._model.geom_rbound * turned > _APART * self._model.stat.extent
        return far & ~self._unbounded

    def _add(self, scene: mujoco.MjvScene, pose: mujoco.MjData, shown: np.ndarray, color: tuple[float, ...]) -> None:
        self._model.geom_rgba[:] = color
        self._model.geom_rgba[~shown, 3] = 0.0  # what is invisible is not added
        option = mujoco.MjvOption()
        option.sitegroup[:] = 0
        first = scene.ngeom
        categories = mujoco.mjtCatBit.mjCAT_DYNAMIC.value | mujoco.mjtCatBit.mjCAT_STATIC.value
        mujoco.mjv_addGeoms(self._model, pose, option, mujoco.MjvPerturb(), categories, scene)
        for geom in scene.geoms[first : scene.ngeom]:
            geom.emission = 0.2


class View:
    """A window of MuJoCo's passive viewer, in which the repair of data.qpos follows as a ghost; see `view`.

    viewer: the mujoco.viewer.Handle. result: of the last `sync`, or None.
    """

    def __init__(self, handle: typing.Any, threads: list[threading.Thread], data: mujoco.MjData, tracker: Tracker) -> None:
        self.viewer = handle
        self.result: Result | None = None
        self._data = data
        self._tracker = tracker
        self._threads = threads
        self._scene = GhostScene(tracker.model)

    def sync(self) -> Result:
        """Repairs data.qpos, draws the ghost, and lets the viewer take over what its sliders say.

        Call it once a frame, as the viewer's own `sync`. `data` is not changed but by the viewer.
        """
        self.result = self._tracker.step(self._data.qpos, self._data)
        with self.viewer.lock():
            self._scene.draw(self.viewer.user_scn, self._data, self.result)
        self.viewer.sync()
        return self.result

    def is_running(self) -> bool:
        """False once the window is closed."""
        return self.viewer.is_running()

    def close(self) -> None:
        """Closes the window and waits until it is gone: where Python ends before, the viewer may crash."""
        self.viewer.close()
        for thread in self._threads:
            thread.join(timeout=10.0)

    def __enter__(self) -> "View":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: types.TracebackType | None
    ) -> None:
        self.close()


def view(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    *,
    key_callback: typing.Callable[[int], None] | None = None,
    show_left_ui: bool = True,
    show_right_ui: bool = True,
    **options: typing.Unpack[TrackOptions],
) -> View:
    """Opens mujoco.viewer.launch_passive with the repair of data.qpos as a blue ghost.

    What overlaps is orange. The ghost follows as a Tracker does, one step with every `sync`:

        with mjcf_pdg.view(model, data) as view:
            while view.is_running():
                mujoco.mj_forward(model, data)     # or your own loop, mj_step
                result = view.sync()               # move a joint's slider: result.q follows

    Args:
      model, data: of which only the viewer changes anything.
      key_callback, show_left_ui, show_right_ui: as of launch_passive.
      options: those of Tracker.

    Raises:
      RuntimeError: there is no display.
      ImportError: the package glfw is not installed, which mujoco.viewer needs.
      ValueError, TypeError: as Tracker.
    """
    options.setdefault("report_contacts", True)
    tracker = Tracker(model, **options)
    import mujoco.viewer

    _check_display()
    before = set(threading.enumerate())
    handle = mujoco.viewer.launch_passive(
        model, data, key_callback=key_callback, show_left_ui=show_left_ui, show_right_ui=show_right_ui
    )
    viewers = [thread for thread in threading.enumerate() if thread not in before]
    return View(handle, viewers, data, tracker)


def _check_display() -> None:
    """Raises RuntimeError if there is no display. The viewer itself would end the process."""
    import glfw

    with warnings.catch_warnings(record=True) as caught:  # which is how the package tells of GLFW's errors
        warnings.simplefilter("always")
        if glfw.init():
            glfw.terminate()
            return
    raise RuntimeError("no window: " + "; ".join(["there is no display", *(str(one.message) for one in caught)]))
