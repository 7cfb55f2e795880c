"""Finds the lens of a fisheye from one image of squares whose places are known: focal lengths and four coefficients, 5 % off at first.

    python fit_fisheye.py --pictures .

Every step compares the image with a rendered one and follows the gradients of its edges (Levenberg and Marquardt). Edges pull only as far as a
pixel, so that it begins with small images, in which all are near. The image has 64 rays a pixel, whose mean differs a little from the
coverage that the gradients are of: the lens is found to about a tenth of a pixel of the last size. fit-before.png and fit-after.png show the image
(red) and the rendered one (blue) over each other.
"""

from __future__ import annotations

import argparse
import pathlib
import tempfile

import anamorph as am
import numpy as np

NAMES = ["fx", "fy", "k1", "k2", "k3", "k4"]
TRUTH = np.array([200.0, 195.0, 0.05, -0.01, 0.004, -0.0008])
SIDE = 640
# of the pictures
PICTURE = 480

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("--sizes", type=int, nargs="+", default=[24, 48, 96, 192], help="sides of the images, pixels")
parser.add_argument("--steps", type=int, default=12, help="steps for each size")
parser.add_argument("--pictures", type=pathlib.Path, help="folder for pictures of the image and the rendered one, before and after")
arguments = parser.parse_args()


def squares() -> am.Scene:
    """White squares all about the eye, up to 85 degrees from where it looks."""
    scene = am.Scene()
    for ring, (angle, count) in enumerate([(0, 1), (22, 6), (45, 10), (66, 14), (85, 16)]):
        for k in range(count):
            turn, tilt = 2 * np.pi * (k + 0.3 * ring) / count, np.radians(angle)
            ahead = np.array([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), -np.cos(tilt)])
            across = np.cross(ahead, [0.3, 1, 0.2])
            across /= np.linalg.norm(across)
            up = np.cross(across, ahead)
            corners = [4 * ahead + 0.5 * (x * across + y * up) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            scene.add(am.Mesh(corners, [[0, 1, 2], [0, 2, 3]], name=f"square {ring}.{k}"))
    return scene


def lens(values: np.ndarray, folder: pathlib.Path) -> am.Camera:
    """The camera with these focal lengths and coefficients."""
    fx, fy, *k = values.tolist()
    centre = (SIDE - 1) / 2
    matrix = f"{fx!r}, 0., {centre}, 0., {fy!r}, {centre}, 0., 0., 1."
    (folder / "lens.yml").write_text(
        f"%YAML:1.0\n---\nimage_width: {SIDE}\nimage_height: {SIDE}\n"
        f"camera_matrix: {{ rows: 3, cols: 3, dt: d, data: [{matrix}] }}\n"
        f"distortion_coefficients: {{ rows: 4, cols: 1, dt: d, data: [{', '.join(map(repr, k))}] }}\n"
    )
    file = str(folder / "lens.yml")
    return am.camera.opencv(eye=[0, 0, 0], target=[0, 0, -1], file=file, model="fisheye")


def radii(values: np.ndarray) -> np.ndarray:
    """How far from the middle directions up to 90 degrees from the axis are seen, to the right and downwards; pixels of the whole image."""
    theta = np.radians(np.linspace(0, 90, 91))
    q = theta**2
    bent = theta * (1 + q * (values[2] + q * (values[3] + q * (values[4] + q * values[5]))))
    return np.stack([values[0] * bent, values[1] * bent])


def fit(photo: np.ndarray, values: np.ndarray, scene: am.Scene, folder: pathlib.Path) -> np.ndarray:
    """Steps towards the lens of an image."""
    side = photo.shape[0]

    def rendered(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The image less the photo, and how it changes with the numbers."""
        of = [f"camera.{name}" for name in NAMES]
        found = am.gradients(scene, lens(values, folder), ["coverage"], of, size=(side, side))
        white = (found["triangle"] != am.NO_ID).astype(float)
        off, change = found.blend(white) - photo, found.of_blend(white)
        # a pixel at the rim of what the lens shows has no derivative
        known = np.isfinite(change).all(axis=-1)
        return off[known], change[known]

    off, change = rendered(values)
    damping = 1e-3
    for _ in range(arguments.steps):
        normal = change.T @ change
        step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), -change.T @ off)
        try:
            next_off, next_change = rendered(values + step)
        except ValueError:
            damping *= 10
            continue
        if next_off @ next_off < off @ off:
            values, off, change = values + step, next_off, next_change
            damping /= 10
        else:
            damping *= 10
        if damping > 1e6 or np.abs(step / values).max() < 1e-6:
            break
    return values


def coverage(values: np.ndarray, side: int, scene: am.Scene, folder: pathlib.Path) -> np.ndarray:
    """The image by that lens: how much of each pixel shows a square."""
    return am.render(scene, lens(values, folder), (side, side), ["A"], samples=64)["A"]


def show(values: np.ndarray, scene: am.Scene, folder: pathlib.Path, name: str) -> None:
    """A picture of the image in red over the rendered one in blue; grey where both show a square."""
    if arguments.pictures:
        photo, own = (coverage(numbers, PICTURE, scene, folder) for numbers in (TRUTH, values))
        red, blue = 1 - 0.75 * own, 1 - 0.75 * photo
        rgba = np.stack([red, 1 - 0.75 * np.maximum(photo, own), blue, np.ones_like(red)], axis=-1)
        am.Frame({"A": photo}, (255 * rgba).round().astype(np.uint8)).save(arguments.pictures / name)


with tempfile.TemporaryDirectory() as name:
    folder, scene = pathlib.Path(name), squares()
    values = TRUTH * (1 + 0.05 * np.array([1, -1, 1, 1, -1, 1]))
    show(values, scene, folder, "fit-before.png")
    print(f"at first: off by up to {np.abs(radii(values) - radii(TRUTH)).max():.3f} px")
    for side in arguments.sizes:
        photo = coverage(TRUTH, side, scene, folder)
        values = fit(photo, values, scene, folder)
        print(f"images of {side} px: off by up to {np.abs(radii(values) - radii(TRUTH)).max():.3f} px")
    show(values, scene, folder, "fit-after.png")
    for own, value, truth in zip(NAMES, values, TRUTH):
        print(f"{own}: {value:.5f}, in truth {truth}")
