"""What a user sees of tables, fits and curves."""

from __future__ import annotations

import subprocess
import sys

import pytest
from conftest import PARAMETERS, STRIP

import ieap


def test_a_table_shows_what_its_reader_saw(campaign):
    table = ieap.read(campaign / "runs/a.csv")
    described = table.describe()
    assert described["format"] == "csv" or described["format"]
    assert [column["name"] for column in described["columns"]] == ["voltage_v", "current_a", "curvature_per_cm"]
    assert described["columns"][1]["unit"] == "A"
    assert "311 rows" in repr(table) and "current_a" in repr(table)
    assert len(table) == 311 and table.column("time_s")[0] == -10.0
    with pytest.raises(ieap.InputError):
        table.column("nothing")
    with pytest.raises(ieap.InputError):
        ieap.read(campaign / "runs/a.csv", table="CURVE")


def test_units_in_names_are_converted(table):
    plain = {name: table.column(name) for name in table.column_names}
    other = {
        "Time (s)": plain["time_s"],
        "E/V": plain["voltage_v"],
        "I/mA": [1e3 * current for current in plain["current_a"]],
        "curvature_per_cm": plain["curvature_per_cm"],
    }
    own, same = (ieap.fit(columns, **STRIP) for columns in (plain, other))
    assert own["r1_ohm_cm2"].value == pytest.approx(same["r1_ohm_cm2"].value, rel=1e-6)


def test_a_fit_reads_well_and_finds_what_was_simulated(table):
    fit = ieap.fit(table, **STRIP, run="my run")
    text = repr(fit)
    assert "my run" in text and "r1_ohm_cm2" in text and "95 %" in text and "R2 of the current" in text
    for key in ("r1_ohm_cm2", "c2_f_per_cm2", "alpha_per_c_cm"):
        own = fit[key]
        # Five standard errors: the noise of this seed is one draw of many.
        assert abs(own.value - PARAMETERS[key]) < 5 * own.standard_error
    current = fit.current.to_dict()
    assert set(current) == {"time_s", "current_a", "fitted", "residual", "residual_sigma"}
    assert len(current["fitted"]) == len(current["time_s"]) > 100
    assert fit.curvature.num_rows > 0 and fit.seconds > 0 and fit.converged
    with pytest.raises(KeyError):
        fit["no_such_parameter"]


def test_an_estimate_says_what_is_not_determined():
    bounded = ieap.Estimate(None, None, 5e4, None, False, "the current does not end")
    assert str(bounded) == "above 5e+04 (the current does not end)"
    assert str(ieap.Estimate(None, None, None, None, False, None)) == "not determined"
    assert "95 %: 0.9 .. open" in str(ieap.Estimate(1.0, 0.1, 0.9, None, False, None))


def test_a_fit_can_be_simulated_and_what_is_not_known_is_not(table):
    fit = ieap.fit(table, **STRIP)
    curves = ieap.simulate(fit, drive=[(0, 2.0), (300, 0.0)])
    assert curves.num_rows == 601 and curves.column("time_s")[-1] == 600.0
    leaky = ieap.simulate(
        fit,
        drive=[(0, 2.0), (300, 0.0)],
        effects={"faradaic-leak": {"leak_current_a_per_cm2": 1e-4, "onset_v": 1.2, "slope_v": 0.15}},
    )
    before, after = curves.column("current_a")[200], leaky.column("current_a")[200]
    assert after > before
    opened = ieap.simulate(fit, drive=[(0, 2.0), (100, None)])
    assert "open_circuit" in opened.column_names and opened.column("voltage_v")[-1] is None
    assert "not measured" in repr(curves)


def test_the_package_needs_no_other(table):
    """The interpreter of this test has pyarrow and others; one that is forbidden them still fits."""
    code = """
import sys
for name in ("numpy", "pandas", "pyarrow", "polars"):
    sys.modules[name] = None
import ieap
t = ieap.simulate({"r1_ohm_cm2": 30, "c1_f_per_cm2": 0.02, "alpha_per_c_cm": 100}, drive=[(0, 1.0)], area_cm2=0.1)
print(ieap.fit(t, area_cm2=0.1, model="lumped-1"))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0 and "r1_ohm_cm2" in done.stdout, done.stderr


def test_the_program_is_there():
    done = subprocess.run([sys.executable, "-m", "ieap", "models"], capture_output=True, text=True)
    assert done.returncode == 0 and "lumped-2" in done.stdout
    wrong = subprocess.run([sys.executable, "-m", "ieap", "no-such-verb"], capture_output=True, text=True)
    assert wrong.returncode == 2
