# SPDX-License-Identifier: Apache-2.0
"""One input through the whole pipeline: start, watch, stop, and put together what came of it."""

import time
from dataclasses import dataclass
from typing import Protocol

from rich.console import Console

from services.cli.ports import gateway_url
from services.cli.progress_view import progress_view
from services.cli.run_progress import RunProgress
from services.cli.run_results import export_results, print_summary, report_results, saved_map_row
from services.cli.run_watch import WATCHED_TOPICS, RunWatch
from services.evaluation.run.outcome import Report, RunOutcome
from services.runtime.bus import Bus
from services.runtime.config import Config
from services.runtime.errors import KinemapError

_DRAIN_S = 0.05


class Services(Protocol):
    """The services of one run as processes; `services.cli.supervision` has the real ones."""

    def up(self) -> None:
        """Start all and return when they live. Raises KinemapError, naming who does not."""

    def down(self) -> None:
        """Let all finish what has arrived, and stop them; again does no harm."""

    def failure(self) -> KinemapError | None:
        """The error of a service that has given up for good, else None."""


class InterruptedRunError(KinemapError):
    """The user ended the run."""

    exit_code = 130


class IncompleteRunError(KinemapError):
    """The run ended by itself, and not every frame is accounted for."""


@dataclass
class PipelineRun:
    """Drives one run; `frames` is what the input's head tells of its length, -1 where it does not."""

    config: Config
    services: Services
    bus: Bus
    console: Console
    frames: int

    def __post_init__(self) -> None:
        self.progress = RunProgress(total=self.frames)
        self._began_s = time.time()
        self._subscription = self.bus.subscribe(WATCHED_TOPICS)
        self._watch = RunWatch(self._subscription, self.progress, self.services.failure, self.config.run.session)

    def drive(self, serve: bool) -> None:
        """Run the input through and write all results; with `serve`, keep the services up until Ctrl-C.

        Raises KinemapError with the reason when the input did not go through whole. What there is of results has been
        written and shown before.
        """
        started_s = time.monotonic()
        error = self._until_done()
        wall_s = time.monotonic() - started_s
        try:
            if not serve or error is not None:
                self._stop()
            report = self._results(error, wall_s)
            error = error or self._incomplete(report)
            if serve and error is None:
                self._serve()
        finally:
            self._stop()
        if error is not None:
            raise error

    def _until_done(self) -> KinemapError | None:
        try:
            with progress_view(self.console) as view:
                view.show(self.progress, time.monotonic())
                self.services.up()
                self._watch.until_done(view)
        except KeyboardInterrupt:
            return InterruptedRunError(f"stopped by the user after {self.progress.frames} frames")
        except KinemapError as error:
            return error
        return None

    def _stop(self) -> None:
        self.services.down()
        # The last heartbeats tell the final peak memory and times.
        while self._watch.step(_DRAIN_S):
            pass

    def _results(self, error: KinemapError | None, wall_s: float) -> Report | None:
        outcome = RunOutcome(
            session=self.config.run.session,
            failure="" if error is None else str(error),
            wall_s=wall_s,
            driven_s=self.progress.driven_s,
            every_frame=self.config.delivery.mode == "lossless",
        )
        folder = self.config.run.out
        try:
            export_results(self.config)
            report = report_results(self.config, outcome, self.progress.services, recover=error is not None)
        except KinemapError as result_error:
            if error is None:
                raise
            # What ended the run is what the user must hear; that its results are poor follows from it.
            self.console.print(f"no report: {result_error}", highlight=False, soft_wrap=True)
            return None
        if report is not None and report["frames"]["in"]:
            save_map = self.config.slam.save_map
            saved = [] if save_map is None else [saved_map_row(save_map, self._began_s)]
            print_summary(self.console, report, folder, *saved)
        return report

    def _incomplete(self, report: Report | None) -> KinemapError | None:
        if report is None:
            return IncompleteRunError(f"no recording in {self.config.run.out}, expected every frame in it")
        return IncompleteRunError(report["failure"]) if report["failure"] else None

    def _serve(self) -> None:
        self.console.print(f"serving {gateway_url(self.config)} until Ctrl-C", highlight=False, soft_wrap=True)
        try:
            while (error := self.services.failure()) is None:
                self._watch.step(1.0)
        except KeyboardInterrupt:
            return
        raise error
