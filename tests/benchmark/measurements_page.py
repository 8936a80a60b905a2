# SPDX-License-Identifier: Apache-2.0
"""This repository's page of measurements, docs/measurements.md, for the benchmarks beside this file."""

from pathlib import Path

from services.evaluation.measurements_page import markdown_table, put_table

__all__ = ["PAGE", "markdown_table", "put"]

PAGE = Path(__file__).resolve().parents[2] / "docs" / "measurements.md"


def put(name: str, command: str, table: str) -> None:
    """Put a benchmark's table between its markers, and print it."""
    print(put_table(PAGE, name, command, table))
