# SPDX-License-Identifier: Apache-2.0
"""Lost on purpose in the simulated town: forty black frames, and a camera carried off to elsewhere.

`python -m tests.benchmark.slam.lost_on_purpose --drives FOLDER [--seeds 1-3]` puts its table into docs/measurements.md.
`black`: 400 frames, 40 black ones, then on from where it was 20 frames before. `kidnapped`: 150 frames, then at once
150 frames further on, until the round has come back to where it began.
"""

from pathlib import Path

from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.benchmark_passes import parser_of, run_groups, tracked_after
from tests.benchmark.slam.engine_pass import EnginePass, PassReport
from tests.benchmark.slam.sequence_part import SequencePart
from tests.benchmark.slam.simulated_drives import add_drive_arguments, simulated_drive

BLACK_AT, BLACK_FRAMES, BACK = 400, 40, 20
KIDNAPPED_AT, CARRIED_TO = 150, 300
HEADER = ("seed", "case", "tracked again after", "maps in the end", "frames in the main map", "ATE")


def cases(folder: Path) -> dict[str, tuple[SequencePart, ...]]:
    """What the camera is shown."""
    return {
        "black": (
            SequencePart(folder, 0, BLACK_AT),
            SequencePart(folder, BLACK_AT, BLACK_FRAMES, black=True),
            SequencePart(folder, BLACK_AT - BACK),
        ),
        "kidnapped": (SequencePart(folder, 0, KIDNAPPED_AT), SequencePart(folder, CARRIED_TO)),
    }


def row(seed: int, case: str, report: PassReport) -> list[str]:
    """A case's line of the table."""
    again = tracked_after(report, len(report.part_starts) - 1)
    return [
        str(seed),
        case,
        "never" if again is None else f"{again} frames",
        str(report.maps),
        f"{report.coverage:.1%}",
        f"{report.ate_m:.2f} m",
    ]


def main() -> None:
    """Lose every seed's camera in both ways."""
    parser = parser_of(__doc__)
    add_drive_arguments(parser, "1-3")
    given = parser.parse_args()
    groups = {
        f"{seed} {case}": [EnginePass(parts, name=f"seed {seed}")]
        for seed in given.seeds
        for case, parts in cases(simulated_drive("static", seed, given.drives)).items()
    }
    reports = run_groups(groups, given.jobs)
    rows = [row(int(name.split()[0]), name.split()[1], of_name[0]) for name, of_name in reports.items()]
    command = f"python -m tests.benchmark.slam.lost_on_purpose ({len(given.seeds)} seeds)"
    put("slam-lost-on-purpose", command, markdown_table(HEADER, rows))


if __name__ == "__main__":
    main()
