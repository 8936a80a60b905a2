# SPDX-License-Identifier: Apache-2.0
"""The source that the configuration asks for."""

from services.camera.sources.detect import SourceOptions, open_source
from services.camera.sources.opencv_log import silence_opencv
from services.camera.sources.source import Source
from services.runtime.config import Config
from services.simulator.options import DriveOptions


def open_configured_source(config: Config) -> Source:
    """Open `config.camera.input`; cheap, so that a run with an input that cannot be used fails before it begins.

    OpenCV's and FFmpeg's own words are kept from this process' standard error from here on.

    Raises:
        InputError: the input, or a file of it, cannot be used.
    """
    silence_opencv()
    return open_source(
        config.camera.input,
        SourceOptions(**config.camera.model_dump(exclude={"input"})),
        DriveOptions(**config.simulator.model_dump()),
    )
