# SPDX-License-Identifier: Apache-2.0
"""Frames of a run with what was decided about every object in them, as one picture."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb

from schemas import topics
from schemas.codec import decode
from schemas.records import Image, MotionState, Objects
from services.evaluation.pictures.figure import new_figure, save_figure
from services.evaluation.run.plots import STATE_COLOURS
from services.runtime.session_file import SessionFile

_COLUMNS = 2
_TINT = 0.45
_WIDTH_IN = 12.0
_LEAST_NAMED_PX = 20


class SeenFrame(NamedTuple):
    """One image with the objects found in it."""

    sequence: int
    image: Image
    objects: Objects


def read_frames(session: Path, count: int, *, recover: bool = False) -> list[SeenFrame]:
    """`count` frames evenly spread over a recorded session; fewer where it has fewer. Raises InputError as it reads."""
    with SessionFile(session, recover=recover) as file:
        places = file.index_of(topics.IMAGE.key)
        chosen = np.unique(np.linspace(0, len(places) - 1, min(count, len(places))).round().astype(int))
        frames = []
        for index in chosen:
            found = {message.key: message for message in file.beside(places[index])}
            image, objects = found.get(topics.IMAGE.key), found.get(topics.OBJECTS.key)
            if image is not None and objects is not None:
                records = decode(topics.IMAGE, image.payload), decode(topics.OBJECTS, objects.payload)
                frames.append(SeenFrame(image.sequence, *records))
    return frames


def tinted(frame: SeenFrame) -> npt.NDArray[np.float64]:
    """(H, W, 3) red-green-blue in 0..1: objects in the colour of their motion state, their outlines in full."""
    pixels = frame.image.pixels
    rgb = np.repeat(pixels[..., None], 3, axis=2) if pixels.ndim == 2 else pixels[..., ::-1]
    picture = rgb.astype(np.float64) / 255.0
    labels = frame.objects.track_image
    if labels.shape != pixels.shape[:2]:
        return picture
    outline = np.zeros(labels.shape, dtype=bool)
    outline[:-1] |= labels[:-1] != labels[1:]
    outline[:, :-1] |= labels[:, :-1] != labels[:, 1:]
    for row in frame.objects.objects:
        mask = labels == row.object_id
        colour = np.array(to_rgb(STATE_COLOURS[row.motion_state]))
        picture[mask] = (1.0 - _TINT) * picture[mask] + _TINT * colour
        picture[mask & outline] = colour
    return picture


def plot_frames(frames: list[SeenFrame], path: Path) -> None:
    """Draw the frames in two columns, the objects' ids beside them. Nothing is written where there are none."""
    if not frames:
        return
    height, width = frames[0].image.pixels.shape[:2]
    rows = -(-len(frames) // _COLUMNS)
    row_in = _WIDTH_IN / _COLUMNS * height / width + 0.3
    figure = new_figure(height_in=rows * row_in + 0.3, width_in=_WIDTH_IN)
    for number, frame in enumerate(frames):
        axes = figure.add_subplot(rows, _COLUMNS, number + 1)
        axes.imshow(tinted(frame), interpolation="nearest")
        for row in frame.objects.objects:
            x, y, box_width, box_height = row.box_px
            if box_height < _LEAST_NAMED_PX:
                continue  # the ids of a far row of cars would only cover each other
            axes.text(x + box_width / 2, max(y - 2, 4), str(row.object_id), color="white", fontsize=5, ha="center")
        axes.set_title(f"frame {frame.sequence}", fontsize=8, pad=2)
        axes.set_axis_off()
    legend = {"moving": MotionState.MOVING, "standing or undecided": MotionState.NON_MOVING}
    for place, (name, state) in enumerate(legend.items()):
        figure.text(0.4 + 0.15 * place, 0.0, name, color=STATE_COLOURS[state], fontsize=8, va="bottom")
    save_figure(figure, path)
