# SPDX-License-Identifier: Apache-2.0
"""The README.txt of a data set."""

from __future__ import annotations

from services.simulator.data_sets.request import DataSetRequest
from services.simulator.data_sets.surface import FARTHEST_M, VOXEL_M

_HEAD = """A data set of kinemap's simulator: {sequences} sequence(s) of {frames} frames,
{width}x{height} px at {rate:g} Hz.
Made by `kinemap simulate`; the options are in dataset.json, checksums in SHA256SUMS (sha256sum -c SHA256SUMS).

Frames of reference
  camera   x right, y down, z forward; metres; pixel (0, 0) is the centre of the top left pixel
  sequence the left camera at the first frame: poses, trajectory.tum and surface are in it
  world    the simulator's: x forward and y left at the start, z up; dataset.json: world_from_first_camera

What is true is true of a frame's time, also where its image is frozen, black or blurred by option.

Folders and files, <seq> = {first}..{last}
"""

_ENTRIES = {
    "kitti": (
        ("sequences/<seq>/image_2", "left colour images, PNG{right}"),
        ("sequences/<seq>/calib.txt", "P0..P3 as in KITTI odometry (P0, P1 grey, P2, P3 colour; P1 and P3 right), px"),
        ("sequences/<seq>/times.txt", "capture times in seconds, one a line"),
        ("poses/<seq>.txt", "KITTI odometry: 3x4, sequence frame from camera, one line a frame"),
    ),
    "grey": (("sequences/<seq>/image_0", "left images in grey, PNG{right_grey}"),),
    "instances": (
        ("sequences/<seq>/instances", "label images: 0 nobody, else an id that lasts over the sequence;"),
        ("", "instances.json: by frame, each id's COCO category and whether it moves (`kinemap run` finds both)"),
    ),
    "moving": (("sequences/<seq>/moving", "8-bit PNG: 0 background, 1 could move but stands, 2 moves (from 0.1 m/s)"),),
    "depth": (
        ("sequences/<seq>/depth", "16-bit PNG: depth along the optical axis in 1/256 m, as KITTI's; to the nearest;"),
        ("", "0: sky, or farther than 255.99 m"),
    ),
    "flow": (
        ("sequences/<seq>/flow", "flow to the next frame (the last has none), KITTI's 16-bit PNG: u * 64 + 2^15,"),
        ("", "v * 64 + 2^15, valid; valid = still seen in the next frame, the sky as infinitely far"),
    ),
    "tracking": (
        ("label_02/<seq>.txt", "KITTI tracking labels: boxes in px round the whole object within the image, size and"),
        ("", "bottom centre in the camera frame; truncated 0..2, occluded 0..2 from visible against whole;"),
        ("", "a bicycle with its rider is one Cyclist with the bicycle's id; buses and lone bicycles are Misc"),
    ),
    "mots": (
        ("instances_txt/<seq>.txt", "MOTS: frame id class_id height width rle; car 1, person 2,"),
        ("", "every other object one ignored region (10)"),
    ),
    "coco": (("annotations/instances.json", "COCO annotations of all sequences; attributes: track_id, moving"),),
    "surface": (
        (
            "surface/<seq>.ply",
            "what stood when seen as points, one a voxel of {voxel:g} m, to {reach:g} m from the",
        ),
        ("", "camera; state 0 static, 1 non_moving (an object that stands); for `kinemap evaluate map`"),
    ),
    "tum": (("sequences/<seq>/trajectory.tum", "timestamp_s tx ty tz qx qy qz qw, sequence frame from camera"),),
}


def readme_text(request: DataSetRequest) -> str:
    """What each folder of this data set is, and in which frame of reference."""
    drive, names = request.drive, request.sequences
    stereo = drive.stereo_baseline_m > 0.0
    values = {
        "sequences": len(names),
        "frames": drive.frames,
        "width": drive.width,
        "height": drive.height,
        "rate": drive.rate_hz,
        "first": names[0],
        "last": names[-1],
        "right": "; image_3: right ones" if stereo else "",
        "right_grey": "; image_1: right ones" if stereo else "",
        "voxel": VOXEL_M,
        "reach": FARTHEST_M,
    }
    rows = [row for name, entries in _ENTRIES.items() if name in request.formats for row in entries]
    return _HEAD.format(**values) + "".join(f"  {name:<31}{text.format(**values)}\n" for name, text in rows)
