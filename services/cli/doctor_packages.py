# SPDX-License-Identifier: Apache-2.0
"""What kinemap needs installed: Debian's packages and Python's, by what the project itself declares."""

import importlib.metadata
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from packaging.requirements import Requirement

_DEBIAN_PACKAGES = Path(__file__).resolve().parents[2] / "deploy" / "setup" / "debian-packages.txt"

_NOT_NEEDED = ("dev", "cpu")
"""extras that everything runs without"""


@dataclass(frozen=True)
class Check:
    """One line of the doctor. `ok` None: neither good nor bad, only worth knowing."""

    name: str
    ok: bool | None
    found: str
    remedy: str = ""


def check_debian_packages() -> Iterator[Check]:
    """Each that the set-up installs, by dpkg; one note where there is no list (an installed wheel) or no dpkg."""
    if not _DEBIAN_PACKAGES.is_file():
        yield Check("Debian packages", None, "not checked: this is no source tree, whose list the set-up goes by")
        return
    rows = [line.partition("#")[0].strip() for line in _DEBIAN_PACKAGES.read_text(encoding="utf-8").splitlines()]
    names = [name for name in rows if name]
    if shutil.which("dpkg-query") is None:
        yield Check("Debian packages", None, f"no dpkg here; this system's own packages of {' '.join(names)}")
        return
    installed = _installed_packages(names)
    for name in names:
        found = installed.get(name) or installed.get(f"{name}t64")
        yield Check(f"Debian {name}", found is not None, found or "not installed", f"sudo apt-get install {name}")


def _installed_packages(names: list[str]) -> dict[str, str]:
    # Ubuntu names some libraries with a t64 suffix since its 64-bit time change.
    command = ["dpkg-query", "--show", "--showformat=${binary:Package} ${db:Status-Status} ${Version}\\n"]
    asked = subprocess.run(
        [*command, *names, *(f"{name}t64" for name in names)], capture_output=True, text=True, check=False
    )
    rows = [line.split() for line in asked.stdout.splitlines()]
    return {row[0].partition(":")[0]: row[2] for row in rows if len(row) == 3 and row[1] == "installed"}


def check_python_packages() -> Iterator[Check]:
    """Every requirement of kinemap's own metadata, all its extras but `dev` and `cpu` included."""
    try:
        declared = [Requirement(text) for text in importlib.metadata.requires("kinemap") or []]
    except importlib.metadata.PackageNotFoundError:
        yield Check("Python package kinemap", False, "not installed", "make setup")
        return
    wrong = []
    needed: dict[str, Requirement] = {}
    for requirement in declared:
        extra = str(requirement.marker).rpartition("==")[2].strip(' "')
        if requirement.name != "kinemap" and extra not in _NOT_NEEDED:
            needed[requirement.name] = requirement
    for name, requirement in sorted(needed.items()):
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            wrong.append(
                Check(f"Python {name}", False, "not installed", f"pip install '{name}{requirement.specifier}'")
            )
            continue
        if not requirement.specifier.contains(version, prereleases=True):
            remedy = f"pip install '{name}{requirement.specifier}'"
            wrong.append(Check(f"Python {name}", False, f"{version}, expected {requirement.specifier}", remedy))
    yield from wrong
    if not wrong:
        yield Check("Python packages", True, f"all {len(needed)} that kinemap declares")
