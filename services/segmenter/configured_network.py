# SPDX-License-Identifier: Apache-2.0
"""Backend `solov2` as it is configured: model, device, precision."""

from typing import TYPE_CHECKING

from services.runtime.config.segmenter import SegmenterConfig
from services.runtime.errors import InputError, ResourceError
from services.runtime.log import get_logger
from services.segmenter.backend import InstanceFilter
from services.segmenter.network_instances import NetworkInstances
from services.segmenter.weights.choice import choose_model

if TYPE_CHECKING:
    import torch

_log = get_logger("segmenter")


def configured_network(settings: SegmenterConfig, chosen: InstanceFilter) -> NetworkInstances:
    """The network that `kinemap doctor` names, ready to run.

    Raises:
        InputError: there is no such model, or it knows none of the categories.
        ResourceError: torch is not installed.
    """
    try:
        import torch
    except ImportError:
        raise ResourceError("segmenter.backend solov2 needs torch: pip install kinemap[segmenter]") from None
    from services.segmenter.inference import TorchInference, TorchOptions, fastest_precision
    from services.segmenter.solov2.instances import InstanceOptions
    from services.segmenter.weights.model_file import load_network

    torch.set_num_threads(settings.threads)
    model = choose_model(settings.weights)
    network, description = load_network(model.path)
    _require_known(settings.categories, description.categories, str(model.path))
    device = _device(settings.device)
    precision = fastest_precision(device) if settings.precision == "auto" else settings.precision
    _log.info(
        "network",
        file=model.path.name,
        why=model.why,
        variant=description.variant,
        device=str(device),
        precision=precision,
        threads=settings.threads,
    )
    options = InstanceOptions(min_score=settings.min_score)
    inference = TorchInference(network, description.input_box, options, TorchOptions(device, precision))
    return NetworkInstances(inference, description.categories, chosen)


def _device(name: str) -> "torch.device":
    import torch

    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    try:
        device = torch.device(name)
        torch.zeros(1, device=device)
    except (RuntimeError, AssertionError) as error:
        raise InputError(f"segmenter.device {name}: not to be had ({str(error).splitlines()[0]})") from error
    return device


def _require_known(asked: tuple[str, ...], known: tuple[str, ...], model: str) -> None:
    unknown = [name for name in asked if name not in known]
    if len(unknown) == len(asked):
        raise InputError(f"segmenter.categories: {model} knows none of {', '.join(asked)}, only {', '.join(known)}")
    if unknown:
        _log.warning("categories_unknown", model=model, unknown=", ".join(unknown))
