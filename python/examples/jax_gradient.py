"""The nearest free configuration as a jax.custom_vjp: poses learn to stay out of a car."""

import functools
import pathlib

import mujoco
import numpy as np

import mjcf_pdg

try:
    import jax
    import jax.numpy as jnp
except ImportError as error:
    print(f"skipped: {error} (pip install jax)")
    raise SystemExit(0)

MODEL = pathlib.Path(__file__).resolve().parents[2] / "models" / "puma" / "puma_car.xml"
jax.config.update("jax_enable_x64", True)


def make_nearest_free(model: mujoco.MjModel, **options):
    """q_in (n, nq) → q (n, nq) and sigma (n,), for a model of hinges and slides, so that nq is nv.

    It may be jitted: solves are called back. Rows without a derivative (mjcf_pdg.Gradient says which)
    pass back zeros.
    """

    def solve(q_in: np.ndarray) -> tuple[np.ndarray, ...]:
        results = mjcf_pdg.solve(model, np.asarray(q_in), **options)
        gradient = mjcf_pdg.gradient(model, results, **options)
        return results.q, results.sigma, np.nan_to_num(gradient.sigma), np.nan_to_num(gradient.q)

    def call(q_in: jax.Array) -> tuple[jax.Array, ...]:
        n, nq = q_in.shape
        shapes = [(n, nq), (n,), (n, nq), (n, nq, nq)]
        return jax.pure_callback(solve, [jax.ShapeDtypeStruct(shape, jnp.float64) for shape in shapes], q_in)

    @jax.custom_vjp
    def nearest_free(q_in: jax.Array) -> tuple[jax.Array, jax.Array]:
        q, sigma, *_ = call(q_in)
        return q, sigma

    def forward(q_in: jax.Array):
        q, sigma, dsigma, dq = call(q_in)
        return (q, sigma), (dsigma, dq)

    def backward(saved, by):
        (dsigma, dq), (by_q, by_sigma) = saved, by
        return (by_sigma[:, None] * dsigma + jnp.einsum("ni,nij->nj", by_q, dq),)

    nearest_free.defvjp(forward, backward)
    return nearest_free


def main() -> None:
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    nearest_free = make_nearest_free(model, effort="fast")
    rng = np.random.default_rng(0)
    keys = np.array([model.key(name).qpos for name in ("tool_scratches_door", "cart_in_running_board")])
    wanted = jnp.asarray(np.repeat(keys, 3, axis=0) + rng.normal(0.0, 0.02, (6, model.nq)))

    @jax.jit
    @functools.partial(jax.value_and_grad, has_aux=True)
    def loss(poses: jax.Array):
        q, sigma = nearest_free(poses)
        # Near the wanted poses, but where little has to be repaired.
        near = 0.1 * jnp.square(poses - wanted).sum() + 0.1 * jnp.square(q - wanted).sum()
        return sigma.sum() + near, sigma

    poses = wanted
    for step in range(16):
        (value, sigma), gradient = loss(poses)
        poses = poses - 0.2 * gradient
        if step % 5 == 0:
            print(f"step {step:2}  loss {value:.6f}  to repair {1e3 * jnp.sqrt(sigma).mean():7.3f} mm (rms)")
    print(f"{sum(mjcf_pdg.solve(model, np.asarray(poses)).free)} of {len(poses)} poses are solved at the end")


if __name__ == "__main__":
    main()
