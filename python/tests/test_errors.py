"""Refusals keep place, reason and remedy."""

from __future__ import annotations

import pytest
from conftest import PARAMETERS, STRIP

import ieap


def test_a_file_that_is_none(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("time_s,current_a\n0,1\n1,2\n0.5,3\n0.2,3\n0.1,2\n")
    with pytest.raises(ieap.InputError) as raised:
        ieap.read(file)
    error = raised.value
    assert str(file) in error.place and "line" in error.place
    assert error.reason and error.remedy and error.code == "time-order"
    assert str(error).startswith(error.place) and error.remedy in str(error)
    assert isinstance(error, ValueError)
    with pytest.raises(ieap.CampaignError) as gone:
        ieap.read(tmp_path / "no.csv")
    assert "no.csv" in str(gone.value) and isinstance(gone.value, OSError)


def test_what_a_fit_lacks(table):
    alone = {name: table.column(name) for name in table.column_names}
    with pytest.raises(ieap.InputError) as raised:
        ieap.fit(alone)
    assert raised.value.place == "area_cm2" and "length_mm" in raised.value.remedy
    columns = {"time_s": [0.0, 1.0, 2.0], "current_a": [1e-3, 9e-4, 8e-4]}
    with pytest.raises(ieap.InputError) as raised:
        ieap.fit(columns, **STRIP)
    assert raised.value.code == "no-drive" and "voltage_v" in raised.value.remedy
    with pytest.raises(ieap.InputError, match="usable readings"):
        ieap.fit(columns, **STRIP, voltage_v=1.0)
    with pytest.raises(ieap.InputError, match="lumped-9"):
        ieap.fit(table, **STRIP, model="lumped-9")
    with pytest.raises(ieap.InputError, match="group"):
        ieap.fit(table, **STRIP, model="lumped-2 + faradaic-leak")


def test_what_is_no_table():
    with pytest.raises(ieap.InputError, match="Arrow"):
        ieap.fit(42, **STRIP)
    with pytest.raises(ieap.InputError, match="no number"):
        ieap.fit({"time_s": ["a"], "current_a": [1.0]}, **STRIP)
    with pytest.raises(ieap.InputError) as raised:
        ieap.fit({"time_s": [0.0, 1.0], "current_a": [1.0]}, **STRIP)
    assert raised.value.place == "column current_a"


def test_what_cannot_be_simulated(table):
    with pytest.raises(ieap.InputError, match="no-such"):
        ieap.simulate(PARAMETERS, drive=[(0, 1)], effects={"no-such": {}}, **STRIP)
    with pytest.raises(ieap.InputError, match="volts"):
        ieap.simulate({"volts": 1.0}, drive=[(0, 1)], **STRIP)
    with pytest.raises(ieap.InputError) as raised:
        ieap.simulate(PARAMETERS, drive=[(0, 1)], **STRIP, time_s=[1.0, 1.0])
    assert raised.value.place == "time_s"
    with pytest.raises(ieap.InputError, match="colour"):
        ieap.simulate(PARAMETERS, drive=[(0, 1)], **STRIP, noise={"colour": 1.0})


def test_what_is_no_campaign_or_group(tmp_path, table):
    with pytest.raises(ieap.InputError, match="campaign.toml"):
        ieap.Campaign(tmp_path)
    with pytest.raises(ieap.InputError) as raised:
        ieap.diagnose({"a": table, "b": table}, **STRIP)
    assert raised.value.code == "same-readings" and "b" in raised.value.place
    with pytest.raises(ieap.InputError, match="no run"):
        ieap.diagnose([], **STRIP)


@pytest.mark.parametrize(
    ("named", "place"),
    [
        ({"area_cm2": "0.1"}, "area_cm2"),
        ({"area_cm2": True}, "area_cm2"),
        ({"seed": -1}, "seed"),
        ({"seed": 2**70}, "seed"),
        ({"model": 2}, "model"),
        ({"tags": 3}, "tags"),
        ({"known": 3}, "known"),
    ],
)
def test_an_argument_of_another_kind_is_refused_by_its_name(table, named, place):
    with pytest.raises(ieap.InputError) as raised:
        ieap.fit(table, **{**STRIP, **named})
    assert raised.value.place == place and raised.value.remedy.startswith("give")


def test_numbers_within_arguments_are_refused_by_their_keys():
    for named, place in [({"noise": {"current_a": "a"}}, "noise, current_a"), ({"effects": {"creep": {"x": "a"}}}, "effects, creep, x")]:
        with pytest.raises(ieap.InputError) as raised:
            ieap.simulate(PARAMETERS, drive=[(0, 1)], **STRIP, **named)
        assert raised.value.place == place
    with pytest.raises(ieap.InputError) as raised:
        ieap.simulate({"r1_ohm_cm2": "a"}, drive=[(0, 1)], **STRIP)
    assert raised.value.place == "parameters, r1_ohm_cm2"
    with pytest.raises(ieap.InputError):
        ieap.impedance([1.0], 3)


@pytest.mark.parametrize("draws", [10, 98, 100_001])
def test_draws_are_those_that_the_program_takes(table, draws):
    with pytest.raises(ieap.InputError, match="from 99 to 100000") as raised:
        ieap.diagnose({"a": table}, **STRIP, group="g", draws=draws)
    assert raised.value.place == "draws"


def test_only_what_is_meant_to_be_used_is_listed():
    assert {name for name in dir(ieap) if not name.startswith("__")} == {*ieap.__all__, "spark"}
