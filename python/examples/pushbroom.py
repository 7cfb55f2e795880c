"""A strip over terrain by a push-broom camera, as from an aircraft or a satellite: heights and colour.

Each row of the image is taken from another place. The height of each pixel's ground point is exact: it is where the pixel's own
ray meets the terrain, with no resampling.

    python pushbroom.py strip.png heights.npy
"""

from __future__ import annotations

import argparse

import anamorph as am
import numpy as np

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("picture")
parser.add_argument("heights")
parser.add_argument("--size", type=int, nargs=2, default=(400, 1200), metavar=("ACROSS", "ALONG"))
arguments = parser.parse_args()

scene = am.Scene()
scene.add_builtin("terrain", seed=2, size=512, color=[0.55, 0.5, 0.4])
lower, upper = scene.bounds
length, top = upper[2] - lower[2], upper[1]
# flies along z, as high above the terrain as that is long, and looks straight down; a row is 30 degrees wide
middle = (lower[0] + upper[0]) / 2
camera = am.camera.pushbroom(
    start=[middle, top + length, upper[2] - 0.1 * length],
    end=[middle, top + length, lower[2] + 0.1 * length],
    look=[0, -1, 0],
    up=[0, 0, -1],
    hfov=30,
)
frame = am.render(scene, camera, size=tuple(arguments.size), channels=["R", "G", "B", "P"])
frame.save(arguments.picture)
heights = frame["P"][..., 1]
np.save(arguments.heights, heights)
seen = np.isfinite(heights)
print(f"{seen.mean():.0%} of the strip shows ground, {heights[seen].min():.3f} to {heights[seen].max():.3f} high")
