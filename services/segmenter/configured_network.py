# SPDX-License-Identifier: Apache-2.0
"""Backend `solov2` as it is configured: model, device, runtime, precision. It may be a Mask R-CNN, to compare."""

import time
from functools import partial

from services.runtime.config.segmenter import SegmenterConfig
from services.runtime.errors import InputError, ResourceError
from services.runtime.log import get_logger
from services.segmenter.backend import InstanceFilter
from services.segmenter.measured_ways import model_key
from services.segmenter.network_instances import NetworkInstances
from services.segmenter.processor import processor_name
from services.segmenter.weights.choice import choose_model

_log = get_logger("segmenter")


def configured_network(settings: SegmenterConfig, chosen: InstanceFilter) -> NetworkInstances:
    """The network that `kinemap doctor` names, ready to run.

    Raises:
        InputError: there is no such model, or it knows none of the categories.
        ResourceError: torch, or the runtime that is asked for, is not installed.
    """
    try:
        import torch
    except ImportError:
        raise ResourceError("segmenter.backend solov2 needs torch: pip install kinemap[segmenter]") from None
    from services.runtime.torch_device import torch_device
    from services.segmenter.agreement import LEAST_KEPT
    from services.segmenter.fastest import fastest
    from services.segmenter.network_runs import NetworkRuns
    from services.segmenter.runtimes.way import asked_ways, versions
    from services.segmenter.solov2.folding import folded
    from services.segmenter.weights.model_file import load_network

    torch.set_num_threads(settings.threads)
    model = choose_model(settings.weights)
    network, description = load_network(model.path)
    _require_known(settings.categories, description.categories, str(model.path))
    device, box = torch_device(settings.device, "segmenter.device"), description.input_box
    runs = NetworkRuns(folded(network), box, device, settings.threads)
    asked = {str(way): way for way in asked_ways(runs.ways, settings.runtime, settings.precision, device.type)}
    way = next(iter(asked))
    if len(asked) > 1:
        judged = {str(way): way for way in (runs.ways[0], *asked.values())}
        machine = torch.cuda.get_device_name(device) if device.type == "cuda" else processor_name()
        key = (
            f"{model_key(model.path)}{description.variant} {box[0]}x{box[1]}, {versions(judged.values())}, {machine}, "
            f"{settings.threads} threads, runtime {settings.runtime}, precision {settings.precision}"
        )
        makers = {name: partial(runs.inference, way, LEAST_KEPT) for name, way in judged.items()}
        way = fastest(key, makers, [*asked], time.perf_counter if device.type == "cuda" else time.process_time)
    _log.info(
        "network",
        file=model.path.name,
        why=model.why,
        variant=description.variant,
        device=str(device),
        way=way,
        threads=settings.threads,
    )
    return NetworkInstances(runs.inference(asked[way], settings.min_score), description.categories, chosen)


def _require_known(asked: tuple[str, ...], known: tuple[str, ...], model: str) -> None:
    unknown = [name for name in asked if name not in known]
    if len(unknown) == len(asked):
        raise InputError(f"segmenter.categories: {model} knows none of {', '.join(asked)}, only {', '.join(known)}")
    if unknown:
        _log.warning("categories_unknown", model=model, unknown=", ".join(unknown))
