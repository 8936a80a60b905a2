#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Install the pinned Python packages into the virtual environment $1: torch first and alone, so that nothing else
# decides which build of it comes.
set -euo pipefail
venv="$1"
root="$(cd "$(dirname "$0")/../.." && pwd)"
pip=("$venv/bin/pip" --disable-pip-version-check install -qq)
torch=2.13.0

if "$venv/bin/python" -c "import torch, sys; sys.exit(torch.__version__.split('+')[0] != '$torch')" 2>/dev/null; then
  echo "set-up: torch $torch is there"
elif command -v nvidia-smi >/dev/null; then
  echo "set-up: installing torch $torch with CUDA (there is an NVIDIA driver)"
  "${pip[@]}" "torch==$torch"
else
  echo "set-up: installing torch $torch, CPU build"
  # A mirror may hold the CPU build itself; else PyTorch's own index; else whatever the registry gives.
  "${pip[@]}" "torch==$torch+cpu" 2>/dev/null ||
    "${pip[@]}" --retries 1 "torch==$torch" --index-url https://download.pytorch.org/whl/cpu 2>/dev/null ||
    "${pip[@]}" "torch==$torch"
fi

echo "set-up: installing pinned Python packages"
# The list is complete, so nothing is resolved: trackeval would bring a second OpenCV that needs a display's libraries.
"${pip[@]}" --no-deps -r "$root/requirements.txt"
