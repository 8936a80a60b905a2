# SPDX-License-Identifier: Apache-2.0
"""Places seen again that do not look the same: other light, other traffic, a metre beside; and driven backward.

`python -m tests.benchmark.slam.second_pass KITTI/sequences --drives FOLDER [--seeds 1-3]` puts its table into
docs/measurements.md. In the town the second drive follows the first at once, so the camera has to find itself in what
the first one mapped. KITTI 03 goes forward and then backward, with 40 black frames in between.
"""

from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.benchmark_passes import (
    add_kitti_argument,
    parser_of,
    run_groups,
    tracked_after,
    tracked_share,
)
from tests.benchmark.slam.engine_pass import EnginePass
from tests.benchmark.slam.sequence_part import SequencePart
from tests.benchmark.slam.simulated_drives import add_drive_arguments, simulated_drive

CUT_FRAMES = 40
HEADER = ("input", "second pass tracked after", "of it in the map of the first", "maps in the end", "ATE of both")


def main() -> None:
    """Drive everything twice."""
    parser = parser_of(__doc__)
    add_kitti_argument(parser)
    add_drive_arguments(parser, "1-3")
    given = parser.parse_args()
    there = given.kitti / "03"
    cut = SequencePart(there, -CUT_FRAMES, black=True)
    inputs: dict[str, tuple[SequencePart, ...]] = {
        "KITTI 03 and back": (SequencePart(there), cut, SequencePart(there, -1, step=-1))
    }
    for seed in given.seeds:
        folders = (simulated_drive(kind, seed, given.drives) for kind in ("static", "second"))
        inputs[f"town {seed}"] = tuple(map(SequencePart, folders))
    reports = run_groups({name: [EnginePass(parts, name=name)] for name, parts in inputs.items()}, given.jobs)
    rows = []
    for name, (report,) in reports.items():
        last = len(report.part_starts) - 1
        again = tracked_after(report, last)
        found = "never" if again is None else f"{again} frames"
        rows.append([name, found, f"{tracked_share(report, last):.1%}", str(report.maps), f"{report.ate_m:.2f} m"])
    command = f"python -m tests.benchmark.slam.second_pass KITTI/sequences ({len(given.seeds)} seeds)"
    put("slam-second-pass", command, markdown_table(HEADER, rows))


if __name__ == "__main__":
    main()
