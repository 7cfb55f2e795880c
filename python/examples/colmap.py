"""Depth and triangle ids of every image of a COLMAP model, fisheyes too, from a mesh in the same world.

For each image, a .npz file has, in the image's own distorted pixels, ``distance`` along the ray (inf where nothing is seen), ``triangle``
(0xffffffff where nothing is seen) and the ray's ``direction`` in the world (NaN where the lens shows none).

    python colmap.py sparse/0 mesh.ply depths
"""

from __future__ import annotations

import argparse
import pathlib

import anamorph as am
import numpy as np

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("model", type=pathlib.Path)
parser.add_argument("mesh", type=pathlib.Path)
parser.add_argument("output", type=pathlib.Path)
arguments = parser.parse_args()

scene = am.Scene()
scene.add(arguments.mesh)
with am.Renderer(scene) as renderer:
    for name in am.colmap_images(arguments.model):
        camera = am.camera.calibrated(file=arguments.model, image=name)
        renderer.aim(camera)
        frame = renderer.render(["Z", "triangle.id"])
        _, directions = camera.rays()
        path = (arguments.output / name).with_suffix(".npz")
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(
            path, distance=frame["Z"], triangle=frame["triangle.id"], direction=directions.astype(np.float32)
        )
        print(f"{name}: {np.isfinite(frame['Z']).mean():.0%} of the pixels show the mesh")
