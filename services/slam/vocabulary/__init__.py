# SPDX-License-Identifier: Apache-2.0
"""The vocabulary that places are known by: the file that is shipped, and how one is trained."""

from pathlib import Path

SHIPPED_VOCABULARY = Path(__file__).with_name("places.kmvocab")
"""Made by `kinemap train vocabulary`."""
