# SPDX-License-Identifier: Apache-2.0
"""The alignment of a map by the poses it was built from: by how the cameras looked, not only by where they were."""

import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.alignment import Alignment, Similarity, align


def align_poses(source: npt.NDArray[np.float64], target: npt.NDArray[np.float64], alignment: Alignment) -> Similarity:
    """The least-squares target_from_source over paired poses, (N, 4, 4) each, with the rotation from the orientations.

    Positions on a nearly straight way leave the rotation about it open (`align`), and a map would be rolled about it
    by what little noise there is. The rotation here is the chordal mean of those between the orientations (Hartley et
    al., "Rotation averaging", IJCV 2013); scale and translation are the best to it. Raises InputError as `align` does.
    """
    if alignment is Alignment.NONE:
        return Similarity.identity()
    by_positions = align(source[:, :3, 3], target[:, :3, 3], alignment)
    u, _, vt = np.linalg.svd(np.einsum("nij,nkj->ik", target[:, :3, :3], source[:, :3, :3]))
    rotation = (u * (1.0, 1.0, np.linalg.det(u) * np.linalg.det(vt))) @ vt
    source_mean, target_mean = source[:, :3, 3].mean(axis=0), target[:, :3, 3].mean(axis=0)
    turned = (source[:, :3, 3] - source_mean) @ rotation.T
    scale = by_positions.scale
    if alignment is Alignment.SIM3:
        scale = float(np.sum(turned * (target[:, :3, 3] - target_mean)) / np.sum(np.square(turned)))
    return Similarity(rotation, target_mean - scale * rotation @ source_mean, scale)
