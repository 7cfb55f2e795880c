"""A PyTorch data set of rendered views: depth, ids and the camera of each, made by worker processes when they are asked for.

    python views.py
"""

from __future__ import annotations

import argparse

import anamorph as am
import numpy as np
import torch
from torch.utils.data import DataLoader, Dataset

class Views(Dataset):  # type: ignore[type-arg]
    """Fisheye views from a ball around a mesh."""

    def __init__(self, scene: am.Scene, count: int, side: int) -> None:
        self.renderer = am.Renderer(scene)
        self.side = side
        lower, upper = scene.bounds
        self.center, radius = (lower + upper) / 2, np.linalg.norm(upper - lower)
        eyes = np.random.default_rng(0).normal(size=(count, 3))
        self.eyes = self.center + radius * eyes / np.linalg.norm(eyes, axis=-1, keepdims=True)

    def __len__(self) -> int:
        return len(self.eyes)

    def __getitem__(self, number: int) -> dict[str, torch.Tensor]:
        self.renderer.aim(am.camera.fisheye(eye=self.eyes[number], target=self.center, fov=120))
        frame = self.renderer.render(["Z", "triangle.id"], size=(self.side, self.side))
        return {
            "depth": torch.from_numpy(frame["Z"]),
            "triangle": torch.from_numpy(frame["triangle.id"].view(np.int32)),
            "eye": torch.from_numpy(self.eyes[number]),
        }


# processes that are spawned import this file
if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--views", type=int, default=64)
    parser.add_argument("--side", type=int, default=96)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    scene = am.Scene()
    scene.add_builtin("teapot")
    views = Views(scene, arguments.views, arguments.side)
    # the renderer is pickled; each worker opens a device of its own
    start = "spawn" if arguments.workers else None
    loader = DataLoader(views, batch_size=16, shuffle=True, num_workers=arguments.workers, multiprocessing_context=start)
    covered = sum(int(torch.isfinite(batch["depth"]).sum()) for batch in loader)
    print(f"{arguments.views} views, {covered / arguments.views / arguments.side**2:.1%} of their pixels show the object")
