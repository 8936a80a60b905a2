# SPDX-License-Identifier: Apache-2.0
"""Whether the engine slows down or fills the memory: ten thousand frames, round after round through the same town.

`python -m tests.benchmark.slam.ten_thousand_frames --drives FOLDER [--seeds 1] [--frames 10000]` puts its tables into
docs/measurements.md. One simulated round is shown again and again, until the last thousand frames show the places of
the second. Processor time is that of all threads of the engine, the background's too. Where other programs run on the
machine it is slower at one time than at another: what counts then is how often the engine's time for a round would
have read that round's images, the same work each time.
"""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.benchmark_passes import parser_of, run_groups
from tests.benchmark.slam.engine_pass import EnginePass, PassReport
from tests.benchmark.slam.engine_run import TRACKING
from tests.benchmark.slam.sequence_part import SequencePart
from tests.benchmark.slam.simulated_drives import add_drive_arguments, simulated_drive

_NOT_YET_BACK = 100
HEADER = (
    "seed",
    "frames, km",
    "coverage",
    "processor ms a frame, second and last thousand",
    "the same in readings of the images",
    "by the clock",
    "memory after the first thousand and in the end",
    "MB a km",
    "keyframes alive of all",
    "landmarks",
)
ROUND_HEADER = (
    "seed, round",
    "processor ms a frame",
    "in readings of the images",
    "keyframes alive",
    "landmarks",
    "memory",
    "frames not tracked",
)


def round_of(part: SequencePart) -> int:
    """After how many frames the drive is nearest to where it began."""
    centers = part.true_poses()[:, :3, 3]
    return int(np.linalg.norm(centers[_NOT_YET_BACK:] - centers[0], axis=1).argmin()) + _NOT_YET_BACK


def thousand_of(frames: int) -> int:
    """Frames in a thousand; less for short trials."""
    return min(1000, frames // 4)


def growth(ms: npt.NDArray[np.float64], thousand: int) -> str:
    """Mean of the second thousand frames, of the last, and how much more that is."""
    second, last = ms[thousand : 2 * thousand].mean(), ms[-thousand:].mean()
    return f"{second:.1f}, {last:.1f} ({last / second - 1:+.0%})"


def smooth(ms: npt.NDArray[np.float64], frames: int) -> npt.NDArray[np.float64]:
    """Each frame's mean over about so many around it: one reading alone is too short to be measured."""
    wanted = np.convolve(ms, np.ones(frames), "same")
    smoothed: npt.NDArray[np.float64] = wanted / np.convolve(np.ones(len(ms)), np.ones(frames), "same")
    return smoothed


def round_rows(seed: int, report: PassReport) -> Iterator[list[str]]:
    """A line of the second table for each round."""
    ends = [*report.part_starts[1:], report.frames]
    for number, (start, end) in enumerate(zip(report.part_starts, ends, strict=True), 1):
        keyframes, landmarks = report.sizes[end - 1]
        yield [
            f"{seed}, {number}",
            f"{report.cpu_ms[start:end].mean():.1f}",
            f"{report.cpu_ms[start:end].mean() / report.read_ms[start:end].mean():.2f}",
            str(keyframes),
            str(landmarks),
            f"{report.rss_mb[end - 1]:.0f} MB",
            str(int((report.states[start:end] != TRACKING).sum())),
        ]


def row(seed: int, report: PassReport) -> list[str]:
    """A seed's line of the table."""
    thousand = thousand_of(report.frames)
    kilometres = np.linalg.norm(np.diff(report.true_centers, axis=0), axis=1).cumsum() / 1000
    grown_mb = report.rss_mb[-1] - report.rss_mb[thousand]
    return [
        str(seed),
        f"{report.frames}, {kilometres[-1]:.1f} km",
        f"{report.coverage:.1%}",
        growth(report.cpu_ms, thousand),
        growth(report.cpu_ms / smooth(report.read_ms, report.part_starts[1]), thousand),
        growth(report.wall_ms, thousand),
        f"{report.rss_mb[thousand]:.0f}, {report.rss_mb[-1]:.0f} MB",
        f"{grown_mb / (kilometres[-1] - kilometres[thousand]):.1f}",
        f"{report.keyframes - report.culled} of {report.keyframes}",
        str(sum(report.landmarks.values())),
    ]


def main() -> None:
    """Drive round after round."""
    parser = parser_of(__doc__)
    add_drive_arguments(parser, "1")
    parser.add_argument("--frames", type=int, default=10_000)
    parser.add_argument("--stage", default="moving")
    given = parser.parse_args()
    groups = {}
    for seed in given.seeds:
        folder = simulated_drive("static", seed, given.drives)
        frames = round_of(SequencePart(folder))
        thousand = thousand_of(given.frames)
        # Made up to where the last thousand frames show the same places as the second thousand.
        total = given.frames + (2 * thousand - given.frames) % frames
        rounds = [SequencePart(folder, 0, frames)] * (total // frames)
        rounds.append(SequencePart(folder, 0, total % frames))
        groups[str(seed)] = [
            EnginePass(tuple(part for part in rounds if part.frames), given.stage, name=f"seed {seed}")
        ]
    reports = run_groups(groups, given.jobs)
    command = f"python -m tests.benchmark.slam.ten_thousand_frames --frames {given.frames}"
    tables = [
        markdown_table(HEADER, [row(int(seed), report) for seed, (report,) in reports.items()]),
        markdown_table(
            ROUND_HEADER, [line for seed, (report,) in reports.items() for line in round_rows(int(seed), report)]
        ),
    ]
    put("slam-ten-thousand-frames", command, "\n\n".join(tables))


if __name__ == "__main__":
    main()
