# SPDX-License-Identifier: Apache-2.0
"""What this machine's processor can do."""

import platform
from functools import cache
from pathlib import Path

_DESCRIPTION = Path("/proc/cpuinfo")
_BFLOAT16_FLAGS = frozenset({"avx512_bf16", "amx_bf16", "bf16"})


@cache
def processor_name() -> str:
    """What the processor calls itself."""
    for line in _description():
        name, _, value = line.partition(":")
        if name.strip() == "model name":
            return value.strip()
    return platform.processor() or platform.machine()


@cache
def multiplies_bfloat16() -> bool:
    """Whether it multiplies numbers of 16 bits by itself; elsewhere they are slower than those of 32."""
    flags = {flag for line in _description() if line.lower().startswith(("flags", "features")) for flag in line.split()}
    return not flags.isdisjoint(_BFLOAT16_FLAGS)


def _description() -> list[str]:
    try:
        return _DESCRIPTION.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []
