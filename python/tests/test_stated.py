"""Nothing that is handed over is misread: the drive of a table, masks, contradictions, digits, threads."""

from __future__ import annotations

import copy
import pickle
import warnings

import pytest
from conftest import NOISE, PARAMETERS, STRIP

import ieap

DRIVE = [(0, 2.0), (300, 0.0)]


def plain(table):
    """The same readings without what the table knows of its drive and strip."""
    return {name: table.column(name) for name in table.column_names}


def test_a_simulated_table_knows_its_drive_and_its_strip():
    table = ieap.simulate(PARAMETERS, drive=DRIVE, area_cm2=0.1, noise=NOISE)
    fit = ieap.fit(table)
    assert fit.drive == DRIVE and fit.area_cm2 == 0.1
    for key in ("r1_ohm_cm2", "c1_f_per_cm2", "lambda_per_s"):
        assert abs(fit[key].value / PARAMETERS[key] - 1) < 0.05, fit
    held = ieap.simulate(PARAMETERS, drive=[(0, 1.0)], baseline_v=2.0, area_cm2=0.1, noise=NOISE)
    assert ieap.fit(held).baseline_v == 2.0
    # What is stated now goes before what the table knows.
    assert ieap.fit(table, area_cm2=0.2).area_cm2 == 0.2
    assert ieap.simulate(ieap.fit(held), noise=NOISE).column("current_a")[0] < 0, "it begins at the baseline of the fit"


def test_a_first_reading_under_voltage_is_an_edge():
    table = ieap.simulate(PARAMETERS, drive=DRIVE, area_cm2=0.1, noise=NOISE)
    fit = ieap.fit(plain(table), area_cm2=0.1)
    assert fit.drive == DRIVE and fit.baseline_v == 0.0
    for key in ("r1_ohm_cm2", "c1_f_per_cm2", "lambda_per_s"):
        own = fit[key]
        assert own.value is not None and own.low_95 <= PARAMETERS[key] <= own.high_95, fit
    assert any(issue.code == "start-state-assumed" for issue in fit.issues)


def test_masks_are_honoured_and_counted():
    numpy = pytest.importorskip("numpy")
    table = ieap.simulate(PARAMETERS, drive=[(0, 2.0)], area_cm2=0.1, noise=NOISE)
    columns = {name: numpy.array(values) for name, values in plain(table).items()}
    whole = ieap.fit(columns, area_cm2=0.1)
    mask = numpy.zeros(len(table), dtype=bool)
    mask[10:60] = True
    columns["current_a"] = numpy.ma.array(numpy.where(mask, 1.0, columns["current_a"]), mask=mask)
    fit = ieap.fit(columns, area_cm2=0.1)
    assert abs(fit["r1_ohm_cm2"].value / whole["r1_ohm_cm2"].value - 1) < 0.02, fit
    told = [issue for issue in fit.issues if issue.code == "readings-masked"]
    assert len(told) == 1 and "50" in told[0].message and told[0].place == "column current_a"
    pandas = pytest.importorskip("pandas")
    values = table.column("current_a")
    columns["current_a"] = pandas.array([None if own else value for own, value in zip(mask, values)], dtype="Float64")
    assert ieap.fit(columns, area_cm2=0.1).parameters == fit.parameters


def test_every_order_of_bytes_and_no_complex_numbers():
    numpy = pytest.importorskip("numpy")
    table = ieap.simulate(PARAMETERS, drive=[(0, 2.0)], area_cm2=0.1)
    columns = {name: numpy.array(values) for name, values in plain(table).items()}
    native = ieap.fit(columns, area_cm2=0.1)
    for kind in (">f8", "<f8"):
        swapped = {name: values.astype(kind) for name, values in columns.items()}
        assert ieap.fit(swapped, area_cm2=0.1).parameters == native.parameters
    assert ieap.fit({**columns, "current_a": columns["current_a"][::-1][::-1]}, area_cm2=0.1).parameters == native.parameters
    with pytest.raises(ieap.InputError, match="complex") as raised:
        ieap.fit({**columns, "current_a": columns["current_a"] + 0j}, area_cm2=0.1)
    assert raised.value.place == "column current_a"
    with pytest.raises(ieap.InputError, match="2 dimensions"):
        ieap.fit({**columns, "current_a": columns["current_a"].reshape(1, -1)}, area_cm2=0.1)


def test_refusals_of_arrays_speak_of_arrays():
    refused = [
        {"time_s": [0.0, 1.0, 2.0], "current": [1.0, 2.0, 3.0]},
        {"time": [0.0, 1.0, 2.0], "current_a": [1.0, 2.0, 3.0]},
        {"current_a": [1.0, 2.0, 3.0]},
        {"time_s": [0.0, 1.0, 0.5, 0.4, 0.3], "current_a": [1.0] * 5},
        {"time_s": [], "current_a": []},
        {"time_s": [0.0, 1.0, "x"], "current_a": [1.0] * 3},
        {"time_s": [0.0, 1.0], "current_a": [1.0]},
    ]
    for columns in refused:
        with pytest.raises(ieap.InputError) as raised:
            ieap.fit(columns, **STRIP, voltage_v=1.0)
        text = str(raised.value)
        assert raised.value.remedy, text
        for word in ("line", "header", "instrument", "profile", "the file"):
            assert word not in text, text
    with pytest.raises(ieap.InputError) as raised:
        ieap.fit({"time_s": [0.0, 1.0, "x"], "current_a": [1.0] * 3}, **STRIP)
    assert raised.value.place == "column time_s, index 2"


def test_what_contradicts_itself_names_both():
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5)], area_cm2=0.1)
    columns = plain(table)
    for stated, words in [
        ({"area_cm2": 0.1, "length_mm": 5, "width_mm": 3}, ["0.1 cm2", "5 mm x 3 mm"]),
        ({"area_cm2": 0.1, "voltage_v": 2, "drive": [(0, 1.5)]}, ["2 V", "1.5 V"]),
        ({"area_cm2": 0.1, "voltage_v": 2, "tags": {"voltage_v": 1}}, ["2.0", "1.0"]),
        ({"area_cm2": 0.1, "tags": {"humidty": 40}}, ["humidty", "relative_humidity_percent"]),
        ({"area_cm2": 0.1, "baseline_v": 1}, ["baseline_v is 1", "drive"]),
        ({"area_cm2": 0.1, "drive": [(0, 1.5), (0, 2)]}, ["0.0 s after 0.0 s"]),
        ({"area_cm2": 0.1, "drive": 2.0}, ["found 2.0"]),
        ({"area_cm2": 0.1, "voltage_v": float("nan")}, ["found nan", "voltage_v"]),
        ({"area_cm2": 0.1, "voltage_v": "two"}, ["found 'two'", "voltage_v"]),
        ({"area_cm2": 0.1, "voltage_v": 2, "tags": {"voltage_v": "two"}}, ["found 'two'", "voltage_v"]),
    ]:
        with pytest.raises(ieap.InputError) as raised:
            ieap.fit(columns, **stated)
        assert all(word in str(raised.value) for word in words), raised.value
    fit = ieap.fit(columns, area_cm2=0.1, voltage_v=2)
    told = [issue.message for issue in fit.issues if issue.code == "tag-disagreement"]
    assert told and "2 V" in told[0] and "1.5" in told[0], fit
    with pytest.raises(ieap.InputError, match="r1_ohm_cm2") as raised:
        ieap.simulate({**PARAMETERS, "r1_ohm_cm2": -1}, drive=[(0, 1)], **STRIP)
    assert "-1" in str(raised.value)


def test_digits_are_enough_for_the_interval_to_hold_its_value():
    shown = str(ieap.Estimate(119.99, 0.013, 119.964, 120.016, False, None))
    assert shown == "119.99 +- 0.013  (95 %: 119.964 .. 120.016)"
    assert str(ieap.Estimate(30.0, None, None, None, False, None)) == "30  (95 %: open .. open)"
    assert str(ieap.Estimate(123456.0, 1500.0, 120456.0, None, False, None)).startswith("1.235e+05 +- 1.5e+03  (95 %: 1.205e+05")


def test_threads_are_bounded_by_the_cores():
    import os

    rows = {"run": ["a"], "time_s": [[0.0, 1.0]], "current_a": [[1.0, 2.0]]}
    pyarrow = pytest.importorskip("pyarrow")
    with pytest.warns(UserWarning, match="cores are of no use"):
        ieap.fit_many(pyarrow.table(rows), threads=20_000)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ieap.fit_many(pyarrow.table(rows), threads=1)
    assert os.cpu_count()
    with pytest.raises(ieap.InputError, match="found 0"):
        ieap.fit_many(pyarrow.table(rows), threads=0)


def test_a_missing_file_is_a_file_not_found(tmp_path):
    with pytest.raises(FileNotFoundError) as raised:
        ieap.read(tmp_path / "no.csv")
    assert isinstance(raised.value, ieap.CampaignError) and raised.value.place.endswith("no.csv")
    again = pickle.loads(pickle.dumps(raised.value))
    assert (str(again), again.code) == (str(raised.value), "no-such-file")
    assert copy.deepcopy(raised.value).remedy == raised.value.remedy


def test_readings_win_over_a_stated_drive_that_they_contradict():
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, until_s=200, every_s=1, noise=NOISE)
    columns = {name: table.column(name) for name in ("time_s", "voltage_v", "current_a", "curvature_per_cm")}
    fit = ieap.fit(columns, drive=[(0.0, 3.0)], **STRIP)
    assert "drive-contradicted" in {issue.code for issue in fit.issues}
    assert abs(fit["r2_ohm_cm2"].value / PARAMETERS["r2_ohm_cm2"] - 1) < 0.05


class _OfPint:
    """What is asked of a quantity of pint."""

    def __init__(self, numbers, unit, factors):
        self.magnitude, self.units, self.factors = numbers, _Unit(unit), factors

    def m_as(self, unit):
        if unit not in self.factors:
            raise ValueError(f"Cannot convert to {unit}")
        return [number * self.factors[unit] for number in self.magnitude]


class _Unit(str):
    def __format__(self, spec):
        assert spec == "~C"
        return str(self)


def test_arrays_with_units_of_their_own_are_converted_or_refused():
    table = ieap.simulate(PARAMETERS, drive=[(0, 2.0)], area_cm2=0.1, noise=NOISE)
    columns = plain(table)
    known = ieap.fit(columns, area_cm2=0.1).parameters
    milli = {
        "time_s": _OfPint([1e3 * own for own in columns["time_s"]], "ms", {"s": 1e-3}),
        "current": _OfPint([1e3 * own for own in columns["current_a"]], "mA", {}),
    }
    rest = {name: columns[name] for name in ("voltage_v", "curvature_per_cm")}
    found = ieap.fit({**milli, **rest}, area_cm2=0.1)
    assert found["r1"].value == pytest.approx(known["r1_ohm_cm2"].value, rel=1e-6)
    with pytest.raises(ieap.InputError, match="in V, and its name says A") as raised:
        ieap.fit({**columns, "current_a": _OfPint(columns["current_a"], "V", {})}, area_cm2=0.1)
    assert raised.value.place == "column current_a" and raised.value.remedy


@pytest.mark.parametrize("library", ["pint", "astropy", "xarray"])
def test_quantities_of_other_libraries_give_the_same_fit(library):
    numpy = pytest.importorskip("numpy")
    table = ieap.simulate(PARAMETERS, drive=[(0, 2.0)], area_cm2=0.1, noise=NOISE)
    columns = {name: numpy.array(values) for name, values in plain(table).items()}
    known = ieap.fit(columns, area_cm2=0.1)["r1"].value
    rest = {name: columns[name] for name in ("voltage_v", "curvature_per_cm")}
    time_ms, current_ma = 1e3 * columns["time_s"], 1e3 * columns["current_a"]
    if library == "pint":
        quantity = pytest.importorskip("pint").UnitRegistry().Quantity
        given = {**rest, "time_s": quantity(time_ms, "ms"), "current": quantity(current_ma, "mA")}
    elif library == "astropy":
        units = pytest.importorskip("astropy.units")
        given = {**rest, "time_s": time_ms * units.ms, "current": current_ma * units.mA}
    else:
        xarray = pytest.importorskip("xarray")
        arrays = {name: ("time", values) for name, values in rest.items()}
        arrays["current"] = ("time", current_ma, {"units": "mA"})
        given = xarray.Dataset(arrays, coords={"time": ("time", columns["time_s"], {"units": "s"})})
        with pytest.raises(ieap.InputError, match="attribute says mA"):
            ieap.fit({**columns, "current_a": given["current"]}, area_cm2=0.1)
    assert ieap.fit(given, area_cm2=0.1)["r1"].value == pytest.approx(known, rel=1e-6)
