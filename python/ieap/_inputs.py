"""What people hand over, in the form that the engine takes. Units are in the names; nothing is calculated here."""

from __future__ import annotations

import os
from array import array
from math import isfinite, nan
from typing import Any, Iterable, Mapping, Sequence
from warnings import warn

from . import _native
from ._errors import InputError
from ._table import Table


Drive = Sequence[tuple[float, "float | None"]]
"""Start (s) and voltage (V; None: open circuit) of each segment."""


def _doubles(name: str, values: Any) -> tuple[bytes, int]:
    """The numbers of a one-dimensional array, a series or a list, and how many were masked; what is None or masked is an
    empty cell."""
    masked = 0
    if hasattr(values, "to_pylist"):  # pyarrow
        values = values.to_pylist()
    elif hasattr(values, "na_value") or hasattr(getattr(values, "dtype", None), "na_value"):  # nullable pandas
        values = values.to_numpy(dtype="float64", na_value=nan)
    elif hasattr(values, "to_numpy"):  # pandas, polars
        values = values.to_numpy()
    kind = getattr(getattr(values, "dtype", None), "kind", None)
    if kind is not None and kind not in "biufO":
        what = {"c": "complex numbers", "M": "dates", "m": "durations", "S": "texts", "U": "texts"}.get(kind, "no numbers")
        needed = "give real numbers: .real, or abs(...)" if kind == "c" else "give numbers in the unit that the name says"
        raise InputError(f"it holds {what}", _column(name), needed, "column-unusable")
    ndim = getattr(values, "ndim", 1)
    if ndim != 1:
        needed = "give an array of one dimension, one value a reading"
        raise InputError(f"it has {ndim} dimensions", _column(name), needed, "column-unusable")
    if kind is not None and hasattr(values, "filled"):  # a mask says that there is no reading
        masked = int(values.mask.sum())
        values = values.astype("float64").filled(nan)
    elif kind is not None and kind != "O":
        values = values.astype("float64", copy=False)  # the machine's order of bytes
    try:
        view = memoryview(values)
    except TypeError:
        return _from_items(name, values), masked
    if view.ndim == 1 and view.format in ("d", "<d", "=d"):
        return view.tobytes(), masked
    return _from_items(name, values), masked


def _from_items(name: str, values: Iterable[Any]) -> bytes:
    try:
        items = list(values)
    except TypeError:
        needed = "give a sequence of numbers, one a reading"
        raise InputError(f"a {type(values).__name__} is no sequence", _column(name), needed, "column-unusable") from None
    numbers = array("d")
    for index, value in enumerate(items):
        try:
            numbers.append(nan if value is None else value)
        except TypeError:
            found = f"{value!r} is no number"
            raise InputError(found, f"{_column(name)}, index {index}", "give numbers; NaN or None is an empty cell") from None
    return numbers.tobytes()


def _column(name: str) -> str:
    return f"column {name}"


def _with_unit(name: str, values: Any) -> tuple[str, Any]:
    """A column whose array has a unit of its own (pint, astropy, xarray), as plain numbers under a name that says it.

    Numbers are converted to the unit that the name says; where it says none, the array's own is put into the name.
    """
    wanted = _native.unit_of(name)
    if hasattr(values, "m_as") and hasattr(values, "units"):  # pint
        own, converted, plain = f"{values.units:~C}" or "1", values.m_as, values.magnitude
    elif hasattr(values, "to_value") and hasattr(values, "unit"):  # astropy
        own, converted, plain = str(values.unit) or "1", values.to_value, values.value
    elif hasattr(values, "attrs") and hasattr(values, "dims") and hasattr(values, "values"):  # xarray
        own, plain = str(values.attrs.get("units", "")), values.values
        if own and wanted and own != wanted:
            found = f"its attribute says {own}, and its name says {wanted}"
            raise InputError(found, _column(name), "name the unit that the numbers are in", "contradiction")
        return (f"{name} ({own})", plain) if own and not wanted else (name, plain)
    else:
        return name, values
    if not wanted:
        return f"{name} ({own})", plain
    try:
        return name, converted(wanted)
    except Exception as error:  # of a class of their own
        found = f"its numbers are in {own}, and its name says {wanted}: {error}"
        raise InputError(found, _column(name), "name the unit that the numbers are in", "contradiction") from None


def table_of(readings: Any) -> Table:
    """Readings in any form as a table."""
    return readings if isinstance(readings, Table) else Table(readings_of(readings))


def readings_of(readings: Any) -> _native.Readings:
    """Readings in any form, as the engine takes them."""
    if isinstance(readings, Table) and readings._readings is not None:
        return readings._readings
    if hasattr(readings, "data_vars") and hasattr(readings, "coords"):  # xarray: the times are a coordinate
        readings = {**readings.coords, **readings.data_vars}
    if isinstance(readings, Mapping):
        named = (_with_unit(str(name), values) for name, values in readings.items())
        return _native.arrays([(name, *_doubles(name, values)) for name, values in named])
    return _native.from_arrow(readings)


def spectrum_of(frequency_hz: Any, impedance_ohm: Any) -> _native.Readings:
    """A spectrum: frequencies beside complex numbers, or readings that have both."""
    if impedance_ohm is None:
        return readings_of(frequency_hz)
    if not hasattr(impedance_ohm, "__len__"):
        raise InputError(f"found {impedance_ohm!r}", "impedance_ohm", "give complex numbers, one a frequency", "bad-argument")
    if not hasattr(impedance_ohm, "real"):
        numbers = [complex(number) for number in impedance_ohm]
        parts = [number.real for number in numbers], [number.imag for number in numbers]
    else:
        parts = impedance_ohm.real, impedance_ohm.imag
    columns = {"frequency_hz": frequency_hz, "impedance_real_ohm": parts[0], "impedance_imaginary_ohm": parts[1]}
    order = range(len(parts[0]))
    return _native.arrays([("time_s", *_doubles("time_s", list(order))), *((name, *_doubles(name, own)) for name, own in columns.items())])


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
    if not hasattr(tags or {}, "items"):
        raise InputError(f"found {tags!r}", "tags", "give a mapping of tags to texts or numbers", "bad-argument")
    words = {key: _word(key, value) for key, value in (tags or {}).items()}
    if voltage_v is not None:
        volts = _number("voltage_v", voltage_v)
        if not isfinite(volts):
            raise InputError(f"found {voltage_v!r}", "voltage_v", "give a voltage, V, or leave it out", "bad-argument")
        tagged = words.setdefault("voltage_v", repr(volts))
        if _number("tag voltage_v", tagged) != volts:
            found = f"voltage_v is {volts!r}, and tags say {tagged}"
            raise InputError(found, "voltage_v", "state it once", "contradiction")
    segments = segments_of(drive)
    if baseline_v and not segments:
        found = f"baseline_v is {baseline_v} V, and there is no drive that it stands before"
        raise InputError(found, "baseline_v", "state the drive as well: [(0, 2.0)]", "contradiction")
    return _native.Stated(area_cm2, length_mm, width_mm, electrode_resistance_ohm_per_sq, baseline_v, segments, words)


def segments_of(drive: Drive | None) -> list[tuple[float, float | None]]:
    """Start (s) and voltage (V; None: open circuit) of each segment, in order."""
    needed = "give start (s) and voltage (V; None: open circuit) of each segment: [(0, 2.0), (300, None)]"
    try:
        segments = [(float(start_s), None if volts is None else float(volts)) for start_s, volts in drive or ()]
    except (TypeError, ValueError):
        raise InputError(f"found {drive!r}", "drive", needed, "bad-drive") from None
    for index, (start_s, volts) in enumerate(segments):
        if not isfinite(start_s) or not isfinite(volts or 0.0):
            raise InputError(f"found {(start_s, volts)}", f"drive, index {index}", needed, "bad-drive")
        if index and not start_s > segments[index - 1][0]:
            found = f"{start_s} s after {segments[index - 1][0]} s"
            raise InputError(found, f"drive, index {index}", "let each segment start later than the one before", "bad-drive")
    return segments


def threads_of(threads: int | None) -> int | None:
    """Threads that are of use: no more than the cores, which is said."""
    if threads is None:
        return None
    if threads < 1:
        raise InputError(f"found {threads}", "threads", "give 1 or more, or None for all cores", "bad-argument")
    affinity = getattr(os, "sched_getaffinity", None)  # only where the system tells
    cores = len(affinity(0)) if affinity else os.cpu_count() or 1
    if threads > cores:
        warn(f"threads={threads}: more than the {cores} cores are of no use; {cores} are taken", stacklevel=3)
    return min(threads, cores)


def _number(key: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"found {value!r}", key, "give a number", "bad-argument") from None


def _word(key: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    try:
        return repr(float(value))
    except (TypeError, ValueError):
        raise InputError(f"found {value!r}", f"tag {key}", "give a text or a number", "bad-argument") from None


Measured = float | tuple[float, float]
"""A number, or a number with its standard error."""


def numbers_of(**given: "Measured | None") -> dict[str, tuple[float, float]]:
    """Each number that is given, with its standard error."""
    found = {}
    for key, own in given.items():
        if own is None:
            continue
        pair = own if isinstance(own, (tuple, list)) else (own, 0.0)
        try:
            value, error = (float(part) for part in pair)
        except (TypeError, ValueError):
            raise InputError(f"found {own!r}", key, "give a number, or a number and its standard error", "bad-argument") from None
        if not isfinite(value) or not error >= 0.0:
            raise InputError(f"found {own!r}", key, "give a finite number, and an error that is not negative", "bad-argument")
        found[key] = value, error
    return found


Known = float | tuple[float, float] | str
"""What is known of a parameter: a number, a number with its standard error, or limits as a text, ``"0.001..0.01"``."""


def known_of(known: "Mapping[str, Known] | None") -> list[str]:
    """What is known of parameters, as ``ieap fit --set`` states it."""
    said = []
    for key, own in (known or {}).items():
        if isinstance(own, str):
            said.append(f"{key}={own}")
            continue
        for value, error in numbers_of(**{key: own}).values():
            has_error = isinstance(own, (tuple, list))
            if error >= abs(value) and has_error:  # nothing would be known; two limits are meant
                found = f"{own!r} is {value:g} with a standard error of {error:g}, which is no smaller than itself"
                needed = f"limits are a text: {key}=\"{value:g}..{error:g}\"; a standard error is smaller than its number"
                raise InputError(found, f"known, {key}", needed, "bad-argument")
            said.append(f"{key}={value!r}±{error!r}" if has_error else f"{key}={value!r}")
    return said


def values_of(given: Mapping[str, Any], where: str) -> dict[str, float]:
    """Numbers by their keys."""
    if not hasattr(given, "items"):
        raise InputError(f"found {given!r}", where, "give a mapping of keys to numbers", "bad-argument")
    return {key: _number(f"{where}, {key}", value) for key, value in given.items()}


def effects_of(effects: Any) -> list[tuple[str, str | None, dict[str, float]]]:
    """Effects as ``{id: {parameter: value}}``; the key ``variant`` names a variant."""
    found = []
    for name, parameters in (effects or {}).items():
        own = {key: value for key, value in parameters.items() if key != "variant"} if hasattr(parameters, "items") else parameters
        variant = parameters.get("variant") if own is not parameters else None
        found.append((name, variant, values_of(own, f"effects, {name}")))
    return found


def times_of(
    drive: Drive, time_s: Any, until_s: float | None, every_s: float | None
) -> list[float]:
    """Times of readings, s: those given, or even ones from the start of the drive on."""
    if time_s is not None:
        return array("d", _doubles("time_s", time_s)[0]).tolist()
    segments = segments_of(drive)
    first, last = segments[0][0], segments[-1][0]
    if until_s is None:
        # As long after the last switching as before it; ten minutes for one step.
        until_s = last + (last - first) if last > first else first + 600.0
    every_s = every_s or (until_s - first) / 600.0
    if not every_s > 0.0 or not until_s > first:
        raise InputError(f"found until_s={until_s}, every_s={every_s}", "until_s", "give an end after the start of the drive")
    count = int((until_s - first) / every_s + 1e-9)
    return [first + step * every_s for step in range(count + 1)]
