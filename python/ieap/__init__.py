"""ieap: measurements on ionic electroactive polymer actuators, with the engine of the program `ieap`.

    import ieap
    table = ieap.read("run.DTA")
    fit = ieap.fit(table, length_mm=5, width_mm=2)
    finding = ieap.diagnose({"a": table, "b": ieap.read("other.DTA")}, length_mm=5, width_mm=2)

Columns are numpy arrays; tables go in and out as Arrow: pyarrow, polars, pandas and DuckDB take them as they are.
The same readings give the same numbers as the program, to the last bit.
"""

from __future__ import annotations

import json
from os import PathLike
from typing import Any, Mapping, Sequence

from . import _native
from ._checked import checked
from ._errors import CampaignError, EngineFault, IeapError, InputError, MissingFileError
from ._estimate import Estimate
from ._inputs import (
    Drive,
    Known,
    Measured,
    effects_of,
    known_of,
    numbers_of,
    readings_of,
    segments_of,
    spectrum_of,
    stated as _stated,
    table_of,
    threads_of,
    times_of,
    values_of,
)
from ._records import Record, record
from ._results import Finding, Fit
from ._table import Table, html_table

__version__: str = _native.version
__all__ = [
    "Campaign",
    "CampaignError",
    "EngineFault",
    "Estimate",
    "Finding",
    "Fit",
    "IeapError",
    "InputError",
    "MissingFileError",
    "Record",
    "Table",
    "convert",
    "cycles",
    "diagnose",
    "diagnose_rows",
    "fit",
    "fit_many",
    "impedance",
    "read",
    "read_all",
    "simulate",
]


def __dir__() -> list[str]:
    return sorted([*__all__, "spark", *(name for name in globals() if name.startswith("__"))])


@checked
def read_all(path: str | PathLike[str]) -> list[Table]:
    """Reads every table of a file of any format that `ieap list formats` lists.

    Raises:
        InputError: no reader can read the file; ``place`` has line and column, ``remedy`` says what helps.
        MissingFileError: there is no such file (also a FileNotFoundError).
        CampaignError: the system cannot give the file.
    """
    return [Table(found) for found in _native.read(path)]


@checked
def read(path: str | PathLike[str], table: str | None = None) -> Table:
    """Reads a run from a file of any format that `ieap list formats` lists.

    Args:
        path: the file. Saved profiles of the campaign that it lies in are obeyed.
        table: the name of the table, where the file holds several.

    Returns:
        A table with ``time_s`` (s) and a column for each channel, in canonical units that the names carry
        (``current_a``, ``curvature_per_cm``). A row without a reading of a slower channel is empty there.
        ``repr`` shows what the reader saw.

    Raises:
        InputError: no reader can read the file, or it holds several tables and `table` names none of them.
    """
    found = read_all(path)
    named = {own.source.rsplit("#", 1)[-1]: own for own in found} if len(found) > 1 else {}
    if table is None and len(found) == 1:
        return found[0]
    if table in named:
        return named[table]
    remedy = f"name one of them: table= {', '.join(named) or 'nothing, there is one only'}"
    raise InputError(f"the file holds {len(found)} tables, and {table!r} is none of them", str(path), remedy)


@checked
def fit(
    readings: Any,
    *,
    area_cm2: float | None = None,
    length_mm: float | None = None,
    width_mm: float | None = None,
    model: str | None = None,
    voltage_v: float | None = None,
    drive: Drive | None = None,
    baseline_v: float = 0.0,
    tags: Mapping[str, Any] | None = None,
    electrode_resistance_ohm_per_sq: float | None = None,
    method: str | None = None,
    simultaneous: bool = False,
    seed: int | None = None,
    known: Mapping[str, Known] | None = None,
    run: str | None = None,
) -> Fit:
    """Fits one run.

    Args:
        readings: a `Table`; a table of any library that speaks Arrow; or a mapping of names to one-dimensional arrays of
            one length. Names are as in a plain run table, with units: ``time_s``, ``current_a`` (or ``I/mA``, ...),
            ``curvature_per_cm``, ``tip_displacement_mm``, ``voltage_v``. NaN or None is an empty cell. Time zero is the
            voltage step. Arrays of pint, astropy and xarray are converted to the unit that their name says.
        area_cm2: active area of the strip, cm2; or length and width.
        length_mm: free length, mm. A tip displacement gives a curvature only with it.
        width_mm: width, mm.
        model: ``lumped-1`` to ``lumped-4``, ``distributed``, or a rival, as ``ieap list models`` lists them; None: ``lumped-2``.
        voltage_v: the step, V, where no voltage was recorded: where the current jumps, else beside time zero.
        drive: start (s) and voltage (V; None: open circuit) of each segment, in place of what was recorded.
        baseline_v: voltage held before `drive`, V.
        tags: what a sidecar may state: ``{"leave_out": "600-1200", "open_circuit": "300-400", ...}``.
        electrode_resistance_ohm_per_sq: of both electrodes along the strip, Ohm per square.
        method: how minima are searched; None: variable projection.
        simultaneous: current and curvature together in place of one after the other.
        seed: of a random method.
        known: what is known of parameters before the fit: ``{"r1_ohm_cm2": 120.0}`` (exact), ``{"r1_ohm_cm2": (120.0, 6.0)}``
            (with its standard error) or ``{"lambda_per_s": "0.001..0.01"}`` (limits); ``"r1"`` is a name as in ``fit["r1"]``.
        run: a name for the run.

    Raises:
        InputError: the readings cannot be fitted; ``reason`` and ``remedy`` say why and what helps.
    """
    table = readings_of(readings)
    said = _stated(
        area_cm2=area_cm2,
        length_mm=length_mm,
        width_mm=width_mm,
        electrode_resistance_ohm_per_sq=electrode_resistance_ohm_per_sq,
        voltage_v=voltage_v,
        drive=drive,
        baseline_v=baseline_v,
        tags=tags,
    )
    recipe = (run or table.source, table, said, model, method, simultaneous, seed, known_of(known))
    return Fit(_native.fit(*recipe), recipe)


@checked
def diagnose(
    runs: Mapping[str, Any] | Sequence[Any],
    *,
    area_cm2: float | None = None,
    length_mm: float | None = None,
    width_mm: float | None = None,
    tags: Mapping[str, Mapping[str, Any]] | None = None,
    drives: Mapping[str, Drive] | None = None,
    group: str = "group",
    model: str | None = None,
    draws: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
) -> Finding:
    """Asks what the model gets wrong in runs of one sample in one condition, and why.

    This takes minutes: what chance does is simulated. Ctrl-C ends it.

    Args:
        runs: readings by name, in any form that `fit` takes; or a list of them.
        area_cm2: active area of the strip, cm2; or `length_mm` and `width_mm`, mm.
        tags: tags by the name of the run, such as ``{"a": {"voltage_v": 1.5}}``.
        drives: drives by the name of the run, as `fit` takes them.
        group: a name for the group.
        model: the base model; None: ``lumped-2``.
        draws: draws of what chance does; None: 999.
        seed: of the draws.
        threads: None: all cores; more than these are not taken.

    Raises:
        InputError: a run cannot be used, or two runs hold the same readings.
    """
    if not isinstance(runs, Mapping):
        tables = [readings_of(own) for own in runs]
        named = {f"{index + 1}: {table.source}": table for index, table in enumerate(tables)}
    else:
        named = {name: readings_of(own) for name, own in runs.items()}

    def said(name: str) -> _native.Stated:
        return _stated(
            area_cm2=area_cm2,
            length_mm=length_mm,
            width_mm=width_mm,
            tags=(tags or {}).get(name),
            drive=(drives or {}).get(name),
        )

    parts = [(name, table, said(name)) for name, table in named.items()]
    return Finding(json.loads(_native.diagnose(group, parts, model, draws, seed, threads_of(threads))))


@checked
def impedance(readings: Any, impedance_ohm: Any = None, *, circuits: Sequence[str] = ()) -> Record:
    """Analyses an impedance spectrum: whether it can be one (Kramers-Kronig, Z-HIT), its relaxation times, and circuits.

        ieap.impedance(frequency_hz, z_ohm).circuits[0].parameters["rss_ohm"]

    Args:
        readings: frequencies, Hz, beside `impedance_ohm`; or one table with ``frequency_hz`` and ``impedance_real_ohm`` and
            ``impedance_imaginary_ohm``, or ``impedance_magnitude_ohm`` and ``impedance_phase_degree``, as `read` gives it.
        impedance_ohm: complex numbers, Ohm: negative imaginary parts are capacitive.
        circuits: circuits beside those that every spectrum is fitted with, such as ``"R0-p(R1,CPE1)-W1"``.

    Returns:
        What ``ieap impedance --json`` says of a spectrum: ``kramers_kronig``, ``z_hit``, ``relaxation``, ``circuits`` (each
        with ``parameters`` in Ohm and F, ``describes``, ``bic_above_best``), ``best``, ``issues``.

    Raises:
        InputError: there is not one spectrum, or too few frequencies; a text is no circuit.
    """
    found: Record = record("impedance", "SweepDocument", json.loads(_native.impedance(spectrum_of(readings, impedance_ohm), list(circuits))))
    return found


@checked
def cycles(
    readings: Any,
    *,
    area_cm2: float | None = None,
    length_mm: float | None = None,
    width_mm: float | None = None,
    drive: Drive | None = None,
    baseline_v: float = 0.0,
    tags: Mapping[str, Any] | None = None,
) -> Table:
    """The cycles of a train: amplitude, charge in and out, coulombic efficiency, energy, alpha, resistance.

    Args are those of `fit`.

    Returns:
        One row a cycle, each number with ``_standard_error``, ``_low_95``, ``_high_95`` and ``_reason``.

    Raises:
        InputError: the drive is no train of three cycles or more.
    """
    said = _stated(area_cm2=area_cm2, length_mm=length_mm, width_mm=width_mm, drive=drive, baseline_v=baseline_v, tags=tags)
    return Table(_native.cycles(readings_of(readings), said))


@checked
def simulate(
    parameters: Fit | Mapping[str, float],
    *,
    model: str | None = None,
    drive: Drive | None = None,
    effects: Mapping[str, Mapping[str, Any]] | None = None,
    area_cm2: float | None = None,
    length_mm: float | None = None,
    width_mm: float | None = None,
    baseline_v: float | None = None,
    time_s: Any = None,
    until_s: float | None = None,
    every_s: float | None = None,
    places_mm: Sequence[float] | None = None,
    noise: Mapping[str, float] | None = None,
    seed: int = 1,
) -> Table:
    """Simulates a run of any model that runs are fitted with.

    Args:
        parameters: a `Fit`, which gives model, area, length, drive and places too; or values by key (``r1_ohm_cm2``,
            ``c1_f_per_cm2``, ..., ``rss_ohm_cm2``, ``alpha_per_c_cm``, ``lambda_per_s``). Those left out are 0, or absent
            branches; those of a rival's bending cannot be left out.
        model: the model that values by key are of, as ``ieap list models`` lists them; None: ``lumped-2``.
        drive: start (s) and voltage (V; None: open circuit) of each segment. None: that of the fit, its edges where the
            fit takes them to be.
        effects: effects that act in the run of a lumped model, ``{"faradaic-leak": {"onset_v": 1.2, ...}}``;
            docs/hidden-effects.md lists them; the key ``variant`` names a variant.
        area_cm2: active area, cm2; or `length_mm` and `width_mm`, mm.
        baseline_v: voltage held before the drive, V; None: that of the fit's drive, else 0.
        time_s: times of the readings, s; or `until_s` and `every_s`. None: 600 even intervals, to as long after the last
            switching as before it, 600 s for one step.
        places_mm: places, mm from the clamp, at which the distributed model gives the curvature, a column each
            (``curvature_per_cm@2``); None: those of the fit's readings, or none.
        noise: standard deviations ``current_a`` (A) and ``curvature_per_cm`` (1/cm), and ``autocorrelation`` of
            neighbouring readings; None: no noise.
        seed: of the noise.

    Returns:
        A table of n rows with ``time_s``, ``voltage_v``, ``current_a`` and ``curvature_per_cm``. It knows its strip and its
        drive, so that ``ieap.fit(table)`` needs neither. An offset that a fit finds beside its model is not in it.

    Raises:
        InputError: something asked for makes no sense, or a parameter of the fit that is needed is not determined.
    """
    if isinstance(parameters, Fit):
        if model not in (None, parameters.model):
            found = f"model is {model!r}, and the fit is of {parameters.model}"
            raise InputError(found, "model", "leave it out, or give the parameters as a mapping", "contradiction")
        model, given = parameters.model, _known(parameters)
        if not drive:
            before_v, drive = parameters._native.drive_as_fitted()
            baseline_v = before_v if baseline_v is None else baseline_v
        if area_cm2 is None and (length_mm is None or width_mm is None):
            area_cm2 = parameters.area_cm2
        length_mm = parameters.length_mm if length_mm is None else length_mm
        places_mm = parameters._native.places_mm if places_mm is None else places_mm
    else:
        given = values_of(parameters, "parameters")
    if not drive:
        raise InputError("there is no drive", "drive", "give start (s) and voltage (V) of each segment: [(0, 2.0)]")
    said = _stated(area_cm2=area_cm2, length_mm=length_mm, width_mm=width_mm, drive=drive, baseline_v=baseline_v or 0.0)
    times = times_of(drive, time_s, until_s, every_s)
    sizes = values_of(noise or {}, "noise")
    own_noise = (sizes.pop("current_a", 0.0), sizes.pop("curvature_per_cm", 0.0), sizes.pop("autocorrelation", 0.0))
    if sizes:
        raise InputError(f"found {', '.join(sizes)}", "noise", "one of current_a, curvature_per_cm, autocorrelation")
    places = [float(place) for place in places_mm or ()]
    return Table(_native.simulate(model or "lumped-2", given, said, effects_of(effects), times, own_noise, seed, places))


@checked
def convert(
    given: str,
    *,
    length_mm: Measured | None = None,
    seen_at_mm: Measured | None = None,
    width_mm: Measured | None = None,
    thickness_mm: Measured | None = None,
    modulus_mpa: Measured | None = None,
    neutral_layer_shift_mm: Measured | None = None,
    mean_elongation: Measured | None = None,
) -> Record:
    """One measure of a bending as all others, with errors: ``ieap.convert("displacement=1.2mm", length_mm=(5, 0.1))``.

    Args:
        given: curvature, radius, displacement, tip-displacement, tangent-angle, strain-difference, bending-strain, moment or
            energy, then ``=`` and the value with its unit, and its standard error where it has one (``1.2±0.05mm``).
        length_mm: free length, mm; like every number, alone or with its standard error: ``(5, 0.1)``.
        seen_at_mm: where the displacement is seen, mm ahead of the clamp; None: the free length.
        width_mm: width, mm.
        thickness_mm: thickness, mm.
        modulus_mpa: effective Young's modulus, MPa.
        neutral_layer_shift_mm: distance of the neutral layer from the middle of the thickness, mm; None: 0.
        mean_elongation: mean elongation of the strip, a share; None: 0.

    Returns:
        The document `ieap/convert/1` of the program: ``.values`` holds every measure by its key, as an `Estimate`.

    Raises:
        InputError: the measure or its unit is unknown, or no circle bends so.
    """
    numbers = numbers_of(
        length_mm=length_mm,
        seen_at_mm=seen_at_mm,
        width_mm=width_mm,
        thickness_mm=thickness_mm,
        modulus_mpa=modulus_mpa,
        neutral_layer_shift_mm=neutral_layer_shift_mm,
        mean_elongation=mean_elongation,
    )
    return _document("convert", _native.conversion(given, numbers))


def _document(schema: str, text: str) -> Record:
    document: Record = record(schema, "", json.loads(text))
    return document


def _known(fit: Fit) -> dict[str, float]:
    """Values of the parameters that the fit's curves are made of; one that is not determined is never made up."""
    needed = {key: fit[key] for key in fit._native.needed_keys}
    missing = [f"{key}: {own}" for key, own in needed.items() if own.value is None]
    if missing:
        remedy = f"give the parameters as a mapping with model={fit.model!r}, with a value for it or without it"
        raise InputError(f"not determined: {'; '.join(missing)}", fit.run, remedy, "not-determined")
    return {key: own.value for key, own in needed.items() if own.value is not None}


def _course_of(rows: Sequence[tuple[float, float]], one: float | None) -> list[tuple[float, float]]:
    """A humidity that changes: times (s) that increase, and percents."""
    course = [(float(time_s), float(percent)) for time_s, percent in rows]
    increase = all(later[0] > earlier[0] for earlier, later in zip(course, course[1:]))
    if course and (one is not None or not increase or not all(0.0 <= percent <= 100.0 for _, percent in course)):
        needed = "give rows of time (s), which increases, and percent, 0 to 100; or one humidity"
        raise InputError(f"found {rows!r}", "relative_humidity_course", needed, "bad-argument")
    return course


@checked
def fit_many(
    rows: Any,
    *,
    model: str | None = None,
    method: str | None = None,
    simultaneous: bool = False,
    seed: int | None = None,
    threads: int | None = None,
    known: Mapping[str, Known] | None = None,
) -> Table:
    """Fits many runs on all cores, one row a run. Ctrl-C ends it.

    Args:
        rows: a table that speaks Arrow. List columns are readings (``time_s``, ``current_a``, ``curvature_per_cm``,
            ``voltage_v``, ...; one length a row, empty cells allowed). ``run`` names the run; ``area_cm2`` or
            ``length_mm`` and ``width_mm`` state the strip; ``drive_start_s`` and ``drive_voltage_v`` (lists) and
            ``baseline_v`` may state the drive; every other column is a tag, such as ``voltage_v`` as one number.
        threads: None: all cores; more than these are not taken. The result does not depend on it.
        known: what is known of parameters of every run, as in `fit`.

    Returns:
        One row a run in the order given: ``run``, ``model``, ``input_hash``, ``converged``, ``n_samples``, ``parameters``
        (a list of records ``key``, ``value``, ``standard_error``, ``low_95``, ``high_95``, ``at_bound``, ``reason``),
        ``r_squared_current``, ``issues``, ... A run that cannot be fitted has ``refused_place``, ``refused_reason`` and
        ``refused_remedy`` instead.
    """
    return Table(_native.fit_many(rows, model, method, simultaneous, seed, threads_of(threads), known_of(known)))


@checked
def diagnose_rows(
    rows: Any,
    *,
    group: str = "group",
    model: str | None = None,
    draws: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
) -> Table:
    """As `diagnose`, of runs in a table as `fit_many` takes it: all rows are one group.

    Returns:
        One row: ``group``, ``runs``, ``left_out`` (runs that could not be used, each with the reason), ``verdict``, ``sentence``, ``p_misfit``, ``causes``, ``most_probable``, ...,
        ``document`` (JSON, a group of ``ieap diagnose --json``), or the reason in ``refused_reason``.
    """
    return Table(_native.diagnose_rows(group, rows, model, draws, seed, threads_of(threads)))


class Campaign:
    """A campaign folder, to read from; it is never changed. Every call shows the campaign as it is then."""

    @checked
    def __init__(self, folder: str | PathLike[str] = ".") -> None:
        """Finds the campaign at `folder` or above it."""
        self._native = _native.Campaign(folder)

    @staticmethod
    def tables() -> dict[str, str]:
        """Every table that `table` gives, and what it holds."""
        return dict(_native.Campaign.tables())

    @checked
    def table(self, name: str) -> Table:
        """A table of results by its name, such as ``runs``, ``fits``, ``laws``: all columns that ``ieap export`` writes, or that
        ``ieap table`` shows. Numbers are in full, in the unit that the column's name ends in; those with
        uncertainty have ``_standard_error``, ``_low_95``, ``_high_95`` and ``_reason`` beside them."""
        return Table(self._native.table(name))

    @checked
    def readings(self, run: str) -> Table:
        """The readings of a run as a fit takes them, with its strip, drive and tags: ``ieap.fit(c.readings(run))``."""
        return Table(self._native.readings(run))

    @checked
    def readings_many(self, runs: Sequence[str] | None = None) -> dict[str, Table]:
        """The readings of many runs by name, with the campaign opened once; None: of every run that results are made from."""
        if runs is None:
            known = self.table("runs")
            speaking = zip(known.column("run"), known.column("standing"))
            runs = [run for run, standing in speaking if standing in ("speaks", "vouched")]
        return dict(zip(runs, map(Table, self._native.readings_many(list(runs)))))

    @checked
    def fit_rows(self, runs: Sequence[str] | None = None) -> Any:
        """Runs as rows for `fit_many`, one a run with its readings, strip and how the campaign fits it, as a pyarrow table.

        What ``ieap export --what traces --partitioned`` writes, without files; results go back by ``ieap import-fits``. None:
        every run that results are made from.
        """
        try:
            from pyarrow import BufferReader, parquet
        except ImportError:
            raise InputError("pyarrow is not installed", "fit_rows", "pip install pyarrow", "no-pyarrow") from None
        rows = parquet.read_table(BufferReader(self._native.fit_rows(None if runs is None else list(runs))))
        known = self.table("runs")
        # In files they are the names of folders.
        for name in ("material", "environment"):
            of_run = dict(zip(known.column("run"), known.column(name)))
            rows = rows.append_column(name, [[of_run[run] for run in rows.column("run").to_pylist()]])
        return rows

    @checked
    def finding(self, group: str) -> Finding:
        """The current finding of a group, by its name as the program takes it: ``"CNaf-1 in air"``, or with its tags."""
        found = _document("diagnosis", self._native.diagnosis_document(group)).groups
        if not found:
            known = ", ".join(other.group for other in self.diagnosis().groups)
            raise InputError("there is no such group", group, f"one of {known or 'none: run ieap diagnose'}")
        first: Finding = found[0]
        return first

    def fits(self) -> Record:
        """What ``ieap fit --json`` prints of the current fits: each of ``.fits`` is of a run."""
        return _document("fits", self._native.fits_document())

    def diagnosis(self) -> Record:
        """What ``ieap diagnose --json`` prints of the current findings: each of ``.groups`` is a `Finding`."""
        return _document("diagnosis", self._native.diagnosis_document(None))

    @checked
    def impedance(self, circuits: Sequence[str] = ()) -> Record:
        """What ``ieap impedance --json`` prints of the spectra that were taken in; ``circuits`` such as
        ``"R0-p(R1,CPE1)-W1"`` are fitted as well."""
        return _document("impedance", self._native.impedance_document(list(circuits)))

    @checked
    def compare(self, models: Sequence[str] = ()) -> Record:
        """Which model is best for which material in which environment: the document `ieap/comparison/1` that
        ``ieap compare --json`` prints.

        `models` are ids, None given: the two lumped ones of the thesis and every rival. What ``ieap compare`` has stored of
        the same models is taken; the rest is fitted now, on all cores, and not stored. Ctrl-C ends it.
        """
        return _document("comparison", self._native.compare(list(models)))

    @checked
    def predict(
        self,
        sample: str,
        *,
        voltage_v: float | None = None,
        drive: Drive | None = None,
        baseline_v: float = 0.0,
        at_s: Sequence[float] = (),
        environment: str | None = None,
        relative_humidity_percent: float | None = None,
        relative_humidity_course: Sequence[tuple[float, float]] = (),
        temperature_c: float | None = None,
        age_h: float | None = None,
        length_mm: Measured | None = None,
        width_mm: Measured | None = None,
        thickness_mm: Measured | None = None,
        modulus_mpa: Measured | None = None,
        electrode_resistance_ohm_per_sq: float | None = None,
    ) -> Record:
        """What a strip will do, from the stored fits of its laminate: the document `ieap/prediction/2` of the program.

        `sample` names the strip whose fits tell; `voltage_v` is a step at time zero, `drive` start (s) and voltage (V) of each
        segment; `at_s` the times asked for. Another size has ``length_mm=12`` or, with its standard error, ``(12, 0.1)``.
        A humidity, temperature or age between those of the runs is reached by the laws across them; `relative_humidity_course`,
        rows of time (s) and percent, each held until the next, is one that changes meanwhile.
        """
        humidity = _course_of(relative_humidity_course, relative_humidity_percent)
        if (voltage_v is None) == (drive is None):
            found = f"voltage_v is {voltage_v}, drive is {drive!r}"
            raise InputError(found, "drive", "give one of both: voltage_v=1.5, or drive=[(0, 1.5), (300, 0.0)]", "bad-argument")
        segments = segments_of(drive if voltage_v is None else [(0.0, voltage_v)])
        numbers = numbers_of(length_mm=length_mm, width_mm=width_mm, thickness_mm=thickness_mm, modulus_mpa=modulus_mpa)
        numbers |= numbers_of(
            relative_humidity_percent=relative_humidity_percent,
            temperature_c=temperature_c,
            age_h=age_h,
            electrode_resistance_ohm_per_sq=electrode_resistance_ohm_per_sq,
        )
        times = [float(time_s) for time_s in at_s]
        of = (sample, environment, humidity)
        return _document("prediction", self._native.predict(of, numbers, (baseline_v, segments), times))

    @checked
    def drive(
        self,
        sample: str,
        *,
        hold_mm: float | None = None,
        for_s: float | None = None,
        course: Sequence[tuple[float, float]] | None = None,
        every_s: float | None = None,
        max_voltage_v: float | None = None,
        max_slope_v_per_s: float | None = None,
        onset_v: Measured | None = None,
        environment: str | None = None,
        relative_humidity_percent: float | None = None,
        relative_humidity_course: Sequence[tuple[float, float]] = (),
        temperature_c: float | None = None,
        age_h: float | None = None,
        length_mm: Measured | None = None,
        width_mm: Measured | None = None,
        thickness_mm: Measured | None = None,
        electrode_resistance_ohm_per_sq: float | None = None,
    ) -> Record:
        """The voltage that brings the tip to a wanted course, open loop: the document `ieap/drive/2` of the program.

        The tip is held at `hold_mm` for `for_s`, or follows `course`, rows of time (s) and displacement (mm).
        `relative_humidity_course` is as of `predict`.
        """
        humidity = _course_of(relative_humidity_course, relative_humidity_percent)
        is_held = hold_mm is not None and for_s is not None
        if is_held == (course is not None) or (hold_mm is None) != (for_s is None):
            found = f"hold_mm={hold_mm}, for_s={for_s}, course={course!r}"
            raise InputError(found, "course", "give hold_mm and for_s, or a course: [(0, 0.0), (60, 0.3)]", "bad-argument")
        held = [(for_s or 0.0, hold_mm or 0.0)] if is_held else course
        rows = [(float(time_s), float(tip_mm)) for time_s, tip_mm in held or ()]
        times = [time_s for time_s, _ in rows]
        if not is_held and (len(rows) < 2 or any(later <= earlier for earlier, later in zip(times, times[1:]))):
            needed = "give two rows of time and displacement or more, with times that increase"
            raise InputError(f"found {course!r}", "course", needed, "bad-argument")
        numbers = numbers_of(length_mm=length_mm, width_mm=width_mm, thickness_mm=thickness_mm, onset_v=onset_v)
        numbers |= numbers_of(
            every_s=every_s,
            max_voltage_v=max_voltage_v,
            max_slope_v_per_s=max_slope_v_per_s,
            relative_humidity_percent=relative_humidity_percent,
            temperature_c=temperature_c,
            age_h=age_h,
            electrode_resistance_ohm_per_sq=electrode_resistance_ohm_per_sq,
        )
        return _document("drive", self._native.drive((sample, environment, humidity), numbers, rows))

    def __reduce__(self) -> tuple[Any, ...]:
        return Campaign, (self._native.folder,)

    def _repr_html_(self) -> str:
        runs = self.table("runs")
        names = [name for name in ("run", "sample", "material", "environment", "voltage_v", "state", "standing") if name in runs]
        cells = [["" if cell is None else cell for cell in runs.column(name)[:50]] for name in names]
        more = [f"{len(runs) - 50} more"] if len(runs) > 50 else []
        return html_table(f"{self._native.folder}: {len(runs)} runs", names, list(zip(*cells)), more)

    def __repr__(self) -> str:
        return repr(self._native)
