# SPDX-License-Identifier: Apache-2.0
"""Flags that several commands take, and how they become the configuration."""

import tomllib
from pathlib import Path
from typing import Annotated, Any

import typer

from services.runtime.config import Config, load_config
from services.runtime.errors import InputError

ConfigFlag = Annotated[
    Path | None, typer.Option("--config", "-c", help="TOML file over the defaults (see: kinemap config dump).")
]
SetFlag = Annotated[
    list[str] | None,
    typer.Option("--set", "-s", metavar="SECTION.FIELD=VALUE", help="One value over file and environment; repeatable."),
]
OutFlag = Annotated[
    Path | None, typer.Option("--out", "-o", help="Folder for everything the run writes (default: runs/<time>).")
]
InputArgument = Annotated[
    str | None,
    typer.Argument(
        metavar="INPUT",
        # A blank line begins a new line of the help.
        help="folder: KITTI (odometry, raw drive, tracking sequence), TUM RGB-D, EuRoC, or images with a "
        "calibration.toml\n\n"
        "file: a video, a ROS 1 bag (.bag), a ROS 2 bag (its folder, or .db3), MCAP (a session of kinemap's, images of "
        "ROS 2 or Foxglove)\n\n"
        "live camera: 0, /dev/video0, rtsp://..., http://...\n\n"
        "'simulator': the default",
    ),
]
StageFlag = Annotated[
    str | None,
    typer.Option("--stage", help="What stays out of tracking: base (nothing), dynamic (all that may move), moving."),
]
PortFlag = Annotated[int | None, typer.Option("--port", help="Port of the HTTP gateway (default: 8000).")]

Overrides = dict[str, dict[str, Any]]


def parse_settings(settings: list[str] | None) -> Overrides:
    """`section.field=value` strings as nested values; a value is read as TOML, else as plain text.

    Raises InputError for one that is not of that form.
    """
    overrides: Overrides = {}
    for setting in settings or []:
        place, equals, text = setting.partition("=")
        section, dot, field = place.strip().partition(".")
        if not (equals and dot and section and field) or "." in field:
            raise InputError(f"--set {setting}: expected SECTION.FIELD=VALUE, such as slam.stage=moving")
        overrides.setdefault(section, {})[field] = _value(text.strip())
    return overrides


def resolve_config(file: Path | None, settings: list[str] | None, flags: Overrides) -> Config:
    """The configuration that a command runs with: defaults < file < environment < --set < the command's own flags.

    Flags that were not given (None) leave what the others say. Raises InputError naming the field and the value.
    """
    return load_config(file, merge_overrides(parse_settings(settings), flags))


def merge_overrides(base: Overrides, over: Overrides) -> Overrides:
    """Both, with `over` winning; None in `over` means not given."""
    merged = {section: dict(fields) for section, fields in base.items()}
    for section, fields in over.items():
        given = {field: value for field, value in fields.items() if value is not None}
        if given:
            merged.setdefault(section, {}).update(given)
    return merged


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
