# SPDX-License-Identifier: Apache-2.0
"""What this machine's processor can do."""

from functools import cache
from pathlib import Path

_DESCRIPTION = Path("/proc/cpuinfo")
_BFLOAT16_FLAGS = frozenset({"avx512_bf16", "amx_bf16", "bf16"})


@cache
def multiplies_bfloat16() -> bool:
    """Whether it multiplies numbers of 16 bits by itself; elsewhere they are slower than those of 32."""
    try:
        lines = _DESCRIPTION.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return False
    flags = {flag for line in lines if line.lower().startswith(("flags", "features")) for flag in line.split()}
    return not flags.isdisjoint(_BFLOAT16_FLAGS)
