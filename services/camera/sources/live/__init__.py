# SPDX-License-Identifier: Apache-2.0
"""Cameras that see now: video devices and streams."""
