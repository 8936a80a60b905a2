# SPDX-License-Identifier: Apache-2.0
"""Generate the Python of schemas/proto from its .proto files: `python -m schemas.generate`.

The generated files are committed, so that nobody needs protoc to install; a test holds them against the sources.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def generate(out: Path = ROOT) -> None:
    """Write `*_pb2.py` and `*_pb2.pyi` for every schema under `out`/schemas/proto/kinemap."""
    import grpc_tools
    from grpc_tools import protoc

    well_known = Path(grpc_tools.__file__).parent / "_proto"
    sources = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "schemas/proto").rglob("*.proto"))
    arguments = ["protoc", f"-I{ROOT}", f"-I{well_known}", f"--python_out={out}", f"--pyi_out={out}", *sources]
    if protoc.main(arguments) != 0:
        sys.exit("protoc failed; its message is above")


if __name__ == "__main__":
    generate()
