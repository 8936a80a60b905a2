# SPDX-License-Identifier: Apache-2.0
"""One default street for all tests of the simulator: building it takes two seconds."""

import pytest

from services.simulator.options import StreetOptions
from services.simulator.street import Street


@pytest.fixture(scope="session")
def street() -> Street:
    """The default drive."""
    return Street(StreetOptions())
