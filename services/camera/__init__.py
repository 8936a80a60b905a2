# SPDX-License-Identifier: Apache-2.0
"""The camera: decides when a frame exists, and publishes it from a dataset, a video or the simulator."""
