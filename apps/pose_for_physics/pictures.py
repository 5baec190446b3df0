"""Plots of runs, and animations of a sketch beside its repair."""

import mujoco
import numpy as np

from simulation import SECONDS, Run, moving

# Colours that a deuteranope tells apart (Okabe and Ito).
COLOURS = {"sketched": "#D55E00", "repaired": "#009E73"}


def plot(path: str, poses: list[tuple[str, dict[str, Run]]], bounds: tuple[float, float]) -> None:
    """A column for each name of a model, with the force and speed of its poses' runs; `bounds` of both are drawn."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    models = list(dict.fromkeys(model for model, _ in poses))
    figure, axes = pyplot.subplots(
        2, len(models), sharex=True, sharey="row", squeeze=False, figsize=(6 * len(models), 7), layout="constrained"
    )
    panels = zip(("force", "speed"), bounds, ("contact force / weight", "fastest body [m/s]"))
    for row, (field, bound, label) in enumerate(panels):
        axes[row, 0].set_ylabel(label)
        for axis, name in zip(axes[row], models):
            for runs in (runs for model, runs in poses if model == name):
                for kind, run in runs.items():
                    values = getattr(run, field)
                    time = np.linspace(0.0, SECONDS, len(values))
                    axis.plot(time, np.maximum(values, 1e-2), color=COLOURS[kind], linewidth=0.8)
            axis.axhline(bound, color="black", linewidth=0.8, linestyle="--")
            axis.set_yscale("log")
    for top, bottom, name in zip(*axes, models):
        top.set_title(name)
        bottom.set_xlabel("time [s]")
    lines = [pyplot.Line2D([], [], color=colour, label=kind) for kind, colour in COLOURS.items()]
    figure.legend(handles=lines, loc="outside upper right", ncols=len(lines))
    figure.savefig(path, dpi=100)


def animate(path: str, source: str, runs: dict[str, Run]) -> None:
    """Runs of the model in the file `source` side by side, four times slower than life."""
    from PIL import Image

    per_second, slower, width, height = 50, 4, 400, 360
    columns = []
    for name, run in runs.items():
        model = mujoco.MjModel.from_xml_path(source)
        colour = [int(COLOURS[name][k : k + 2], 16) / 255 for k in (1, 3, 5)]
        painted = moving(model)[model.geom_bodyid]
        model.geom_matid[painted] = -1
        model.geom_rgba[painted] = [*colour, 1]
        data, frames = mujoco.MjData(model), []
        steps = np.rint(np.arange(0.0, SECONDS + 1e-9, 1 / per_second) / run.timestep).astype(int)
        with mujoco.Renderer(model, height, width) as renderer:
            for q in run.q[np.minimum(steps, len(run.q) - 1)]:
                data.qpos[:] = q
                mujoco.mj_forward(model, data)
                renderer.update_scene(data, 0 if model.ncam else -1)
                frames.append(renderer.render().copy())
        columns.append(frames)
    images = [Image.fromarray(np.hstack(both)).quantize(64) for both in zip(*columns)]
    images[0].save(path, save_all=True, append_images=images[1:], duration=1000 * slower // per_second, loop=0)
