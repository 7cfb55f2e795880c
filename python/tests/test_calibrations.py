"""Calibrated cameras against COLMAP's own code (pycolmap).

ANAMORPH_POINTS is how many points are projected through each lens: 500 without it.
"""

from __future__ import annotations

import os
import pathlib
from typing import Any

import anamorph as am
import numpy as np
import pytest

POINTS = int(os.environ.get("ANAMORPH_POINTS", 500))
SIZE = (160, 120)

# Pixels of up to 160 round to 2^-46, and the models' formulas make that some ten times larger.
PIXEL = 1e-12

# Parameters after the focal lengths and the principal point, as means and largest deviations.
COLMAP = {
    "SIMPLE_PINHOLE": [],
    "PINHOLE": [],
    "SIMPLE_RADIAL": [(0, 0.1)],
    "RADIAL": [(0, 0.1), (0, 0.02)],
    "OPENCV": [(0, 0.1), (0, 0.02), (0, 2e-3), (0, 2e-3)],
    "OPENCV_FISHEYE": [(0, 0.05), (0, 5e-3), (0, 1e-3), (0, 1e-4)],
    "FULL_OPENCV": [(0, 0.1), (0, 0.02), (0, 2e-3), (0, 2e-3), (0, 0.01), (0, 0.1), (0, 0.02), (0, 0.01)],
    "FOV": [(0.8, 0.5)],
    "SIMPLE_RADIAL_FISHEYE": [(0, 0.05)],
    "RADIAL_FISHEYE": [(0, 0.05), (0, 5e-3)],
    "THIN_PRISM_FISHEYE": [(0, 0.05), (0, 5e-3), (0, 2e-3), (0, 2e-3), (0, 1e-3), (0, 1e-4), (0, 2e-3), (0, 2e-3)],
    "RAD_TAN_THIN_PRISM_FISHEYE": [
        *[(0, 0.05), (0, 5e-3), (0, 1e-3), (0, 1e-4), (0, 1e-5), (0, 1e-6)],
        *[(0, 2e-3), (0, 2e-3), (0, 2e-3), (0, 2e-3), (0, 2e-3), (0, 2e-3)],
    ],
    "SIMPLE_DIVISION": [(-0.2, 0.25)],
    "DIVISION": [(-0.2, 0.25)],
    "SIMPLE_FISHEYE": [],
    "FISHEYE": [],
    "EUCM": [(0.5, 0.5), (1.0, 0.5)],
    "EQUIRECTANGULAR": [],
}


def placed(file: pathlib.Path) -> am.Camera:
    """The camera at the origin, its frame the world's: x right, y down, z forward."""
    return am.camera.calibrated(file=str(file), matrix=np.eye(4)[:3].tolist(), convention="opencv")


def known(model: str, own: Any, points: np.ndarray) -> np.ndarray:
    """Which points COLMAP projects, but for those near the axis of its FOV, where it is a short series."""
    finite = np.isfinite(projected(own, points)).all(axis=1)
    return finite & ((points[:, :2] ** 2).sum(axis=1) > 1e-4 * points[:, 2] ** 2) if model == "FOV" else finite


def projected(own: Any, points: np.ndarray) -> np.ndarray:
    """By COLMAP, behind the eye too, but for its fisheyes, which mirror what is there."""
    return own.img_from_cam(points, check_cheirality="FISHEYE" in own.model.name)


@pytest.mark.parametrize("model", COLMAP)
def test_colmap(model: str, tmp_path: pathlib.Path) -> None:
    pycolmap = pytest.importorskip("pycolmap")
    rng = np.random.default_rng(list(model.encode()))
    fields = 0
    for lens in range(3):
        k = [mean + deviation * rng.uniform(-1, 1) for mean, deviation in COLMAP[model]]
        is_wide = "FISHEYE" in model or model in ("EUCM", "EQUIRECTANGULAR")
        focal = rng.uniform(35, 50, 2) if is_wide else rng.uniform(100, 130, 2)
        centre = [SIZE[0] / 2 + rng.uniform(-9, 9), SIZE[1] / 2 + rng.uniform(-9, 9)]
        parameters = [*(focal[:1] if model.startswith(("SIMPLE", "RADIAL")) else focal), *centre, *k]
        if model == "EQUIRECTANGULAR":
            parameters = list(SIZE)
        own = pycolmap.Camera(model=model, width=SIZE[0], height=SIZE[1], params=parameters)
        (tmp_path / "cameras.txt").write_text(f"1 {model} {SIZE[0]} {SIZE[1]} {' '.join(repr(float(p)) for p in parameters)}\n")
        camera = placed(tmp_path)

        # the rays of all pixels are COLMAP's own pixels
        _, rays = camera.rays(SIZE)
        y, x = np.nonzero(np.isfinite(rays).all(axis=-1))
        rays, pixels = rays[y, x], np.stack([x, y], axis=1) + 0.5
        answered = known(model, own, rays)
        off = np.linalg.norm(projected(own, rays[answered]) - pixels[answered], axis=1)
        assert off.max() <= PIXEL, (lens, parameters, off.max())
        fields += len(off)

        # and each point of such a ray is seen there, once, at its t
        some = rng.choice(np.flatnonzero(answered), POINTS)
        t = rng.uniform(0.5, 8, POINTS)
        for number, at, found in zip(some, t, am.project(None, camera, t[:, None] * rays[some], SIZE), strict=True):
            ahead = found.images[found.t > 0]
            assert len(ahead) == 1 and np.linalg.norm(ahead[0] - pixels[number]) <= PIXEL, (lens, number, found)
            assert np.abs(found.t[found.t > 0] / at - 1).max() <= 1e-14, (lens, number, found)
    # of three lenses; its fisheyes answer up to 90 degrees
    assert fields > 1.5 * SIZE[0] * SIZE[1], fields
