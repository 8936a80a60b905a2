# SPDX-License-Identifier: Apache-2.0
"""Reads the configuration: defaults, then a TOML file, then KINEMAP_<SECTION>__<FIELD>, then flags."""

import tomllib
from pathlib import Path
from typing import Any

from pydantic import BaseModel, Field, ValidationError
from pydantic_settings import BaseSettings, PydanticBaseSettingsSource, SettingsConfigDict

from services.runtime.config.bus import BusConfig
from services.runtime.config.camera import CameraConfig
from services.runtime.config.delivery import DeliveryConfig
from services.runtime.config.log import LogConfig
from services.runtime.config.mapstore import MapstoreConfig
from services.runtime.config.motion import MotionConfig
from services.runtime.config.recorder import RecorderConfig
from services.runtime.config.run import RunConfig
from services.runtime.config.segmenter import SegmenterConfig
from services.runtime.config.simulator import SimulatorConfig
from services.runtime.config.slam import SlamConfig
from services.runtime.config.tracker import TrackerConfig
from services.runtime.errors import InputError


class _FileSource(PydanticBaseSettingsSource):
    """The values of a TOML file, already read."""

    def __init__(self, settings: type[BaseSettings], values: dict[str, Any]) -> None:
        super().__init__(settings)
        self._values = values

    def get_field_value(self, field: Any, field_name: str) -> tuple[Any, str, bool]:
        return self._values.get(field_name), field_name, False

    def __call__(self) -> dict[str, Any]:
        return self._values


class Config(BaseSettings):
    """All of kinemap's configuration, one section a service."""

    model_config = SettingsConfigDict(env_prefix="KINEMAP_", env_nested_delimiter="__", extra="forbid")

    run: RunConfig = Field(default_factory=RunConfig)
    bus: BusConfig = Field(default_factory=BusConfig)
    delivery: DeliveryConfig = Field(default_factory=DeliveryConfig)
    log: LogConfig = Field(default_factory=LogConfig)
    camera: CameraConfig = Field(default_factory=CameraConfig)
    simulator: SimulatorConfig = Field(default_factory=SimulatorConfig)
    segmenter: SegmenterConfig = Field(default_factory=SegmenterConfig)
    motion: MotionConfig = Field(default_factory=MotionConfig)
    tracker: TrackerConfig = Field(default_factory=TrackerConfig)
    slam: SlamConfig = Field(default_factory=SlamConfig)
    mapstore: MapstoreConfig = Field(default_factory=MapstoreConfig)
    recorder: RecorderConfig = Field(default_factory=RecorderConfig)


def load_config(file: Path | None = None, overrides: dict[str, Any] | None = None) -> Config:
    """The configuration of `file` (TOML), the environment and `overrides` (nested by section).

    Raises InputError, naming the field, its value and what was expected.
    """
    values = _read_toml(file) if file is not None else {}

    class Loaded(Config):
        @classmethod
        def settings_customise_sources(
            cls,
            settings_cls: type[BaseSettings],
            init_settings: PydanticBaseSettingsSource,
            env_settings: PydanticBaseSettingsSource,
            dotenv_settings: PydanticBaseSettingsSource,
            file_secret_settings: PydanticBaseSettingsSource,
        ) -> tuple[PydanticBaseSettingsSource, ...]:
            return init_settings, env_settings, _FileSource(settings_cls, values)

    try:
        return Loaded(**(overrides or {}))
    except ValidationError as error:
        raise InputError(_one_line(error)) from error


def dump_config(config: BaseModel) -> dict[str, Any]:
    """The configuration as TOML can hold it: nested tables of plain values, without what is None."""
    dumped: dict[str, Any] = config.model_dump(mode="json", exclude_none=True)
    return dumped


def _read_toml(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"configuration {file} cannot be read: {error.strerror}; expected a TOML file") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"configuration {file} is no TOML: {error}") from error


def _one_line(error: ValidationError) -> str:
    parts = []
    for problem in error.errors():
        place = ".".join(str(part) for part in problem["loc"])
        # What a section's own check says already names its fields.
        if problem["type"] == "value_error" and isinstance(problem["input"], dict):
            parts.append(f"{place}: {problem['ctx']['error']}")
            continue
        parts.append(f"{place} = {problem['input']!r}: {problem['msg'][:1].lower()}{problem['msg'][1:]}")
    return "configuration: " + "; ".join(parts)
