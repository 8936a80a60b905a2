# SPDX-License-Identifier: Apache-2.0
"""Widths of the town's streets, metres from the centre line; traffic keeps to the right.

The loop has two lanes each way and a row of bays on both sides; a side street has one lane each way.
"""

LANE_WIDTH_M = 3.25
LANE_CENTRES_M = (0.5 * LANE_WIDTH_M, 1.5 * LANE_WIDTH_M)
"""Inner and outer lane; to the right of the centre line (negative n) in the direction of s, to the left against it."""
BAY_CENTRE_M = 2.0 * LANE_WIDTH_M + 1.1
KERB_M = 2.0 * LANE_WIDTH_M + 2.2
PAVEMENT_EDGE_M = KERB_M + 3.5
WALKWAY_M = (KERB_M + 1.1, KERB_M + 3.0)
"""Part of the pavement where nothing stands."""
KERB_HEIGHT_M = 0.12
BAY_LENGTH_M = 6.0
"""Bay k of either side lies between s = k and k + 1 bay lengths; its marks are painted there."""
ZEBRA_HALF_LENGTH_M = 1.8
"""How far a zebra crossing reaches along the loop from its middle; no bays within `ZEBRA_CLEAR_M`."""
ZEBRA_CLEAR_M = 8.0
CROSSING_CLEAR_M = 14.0
"""No bays within this of a junction's middle."""

SIDE_LANE_CENTRE_M = 1.65
SIDE_KERB_M = 3.6
SIDE_PAVEMENT_EDGE_M = SIDE_KERB_M + 2.4
CORNER_RADIUS_M = 5.0
"""Of the kerb where a side street opens into the loop."""
SIDE_STOP_M = KERB_M + 4.6
"""Stop line of a side street, along it from the loop's centre line."""
