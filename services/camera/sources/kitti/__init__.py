# SPDX-License-Identifier: Apache-2.0
"""KITTI as the benchmarks lay it out: odometry sequences, raw drives, tracking sequences."""
