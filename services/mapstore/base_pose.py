# SPDX-License-Identifier: Apache-2.0
"""Where the robot is, from where its camera is (REP-105: map -> base_link -> camera)."""

from services.mapstore import sim3
from services.mapstore.map_view import MapView


class BasePose:
    """Knows how the camera sits on the robot."""

    def __init__(self, base_from_camera: sim3.Floats) -> None:
        """`base_from_camera` (7,) tx ty tz qx qy qz qw, in metres."""
        self._camera_from_base = sim3.inverse_pose(base_from_camera)

    def in_map(self, view: MapView) -> sim3.Floats | None:
        """(7,) map_from_base of the newest frame, None where it was not tracked.

        Where the map is not metric the offset between camera and base has no length in it, and is left out.
        """
        map_from_camera = view.current_pose()
        if map_from_camera is None:
            return None
        camera_from_base = self._camera_from_base.copy()
        if not view.metric_scale:
            camera_from_base[:3] = 0.0
        return sim3.compose_pose(map_from_camera, camera_from_base)
