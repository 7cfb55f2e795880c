"""A function for each kind of camera, and the same pictures as the program's."""

import inspect
import os
import pathlib
import re
import subprocess
import sys

import anamorph as am
import numpy as np
import pytest
from anamorph import _native

HERE = pathlib.Path(__file__).parent
KINDS = _native.camera_kinds()

# with ANAMORPH_ALL_EXAMPLES=1 all that the program has
EXAMPLES = ["demo", "cross-slit", "fisheye", "twist", "mirror-ball", "mesh"]


def test_the_functions_are_made_from_the_help_texts():
    sys.path.insert(0, str(HERE.parent))
    try:
        import generate_cameras
    finally:
        sys.path.pop(0)
    assert generate_cameras.module(KINDS) == pathlib.Path(am.camera.__file__).read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", [name for name, _ in KINDS])
def test_every_function_has_the_keys_of_its_kind(kind):
    function = getattr(am.camera, kind)
    own = {name.rstrip("_") for name in inspect.signature(function).parameters}
    with pytest.raises(ValueError, match="known: ") as refused:
        am.Camera(kind, {"unknown": 1}).rays((8, 6))
    known = set(re.search(r"known: ([^)]*)\)", str(refused.value)).group(1).split(", "))
    # a key may be known only beside others
    assert own >= known - {"kind"}, kind
    assert len(function.__doc__) > 100


def test_cameras_are_values():
    a = am.camera.pinhole(eye=np.array([0, 0, 4]), target=(0, 0, 0), vfov=40)
    assert a == am.camera.pinhole(eye=[0, 0, 4], target=[0, 0, 0], vfov=40) != a.with_(vfov=41)
    assert a == am.camera.pinhole(eye=[0, 0, 4], target=[0, 0, 0], vfov=40.0)
    assert a.with_(vfov=41).with_(vfov=40) == a and "vfov" not in a.with_(vfov=None).keys
    rays = am.camera.rays(np.zeros((2, 3, 3)), np.ones((2, 3, 3)))
    assert rays == am.camera.rays(np.zeros((2, 3, 3)), np.ones((2, 3, 3))) != am.camera.rays(np.ones((2, 3, 3)), np.ones((2, 3, 3)))
    with pytest.raises(ValueError, match="has no keys"):
        rays.with_(vfov=3)


def program(*arguments, folder):
    out = subprocess.run([sys.executable, "-m", "anamorph", *arguments], cwd=folder, capture_output=True, text=True)
    assert out.returncode == 0, out
    return out.stdout


def examples():
    if os.environ.get("ANAMORPH_ALL_EXAMPLES") != "1":
        return EXAMPLES
    listed = program("example", "--list", folder=".")
    return [line.split()[0] for line in listed.splitlines() if line.startswith("  ")]


@pytest.mark.parametrize("name", examples())
def test_the_program_and_the_package_give_the_same_bytes(name, tmp_path):
    program("example", name, "--out", ".", folder=tmp_path)
    compare_with_program(tmp_path / f"{name}.toml", tmp_path, None if name == "fisheye" else (64, 48))


# the scene files of a folder, as `make agreement` leaves them
SCENES = sorted(pathlib.Path(os.environ["ANAMORPH_SCENES"]).glob("*.toml")) if "ANAMORPH_SCENES" in os.environ else []


@pytest.mark.skipif(not SCENES, reason="ANAMORPH_SCENES names no folder of scenes")
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scenes_of_a_folder_have_the_same_bytes(path, tmp_path):
    # some have rays for one size of image alone
    has_size = re.search('"?kind"? *= *"(raymap|lidar)"', path.read_text())
    # whole numbers of lenslets
    compare_with_program(path, tmp_path, None if has_size else (60, 48))


def compare_with_program(path, folder, size):
    sized = () if size is None else ("--size", f"{size[0]}x{size[1]}")
    program("render", str(path), *sized, "--exr", str(folder / "own.exr"), "-o", str(folder / "own.png"), folder=path.parent)
    scene = am.Scene.load(path)
    theirs = am.Frame.read(folder / "own.exr")
    frame = am.render(scene, size=size, channels=list(theirs))
    assert list(frame) == list(theirs) and len(frame) >= 10
    for channel in frame:
        assert frame[channel].tobytes() == theirs[channel].tobytes(), channel
    frame.save(folder / "package.png")
    assert (folder / "package.png").read_bytes() == (folder / "own.png").read_bytes()
