"""Gradients: shapes, closed forms, and what is refused."""

import anamorph as am
import numpy as np
import pytest


def wall() -> am.Scene:
    """Three units wide, at z = 0."""
    scene = am.Scene()
    scene.add(am.Mesh([[-1.5, -9, 0], [1.5, -9, 0], [1.5, 9, 0], [-1.5, 9, 0]], [[0, 1, 2], [0, 2, 3]], name="wall"))
    return scene


CAMERA = am.camera.pinhole(eye=[0, 0, 4], target=[0, 0, 0], vfov=40)
SIZE = (60, 40)


def test_a_wall_before_a_pinhole() -> None:
    of = ["vertices", "camera.eye.2", "camera.vfov"]
    found = am.gradients(wall(), CAMERA, ["t", "position", "barycentrics", "coverage"], of, size=SIZE)
    seen = found["triangle"] != am.NO_ID
    assert 0.5 < seen.mean() < 1
    # t is the depth along the axis: it grows as the eye moves away, and falls as corners come nearer
    assert np.allclose(found["t.camera"][seen], [1, 0], atol=1e-6) and not found["t.camera"][~seen].any()
    assert np.allclose(found["t.vertices"][seen][..., 2].sum(axis=1), -1, atol=1e-6)
    assert np.abs(found["position.camera"][seen][:, 2]).max() < 1e-6
    assert np.abs(found["barycentrics.vertices"].sum(axis=2)).max() < 1e-5
    # both upright edges, and what a wider view does: the wall gets narrower
    pixel = 2 * 4 * np.tan(np.radians(20)) / SIZE[1]
    column = SIZE[0] / 2 - 1.5 / pixel
    share = found["coverage"][20, int(column)]
    assert share == pytest.approx(1 - column % 1, abs=1e-6)
    assert found["coverage.camera"][20, int(column), 1] < 0 and found["coverage.camera"][20, -1 - int(column), 1] < 0
    assert [p.name for p in found.parameters] == of[1:] and found.parameters[1].value == 40
    assert found.parameters[0].direction_error < 1e-9


def test_blended_colors_move_with_the_camera() -> None:
    found = am.gradients(wall(), CAMERA, ["coverage"], ["camera.vfov"], size=SIZE)
    white = (found["triangle"] != am.NO_ID).astype(float)

    def blended(vfov: float) -> np.ndarray:
        own = am.gradients(wall(), CAMERA.with_(vfov=vfov), ["coverage"], size=SIZE)
        return own.blend((own["triangle"] != am.NO_ID).astype(float))

    slope = (blended(40.001) - blended(39.999)) / 0.002
    change = found.of_blend(white)
    assert change.shape == (*SIZE[::-1], 1) and np.abs(slope).max() > 0.1
    # a difference of float32 over 0.002
    assert np.abs(change[..., 0] - slope).max() < 2e-4
    color = np.stack([white, 2 * white], axis=-1)
    assert found.of_blend(color).shape == (*SIZE[::-1], 2, 1)
    assert np.allclose(found.of_blend(color)[..., 1, :], 2 * change)
    with pytest.raises(ValueError, match="colors needs"):
        found.blend(white.T)


def test_what_is_wrong_is_said() -> None:
    with pytest.raises(ValueError, match="known: depth"):
        am.gradients(wall(), CAMERA, ["colour"], size=SIZE)
    with pytest.raises(ValueError, match="it has eye.0"):
        am.gradients(wall(), CAMERA, ["depth"], ["camera.fov"], size=SIZE)
    found = am.gradients(wall(), CAMERA, ["depth"], size=SIZE)
    with pytest.raises(KeyError, match="there are triangle, depth.vertices"):
        found["t.vertices"]
    mirror = am.camera.reflection(
        eye={"kind": "pinhole", "eye": [0, 0, 5], "target": [0, 0, 0], "vfov": 40},
        mirror={"shape": "sphere", "center": [0, 0, 0], "radius": 1},
    )
    with pytest.raises(ValueError, match="have no gradients"):
        am.gradients(wall(), mirror, ["depth"], size=SIZE)
