# SPDX-License-Identifier: Apache-2.0
"""The messages as plain dataclasses of numpy arrays: what everything but a service.py works with."""

from schemas.records.camera import (
    CameraCalibration,
    DepthImage,
    EndOfInput,
    FrameManifest,
    Image,
    TrueInstances,
    TrueObject,
    TruePose,
)
from schemas.records.control import FrameAnswer, Heartbeat
from schemas.records.density import Density, DensityLevel
from schemas.records.instances import Instance, Instances
from schemas.records.mapped_objects import MappedObject, MappedObjects
from schemas.records.motion import EgoMotion, InstanceMotion, InstanceMotions, MovingMask
from schemas.records.objects import MotionState, Objects, ObjectTrack
from schemas.records.slam import MapUpdate, MaskSource, PoseInMap, TrackedFrame, TrackingState

__all__ = [
    "CameraCalibration",
    "Density",
    "DensityLevel",
    "DepthImage",
    "EgoMotion",
    "EndOfInput",
    "FrameAnswer",
    "FrameManifest",
    "Heartbeat",
    "Image",
    "Instance",
    "InstanceMotion",
    "InstanceMotions",
    "Instances",
    "MapUpdate",
    "MappedObject",
    "MappedObjects",
    "MaskSource",
    "MotionState",
    "MovingMask",
    "ObjectTrack",
    "Objects",
    "PoseInMap",
    "TrackedFrame",
    "TrackingState",
    "TrueInstances",
    "TrueObject",
    "TruePose",
]
