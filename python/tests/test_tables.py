"""Tables and results as people of numpy, pandas and lmfit use them."""

from __future__ import annotations

import json
import math
import pickle
import subprocess
import sys

import pytest
from conftest import NOISE, PARAMETERS, STRIP, program

import ieap

numpy = pytest.importorskip("numpy")


def test_columns_are_arrays_in_their_place(table):
    current = table["current_a"]
    assert isinstance(current, numpy.ndarray) and current.dtype == float and not current.flags.writeable
    assert current.__array_interface__["data"][0] == table._readings._address("current_a")
    assert (1e3 * current).tolist() == [1e3 * own for own in table.column("current_a")]
    kept = current.copy()
    del table
    assert (current == kept).all(), "the array keeps its memory"


def test_a_table_is_gone_over_as_a_mapping(table):
    assert list(table) == table.column_names and "time_s" in table and "volts" not in table
    assert len(table) == table.num_rows == 301
    assert ieap.fit(dict(table), **STRIP).n_samples == 602
    with pytest.raises(ieap.InputError, match="no such column"):
        table["volts"]


def test_empty_cells_are_nan_or_none(campaign, fits):
    own = ieap.Campaign(campaign)
    runs, long = own.table("runs"), own.table("fits")
    assert runs["run"].dtype == object and (runs["run"] == "runs/a.csv").sum() == 1
    assert runs["voltage_v"].dtype == float
    assert math.isnan(long["low_95"][[cell is None for cell in long.column("low_95")]].sum()) or None not in long.column("low_95")
    columns = {"time_s": [0.0, 1.0, 2.0], "current_a": [1.0, 2.0, 3.0], "curvature_per_cm": [0.1, None, 0.3]}
    curvature = ieap._inputs.table_of(columns)["curvature_per_cm"]
    assert curvature[0] == 0.1 and math.isnan(curvature[1])


def test_tables_become_data_frames(campaign, fits):
    runs = ieap.Campaign(campaign).table("runs")
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    frame = runs.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and list(frame.columns) == list(runs) and len(frame) == 2
    assert isinstance(runs.to_polars(), polars.DataFrame) and runs.to_polars()["run"].to_list() == runs.column("run")
    if hasattr(pandas.DataFrame, "from_arrow"):
        assert list(pandas.DataFrame.from_arrow(runs).columns) == list(runs)
    with pytest.raises(ieap.InputError, match="to_pandas"):
        pandas.DataFrame(runs)
    assert "<table>" in runs._repr_html_() and "runs/a.csv" in runs._repr_html_()
    assert pickle.loads(pickle.dumps(runs)).to_dict() == runs.to_dict()


def test_without_numpy_columns_are_arrays_of_the_standard_library():
    code = """
import sys
for name in ("numpy", "pandas", "pyarrow", "polars"):
    sys.modules[name] = None
from array import array
import ieap
t = ieap.simulate({"r1_ohm_cm2": 30, "c1_f_per_cm2": 0.02, "alpha_per_c_cm": 100}, drive=[(0, 1.0)], area_cm2=0.1)
assert isinstance(t["current_a"], array) and t["current_a"].tolist() == t.column("current_a")
assert isinstance(ieap.fit(t).residuals["current_a"], array)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_every_table_of_the_registries_is_there(campaign, findings):
    own = ieap.Campaign(campaign)
    listed = {entry["name"] for entry in json.loads(program("list", "tables", "--json"))["tables"]}
    tables = own.tables()
    assert listed | {"tags", "fits-wide", "monitoring", "dma", "columns"} == set(tables) and all(tables.values())
    for name in tables:
        assert own.table(name).column_names, name
    with pytest.raises(ieap.InputError, match="relaxation-times") as raised:
        own.table("no-such-table")
    assert raised.value.place == "table"


def test_a_table_of_pages_has_its_numbers_in_full(campaign, fits):
    found = ieap.Campaign(campaign).table("table5")
    told = json.loads(program("table", "table5", "--format", "json", str(campaign)))
    assert len(found) == len(told["rows"])
    alone = [name for name in found if name.endswith("_standard_error")]
    assert alone and all(name.removesuffix("_standard_error") in found for name in alone)


def test_an_estimate_is_a_number_with_its_unit(table):
    fit = ieap.fit(table, **STRIP)
    assert numpy.log(fit["r1"]) == numpy.log(fit["r1"].value) and (numpy.ones(2) * fit["r1"]).dtype == float
    assert float(fit["r1"]) == fit["r1"].value and fit["r1"].unit == "Ohm cm2" and fit["alpha"].unit == "1/(C cm)"
    assert math.isnan(float(ieap.Estimate(None, None, None, None)))
    assert numpy.array([fit[key] for key in fit], dtype=float).shape == (len(fit),)


def test_residuals_and_criteria_tell_models_apart():
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5), (900, 0.0)], **STRIP, every_s=0.5, noise=NOISE)
    fits = {model: ieap.fit(table, model=model) for model in ("lumped-1", "lumped-2", "lumped-3")}
    fit = fits["lumped-2"]
    for name, curve in (("current_a", fit.current), ("curvature_per_cm", fit.curvature)):
        left = fit.residuals[name]
        assert left == pytest.approx(curve[name] - curve["fitted"])
        assert left.std() == pytest.approx(NOISE[name], rel=0.1)
    # Of twice 3601 readings whose noise is known, -2 ln L is about their number.
    assert fit.n_parameters == 7 and fit.aic - 14 == pytest.approx(2 * 3601, rel=0.1)
    assert fit.bic - fit.aic == pytest.approx(7 * (math.log(2 * 3601) - 2), rel=0.02)
    assert min(fits, key=lambda model: fits[model].bic) == "lumped-2"
    assert fits["lumped-1"].aic > fit.aic + 100


def spectrum():
    """A resistance beside a branch: R parallel to C with R in series."""
    frequency_hz = numpy.logspace(4, -1, 40)
    omega = 2j * numpy.pi * frequency_hz
    return frequency_hz, 20 + 100 / (1 + omega * 100 * 1e-3)


def test_a_spectrum_is_analysed_without_a_campaign():
    frequency_hz, z_ohm = spectrum()
    found = ieap.impedance(frequency_hz, z_ohm, circuits=["R0-p(R1,C1)"])
    assert found.frequencies == 40 and found.kramers_kronig.verdict == "consistent"
    (own,) = [fit for fit in found.circuits if fit.circuit == "R0-p(R1,C1)"]
    values = {key: float(estimate) for key, estimate in own.parameters.items()}
    assert sorted(values.values())[-2:] == pytest.approx([20, 100], rel=1e-3) and own.describes
    assert any(estimate.unit == "Ohm" for estimate in own.parameters.values())
    columns = {"frequency_hz": frequency_hz, "impedance_magnitude_ohm": abs(z_ohm), "impedance_phase_degree": numpy.degrees(numpy.angle(z_ohm)),
               "time_s": numpy.arange(40.0)}
    again = ieap.impedance(columns)
    assert again.best == ieap.impedance(frequency_hz, list(z_ohm)).best
    assert pickle.loads(pickle.dumps(found)) == found
    with pytest.raises(ieap.InputError, match="too few"):
        ieap.impedance(frequency_hz[:3], z_ohm[:3])
    with pytest.raises(ieap.InputError, match="one is needed"):
        ieap.impedance({"time_s": [0.0, 1.0], "current_a": [1.0, 2.0]})


def test_cycles_without_a_campaign():
    drive = [(10.0 * k, 1.0 if k % 2 == 0 else -1.0) for k in range(20)]
    table = ieap.simulate(PARAMETERS, drive=drive, **STRIP, until_s=200, every_s=0.1, noise=NOISE)
    found = ieap.cycles(table)
    assert found["cycle"].tolist() == list(range(1, len(found) + 1)) and len(found) >= 9
    settled = found["amplitude_per_cm"][3:]
    assert (settled > 0).all() and {"charge_in_c", "charge_in_c_low_95", "charge_in_c_reason"} <= set(found)
    # As much flows out as in, but for what leaks.
    assert found["coulombic_efficiency_percent"][5] == pytest.approx(100, abs=20)
    with pytest.raises(ieap.InputError, match="no train") as raised:
        ieap.cycles(ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP))
    assert raised.value.remedy


def test_results_say_what_they_hold(campaign, findings):
    group = ieap.Campaign(campaign).diagnosis().groups[0]
    assert isinstance(group, ieap.Finding) and group.account.to_dict() == group.to_dict()["account"]
    with pytest.raises(AttributeError, match="one of"):
        group.weight
    converted = ieap.convert("displacement=1.2mm", length_mm=5)
    assert isinstance(converted, ieap.Record) and "Its value" in type(converted).value.__doc__
