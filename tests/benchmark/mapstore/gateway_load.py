# SPDX-License-Identifier: Apache-2.0
"""Ask a running gateway at a steady rate and say how long it took, and how much of a core it cost the mapstore.

python -m tests.benchmark.mapstore.gateway_load [--url http://127.0.0.1:8000] [--rate 50] [--seconds 20] [--pid PID]
"""

import argparse
import http.client
import time
from urllib.parse import urlsplit

import numpy as np
import psutil

PATH = "/density?pose=current"


def ask_steadily(url: str, rate: float, seconds: float, keep_alive: bool) -> tuple[list[float], int]:
    """Milliseconds of every answer, counted from when its request was due, and how many were not 200.

    Ends early when the gateway is gone: the run is over, and what it broke off as it closed is not counted.
    """
    address = urlsplit(url).netloc
    connection = http.client.HTTPConnection(address, timeout=10)
    durations: list[float] = []
    failed, broken_off = 0, False
    started = time.perf_counter()
    for number in range(round(rate * seconds)):
        due = started + number / rate
        time.sleep(max(0.0, due - time.perf_counter()))
        try:
            connection.request("GET", PATH)
            answer = connection.getresponse()
            answer.read()
            broken_off = False
            failed += answer.status != 200
        except ConnectionRefusedError:
            return durations, failed - broken_off
        except OSError:
            failed, broken_off = failed + 1, True
            connection.close()
        durations.append((time.perf_counter() - due) * 1e3)
        if not keep_alive:
            connection.close()
    connection.close()
    return durations, failed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--url", default="http://127.0.0.1:8000")
    parser.add_argument("--rate", type=float, default=50.0)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--pid", type=int, help="the mapstore's process, to say what it cost")
    parser.add_argument("--new-connections", action="store_true", help="one connection a request")
    arguments = parser.parse_args()
    process = psutil.Process(arguments.pid) if arguments.pid else None
    before, started = (process.cpu_times() if process else None), time.perf_counter()
    durations, failed = ask_steadily(arguments.url, arguments.rate, arguments.seconds, not arguments.new_connections)
    p50, p95, p99 = np.percentile(durations, (50, 95, 99))
    print(f"{len(durations)} requests, {failed} failed, p50 {p50:.1f} ms, p95 {p95:.1f} ms, p99 {p99:.1f} ms")
    if process and before and process.is_running():
        after = process.cpu_times()
        busy_s = after.user + after.system - before.user - before.system
        print(f"mapstore process: {100 * busy_s / (time.perf_counter() - started):.1f} % of a core")


if __name__ == "__main__":
    main()
