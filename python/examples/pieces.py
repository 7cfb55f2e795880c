"""How the error of a panorama falls with the number of pieces that it is made of, as a plot.

A panorama of N pieces takes the exact camera's rays at N + 1 columns, and affine ones between. The error of a pixel is how far what it
shows lies from what the exact camera shows there.

    python pieces.py pieces.png
"""

from __future__ import annotations

import argparse

import anamorph as am
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("plot")
parser.add_argument("--size", type=int, nargs=2, default=(720, 240), metavar=("WIDTH", "HEIGHT"))
arguments = parser.parse_args()

scene = am.Scene()
scene.add_builtin("teapot")
lower, upper = scene.bounds
center, size = (lower + upper) / 2, np.linalg.norm(upper - lower)


def shown(pieces: int | str) -> am.Frame:
    camera = am.camera.panorama(center=center, radius=size, height=0.8 * size, pieces=pieces)
    return am.render(scene, camera, size=tuple(arguments.size), channels=["triangle.id", "P"])


exact = shown("exact")
numbers = [4, 8, 16, 32, 64, 128]
off, wrong = [], []
for number in numbers:
    frame = shown(number)
    both = (frame.ids != am.NO_ID) & (exact.ids != am.NO_ID)
    off.append(np.median(np.linalg.norm(frame["P"][both] - exact["P"][both], axis=-1)) / size)
    wrong.append(np.mean(frame.ids != exact.ids))
figure, axes = pyplot.subplots(figsize=(6, 4), layout="constrained")
axes.loglog(numbers, off, "o-", label="median distance of the points shown, of the object's size")
axes.loglog(numbers, wrong, "s-", label="share of pixels that show another triangle")
axes.set_xlabel("pieces")
axes.legend(loc="upper right")
figure.savefig(arguments.plot, dpi=120)
for row in zip(numbers, off, wrong):
    print("{:4} pieces: {:.2e} of the size, {:.2%} of the pixels".format(*row))
