"""A page in the browser: that it is served, shows the scene, and ends."""

import pathlib
import re
import urllib.error
import urllib.request

import anamorph as am
import pytest

SCENE = """
image = { width = 64, height = 48 }
mesh = [{ builtin = "icosphere", level = 2 }]
camera = { kind = "pinhole", eye = [0, 0.5, 4], target = [0, 0, 0], vfov = 40 }
"""


def page(viewer: am.Viewer) -> str:
    with urllib.request.urlopen(viewer.address, timeout=30) as answer:
        text: str = answer.read().decode()
    return text


def test_a_scene_file_is_served_until_it_is_closed(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    with am.view(path, size=(32, 24), overrides={"camera.vfov": 50}) as viewer:
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/\?token=[0-9a-f]{32}", viewer.address)
        assert "<title>anamorph</title>" in page(viewer)
        assert f'src="{viewer.address}"' in viewer._repr_html_()
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(viewer.address.partition("?")[0], timeout=30)
    with pytest.raises(urllib.error.URLError):
        page(viewer)
    assert path.read_text() == SCENE


def test_scenes_in_memory_are_viewed_through_any_camera(square: am.Scene, pinhole: am.Camera) -> None:
    with am.view(square, pinhole, size=(32, 24)) as viewer, am.view(square, pinhole, size=(32, 24)) as other:
        assert viewer.address != other.address
        assert "script" in page(viewer)
    loaded = am.Scene.parse(SCENE)
    loaded.add_builtin("box")
    with am.view(loaded) as viewer:
        assert "script" in page(viewer)


def test_what_cannot_be_viewed_is_refused(square: am.Scene, pinhole: am.Camera, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValueError, match="no camera"):
        am.view(square)
    with pytest.raises(ValueError, match="unknown key"):
        am.view(square, am.Camera("pinhole", {"fov": 3}), size=(8, 6))
    with pytest.raises(ValueError, match="has no keys to change"):
        am.view(square, am.camera.rays([[[0, 0, 4]]], [[[0, 0, -1]]]))
    with pytest.raises(ValueError, match="own camera"):
        am.view(tmp_path / "scene.toml", pinhole)
    with pytest.raises(FileNotFoundError):
        am.view(tmp_path / "none.toml")
    with am.view(square, pinhole, size=(8, 6)) as viewer:
        port = int(viewer.address.split(":")[2].split("/")[0])
        with pytest.raises(RuntimeError, match="cannot be used"):
            am.view(square, pinhole, size=(8, 6), port=port)
