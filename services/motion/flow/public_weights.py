# SPDX-License-Identifier: Apache-2.0
"""The public weights of RAFT that can be pulled by name: torchvision's (BSD 3-clause)."""

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from services.runtime.errors import ResourceError
from services.weights.cache_folder import cache_folder
from services.weights.checksum import require_sha256_prefix
from services.weights.download import Progress, download

_PUBLISHER: Final = "https://download.pytorch.org/models"


@dataclass(frozen=True)
class PublicFlowWeights:
    """A file of torchvision's."""

    name: str
    file_name: str
    trained_on: str

    @property
    def url(self) -> str:
        """Where it is downloaded from."""
        return f"{_PUBLISHER}/{self.file_name}"

    def here(self) -> Path | None:
        """Where they lie, if they were pulled."""
        path = cached_weights(self.name)
        return path if path.is_file() else None

    def pull(self, progress: Progress | None = None) -> Path:
        """Download and check them; the path of what is in the cache then. Raises as download."""
        path = cached_weights(self.name)
        download(self.url, path, self._sha256_prefix, progress)
        return path

    def take(self, path: Path) -> Path:
        """Check a file that was got elsewhere and copy it into the cache; its path there.

        Raises:
            InputError: it is damaged, cut off or another one.
            ResourceError: the cache cannot be written.
        """
        require_sha256_prefix(path, self._sha256_prefix)
        target = cached_weights(self.name)
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)
        except OSError as error:
            raise ResourceError(f"{target}: cannot be written ({error.strerror})") from error
        return target

    @property
    def _sha256_prefix(self) -> str:
        """The first eight hex digits, which the publisher writes into the name."""
        return Path(self.file_name).stem.rpartition("-")[2]


PUBLIC_WEIGHTS: Final = (
    PublicFlowWeights("raft_small", "raft_small_C_T_V2-01064c6d.pth", "FlyingChairs, FlyingThings3D"),
    PublicFlowWeights("raft_large", "raft_large_C_T_SKHT_V2-ff5fadd5.pth", "and Sintel, KITTI, HD1K"),
    PublicFlowWeights("raft_large_kitti", "raft_large_C_T_SKHT_K_V2-b5c70766.pth", "and once more KITTI"),
)
"""The fastest first."""


def cached_weights(name: str) -> Path:
    """Where those of this name lie once they are pulled."""
    return cache_folder() / f"{name}.pth"
