"""Depth and triangle ids of every image of a COLMAP model, fisheyes too, from a mesh in the same world.

For each image, a .npz file has, in the image's own distorted pixels, ``distance`` along the ray (inf where nothing is seen), ``triangle``
(0xffffffff where nothing is seen), and the ray's ``direction`` in the world, of length 1 (NaN where the lens shows none); and the ``eye``.
A point that is seen is eye + distance * direction.

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

arguments.output.mkdir(parents=True, exist_ok=True)
scene = am.Scene()
scene.add(arguments.mesh)
with am.Renderer(scene) as renderer:
    for name in am.colmap_images(arguments.model):
        camera = am.camera.calibrated(file=arguments.model, image=name)
        renderer.aim(camera)
        frame = renderer.render(["Z", "triangle.id"])
        origins, directions = camera.rays()
        directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
        eye = origins[np.isfinite(origins).all(axis=-1)][0]
        # names may have folders in them
        np.savez_compressed(
            arguments.output / (name.replace("/", "_") + ".npz"),
            distance=frame["Z"],
            triangle=frame["triangle.id"],
            direction=directions,
            eye=eye,
        )
        print(f"{name}: {np.isfinite(frame['Z']).mean():.0%} of the pixels show the mesh")
