# SPDX-License-Identifier: Apache-2.0
"""LabelMe's JSON: one file an image, with the shapes that somebody drew on it.

Source: LabelMe (Russell et al., IJCV 2008) as the program of that name writes it: `shapes` (`label`, `points`,
`shape_type`, `group_id`), `imagePath`, `imageHeight`, `imageWidth`. The image itself (`imageData`) is not looked at.
"""

import math
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import Any

import numpy as np
import numpy.typing as npt

from services.formats.json_file import read_json, shortened, write_json
from services.formats.rle import decode_mask, rle_from_coco
from services.runtime.errors import InputError

_EXPECTED = "LabelMe's annotations: an object with shapes, imagePath, imageHeight and imageWidth"
_SHAPES = {"polygon": 3, "rectangle": 2, "circle": 2}
"""with the fewest points that each needs; the others that LabelMe draws have no area"""
_CIRCLE_CORNERS = 64
_LARGEST_SIDE_PX = 65535


@dataclass(frozen=True)
class LabelmeShape:
    """One shape. `points_px` (N, 2): x, y, where the top left pixel reaches from (0, 0) to (1, 1).

    A polygon's corners, a rectangle's two opposite ones, or a circle's centre and a point on it. Shapes of one label
    and one `group_id` are parts of one object.
    """

    label: str
    points_px: npt.NDArray[np.float64]
    shape_type: str = "polygon"
    group_id: int | None = None

    def polygon_px(self) -> npt.NDArray[np.float64]:
        """The outline's corners (N, 2)."""
        if self.shape_type == "rectangle":
            (x1, y1), (x2, y2) = self.points_px[:2]
            return np.array([[x1, y1], [x2, y1], [x2, y2], [x1, y2]])
        if self.shape_type == "circle":
            centre, rim = self.points_px[:2]
            angles = np.linspace(0.0, 2.0 * np.pi, _CIRCLE_CORNERS, endpoint=False)
            radius: float = math.dist(centre, rim)
            return np.asarray(centre + radius * np.stack((np.cos(angles), np.sin(angles)), axis=1))
        return self.points_px


@dataclass(frozen=True)
class LabelmeImage:
    """The shapes of one image, in the order in which they were drawn; sizes in pixels."""

    image_path: str
    width: int
    height: int
    shapes: tuple[LabelmeShape, ...]

    @property
    def name(self) -> str:
        """The image's name without folder (of any system) and suffix."""
        return PureWindowsPath(self.image_path).stem

    def mask(self, shape: LabelmeShape) -> npt.NDArray[np.bool_]:
        """The pixels (height, width) within a shape, as pycocotools draws polygons; what lies outside is cut off."""
        flat = [float(value) for value in shape.polygon_px().ravel()]
        return np.asarray(decode_mask(rle_from_coco([flat], self.height, self.width)), dtype=np.bool_)


def read_labelme(path: Path) -> LabelmeImage:
    """Read one file.

    Raises:
        InputError: no such file, or not as LabelMe writes it; names file, shape, what was found and expected.
    """
    match read_json(path, _EXPECTED):
        case {
            "shapes": list(rows),
            "imagePath": str(image_path),
            "imageHeight": int(height),
            "imageWidth": int(width),
        } if image_path and 0 < height <= _LARGEST_SIDE_PX and 0 < width <= _LARGEST_SIDE_PX:
            shapes = tuple(_shape(f"{path} shape {number}", row) for number, row in enumerate(rows))
            return LabelmeImage(image_path, width, height, shapes)
        case other:
            found = sorted(other) if isinstance(other, dict) else other
            raise InputError(f"{path}: {shortened(found)}, expected {_EXPECTED}")


def write_labelme(path: Path, image: LabelmeImage) -> None:
    """Write one file as LabelMe opens it, the image not in it but beside it."""
    rows = [
        {
            "label": shape.label,
            "points": shape.points_px.tolist(),
            "group_id": shape.group_id,
            "shape_type": shape.shape_type,
            "flags": {},
        }
        for shape in image.shapes
    ]
    size = {"imageHeight": image.height, "imageWidth": image.width}
    write_json(
        path, {"version": "5.0.0", "flags": {}, "shapes": rows, "imagePath": image.image_path, "imageData": None} | size
    )


def _shape(place: str, row: Any) -> LabelmeShape:
    match row:
        case {"label": str(label), "points": list(points)} if all(_is_point(point) for point in points):
            kind, group = row.get("shape_type", "polygon"), row.get("group_id")
            if kind not in _SHAPES:
                raise InputError(f"{place}: a {shortened(kind)}, expected {', '.join(_SHAPES)}")
            if len(points) < _SHAPES[kind]:
                raise InputError(f"{place}: a {kind} of {len(points)} points, expected at least {_SHAPES[kind]}")
            if group is None or (isinstance(group, int) and not isinstance(group, bool)):
                return LabelmeShape(label, np.array(points, dtype=np.float64), kind, group)
    raise InputError(f'{place}: {shortened(row)}, expected {{"label": NAME, "points": [[x, y], ...]}}')


def _is_point(point: Any) -> bool:
    return (
        isinstance(point, list) and len(point) == 2 and all(type(v) in (int, float) and math.isfinite(v) for v in point)
    )
