# SPDX-License-Identifier: Apache-2.0
"""A folder of images of one's own camera, with a calibration file beside them."""

from pathlib import Path

from schemas.records import Image
from services.camera.sources.calibration_file import CALIBRATION_NAMES, find_calibration, read_calibration
from services.camera.sources.image_files import ImageFiles
from services.camera.sources.number_rows import even_times_ns, rate_of, read_times_ns
from services.camera.sources.source import SourceFrame

ASSUMED_RATE_HZ = 10.0
_IMAGES = "images"


class ImageFolder:
    """Images (or a subfolder `images` of them) in the order of their names, calibration.toml or calib.txt, times.txt.

    Args:
        folder: the folder with the images, or the one above `images`.
        calibration: the calibration file; None looks for it in the folder.
        rate_hz: images a second where there is no times.txt; None takes the calibration file's, or 10.

    Raises:
        InputError: whatever of the folder cannot be used, by file.
    """

    def __init__(self, folder: Path, *, calibration: Path | None = None, rate_hz: float | None = None) -> None:
        images = folder / _IMAGES if (folder / _IMAGES).is_dir() else folder
        self._images = ImageFiles(images)
        model = read_calibration(find_calibration(calibration, *(folder / name for name in CALIBRATION_NAMES)))
        self._camera = model.for_images(self._images.size, self._images.paths[0])
        self._notes: tuple[str, ...] = ()
        rate_hz = rate_hz or model.rate_hz
        if (folder / "times.txt").is_file():
            self._times_ns = read_times_ns(folder / "times.txt", len(self._images))
            self._rate_hz = rate_of(self._times_ns, rate_hz or ASSUMED_RATE_HZ)
        else:
            self._rate_hz = rate_hz or ASSUMED_RATE_HZ
            self._times_ns = even_times_ns(len(self._images), self._rate_hz)
            if rate_hz is None:
                self._notes = (f"no times.txt in {folder.name}: times are assumed at {ASSUMED_RATE_HZ:g} Hz",)
        self._name = f"images of {folder.resolve().name}"

    @property
    def name(self) -> str:
        return self._name

    @property
    def frame_count(self) -> int:
        return len(self._images)

    @property
    def rate_hz(self) -> float:
        return self._rate_hz

    @property
    def notes(self) -> tuple[str, ...]:
        return self._notes

    def frame(self, index: int) -> SourceFrame | None:
        if index >= len(self._images):
            return None
        time_ns = self._times_ns[index]
        return SourceFrame(
            self._images.name(index), time_ns, Image(time_ns, self._images.read(index)), self._camera.record(time_ns)
        )

    def close(self) -> None:
        """Nothing is held open."""
