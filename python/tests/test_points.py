"""Many points at once: arrays, and pictures of them."""

import anamorph as am
import numpy as np
import pytest

PINHOLE = am.camera.pinhole(eye=[0.3, 0.4, 4], target=[0, 0, 0], vfov=40)
SLITS = am.camera.cross_slit(slits=[{"distance": 4, "angle": 20}, {"distance": 2.5, "angle": 100}], eye=[0, 0, 4], target=[0, 0, 0], height=2)
FISHEYE = am.camera.fisheye(eye=[0, 0, 2], target=[0, 0, 0], fov=50)
SIZE = (60, 44)


def cloud(count):
    points = np.random.default_rng(5).uniform(-0.6, 0.6, (count, 3))
    points[7] = np.nan
    return points


@pytest.mark.parametrize("camera", [PINHOLE, SLITS, FISHEYE])
def test_arrays_are_those_of_project(camera):
    points = cloud(300)
    each = am.project(None, camera, points, SIZE)
    for device in (None, ""):
        many = am.project_many(camera, points, size=SIZE, device=device)
        assert many.first.tolist() == [0, *np.cumsum([len(p.t) for p in each]).tolist()] and many.by_kernel == 0
        for name in ("images", "t", "piece"):
            assert (getattr(many, name) == np.concatenate([getattr(p, name) for p in each])).all()


def test_images_of_kernels_are_within_their_bound():
    points = cloud(3000)
    exact = am.project_many(SLITS, points, size=SIZE)
    fast = am.project_many(SLITS, points, size=SIZE, device="", within_px=0.01)
    assert fast.by_kernel > 2500 and (fast.first == exact.first).all() and len(exact.t) > 1000
    off = np.abs(fast.images - exact.images).max()
    assert 0 < off <= 0.01
    with pytest.raises(ValueError, match="within_px"):
        am.project_many(SLITS, points, size=SIZE, within_px=-1)


@pytest.mark.parametrize("camera", [PINHOLE, SLITS, FISHEYE])
def test_splats_are_the_nearest_points(camera):
    points = cloud(4000)
    colors = np.arange(4000, dtype=np.uint16)[:, None]
    splat = am.splat(camera, points, colors, size=SIZE)
    nearest = {}
    for k, of in enumerate(am.project(None, camera, points, SIZE)):
        for (x, y), t in zip(of.images, of.t):
            pixel = (min(int(y), SIZE[1] - 1), min(int(x), SIZE[0] - 1))
            nearest[pixel] = min(nearest.get(pixel, (np.inf, -1)), (t, k))
    assert len(nearest) > 400 and np.isfinite(splat.t).sum() == len(nearest)
    assert all(splat.point[p] == k and splat.t[p] == t and splat.colors[p] == k for p, (t, k) in nearest.items())
    for device in ("",):
        other = am.splat(camera, points, size=SIZE, device=device)
        assert (other.point == splat.point).all() and (other.t == splat.t).all() and other.colors is None
    with pytest.raises(ValueError, match="4000 points"):
        am.splat(camera, points, colors[1:], size=SIZE)


@pytest.mark.parametrize("size", [(1, 1), (1, 3), (3, 3), (5, 1)])
@pytest.mark.parametrize(
    "camera",
    [
        am.camera.fisheye(eye=[0.3, 0, 4], target=[0, 0, 0], fov=180),
        # half a pixel of a column is half a turn
        am.camera.fisheye(eye=[0.3, 0, 4], target=[0, 0, 0], fov=360),
        am.camera.panini(eye=[0.3, 0, 4], target=[0, 0, 0], fov=120),
        am.camera.sphere(eye=[0.3, 0, 4], target=[0, 0, 0]),
        am.camera.cylinder(eye=[0.3, 0, 4], target=[0, 0, 0]),
    ],
    ids=lambda camera: f"{camera.kind}-{camera.keys.get('fov')}",
)
def test_the_point_on_the_axis_is_seen_in_images_of_few_pixels(camera, size):
    for device in (None, ""):
        found = am.project_many(camera, [[0, 0, 0]], size=size, device=device)
        # places that are closer than 1e-6 px are one
        assert found.degenerate.tolist() == [0] and np.abs(found.images - np.array(size) / 2).max() < 1e-6, found
        assert len(found.t) == 1
