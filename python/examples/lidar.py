"""A spinning LiDAR on a vehicle that drives through a city, as a point cloud.

Every pulse has a ray of its own: the platform moves while the head spins, so a turn is sheared. The points go to a PLY file, with the
triangle that each lies on.

    python lidar.py lidar.ply
"""

from __future__ import annotations

import argparse

import anamorph as am
import numpy as np

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("output")
parser.add_argument("--turns", type=int, default=10)
parser.add_argument("--steps", type=int, default=1800, help="pulses of each laser a turn")
arguments = parser.parse_args()

scene = am.Scene()
scene.add_builtin("city", seed=3, blocks=12, triangles=15000)

# 32 lasers from -25 to 15 degrees of elevation, 10 turns a second, 8 m/s along x; y points up
elevations = np.radians(np.linspace(-25, 15, 32))
time = np.arange(arguments.turns * arguments.steps) / (10 * arguments.steps)
azimuth = 2 * np.pi * 10 * time
origins = np.stack([-8 + 8 * time, np.full_like(time, 1.8), np.zeros_like(time)], axis=-1)[:, None, :]
directions = np.stack(
    [
        np.cos(azimuth)[:, None] * np.cos(elevations),
        np.broadcast_to(np.sin(elevations), (len(time), len(elevations))),
        np.sin(azimuth)[:, None] * np.cos(elevations),
    ],
    axis=-1,
)
# directions of unit length: t is the range in metres, of 0.5 to 100
hits = am.cast(scene, origins, directions, t_range=(0.5, 100))
seen = hits.triangle >= 0
points, ids = hits.point[seen], hits.triangle[seen]

rows = np.empty(len(points), dtype=[("p", "<f4", 3), ("triangle", "<i4")])
rows["p"], rows["triangle"] = points, ids
properties = "".join(f"property float {axis}\n" for axis in "xyz") + "property int triangle\n"
with open(arguments.output, "wb") as file:
    file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n{properties}end_header\n".encode())
    file.write(rows.tobytes())
print(f"{seen.size} pulses, {seen.sum()} points on {len(np.unique(ids))} triangles")
