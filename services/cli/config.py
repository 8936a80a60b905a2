# SPDX-License-Identifier: Apache-2.0
"""`kinemap config`: the configuration as it would be used, and where each value comes from."""

import os
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import tomli_w
import typer
from pydantic import BaseModel

from services.cli.flags import ConfigFlag, Overrides, SetFlag, parse_settings, resolve_config
from services.runtime.config import Config, dump_config

config_app = typer.Typer(help="The configuration.", no_args_is_help=True)


@config_app.callback()
def _config() -> None:
    """Keeps `dump` a command of its own, though it is the only one."""


@config_app.command()
def dump(config: ConfigFlag = None, settings: SetFlag = None) -> None:
    """Print the whole configuration as TOML, each value with what it means and where it comes from.

    The output is a configuration file: redirect it, edit it, and give it back with --config.
    """
    resolved = resolve_config(config, settings, {})
    file_values = tomllib.loads(config.read_text(encoding="utf-8")) if config is not None else {}
    for line in dump_lines(resolved, config, file_values, parse_settings(settings)):
        print(line)


def dump_lines(resolved: Config, file: Path | None, file_values: dict[str, Any], flags: Overrides) -> Iterator[str]:
    """The lines of the dump; a field without a value is a comment, since TOML has no word for nothing."""
    values = dump_config(resolved)
    for section in type(resolved).model_fields:
        fields: BaseModel = getattr(resolved, section)
        yield f"[{section}]"
        for field, info in type(fields).model_fields.items():
            origin = _origin(section, field, file, file_values, flags)
            comment = "; ".join(part for part in (info.description, origin) if part)
            yield f"# {comment}"
            if field in values[section]:
                yield tomli_w.dumps({field: values[section][field]}, multiline_strings=False).rstrip("\n")
            else:
                yield f"# {field} ="
        yield ""


def _origin(section: str, field: str, file: Path | None, file_values: dict[str, Any], flags: Overrides) -> str:
    variable = f"KINEMAP_{section}__{field}".upper()
    if field in flags.get(section, {}):
        return "from --set"
    if variable in {name.upper() for name in os.environ}:
        return f"from {variable}"
    if field in file_values.get(section, {}):
        return f"from {file}"
    return "default"
