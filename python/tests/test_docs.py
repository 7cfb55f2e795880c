"""The Python of the project's pages runs. A block that is not run says why on the line above it: <!-- not run: ... -->."""

import pathlib
import re

import anamorph as am
import numpy as np
import pytest

ROOT = pathlib.Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "python/README.md", *sorted((ROOT / "docs").glob("**/*.md"))]
BLOCK = re.compile(r"(?P<before>[^\n]*)\n```python\n(?P<code>.*?)\n```", re.DOTALL)

# Four triangles around a point, as a scan.
SCAN = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
0.3 0.2 0.1
-0.4 0.1 0.2
0.1 -0.3 0.4
3 0 1 2
3 0 3 1
3 0 2 3
3 1 3 2
"""


SCENE = """[image]
width = 64
height = 48
[[mesh]]
file = "scan.ply"
[camera]
kind = "pinhole"
eye = [0, 0, 3]
target = [0, 0, 0]
vfov = 40
"""


def blocks(page):
    """The code of a page that is run."""
    found = BLOCK.finditer("\n" + page.read_text())
    return [match["code"] for match in found if not match["before"].startswith("<!-- not run: ")]


def given():
    """What pages take as there: things of the reader's own."""
    scene = am.Scene()
    scene.add("scan.ply")
    camera = am.camera.fisheye(eye=[0, 1, 3], target=[0, 0, 0], fov=100)
    frame = am.render(scene, camera, size=(640, 480), channels=["R", "G", "B"])
    points = np.random.default_rng(3).uniform(-0.5, 0.5, (20, 3))
    return {
        "np": np,
        "scene": scene,
        "camera": camera,
        "cameras": [camera, camera.with_(eye=[0.1, 1, 3])],
        "poses": [[0, 1, 3], [0.1, 1, 3]],
        "matrix": np.eye(4),
        "frame": frame,
        "photo": np.zeros((480, 640)),
        "points": points,
        "positions": points,
        "ends": np.stack([points, points + 0.1], axis=1),
        "colors": np.ones((20, 3), dtype=np.float32),
        "rgb": np.ones((20, 3)),
        "a": np.zeros((4, 4, 4), dtype=np.float32),
        "origins": np.tile([0.0, 0.0, 5.0], (4, 1)),
        "directions": np.tile([0.0, 0.0, -1.0], (4, 1)),
        "mesh": am.Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]]),
    }


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p)], ids=lambda p: p.relative_to(ROOT).as_posix())
def test_the_code_of_a_page_runs(page, tmp_path, monkeypatch):
    (tmp_path / "scan.ply").write_text(SCAN)
    (tmp_path / "scene.toml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    names = given()
    # blocks of a page follow one another
    for code in blocks(page):
        exec(compile(code, str(page), "exec"), names)
