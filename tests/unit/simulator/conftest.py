# SPDX-License-Identifier: Apache-2.0
"""One default street for all tests of the simulator: building it takes two seconds."""

import pytest

from services.simulator.drive import Drive
from services.simulator.options import DriveOptions


@pytest.fixture(scope="session")
def street() -> Drive:
    """The default drive."""
    return Drive(DriveOptions())
