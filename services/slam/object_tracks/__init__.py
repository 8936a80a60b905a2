# SPDX-License-Identifier: Apache-2.0
"""Where the objects of each frame are in the map, how fast they move, and how large they are."""

from services.slam.object_tracks.object_tracks import ObjectTracks
from services.slam.object_tracks.sighting import CameraView, Sighting, sight

__all__ = ["CameraView", "ObjectTracks", "Sighting", "sight"]
