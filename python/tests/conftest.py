"""What all tests share."""

import anamorph as am
import numpy as np
import pytest


@pytest.fixture
def square() -> am.Scene:
    """A square of two triangles at z = 0, from -1 to 1, red on the left and blue on the right."""
    scene = am.Scene()
    vertices = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    colors = [[1, 0, 0], [0, 0, 1], [0, 0, 1], [1, 0, 0]]
    scene.add(am.Mesh(vertices, [[0, 1, 2], [0, 2, 3]], colors=np.array(colors, dtype=np.float64), name="square"))
    return scene


@pytest.fixture
def pinhole() -> am.Camera:
    """Four units before the square."""
    return am.camera.pinhole(eye=[0, 0, 4], target=[0, 0, 0], vfov=40)
