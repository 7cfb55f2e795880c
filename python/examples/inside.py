"""Is a mesh closed, and which points are inside of it? Exactly, by rays.

A ray from outside of a closed mesh goes in as often as out, also through vertices and edges: as its hits are found without
rounding, an odd number of them proves a hole. A point is inside where a ray from it has an odd number of hits.

    python inside.py [MESH.ply]
"""

from __future__ import annotations

import argparse

import anamorph as am
import numpy as np

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("mesh", nargs="?", help="a mesh file; without one, a ball, and the ball without a triangle")
parser.add_argument("--rays", type=int, default=100_000)
arguments = parser.parse_args()
random = np.random.default_rng(1)


def holes(scene: am.Scene, count: int) -> int:
    """How many of so many rays from outside prove a hole: they go in, and not out."""
    lower, upper = scene.bounds
    size = np.linalg.norm(upper - lower)
    origins = random.normal(size=(count, 3))
    origins *= size / np.linalg.norm(origins, axis=-1, keepdims=True)
    targets = random.uniform(lower, upper, size=(count, 3))
    hits = am.cast(scene, origins + (lower + upper) / 2, targets - origins - (lower + upper) / 2, all=True)
    return int((np.bincount(hits.ray, minlength=count) % 2).sum())


def volume(scene: am.Scene, count: int) -> float:
    """The volume of a closed mesh, by points of its box that are inside."""
    lower, upper = scene.bounds
    inside = am.RayCaster(scene).contains_points(random.uniform(lower, upper, size=(count, 3)))
    return float(inside.mean() * np.prod(upper - lower))


scene = am.Scene()
if arguments.mesh:
    scene.add(arguments.mesh)
else:
    scene.add_builtin("icosphere", level=4)
found = holes(scene, arguments.rays)
if found:
    print(f"open: {found} of {arguments.rays} rays go in and not out")
else:
    print(f"closed, as far as {arguments.rays} rays tell; its volume is about {volume(scene, arguments.rays):.4f}")

if not arguments.mesh:
    angles = np.linspace(0, 2 * np.pi, 50, endpoint=False)
    rim = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=-1)
    # a cone without its base
    cone = am.Scene()
    cone.add(am.Mesh(np.vstack([rim, [[0, 0, 2]]]), [[k, (k + 1) % 50, 50] for k in range(50)]))
    print(f"a cone without its base: {holes(cone, arguments.rays)} of {arguments.rays} rays prove that it is open")
