"""What people hand over, in the form that the engine takes. Units are in the names; nothing is calculated here."""

from __future__ import annotations

from array import array
from math import nan
from typing import Any, Iterable, Mapping, Sequence

from . import _native
from ._errors import InputError

Drive = Sequence[tuple[float, "float | None"]]
"""Start (s) and voltage (V; None: open circuit) of each segment."""


def doubles(name: str, values: Any) -> bytes:
    """The numbers of a one-dimensional array, a series or a list; None is an empty cell."""
    if hasattr(values, "to_pylist"):  # pyarrow
        values = values.to_pylist()
    elif hasattr(values, "to_numpy"):  # pandas, polars
        values = values.to_numpy()
    try:
        view = memoryview(values)
    except TypeError:
        return _from_items(name, values)
    if view.ndim != 1:
        raise InputError(f"it has {view.ndim} dimensions", name, "give an array of one dimension, one value a reading")
    if view.format in ("d", "<d", "=d"):
        return view.tobytes()
    return _from_items(name, view.tolist() if view.format not in ("O", "e") else values)


def _from_items(name: str, values: Iterable[Any]) -> bytes:
    try:
        return array("d", (nan if value is None else value for value in values)).tobytes()
    except TypeError:
        raise InputError(f"a {type(values).__name__} holds no numbers", name, "give a sequence of numbers") from None


def table_of(readings: Any) -> _native.Table:
    """Readings in any form as a table of the engine."""
    if isinstance(readings, _native.Table):
        return readings
    if isinstance(readings, Mapping):
        return _native.arrays([(name, doubles(name, values)) for name, values in readings.items()])
    return _native.from_arrow(readings)


def stated(
    *,
    area_cm2: float | None = None,
    length_mm: float | None = None,
    width_mm: float | None = None,
    electrode_resistance_ohm_per_sq: float | None = None,
    voltage_v: float | None = None,
    drive: Drive | None = None,
    baseline_v: float = 0.0,
    tags: Mapping[str, Any] | None = None,
) -> _native.Stated:
    """What is stated of readings."""
    words = {key: _word(value) for key, value in (tags or {}).items()}
    if voltage_v is not None:
        words["voltage_v"] = _word(voltage_v)
    segments = [(float(start_s), None if volts is None else float(volts)) for start_s, volts in drive or ()]
    return _native.Stated(area_cm2, length_mm, width_mm, electrode_resistance_ohm_per_sq, baseline_v, segments, words)


def _word(value: Any) -> str:
    return value if isinstance(value, str) else repr(float(value))


def effects_of(effects: Any) -> list[tuple[str, str | None, dict[str, float]]]:
    """Effects as ``{id: {parameter: value}}``; the key ``variant`` names a variant."""
    found = []
    for name, parameters in (effects or {}).items():
        own = dict(parameters)
        variant = own.pop("variant", None)
        found.append((name, variant, {key: float(value) for key, value in own.items()}))
    return found


def times_of(
    drive: Drive, time_s: Any, until_s: float | None, every_s: float | None
) -> list[float]:
    """Times of readings, s: those given, or even ones from the start of the drive on."""
    if time_s is not None:
        return array("d", doubles("time_s", time_s)).tolist()
    first, last = float(drive[0][0]), float(drive[-1][0])
    if until_s is None:
        # As long after the last switching as before it; ten minutes for one step.
        until_s = last + (last - first) if last > first else first + 600.0
    every_s = every_s or (until_s - first) / 600.0
    if not every_s > 0.0 or not until_s > first:
        raise InputError(f"found until_s={until_s}, every_s={every_s}", "until_s", "give an end after the start of the drive")
    count = int((until_s - first) / every_s + 1e-9)
    return [first + step * every_s for step in range(count + 1)]
