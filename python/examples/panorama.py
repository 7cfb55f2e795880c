"""An eye goes round a teapot: frames of an animation in which its way grows from a twelfth of a turn to all of it.

    python panorama.py frames
"""

from __future__ import annotations

import argparse
import pathlib

import anamorph as am
import numpy as np

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("folder", type=pathlib.Path)
parser.add_argument("--frames", type=int, default=60)
parser.add_argument("--size", type=int, nargs=2, default=(960, 320), metavar=("WIDTH", "HEIGHT"))
arguments = parser.parse_args()

scene = am.Scene()
scene.add_builtin("teapot", color=[0.8, 0.55, 0.3])
lower, upper = scene.bounds
center, size = (lower + upper) / 2, np.linalg.norm(upper - lower)
arguments.folder.mkdir(parents=True, exist_ok=True)
# the scene stays on the device from frame to frame
with am.Renderer(scene) as renderer:
    for number, sweep in enumerate(np.linspace(30, 360, arguments.frames)):
        renderer.aim(am.camera.panorama(center=center, radius=size, height=0.8 * size, sweep=sweep))
        frame = renderer.render(["R", "G", "B"], size=tuple(arguments.size), samples=4)
        frame.save(arguments.folder / f"{number:04}.png")
print(f"{arguments.frames} frames in {arguments.folder}")
