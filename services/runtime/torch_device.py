# SPDX-License-Identifier: Apache-2.0
"""The device that a network runs or learns on."""

import torch

from services.runtime.errors import InputError


def torch_device(name: str, option: str) -> torch.device:
    """The device of a name; `auto` is a CUDA device where there is one, else the processor.

    Args:
        name: as torch names devices, or `auto`.
        option: what the user set it by; errors begin with it.

    Raises:
        InputError: it is not to be had here.
    """
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    try:
        device = torch.device(name)
        torch.zeros(1, device=device)
    except (RuntimeError, AssertionError) as error:
        raise InputError(f"{option} {name}: not to be had ({str(error).splitlines()[0]})") from error
    return device
