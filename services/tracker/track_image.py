# SPDX-License-Identifier: Apache-2.0
"""The track image of thesis 3.1.3: every pixel says which object it belongs to."""

import numpy as np
import numpy.typing as npt


def draw_track_image(labels: npt.NDArray[np.uint32], object_of_instance: dict[int, int]) -> npt.NDArray[np.uint32]:
    """uint32 (H, W): the object id of each labelled pixel, 0 for background and for instances that are no object."""
    if not object_of_instance:
        return np.zeros(labels.shape, dtype=np.uint32)
    instance_ids = np.array(sorted(object_of_instance), dtype=np.uint32)
    object_ids = np.array([object_of_instance[int(i)] for i in instance_ids], dtype=np.uint32)
    place = np.minimum(np.searchsorted(instance_ids, labels), len(instance_ids) - 1)
    return np.where(instance_ids[place] == labels, object_ids[place], np.uint32(0)).astype(np.uint32)
