# SPDX-License-Identifier: Apache-2.0
"""Messages to records and back: `encode(topic, record)` and `decode(topic, payload)`."""

from schemas.codec.registry import decode, encode

__all__ = ["decode", "encode"]
