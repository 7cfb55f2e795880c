"""What one camera has seen, drawn as points through another.

A pinhole renders a city with depth; each pixel's point is at its ray's t. A cross-slit camera draws these points, and shows nothing where the
first one saw nothing. Beside it is what it would see of the city itself.

    python reproject.py reprojected.png rendered.png
"""

from __future__ import annotations

import argparse

import anamorph as am
import numpy as np

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("reprojected")
parser.add_argument("rendered")
parser.add_argument("--size", type=int, nargs=2, default=(640, 480))
parser.add_argument("--device", help="a part of an adapter's name; without it the CPU")
arguments = parser.parse_args()
size = tuple(arguments.size)

scene = am.Scene()
scene.add_builtin("city", seed=3, blocks=12, triangles=15000)
first = am.camera.pinhole(eye=[30, 30, 40], target=[0, 0, 0], vfov=50)
second = am.camera.cross_slit(slits=[{"distance": 60, "angle": 0}, {"distance": 45, "angle": 90}], eye=[32, 30, 40], target=[0, 0, 0], height=45)

# twice the size, so that the other image has few gaps
wide = (2 * size[0], 2 * size[1])
frame = am.render(scene, first, wide, channels=["R", "G", "B", "P", "t"])
seen = np.isfinite(frame["t"])
points, colors = frame["P"][seen], frame.rgb[seen]

splat = am.splat(second, points, colors, size=size, device=arguments.device)
filled = np.isfinite(splat.t)
rgba = np.concatenate([splat.colors, 255 * filled[..., None].astype(np.uint8)], axis=-1)
am.Frame({"t": splat.t.astype(np.float32)}, rgba).save(arguments.reprojected)
own = am.render(scene, second, size, channels=["R", "G", "B", "t"])
own.save(arguments.rendered)

# where both see something: the same depth, or what hides it from the first camera
both = filled & np.isfinite(own["t"])
near = np.abs(splat.t[both] - own["t"][both]) < 0.02 * own["t"][both]
print(f"{len(points)} points, {filled.mean():.1%} of the pixels filled, {near.mean():.1%} of them at the depth of the render")
