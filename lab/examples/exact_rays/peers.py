"""`python peers.py FOLDER`: what Embree (by embreex) and trimesh meet with the rays that `exact_rays` wrote to FOLDER, beside this package.

Needs anamorph, embreex, trimesh and rtree. Prints a table of how often each names another triangle than the truth, or none where there is one,
and how many rays it takes a second, once with the time that its index takes and once without. embreex runs on one core, in its robust mode;
anamorph on all that there are.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import anamorph as am
import numpy as np
import numpy.typing as npt
import trimesh
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

Array = npt.NDArray[Any]

MESHES = ("ball", "torus", "bumpy-ball", "cube", "large-ball")
#: trimesh's own rays take milliseconds each, and in larger meshes gigabytes.
TRIMESH_RAYS = 2000
TRIMESH_TRIANGLES = 100_000


def by_anamorph(vertices: Array, faces: Array) -> Callable[[Array, Array], Array]:
    scene = am.Scene()
    scene.add(am.Mesh(vertices, faces))
    # the index is made by the first call
    am.cast(scene, [0.0, 0.0, 9.0], [0.0, 0.0, 1.0])
    return lambda origins, directions: am.cast(scene, origins, directions).triangle


def by_embree(vertices: Array, faces: Array) -> Callable[[Array, Array], Array]:
    scene = rtcore_scene.EmbreeScene(robust=True)
    TriangleMesh(scene, vertices.astype(np.float32)[faces])
    scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))
    return lambda origins, directions: scene.run(origins.astype(np.float32), directions.astype(np.float32))


def by_trimesh(vertices: Array, faces: Array) -> Callable[[Array, Array], Array]:
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    caster = trimesh.ray.ray_triangle.RayMeshIntersector(mesh)
    caster.intersects_first(np.zeros((1, 3)), np.ones((1, 3)))
    return caster.intersects_first


def main(folder: Path) -> None:
    print(f"{os.cpu_count()} cores; anamorph on all of them, embreex and trimesh on one\n")
    print("| mesh | triangles | by | rays | other triangle | missed | met in vain | M rays/s | with the index |")
    print("|---|---:|---|---:|---:|---:|---:|---:|---:|")
    for name in MESHES:
        vertices, faces, origins, directions, truth = (
            np.load(folder / f"{name}.{what}.npy", mmap_mode="r") for what in ("vertices", "faces", "origins", "directions", "truth")
        )
        vertices, faces = np.array(vertices), faces.astype(np.int64)
        for by, index in (("anamorph", by_anamorph), ("embreex, robust", by_embree), ("trimesh, rtree", by_trimesh)):
            if index is by_trimesh and len(faces) > TRIMESH_TRIANGLES:
                continue
            count = min(TRIMESH_RAYS, len(truth)) if index is by_trimesh else len(truth)
            rays = np.array(origins[:count]), np.array(directions[:count])
            started = time.perf_counter()
            cast = index(vertices, faces)
            indexed = time.perf_counter() - started
            started = time.perf_counter()
            met = np.asarray(cast(*rays)).astype(np.int64)
            took = time.perf_counter() - started
            right = np.array(truth[:count], np.int64)
            other = ((met >= 0) & (right >= 0) & (met != right)).sum()
            missed, vain = ((met < 0) & (right >= 0)).sum(), ((met >= 0) & (right < 0)).sum()
            speeds = f"{count / took / 1e6:.4f} | {count / (took + indexed) / 1e6:.4f}"
            print(f"| {name} | {len(faces)} | {by} | {count} | {other} | {missed} | {vain} | {speeds} |", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
