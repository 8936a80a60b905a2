# SPDX-License-Identifier: Apache-2.0
"""The way to deliver that the configuration asks for."""

from schemas import topics
from services.camera.delivery import Delivery, Outlet
from services.camera.lossless import LosslessDelivery
from services.camera.pacing import AsTheyCome, Pacing
from services.camera.position import PositionFile
from services.camera.realtime import RealtimeDelivery
from services.camera.sources.live.live_address import is_live, without_credentials
from services.runtime.config import Config
from services.runtime.errors import InputError
from services.runtime.frame_window import FrameWindow


def configured_delivery(config: Config, first: int, position_file: PositionFile, outlet: Outlet) -> Delivery:
    """The delivery of the frames from `first` on."""
    settings, services = config.delivery, topics.ANSWERING_SERVICES
    if settings.mode == "lossless":
        window = FrameWindow(settings.window, services, settings.resend_after_s, first)
        return LosslessDelivery(window, position_file, outlet)
    pacing = AsTheyCome() if is_live(config.camera.input) else Pacing()
    return RealtimeDelivery(FrameWindow(1, services, settings.resend_after_s), position_file, outlet, pacing)


def require_realtime(config: Config) -> None:
    """Raises InputError when a live camera, which cannot repeat a frame, is to be delivered `lossless`."""
    if is_live(config.camera.input) and config.delivery.mode != "realtime":
        given = without_credentials(config.camera.input)
        raise InputError(f"input {given}: a live camera cannot repeat a frame, expected delivery.mode = realtime")
