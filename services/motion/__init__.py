# SPDX-License-Identifier: Apache-2.0
"""The motion service: the camera's own motion, and which instances move besides."""
