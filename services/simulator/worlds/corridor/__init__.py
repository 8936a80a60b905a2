# SPDX-License-Identifier: Apache-2.0
"""An office floor: a closed loop of corridors with open offices beside it, for a robot at walking height."""
