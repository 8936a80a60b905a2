# SPDX-License-Identifier: Apache-2.0
"""How large objects of a category usually are."""

from typing import NamedTuple


class Size(NamedTuple):
    """Of a cuboid, metres; length lies along the heading."""

    length: float
    width: float
    height: float


_SIZES = {
    "person": Size(0.5, 0.55, 1.72),
    "bicycle": Size(1.75, 0.6, 1.65),
    "motorcycle": Size(2.1, 0.8, 1.6),
    "car": Size(4.2, 1.8, 1.52),
    "truck": Size(7.5, 2.4, 3.1),
    "bus": Size(11.0, 2.5, 3.1),
}
_ON_WHEELS = ("car", "truck", "bus")
_WHEEL_INSET = 0.2
_OTHER = Size(1.0, 1.0, 1.0)


def usual_size(category: str) -> Size:
    """Rounded means of KITTI's 3D boxes (Geiger et al. 2012) and, for buses, of city buses."""
    return _SIZES.get(category, _OTHER)


def wheel_inset_m(category: str, size: Size) -> float:
    """How far behind its end an object of this category touches the road: a wheelbase is about 0.6 of the length."""
    return _WHEEL_INSET * size.length if category in _ON_WHEELS else 0.0
