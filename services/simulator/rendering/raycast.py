# SPDX-License-Identifier: Apache-2.0
"""Rays against triangles, by Open3D's RaycastingScene (Embree). The only file that knows Open3D."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from services.runtime.errors import ResourceError


def _open3d() -> Any:
    # Imported at the first scene, not with this module: it takes a second and is needed by nobody else.
    try:
        import open3d
    except (ImportError, OSError) as error:
        message = f"simulator: Open3D cannot be loaded ({error}); expected open3d and Debian's libusb-1.0-0"
        raise ResourceError(message) from error
    return open3d


class RayScene:
    """A fixed set of triangles to cast rays against.

    vertices: (V, 3) metres; triangles: (T, 3). Results do not depend on `threads`, at most the cores there are.
    """

    def __init__(self, vertices: NDArray[np.float64], triangles: NDArray[np.int32], threads: int) -> None:
        open3d = _open3d()
        self._tensor = open3d.core.Tensor
        self._threads = threads
        self._scene = open3d.t.geometry.RaycastingScene(threads)
        self._scene.add_triangles(
            self._tensor(np.ascontiguousarray(vertices, np.float32)),
            self._tensor(np.ascontiguousarray(triangles, np.uint32)),
        )

    def cast(
        self, origin: NDArray[np.float64], directions: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """First hits of rays from one origin (3,) along `directions` (N, 3).

        Returns the distance in lengths of the direction (infinity = none) and the triangle (-1 = none), each (N,).
        """
        rays = np.empty((len(directions), 6), np.float32)
        rays[:, :3] = origin
        rays[:, 3:] = directions
        found = self._scene.cast_rays(self._tensor.from_numpy(rays), self._threads)
        # Open3D's "none" is the largest unsigned number: -1 with a sign.
        return found["t_hit"].numpy(), found["primitive_ids"].numpy().view(np.int32)

    def covered(self, origins: NDArray[np.float32], direction: NDArray[np.float32], from_m: float) -> NDArray[np.bool_]:
        """Whether anything lies beyond `from_m` from the origins (N, 3) in a direction (3,) of length 1; (N,)."""
        rays = np.empty((len(origins), 6), np.float32)
        rays[:, :3] = origins
        rays[:, 3:] = direction
        hit = self._scene.test_occlusions(self._tensor.from_numpy(rays), from_m, float("inf"), self._threads)
        return np.asarray(hit.numpy(), np.bool_)
