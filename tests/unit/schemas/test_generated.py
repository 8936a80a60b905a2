# SPDX-License-Identifier: Apache-2.0
"""The committed Python of the schemas is what their sources give."""

from pathlib import Path

from schemas.generate import ROOT, generate


def test_generated_files_match_their_sources(tmp_path: Path) -> None:
    generate(tmp_path)
    fresh = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*_pb2.py*"))
    assert fresh == sorted(path.relative_to(ROOT) for path in (ROOT / "schemas").rglob("*_pb2.py*"))
    for path in fresh:
        assert (tmp_path / path).read_text() == (ROOT / path).read_text(), f"{path}: run python -m schemas.generate"
