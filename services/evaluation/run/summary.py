# SPDX-License-Identifier: Apache-2.0
"""A report in a few lines, for people."""

from services.evaluation.run.outcome import Report

_MEBIBYTE = 1024 * 1024


def summary_rows(report: Report) -> list[tuple[str, str]]:
    """(what, value) pairs, in the order to show them; what a run does not have is left out."""
    frames = report["frames"]
    rows = [("input", f"{report['input']}  (stage {report['stage'] or 'unknown'})")]
    rows.append(
        (
            "frames",
            f"{frames['in']} of {frames['expected']} in, {frames['tracked']} tracked, {frames['lost']} lost,"
            f" {frames['initializing']} initializing",
        )
    )
    if frames["initialized_at"] is not None:
        since = f"{frames['tracked_after_initialization']:.1%} tracked since"
        rows.append(("initialized", f"at frame {frames['initialized_at']}, {since}"))
    rows.extend(_error_rows(report))
    landmarks = ", ".join(f"{count} {label}" for label, count in report["landmarks"].items() if count)
    rows.append(("map", f"{report['keyframes']} keyframes, landmarks: {landmarks or 'none'} (scale {report['scale']})"))
    density = ", ".join(f"{level} {count}" for level, count in report["density_frames"].items())
    rows.append(("density", f"{density} (frames)"))
    flag = report["moving_flag"]
    if flag is not None:
        rows.append(
            (
                "moving flag",
                f"precision {_share(flag['precision'])}, recall {_share(flag['recall'])}, F1 {_share(flag['f1'])}"
                f" over {flag['frames']} frames",
            )
        )
    for stage, times in report["stage_ms"].items():
        if "/" not in stage or stage.endswith("/total"):
            rows.append((f"{stage}", f"{times['p50']:.1f} ms median, {times['p95']:.1f} ms p95"))
    if report["services"]:
        peak = {name: usage["peak_memory_bytes"] / _MEBIBYTE for name, usage in report["services"].items()}
        rows.append(("peak memory", ", ".join(f"{name} {size:.0f}" for name, size in peak.items()) + " MiB"))
    if report["wall_s"] and report["frames_per_s"]:
        rows.append(("time", f"{report['wall_s']:.1f} s, {report['frames_per_s']:.1f} frames/s once it ran"))
    return rows


def _error_rows(report: Report) -> list[tuple[str, str]]:
    rows = []
    for name, error in (report["ate"] or {}).items():
        if "none_because" in error:
            rows.append((f"ATE {name}", f"none: {error['none_because']}"))
            continue
        ate = error["ate_m"]
        # The best scale of a metric map's trajectory says how far its metres are off.
        scale = report["ate"].get(name.removesuffix("_metric"), {}).get("scale") if name.endswith("_metric") else None
        rows.append(
            (
                f"ATE {name}",
                f"RMSE {ate['rmse']:.3f} m, mean {ate['mean']:.3f}, median {ate['median']:.3f}, max {ate['max']:.3f}"
                f" ({error['alignment']}, {error['poses']} of {error['frames']} frames = {error['coverage']:.1%})"
                + ("" if scale is None else f", scale {abs(scale - 1):.2%} off"),
            )
        )
    return rows


def _share(value: float | None) -> str:
    return "undefined" if value is None else f"{value:.3f}"
