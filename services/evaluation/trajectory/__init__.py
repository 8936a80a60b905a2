# SPDX-License-Identifier: Apache-2.0
"""Trajectories beside the truth: alignment, errors, tables and pictures."""
