"""Calibrated cameras against the libraries whose files they read: COLMAP's own code (pycolmap) and OpenCV's.

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

# Pixels: they round to 2^-43, and the models' formulas make that some hundred times larger.
PIXEL = 1e-9

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


def directions(rng: np.random.Generator, widest: float) -> np.ndarray:
    """Points at random distances, at angles from z up to the widest, evenly."""
    theta, phi = rng.uniform(0, widest, POINTS), rng.uniform(-np.pi, np.pi, POINTS)
    across = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1)
    return across * rng.uniform(0.5, 8, (POINTS, 1))


def seen(camera: am.Camera, points: np.ndarray) -> list[np.ndarray]:
    """Where each point is seen at a t over 0, in pixels; the first pixel from 0 to 1."""
    found = am.project(None, camera, points, SIZE)
    return [p.images[p.t > 0] for p in found]


def inside(pixels: np.ndarray) -> np.ndarray:
    return np.all((pixels >= 0) & (pixels <= SIZE), axis=-1)


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
    fields = hits = 0
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

        # and points are where COLMAP sees them
        points = directions(rng, np.pi if model == "EQUIRECTANGULAR" else 0.7 * np.pi if is_wide else 0.2 * np.pi)
        points = points[known(model, own, points)]
        expected = projected(own, points)
        for point, pixel, found in zip(points, expected, seen(camera, points), strict=True):
            # beyond a fold COLMAP's formula shows what no ray sees
            if inside(pixel) and len(found):
                assert np.linalg.norm(found - pixel, axis=1).min() <= PIXEL, (lens, point, pixel, found)
                hits += 1
    assert fields > SIZE[0] * SIZE[1] and hits > POINTS, (fields, hits)
