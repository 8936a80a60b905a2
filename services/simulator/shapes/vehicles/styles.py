# SPDX-License-Identifier: Apache-2.0
"""What kinds of vehicles there are: names, sizes and how common they are."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class VehicleStyle:
    """category: name in COCO. size_m: length, width, height of the body. half_base_m: half the distance of the axles.

    share: how common it is on the road. in_every_lane: it also drives on the inner lane. parks: it stands in bays.
    """

    name: str
    category: str
    size_m: tuple[float, float, float]
    half_base_m: float
    share: float
    in_every_lane: bool = True
    parks: bool = True


SALOON = VehicleStyle("town_saloon", "car", (4.44, 1.78, 1.46), 1.36, 0.16)
HATCHBACK = VehicleStyle("town_hatchback", "car", (3.9, 1.72, 1.52), 1.22, 0.17)
ESTATE = VehicleStyle("estate", "car", (4.66, 1.82, 1.5), 1.4, 0.12)
SUV = VehicleStyle("suv", "car", (4.58, 1.9, 1.74), 1.36, 0.14)
SPORTS = VehicleStyle("sports", "car", (4.3, 1.84, 1.26), 1.26, 0.04)
TAXI = VehicleStyle("taxi", "car", (4.6, 1.8, 1.66), 1.4, 0.06)
PICKUP = VehicleStyle("pickup", "car", (5.1, 1.88, 1.78), 1.6, 0.05)
VAN = VehicleStyle("town_van", "car", (4.72, 1.94, 2.06), 1.48, 0.08)
DELIVERY = VehicleStyle("delivery", "truck", (5.7, 2.04, 2.6), 1.75, 0.06, parks=False)
BOX_LORRY = VehicleStyle("box_lorry", "truck", (7.9, 2.4, 3.3), 2.3, 0.04, in_every_lane=False, parks=False)
FLATBED = VehicleStyle("flatbed", "truck", (7.6, 2.36, 2.7), 2.2, 0.025, in_every_lane=False, parks=False)
BUS = VehicleStyle("bus", "bus", (10.8, 2.5, 3.05), 2.95, 0.04, in_every_lane=False, parks=False)
BICYCLE = VehicleStyle("bicycle", "bicycle", (1.74, 0.6, 1.1), 0.53, 0.08, in_every_lane=False, parks=False)

CARS = (SALOON, HATCHBACK, ESTATE, SUV, SPORTS, TAXI, PICKUP, VAN)
LARGE = (DELIVERY, BOX_LORRY, FLATBED, BUS)
KINDS = (*CARS, *LARGE, BICYCLE)
