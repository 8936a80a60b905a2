# SPDX-License-Identifier: Apache-2.0
"""OpenCV's and FFmpeg's own words about what they cannot open, kept from the user, who hears one line of ours."""

import os

import cv2


def silence_opencv() -> None:
    """For this process, and before its first video is opened: FFmpeg's level is read once, from the environment."""
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # AV_LOG_QUIET
