"""The worked examples run, on little."""

from __future__ import annotations

import importlib.util
import pathlib
import subprocess
import sys

import numpy as np
import pytest

EXAMPLES = pathlib.Path(__file__).parent.parent / "examples"


def run(name: str, *arguments: object) -> str:
    command = [sys.executable, "-W", "error", str(EXAMPLES / name), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def needs(module: str) -> None:
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"{module} is not installed")


def test_every_example_is_run() -> None:
    text = pathlib.Path(__file__).read_text()
    for example in EXAMPLES.glob("*.py"):
        assert f'run("{example.name}"' in text, example.name


def test_lidar(tmp_path: pathlib.Path) -> None:
    said = run("lidar.py", tmp_path / "lidar.ply", "--turns", 1, "--steps", 60)
    head, rows = (tmp_path / "lidar.ply").read_bytes().split(b"end_header\n")
    points = int(said.split()[2])
    assert said.startswith(f"{60 * 32} pulses") and points > 300 and len(rows) == 16 * points and b"int triangle" in head


def test_colmap(tmp_path: pathlib.Path) -> None:
    # the camera's axes are x right, y down, z forward: from 4 units behind the origin, and to one side
    (tmp_path / "cameras.txt").write_text("1 OPENCV_FISHEYE 60 40 20 20 30 20 0.01 0 0 0\n")
    (tmp_path / "images.txt").write_text("1 1 0 0 0 0 0 4 1 rig/b.jpg\n\n2 1 0 0 0 1 0 4 1 a.jpg\n\n")
    triangle = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n"
    (tmp_path / "mesh.obj").write_text(triangle)
    said = run("colmap.py", tmp_path, tmp_path / "mesh.obj", tmp_path / "out").splitlines()
    assert [line.split(":")[0] for line in said] == ["a.jpg", "rig/b.jpg"]
    for name, side in (("a.jpg", 1), ("rig_b.jpg", 0)):
        found = np.load(tmp_path / "out" / f"{name}.npz")
        seen = found["triangle"] == 0
        assert seen.sum() > 20 and (found["triangle"][~seen] == 0xFFFFFFFF).all()
        assert np.abs(found["eye"] - [-side, 0, -4]).max() < 1e-15
        points = found["eye"] + found["distance"][seen][:, None] * found["direction"][seen]
        # float32 distances of some 5 units
        assert np.abs(points[:, 2]).max() < 2e-6 and np.abs(points).max() <= 1 + 2e-6


def test_inside() -> None:
    said = run("inside.py", "--rays", 2000)
    assert "closed, as far as 2000 rays tell" in said
    # of a ball of radius 1, of which 2000 points of a box of 8 tell half: three standard deviations
    volume = float(said.split("about ")[1].split("\n")[0])
    assert abs(volume - 4 / 3 * np.pi) < 3 * 8 * np.sqrt(0.25 / 2000)
    opened = int(said.split("a cone without its base: ")[1].split()[0])
    assert 100 < opened < 2000


def test_pushbroom(tmp_path: pathlib.Path) -> None:
    run("pushbroom.py", tmp_path / "strip.png", tmp_path / "heights.npy", "--size", 40, 120)
    heights = np.load(tmp_path / "heights.npy")
    assert heights.shape == (120, 40) and np.isfinite(heights).mean() > 0.9 and (tmp_path / "strip.png").stat().st_size > 1000


def test_reproject(tmp_path: pathlib.Path) -> None:
    said = run("reproject.py", tmp_path / "reprojected.png", tmp_path / "rendered.png", "--size", 120, 90)
    filled, near = (float(part.split("%")[0].split()[-1]) for part in said.split(",")[1:3])
    assert filled > 40 and near > 80, said
    assert all((tmp_path / name).stat().st_size > 1000 for name in ("reprojected.png", "rendered.png"))


def test_panorama(tmp_path: pathlib.Path) -> None:
    run("panorama.py", tmp_path, "--frames", 2, "--size", 96, 32)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["0000.png", "0001.png"]


def test_fit_fisheye() -> None:
    lines = run("fit_fisheye.py", "--sizes", 24, 48, "--steps", 6).splitlines()
    off = [float(line.split()[-2]) for line in lines[:3]]
    # to a fifth of a pixel of each size, of which 24 and 48 are as wide as 640
    assert off[0] > 10 and off[1] < 640 / 24 / 5 and off[2] < 640 / 48 / 5


def test_pieces(tmp_path: pathlib.Path) -> None:
    needs("matplotlib")
    said = run("pieces.py", tmp_path / "pieces.png", "--size", 90, 30)
    wrong = [float(line.split()[-4].rstrip("%")) for line in said.splitlines()]
    assert len(wrong) == 6 and wrong[-1] < wrong[0] / 4 and (tmp_path / "pieces.png").exists()


def test_views() -> None:
    needs("torch")
    assert run("views.py", "--views", 4, "--side", 16).startswith("4 views, ")
