# SPDX-License-Identifier: Apache-2.0
"""Who moves in the town: simulated ahead of time, so that every actor is a pure function of time."""
