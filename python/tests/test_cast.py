"""Rays from anywhere."""

from __future__ import annotations

from fractions import Fraction

import anamorph as am
import numpy as np
import numpy.typing as npt
import pytest

CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)


def cube() -> am.Scene:
    scene = am.Scene()
    scene.add(am.Mesh(CUBE, FACES))
    return scene


def ball(vertices: int = 200) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """A closed mesh: a tetrahedron whose faces are divided again and again."""
    points = [np.array(p, float) for p in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))]
    faces = [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]
    middles: dict[tuple[int, int], int] = {}

    def middle(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in middles:
            points.append(points[a] + points[b])
            middles[key] = len(points) - 1
        return middles[key]

    while len(points) < vertices:
        middles.clear()
        divided = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            divided += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = divided
    return np.array([p / np.linalg.norm(p) for p in points]), np.array(faces)


def test_a_hit_says_where_and_what() -> None:
    scene = cube()
    scene.add(am.Mesh(CUBE, FACES, name="far"), translate=[10, 0, 0])
    hits = am.cast(scene, [-5.0, 0.25, 0.5], [2, 0, 0])
    assert hits.t.shape == () and hits.t == 2.0 and hits.mesh == 0 and hits.certified
    assert hits.point.tolist() == [-1.0, 0.25, 0.5] and hits.normal.tolist() == [-1.0, 0.0, 0.0]
    corners = CUBE[FACES[hits.triangle]]
    u, v = hits.bary
    assert np.allclose((1 - u - v) * corners[0] + u * corners[1] + v * corners[2], hits.point)
    beyond = am.cast(scene, [-5.0, 0.25, 0.5], [2, 0, 0], t_range=(3.5, 100))
    assert beyond.t == 7.0 and beyond.mesh == 1 and 12 <= beyond.triangle < 24
    # ends of the range are in it
    ends = am.cast(scene, [-5.0, 0.25, 0.5], [2, 0, 0], t_range=(2, 8), all=True)
    assert ends.t.tolist() == [2.0, 3.0, 7.0, 8.0] and ends.mesh.tolist() == [0, 0, 1, 1] and ends.ray.tolist() == [0] * 4
    miss = am.cast(scene, [-5.0, 3.0, 0.5], [2, 0, 0])
    assert miss.t == np.inf and miss.triangle == miss.mesh == -1 and np.isnan(miss.point).all() and miss.certified


def test_shapes_types_and_strides() -> None:
    scene = cube()
    origins = np.zeros((2, 3, 3), np.float32)
    origins[..., 2] = 5
    hits = am.cast(scene, origins, [0, 0, -1])
    assert hits.t.shape == hits.triangle.shape == hits.ray.shape == (2, 3) and hits.point.shape == (2, 3, 3)
    assert hits.bary.shape == (2, 3, 2) and (hits.t == 4).all() and hits.ray.tolist() == [[0, 1, 2], [3, 4, 5]]
    strided = np.zeros((8, 6))[::2, ::2]
    strided[:, 2] = 5
    assert (am.cast(scene, strided, -strided).t == 0.8).all()
    assert am.cast(scene, np.zeros((0, 3)), np.zeros((0, 3))).t.shape == (0,)


@pytest.mark.parametrize(
    "origins, directions, t_range, says",
    [
        ([[0, 0]], [[0, 0, 1]], (0, 1), "origins: an array of shape"),
        (np.zeros((2, 3)), np.ones((3, 3)), (0, 1), "origins and directions have the shapes"),
        ([0, 0, np.nan], [0, 0, 1], (0, 1), "ray 0: its origin is"),
        (np.zeros((2, 3)), [[0, 0, 1], [0, 0, 0]], (0, 1), "ray 1: its direction is"),
        ([0, 0, 0], [0, 0, 1], (1, 0), "t_range is 1 to 0"),
        ([0, 0, 0], [0, 0, 1], (np.nan, 1), "t_range is NaN"),
    ],
)
def test_wrong_rays_say_so(origins: object, directions: object, t_range: tuple[float, float], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        am.cast(cube(), origins, directions, t_range)  # type: ignore[arg-type]


def test_text_is_no_ray() -> None:
    with pytest.raises(TypeError, match="directions: numbers are needed"):
        am.cast(cube(), [0, 0, 0], ["a", "b", "c"])  # type: ignore[list-item]


@pytest.mark.parametrize("aim", ["vertices", "edges", "anywhere"])
def test_a_closed_mesh_is_crossed_in_and_out(aim: str) -> None:
    vertices, faces = ball()
    scene = am.Scene()
    scene.add(am.Mesh(vertices, faces))
    random = np.random.default_rng(5)
    origins = 3 * random.normal(size=(4000, 3))
    origins = origins[np.linalg.norm(origins, axis=1) > 1.1]
    targets = {
        "vertices": vertices[random.integers(len(vertices), size=len(origins))],
        "edges": vertices[faces[random.integers(len(faces), size=len(origins)), :2]].mean(axis=1),
        "anywhere": 0.5 * random.normal(size=origins.shape),
    }[aim]
    hits = am.cast(scene, origins, targets - origins, all=True)
    counts = np.bincount(hits.ray, minlength=len(origins))
    assert (counts % 2 == 0).all() and hits.certified.all() and counts.sum() > 2000
    # in as often as out, near to far
    facing = np.sign((hits.normal * (targets - origins)[hits.ray]).sum(axis=1))
    assert (np.bincount(hits.ray, facing, minlength=len(origins)) == 0).all()
    first = np.r_[True, hits.ray[1:] != hits.ray[:-1]]
    # in order but for the rounding of t
    assert (np.diff(hits.t)[~first[1:]] >= -(2.0**-39) * hits.t[1:][~first[1:]]).all()
    # the first of all is the first
    alone = am.cast(scene, origins, targets - origins)
    assert (alone.triangle[hits.ray[first]] == hits.triangle[first]).all() and ((alone.triangle >= 0) == (counts > 0)).all()


def test_order_is_that_of_exact_fractions() -> None:
    # planes z = k 2^-60, which f64 tells apart near 0 alone: from z = 1 on, all are at t = 1 but for less than rounding
    heights = [k * 2.0**-60 for k in (3, 1, 2)]
    scene = am.Scene()
    for z in heights:
        scene.add(am.Mesh([[-1, -1, z], [1, -1, z], [0, 1, z]], [[0, 1, 2]]))
    hits = am.cast(scene, [0, 0, 1], [0, 0, -1], all=True)
    exact = sorted(range(3), key=lambda k: 1 - Fraction(heights[k]))
    assert hits.triangle.tolist() == exact == [0, 2, 1] and set(hits.t) == {1.0}


def test_one_sided_and_changed_scenes() -> None:
    scene = am.Scene()
    triangle = am.Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
    scene.add(triangle, two_sided=False)
    assert am.cast(scene, [0, 0, 1], [0, 0, -1]).triangle == 0 and am.cast(scene, [0, 0, -1], [0, 0, 1]).triangle == -1
    scene.add(triangle, translate=[0, 0, 0.5])
    assert am.cast(scene, [0, 0, 1], [0, 0, -1]).triangle == 1 and am.cast(scene, [0, 0, -1], [0, 0, 1]).triangle == 1
    assert am.cast(am.Scene(), [0, 0, 1], [0, 0, -1]).triangle == -1


def test_spheres_are_met_as_frames_have_them() -> None:
    scene = cube()
    scene.add_spheres([[0, 0, 9], [0, 3, 9]], radii=[2, 0.5], name="balls")
    hits = am.cast(scene, [[1.2, 0, 20], [0, 3, 9], [0.25, 0.5, -5]], [[0, 0, -1], [0, 1, 0], [0, 0, 1]])
    assert hits.triangle.tolist()[:2] == [12, 13] and hits.triangle[2] < 12 and hits.mesh.tolist() == [1, 1, 0]
    assert np.allclose(hits.t, [9.4, 0.5, 4.0], rtol=1e-14) and hits.certified.all()
    assert np.allclose(hits.point[0], [1.2, 0, 10.6], atol=1e-14) and np.allclose(hits.normal[0], [0.6, 0, 0.8], atol=1e-14)
    assert hits.bary[:2].tolist() == [[0, 0], [0, 0]]
    through = am.cast(scene, [0, 0, 20], [0, 0, -1], all=True)
    assert through.t.tolist() == [9.0, 13.0, 19.0, 21.0]
    camera = am.camera.pinhole(eye=[0, 1, 30], target=[0, 1, 0], vfov=20)
    ids = am.render(scene, camera, size=(40, 30), channels=["triangle.id"])["triangle.id"]
    assert {12, 13} <= set(ids.ravel().tolist())


def test_what_trimesh_calls() -> None:
    vertices, faces = ball()
    caster = am.RayCaster(am.Mesh(vertices, faces))
    random = np.random.default_rng(6)
    origins, directions = 2 * random.normal(size=(500, 3)), random.normal(size=(500, 3))
    first = caster.intersects_first(origins, directions)
    assert (caster.intersects_any(origins, directions) == (first >= 0)).all() and 20 < (first >= 0).sum() < 480
    triangles, rays, places = caster.intersects_id(origins, directions, return_locations=True)  # type: ignore[misc]
    assert len(triangles) > (first >= 0).sum() and np.abs(np.linalg.norm(places, axis=1) - 0.95).max() < 0.06
    locations, index_ray, index_tri = caster.intersects_location(origins, directions, multiple_hits=False)
    assert (index_ray == np.flatnonzero(first >= 0)).all() and (index_tri == first[first >= 0]).all()
    along = locations - origins[index_ray]
    assert np.abs(np.cross(along, directions[index_ray])).max() < 1e-9
    inside = caster.contains_points(random.normal(size=(500, 3)) * 0.6)
    assert 50 < inside.sum() < 450
    points = np.array([[0, 0, 0], vertices[3] * 0.99, vertices[3] * 1.01, [0, 0, -3]])
    assert caster.contains_points(points).tolist() == [True, True, False, False]
    assert np.array_equal(rays, caster.intersects_id(origins, directions)[1])


def test_beside_trimesh_itself() -> None:
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = ball()
    theirs = trimesh.Trimesh(vertices, faces, process=False)
    ours = am.RayCaster(theirs)
    random = np.random.default_rng(7)
    origins, directions = 2 * random.normal(size=(300, 3)), random.normal(size=(300, 3))
    assert np.array_equal(theirs.ray.intersects_first(origins, directions), ours.intersects_first(origins, directions))
    assert np.array_equal(theirs.ray.intersects_any(origins, directions), ours.intersects_any(origins, directions))
    key = lambda found: sorted(zip(found[1].tolist(), found[2].tolist()))  # noqa: E731
    assert key(theirs.ray.intersects_location(origins, directions)) == key(ours.intersects_location(origins, directions))
