# SPDX-License-Identifier: Apache-2.0
"""kill -9 at any moment: a whole frame or none, and the run ends as if nothing had happened."""

import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from services.mapstore.export import export_map, load_view
from services.runtime.config.delivery import DeliveryConfig
from tests.unit.mapstore.mapstore_process import FedMapstore, config_of

FRAMES = 17
ROOT = Path(__file__).resolve().parents[3]


def finish(out: Path) -> tuple[dict[int, bytes], list[bytes]]:
    """Feeds the whole drive again to a mapstore that finds what is on disk; its densities and exported files."""
    fed = FedMapstore(config_of(out, serve_http=False))
    densities = fed.feed(FRAMES)
    fed.close()
    assert sorted(set(fed.answers)) == list(range(FRAMES + 1))
    return densities, [path.read_bytes() for path in export_map(out / "map.sqlite", out, ("tum", "kitti", "pcd"))]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[int, bytes], list[bytes]]:
    return finish(tmp_path_factory.mktemp("undisturbed"))


@pytest.mark.real_processes
@pytest.mark.parametrize(
    "moment", ["statement:1", "statement:19", "statement:40", "statement:170", "commit:1", "commit:9"]
)
def test_a_killed_mapstore_ends_with_the_same_bytes(
    tmp_path: Path, undisturbed: tuple[dict[int, bytes], list[bytes]], moment: str
) -> None:
    child = [sys.executable, "-m", "tests.unit.mapstore.mapstore_process", str(tmp_path), str(FRAMES), moment]
    assert subprocess.run(child, cwd=ROOT, check=False, timeout=60).returncode == -signal.SIGKILL
    with sqlite3.connect(tmp_path / "map.sqlite") as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        counts = [
            connection.execute(f"SELECT count(*) FROM {table}").fetchone()[0] for table in ("frames", "densities")
        ]
    view = load_view(tmp_path / "map.sqlite")
    assert counts == [view.sequence + 1] * 2
    assert view.sequence < FRAMES - 1, "it should have died on the way"
    densities, files = finish(tmp_path)
    assert files == undisturbed[1]
    lost = set(undisturbed[0]) - set(densities)
    assert all(densities[sequence] == undisturbed[0][sequence] for sequence in densities)
    assert lost <= set(range(view.sequence - 2 * DeliveryConfig().window + 1)), (
        "densities of the last frames are sent again"
    )
