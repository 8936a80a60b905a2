# SPDX-License-Identifier: Apache-2.0
"""Which runs a benchmark is made of: every input, in every variant, with every seed, as often as asked."""

import hashlib
import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from services.cli.flags import Overrides, merge_overrides, parse_settings
from services.runtime.config import Config, dump_config, load_config
from services.runtime.errors import InputError

SIMULATOR = "simulator"
STAGES = ("base", "dynamic", "moving")

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
# A comma separates settings only where another setting follows: a list has commas of its own.
_NEXT_SETTING = re.compile(r",(?=\s*\w+\.\w+\s*=)")


@dataclass(frozen=True)
class Variant:
    """A configuration under a name; the stages are the variants of a benchmark that names no others."""

    name: str
    overrides: Overrides


@dataclass(frozen=True)
class BenchRequest:
    """What a benchmark was asked for."""

    inputs: tuple[str, ...] = (SIMULATOR,)
    variants: tuple[Variant, ...] = ()
    seeds: tuple[int, ...] = ()
    repeat: int = 1
    frames: int | None = None
    config: Path | None = None
    settings: tuple[str, ...] = ()


@dataclass(frozen=True)
class PlannedRun:
    """One run to be: `folder` is relative to the benchmark's, `configuration` what `kinemap run --config` is given."""

    input: str
    variant: str
    trial: str
    folder: Path
    configuration: dict[str, Any]

    @property
    def name(self) -> str:
        """For people."""
        return f"{self.input} {self.variant} {self.trial}"

    @property
    def fingerprint(self) -> str:
        """SHA-256 of the configuration: equal where nothing that a run depends on was configured otherwise."""
        text = json.dumps(self.configuration, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def stage_variants(names: str) -> tuple[Variant, ...]:
    """Variants of a list such as `base,dynamic,moving`. Raises InputError for a stage that there is not."""
    stages = [name.strip() for name in names.split(",")]
    for stage in stages:
        if stage not in STAGES:
            raise InputError(f"--stages {names}: {stage!r} is no stage, expected some of {','.join(STAGES)}")
    return tuple(Variant(stage, {"slam": {"stage": stage}}) for stage in stages)


def parse_variant(text: str) -> Variant:
    """A variant of `NAME:section.field=value[,...]`. Raises InputError for one that is not of that form."""
    name, colon, settings = text.partition(":")
    if not colon or not _NAME.fullmatch(name):
        raise InputError(f"--variant {text}: expected NAME:SECTION.FIELD=VALUE[,SECTION.FIELD=VALUE]")
    try:
        return Variant(name, parse_settings(_NEXT_SETTING.split(settings)))
    except InputError as error:
        raise InputError(f"--variant {text}: {str(error).removeprefix('--set ')}") from None


def parse_seeds(text: str) -> tuple[int, ...]:
    """Seeds of a list such as `7,13,14`. Raises InputError for anything else."""
    words = [word.strip() for word in text.split(",")]
    if not all(word.isdecimal() for word in words) or len(set(map(int, words))) < len(words):
        raise InputError(f"--seeds {text}: expected different whole numbers such as 7,13,14")
    return tuple(map(int, words))


def plan_runs(request: BenchRequest) -> list[PlannedRun]:
    """Every run in the order to do them: those that are compared with each other one right after the other.

    A repeat adds one to the seeds of slam and motion: with equal seeds a lossless run gives equal bytes, and there
    would be nothing to repeat. Raises InputError where the request cannot be met.
    """
    names = [variant.name for variant in request.variants]
    if len(set(names)) < len(names):
        raise InputError(f"variants {','.join(names)}: expected different names")
    if request.seeds and SIMULATOR not in request.inputs:
        given = ",".join(map(str, request.seeds))
        raise InputError(f"--seeds {given}: of the simulator, which is no input here; expected --repeat for recordings")
    runs = []
    for name, given in _named(request.inputs).items():
        for trial, seed, repeat in _trials(request, given):
            for variant in request.variants:
                config = _resolve(request, variant, given, seed)
                config.slam.seed += repeat
                config.motion.seed += repeat
                folder = Path(name) / variant.name / trial
                runs.append(PlannedRun(name, variant.name, trial, folder, _configuration(config)))
    return runs


def _named(inputs: Sequence[str]) -> dict[str, str]:
    named: dict[str, str] = {}
    for given in inputs:
        parts = [given] if given == SIMULATOR else [part for part in Path(given).resolve().parts if part != "/"]
        # Two sequences may have one name in two data sets.
        choices = ("-".join(parts[-count:]) for count in range(1, len(parts) + 1))
        names = [re.sub(r"[^A-Za-z0-9._-]", "-", choice).lstrip(".-") for choice in choices]
        name = next((name for name in names if name and name not in named), None)
        if name is None or given in named.values():
            raise InputError(f"input {given}: given twice, expected each input once")
        named[name] = given
    return named


def _trials(request: BenchRequest, given: str) -> Iterator[tuple[str, int | None, int]]:
    """(name, seed of the simulator or None, number of the repeat from 0)."""
    seeds: tuple[int | None, ...] = request.seeds if given == SIMULATOR and request.seeds else (None,)
    for seed in seeds:
        for repeat in range(request.repeat):
            words = ([] if seed is None else [f"seed-{seed}"]) + (
                [f"repeat-{repeat + 1}"] if seed is None or request.repeat > 1 else []
            )
            yield "-".join(words), seed, repeat


def _resolve(request: BenchRequest, variant: Variant, given: str, seed: int | None) -> Config:
    overrides = merge_overrides(parse_settings(list(request.settings)), variant.overrides)
    own: Overrides = {"camera": {"input": given, "max_frames": request.frames}, "simulator": {"seed": seed}}
    config = load_config(request.config, merge_overrides(overrides, own))
    if config.camera.input != SIMULATOR:
        try:
            if Path(config.camera.input).exists():
                config.camera.input = str(Path(config.camera.input).resolve())
        except OSError as error:
            raise InputError(f"input {config.camera.input}: cannot be opened ({error.strerror})") from error
    return config


def _configuration(config: Config) -> dict[str, Any]:
    """What the run depends on: not where it writes, and of the bus only what was asked for."""
    configuration = dump_config(config)
    del configuration["run"]
    configuration["bus"] = config.bus.model_dump(mode="json", exclude_unset=True)
    configuration["mapstore"]["http_port"] = 0
    return configuration
