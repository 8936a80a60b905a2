# SPDX-License-Identifier: Apache-2.0
"""The flow that the options name, ready to run."""

from pathlib import Path

from services.motion.flow.algorithm import FlowAlgorithm
from services.motion.flow.dis import Dis
from services.motion.flow.options import OpticalFlowOptions
from services.runtime.errors import InputError, ResourceError


def configured_algorithm(options: OpticalFlowOptions) -> FlowAlgorithm:
    """Make it.

    Raises:
        InputError: an unknown preset, weights that are not there or fit no network, no such device.
        ResourceError: torch is not installed.
    """
    if options.algorithm == "dis":
        return Dis(options.preset, options.finest_level)
    try:
        import torch
    except ImportError:
        raise ResourceError("motion.flow raft needs torch: pip install kinemap[segmenter]") from None
    from services.motion.flow.raft.checkpoint import read_raft
    from services.motion.flow.raft_algorithm import RaftAlgorithm
    from services.runtime.torch_device import torch_device

    path = _weights(options.weights)
    torch.set_num_threads(options.threads)
    return RaftAlgorithm(read_raft(path), torch_device(options.device, "motion.device"), options.iterations)


def _weights(asked: str | None) -> Path:
    from services.motion.flow.public_weights import PUBLIC_WEIGHTS, cached_weights
    from services.weights.cache_folder import cache_folder

    if asked is None:
        here = next((path for weights in PUBLIC_WEIGHTS if (path := weights.here()) is not None), None)
        if here is not None:
            return here
        raise InputError(
            f"motion.flow raft: no weights in {cache_folder()}, expected some: "
            f"`kinemap weights pull {PUBLIC_WEIGHTS[0].name}`, or motion.flow_weights"
        )
    path = cached_weights(asked) if asked in {weights.name for weights in PUBLIC_WEIGHTS} else Path(asked)
    if not path.is_file():
        names = ", ".join(weights.name for weights in PUBLIC_WEIGHTS)
        raise InputError(f"motion.flow_weights {asked}: no such file ({path}), expected a .pth file or one of {names}")
    return path
