# SPDX-License-Identifier: Apache-2.0
"""What shading needs to know of each triangle, laid out so that a pixel is a few multiplications."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import Mesh, cross

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class TriangleTable:
    """Triangles in the world frame.

    corner: (T, 3, 3) metres. gradient: (T, 2, 3), change of (u, v) by position, tiles a metre. uv: (T, 2) at the first
    corner. normal: (T, 3), unit, either way. texture, part, instance: (T,); instance 0 is nobody. tint: (T, 3).
    """

    corner: Floats
    gradient: Floats
    uv: Floats
    normal: Floats
    texture: NDArray[np.int32]
    part: NDArray[np.int32]
    instance: NDArray[np.int32]
    tint: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.texture)

    def take(self, rows: NDArray[np.intp]) -> TriangleTable:
        """Some rows of it."""
        return TriangleTable(*(getattr(self, name)[rows] for name in self.__slots__))


def table_of(mesh: Mesh, vertices: Floats, instance: NDArray[np.int32]) -> TriangleTable:
    """Table of a mesh whose vertices (V, 3) are given in the world frame."""
    corner = vertices[mesh.triangles]
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normal = cross(e1, e2)
    area = np.einsum("ij,ij->i", normal, normal)[:, None]
    # Gradients of the barycentric coordinates belonging to the second and third corner.
    grad_1, grad_2 = cross(e2, normal) / area, cross(normal, e1) / area
    d1, d2 = mesh.uv[:, 1] - mesh.uv[:, 0], mesh.uv[:, 2] - mesh.uv[:, 0]
    gradient = d1[:, :, None] * grad_1[:, None, :] + d2[:, :, None] * grad_2[:, None, :]
    return TriangleTable(
        corner, gradient, mesh.uv[:, 0], normal / np.sqrt(area), mesh.texture, mesh.part, instance, mesh.tint
    )


def joined(tables: Sequence[TriangleTable]) -> TriangleTable:
    """One table of several; parts stay distinct."""
    first_part = np.cumsum([0] + [int(table.part.max(initial=-1)) + 1 for table in tables])
    columns = {name: np.concatenate([getattr(table, name) for table in tables]) for name in TriangleTable.__slots__}
    columns["part"] = np.concatenate([t.part + o for t, o in zip(tables, first_part, strict=False)])
    return TriangleTable(**columns)
