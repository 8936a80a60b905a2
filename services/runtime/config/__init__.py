# SPDX-License-Identifier: Apache-2.0
"""The typed configuration, one file a section."""

from services.runtime.config.load import Config, dump_config, load_config

__all__ = ["Config", "dump_config", "load_config"]
