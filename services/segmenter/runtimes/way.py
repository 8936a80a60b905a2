# SPDX-License-Identifier: Apache-2.0
"""The ways there are to run a network, by library and precision, and which of them a machine has."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Final, Literal

from services.runtime.errors import InputError, ResourceError
from services.segmenter.processor import multiplies_bfloat16

Precision = Literal["fp32", "bf16", "fp16"]
Runtime = Literal["torch", "openvino", "onnxruntime"]

_EXPORTER: Final = "onnx"
_ON_PROCESSORS: Final[tuple[Runtime, ...]] = ("openvino", "onnxruntime")


@dataclass(frozen=True)
class Way:
    """One way to run a network."""

    runtime: Runtime
    precision: Precision

    def __str__(self) -> str:
        return f"{self.runtime} {self.precision}"


def precisions(device: str, runtime: Runtime = "torch") -> tuple[Precision, ...]:
    """What a library can compute in on a device (`cpu` or `cuda`), the exact one first."""
    if device == "cuda":
        return ("fp32", "fp16")
    # ONNX Runtime has no kernels for convolutions of 16 bits on a processor
    return ("fp32", "bf16") if multiplies_bfloat16() and runtime != "onnxruntime" else ("fp32",)


def ways_here(device: str) -> tuple[Way, ...]:
    """Every way of running SOLOv2 that this machine has the libraries for, exact torch first, 16 bits last."""
    runtimes: tuple[Runtime, ...] = ("torch", *(installed() if device == "cpu" else ()))
    ways = (Way(runtime, precision) for runtime in runtimes for precision in precisions(device, runtime))
    return tuple(sorted(ways, key=lambda way: way.precision != "fp32"))


def asked_ways(
    here: tuple[Way, ...], runtime: Runtime | Literal["auto"], precision: Precision | Literal["auto"], device: str
) -> tuple[Way, ...]:
    """Those of the ways `here` that are asked for; at least one, as torch takes any precision.

    Raises:
        InputError: a library that is asked for does not run on this device, or not in this precision.
        ResourceError: it is not installed.
    """
    if runtime != "auto" and runtime != "torch":  # noqa: PLR1714 (mypy narrows by these)
        if device != "cpu":
            raise InputError(f"segmenter.runtime {runtime}: runs on processors only, expected segmenter.device cpu")
        if not any(way.runtime == runtime for way in here):
            raise ResourceError(f"segmenter.runtime {runtime}: not installed; expected pip install {runtime} onnx")
        possible = precisions(device, runtime)
        if precision not in ("auto", *possible):
            raise InputError(f"segmenter.precision {precision}: {runtime} has {', '.join(possible)} on this processor")
    found = tuple(way for way in here if runtime in ("auto", way.runtime) and precision in ("auto", way.precision))
    return found or (Way("torch", "fp32" if precision == "auto" else precision),)


def versions(ways: Iterable[Way]) -> str:
    """Of the libraries of these ways: what they compute and how fast may change with them."""
    return ", ".join(f"{name} {version(name)}" for name in dict.fromkeys(way.runtime for way in ways))


def installed() -> Iterator[Runtime]:
    """Libraries besides torch, where there is what gets a network into them."""
    if _has(_EXPORTER):
        yield from (name for name in _ON_PROCESSORS if _has(name))


def _has(package: str) -> bool:
    try:
        version(package)
    except PackageNotFoundError:
        return False
    return True
