"""Fixtures that the tests share."""

from pathlib import Path

import numpy as np
import pytest

import realistic


@pytest.fixture(scope="session")
def checkout() -> Path:
    """The checkout's root."""
    return Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def camera() -> realistic.Camera:
    """A camera with a double Gauss lens, whose samples cover the whole rear element, so that some rays are blocked."""
    return realistic.Camera("dgauss.50mm", resolution=(1920, 1280), focus_distance=1000.0, pupil="rear")


@pytest.fixture
def samples():
    """A function that makes n random samples of a camera: image_xy and lens_uv, (n, 2) of float32 in C order."""

    def make(camera: realistic.Camera, n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
        random = np.random.default_rng(seed)
        scale = np.asarray(camera.resolution, np.float32)
        return random.random((n, 2), np.float32) * scale, random.random((n, 2), np.float32)

    return make
