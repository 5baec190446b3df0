"""The nearest free configuration as a torch.autograd.Function: poses learn to stay out of a car."""

import pathlib

import mujoco
import numpy as np

import mjcf_pdg

try:
    import torch
except ImportError as error:
    print(f"skipped: {error} (pip install torch)")
    raise SystemExit(0)

MODEL = pathlib.Path(__file__).resolve().parents[2] / "models" / "puma" / "puma_car.xml"


class NearestFree(torch.autograd.Function):
    """q_in (n, nq) → q (n, nq) and sigma (n,), for a model of hinges and slides, so that nq is nv.

    Rows without a derivative (mjcf_pdg.Gradient says which) pass back zeros.
    """

    @staticmethod
    def forward(ctx, q_in: torch.Tensor, model: mujoco.MjModel, options: dict) -> tuple[torch.Tensor, torch.Tensor]:
        results = mjcf_pdg.solve(model, q_in.detach().numpy(), **options)
        gradient = mjcf_pdg.gradient(model, results, **options)
        ctx.save_for_backward(torch.from_numpy(gradient.sigma), torch.from_numpy(gradient.q))
        return torch.from_numpy(results.q), torch.from_numpy(results.sigma)

    @staticmethod
    def backward(ctx, by_q: torch.Tensor, by_sigma: torch.Tensor) -> tuple[torch.Tensor, None, None]:
        dsigma, dq = (saved.nan_to_num() for saved in ctx.saved_tensors)
        return by_sigma[:, None] * dsigma + torch.einsum("ni,nij->nj", by_q, dq), None, None


def main() -> None:
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    rng = np.random.default_rng(0)
    keys = np.array([model.key(name).qpos for name in ("tool_scratches_door", "cart_in_running_board")])
    wanted = torch.from_numpy(np.repeat(keys, 3, axis=0) + rng.normal(0.0, 0.02, (6, model.nq)))
    poses = wanted.clone().requires_grad_()
    optimizer = torch.optim.SGD([poses], lr=0.2)
    for step in range(16):
        optimizer.zero_grad()
        q, sigma = NearestFree.apply(poses, model, {"effort": "fast"})
        # Near the wanted poses, but where little has to be repaired.
        loss = sigma.sum() + 0.1 * (poses - wanted).square().sum() + 0.1 * (q - wanted).square().sum()
        loss.backward()
        optimizer.step()
        if step % 5 == 0:
            print(f"step {step:2}  loss {loss.item():.6f}  to repair {1e3 * sigma.sqrt().mean():7.3f} mm (rms)")
    print(f"{sum(mjcf_pdg.solve(model, poses.detach().numpy()).free)} of {len(poses)} poses are solved at the end")


if __name__ == "__main__":
    main()
