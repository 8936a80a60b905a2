# SPDX-License-Identifier: Apache-2.0
"""Backend `solov2` as it is configured: model, device, precision. The model may be a Mask R-CNN, to compare with."""

from typing import TYPE_CHECKING

from services.runtime.config.segmenter import SegmenterConfig
from services.runtime.errors import InputError, ResourceError
from services.runtime.log import get_logger
from services.segmenter.backend import InstanceFilter
from services.segmenter.network_instances import Inference, NetworkInstances
from services.segmenter.weights.choice import choose_model

if TYPE_CHECKING:
    from services.segmenter.inference import TorchOptions
    from services.segmenter.networks import Network

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
    from services.segmenter.fastest import fastest
    from services.segmenter.inference import TorchOptions, precisions
    from services.segmenter.processor import processor_name
    from services.segmenter.solov2.folding import folded
    from services.segmenter.torch_device import torch_device
    from services.segmenter.weights.model_file import load_network

    torch.set_num_threads(settings.threads)
    model = choose_model(settings.weights)
    network, description = load_network(model.path)
    _require_known(settings.categories, description.categories, str(model.path))
    device = torch_device(settings.device, "segmenter.device")
    ready, box = folded(network), description.input_box
    asked = precisions(device) if settings.precision == "auto" else (settings.precision,)
    ways: dict[str, Inference] = {
        name: inference_of(ready, box, settings.min_score, TorchOptions(device, name)) for name in asked
    }
    machine = torch.cuda.get_device_name(device) if device.type == "cuda" else processor_name()
    key = f"{description.variant} {box[0]}x{box[1]}, torch {torch.__version__}, {machine}, {settings.threads} threads"
    precision = fastest(key, ways, box) if len(ways) > 1 else next(iter(ways))
    _log.info(
        "network",
        file=model.path.name,
        why=model.why,
        variant=description.variant,
        device=str(device),
        precision=precision,
        threads=settings.threads,
    )
    return NetworkInstances(ways[precision], description.categories, chosen)


def inference_of(network: "Network", box: tuple[int, int], min_score: float, runtime: "TorchOptions") -> Inference:
    """What runs a network; instances below `min_score` are left out."""
    from services.segmenter.inference import TorchInference
    from services.segmenter.mask_rcnn.inference import MaskRcnnInference
    from services.segmenter.mask_rcnn.network import DetectionOptions, MaskRcnn
    from services.segmenter.solov2.instances import InstanceOptions

    if isinstance(network, MaskRcnn):
        return MaskRcnnInference(network, box, DetectionOptions(min_score=min_score), runtime)
    return TorchInference(network, box, InstanceOptions(min_score=min_score), runtime)


def _require_known(asked: tuple[str, ...], known: tuple[str, ...], model: str) -> None:
    unknown = [name for name in asked if name not in known]
    if len(unknown) == len(asked):
        raise InputError(f"segmenter.categories: {model} knows none of {', '.join(asked)}, only {', '.join(known)}")
    if unknown:
        _log.warning("categories_unknown", model=model, unknown=", ".join(unknown))
