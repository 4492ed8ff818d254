"""Figures of results, with matplotlib; nothing is calculated here."""

from __future__ import annotations

from typing import Any

from ._errors import InputError

_LABELS = {"current": ("current_a", "current (A)"), "curvature": ("curvature_per_cm", "curvature (1/cm)")}


def plot_fit(fit: Any, axes: Any = None) -> Any:
    """Readings and fitted curve of each response, and below them the residuals in standard deviations of the noise."""
    shown = {name: curve for name in _LABELS if (curve := getattr(fit, name)) is not None}
    if not shown:
        raise InputError("the fit has no curve", fit.run, "fit a run with a current or a curvature")
    if axes is None:
        import matplotlib.pyplot as pyplot

        sizes = {"figsize": (5.5 * len(shown), 5.0), "gridspec_kw": {"height_ratios": (3, 1)}}
        _, axes = pyplot.subplots(2, len(shown), sharex="col", squeeze=False, layout="constrained", **sizes)
    for column, (name, curve) in enumerate(shown.items()):
        key, label = _LABELS[name]
        above, below = axes[0][column], axes[1][column]
        time_s = curve.column("time_s")
        above.plot(time_s, curve.column(key), ".", markersize=3, color="0.55", label="readings")
        above.set_ylabel(label)
        below.set_xlabel("time (s)")
        below.set_ylabel("residual (sigma)")
        if "fitted" in curve.column_names:
            above.plot(time_s, curve.column("fitted"), "-", linewidth=1.5, color="C0", label=fit.model)
            below.plot(time_s, curve.column("residual_sigma"), ".", markersize=3, color="C0")
            below.axhline(0.0, color="0.3", linewidth=0.8)
        above.legend(frameon=False)
    axes[0][0].set_title(fit.run, fontsize="medium", loc="left")
    return axes[0][0].figure
