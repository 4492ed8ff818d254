"""The package gives what the program gives, to the last bit."""

from __future__ import annotations

import json

import pytest
from conftest import NOISE, PARAMETERS, STRIP, program

import ieap

# What `FitAtHand` has in common with a fit of a campaign.
SAME = ("model", "model_version", "code_version", "data_hash", "converged", "why_stopped", "method", "n_samples",
        "parameters", "r_squared_current", "r_squared_curvature", "noise")


def of_program(fits: dict, run: str) -> dict:
    (found,) = [fit for fit in fits["fits"] if fit["run"] == run]
    return found


def test_a_fit_of_a_file(campaign, fits):
    fit = ieap.fit(ieap.read(campaign / "runs/a.csv"), **STRIP)
    stored = of_program(fits, "runs/a.csv")
    assert {key: fit.to_dict()[key] for key in SAME} == {key: stored[key] for key in SAME}
    assert all(issue.to_dict() in stored["issues"] for issue in fit.issues)


def test_a_fit_of_lists_of_numbers(campaign, fits):
    table = ieap.read(campaign / "runs/b.csv")
    columns = {name: table.column(name) for name in table.column_names}
    assert set(columns) == {"time_s", "voltage_v", "current_a", "curvature_per_cm"}
    fit = ieap.fit(columns, area_cm2=0.1, length_mm=5)
    stored = of_program(fits, "runs/b.csv")
    assert fit.to_dict()["parameters"] == stored["parameters"]
    assert fit.to_dict()["data_hash"] == stored["data_hash"]


def test_a_fit_with_other_models_and_methods(campaign):
    run = campaign / "runs/a.csv"
    stored = json.loads(program("fit", "--json", "--model", "lumped-1", "--simultaneous", str(campaign)))
    fit = ieap.fit(ieap.read(run), **STRIP, model="lumped-1", simultaneous=True)
    assert fit.to_dict()["parameters"] == of_program(stored, "runs/a.csv")["parameters"]
    program("fit", "--model", "lumped-2", str(campaign))


def test_a_campaign_is_read_as_the_program_prints_it(campaign, fits):
    own = ieap.Campaign(campaign)
    fit = ieap.fit(own.readings("runs/a.csv"))
    assert fit.to_dict()["parameters"] == of_program(fits, "runs/a.csv")["parameters"]
    again = json.loads(program("fit", "--json", str(campaign)))
    assert own.fits().to_dict() == again
    assert [fit.run for fit in own.fits().fits] == ["runs/a.csv", "runs/b.csv"]
    long = own.table("fits").to_dict()
    first = {(run, key): value for run, key, value in zip(long["run"], long["parameter"], long["value"])}
    assert first["runs/a.csv", "r1_ohm_cm2"] == of_program(again, "runs/a.csv")["parameters"]["r1_ohm_cm2"]["value"]
    assert sorted(own.table("runs")["run"]) == ["runs/a.csv", "runs/b.csv"]
    assert len(own.table("conditions")) == 2 and len(own.table("fits-wide")) == 2
    assert "sample" in own.table("tags")["key"]
    assert "campaign" in repr(own).lower()


def test_a_diagnosis(campaign, findings):
    (group,) = findings["groups"]
    runs = {name: ieap.read(campaign / name) for name in group["runs"]}
    finding = ieap.diagnose(runs, **STRIP, group=group["group"], draws=99)
    assert finding.to_dict() == group
    assert finding.verdict == group["verdict"] and finding.sentence in repr(finding)
    own = ieap.Campaign(campaign)
    for said in (group["group"], "S in air"):
        assert own.finding(said).to_dict() == group
    assert group["verdict"] in own.table("findings").column("verdict")


def test_simulated_readings(campaign):
    times = [float(t) for t in range(-10, 301)]
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, time_s=times, noise=NOISE, seed=7)
    rows = [line.split(",") for line in (campaign / "runs/a.csv").read_text().splitlines()[2:]]
    assert len(rows) == table.num_rows
    # The program prints six and five digits.
    for row, current, curvature in zip(rows, table.column("current_a"), table.column("curvature_per_cm")):
        assert float(row[2]) == pytest.approx(current, rel=1e-5, abs=1e-12)
        assert float(row[3]) == pytest.approx(curvature, abs=5.001e-6)


def test_what_is_predicted_and_driven(campaign, fits):
    own = ieap.Campaign(campaign)
    sample = ("--sample", "S", str(campaign), "--json")
    told = json.loads(program("predict", "--voltage", "1.5V", "--at", "10,60", "--length", "6±0.1mm", "--width", "2mm", *sample))
    assert own.predict("S", voltage_v=1.5, at_s=[10, 60], length_mm=(6, 0.1), width_mm=2).to_dict() == told
    assert own.predict("S", drive=[(0, 1.5)], at_s=[10, 60], length_mm=(6, 0.1), width_mm=2).to_dict() == told
    told = json.loads(program("drive", "--hold", "0.2mm", "--for", "60s", *sample))
    assert own.drive("S", hold_mm=0.2, for_s=60).to_dict() == told
    with pytest.raises(ieap.InputError, match="give one of both"):
        own.predict("S", voltage_v=1.5, drive=[(0, 1.5)])
    with pytest.raises(ieap.InputError, match="give hold_mm and for_s"):
        own.drive("S", hold_mm=0.2)
    with pytest.raises(ieap.InputError, match="times that increase"):
        own.drive("S", course=[(60, 0.1), (0, 0.2)])
    with pytest.raises(ieap.InputError, match="give hold_mm and for_s"):
        own.drive("S", hold_mm=0.2, course=[(0, 0.1), (60, 0.2)])
    with pytest.raises(ieap.InputError, match="give a segment or more"):
        own.predict("S", drive=[])
    with pytest.raises(ieap.InputError, match="its error is not used here"):
        own.predict("S", voltage_v=1.5, relative_humidity_percent=(40, 2))
    for wrong in ([(0, 40), (0, 50)], [(0, 130)]):
        with pytest.raises(ieap.InputError, match="relative_humidity_course"):
            own.predict("S", voltage_v=1.5, relative_humidity_course=wrong)
    with pytest.raises(ieap.InputError, match="rh-course|humidity"):
        own.predict("S", voltage_v=1.5, relative_humidity_course=[(0, 40), (60, 50)])
    with pytest.raises(ieap.InputError, match="no-such-sample"):
        own.predict("no-such-sample", voltage_v=1.5)


def test_conversions_tables_and_spectra(campaign, fits):
    told = json.loads(program("convert", "displacement=1.2±0.05mm", "--length", "5±0.1mm", "--json"))
    converted = ieap.convert("displacement=1.2±0.05mm", length_mm=(5, 0.1))
    assert converted.to_dict() == told
    curvature = converted.values["curvature_per_cm"]
    assert (float(curvature), curvature.unit) == (told["values"]["curvature_per_cm"]["value"], "1/cm")
    with pytest.raises(ieap.InputError, match="standard error"):
        ieap.convert("displacement=1.2mm", length_mm="5mm")
    own = ieap.Campaign(campaign)
    assert own.impedance().to_dict() == json.loads(program("impedance", "--json", str(campaign)))
    text = "R0-p(R1,CPE1)"
    asked = program("impedance", "--json", "--circuit", text, str(campaign))
    assert own.impedance(circuits=[text]).to_dict() == json.loads(asked)
    with pytest.raises(ieap.InputError, match="character 4"):
        own.impedance(circuits=["R0-Q1"])


def test_models_compared(campaign, fits):
    own = ieap.Campaign(campaign)
    models = ["lumped-2", "maxwell"]
    now = own.compare(models).to_dict()
    told = json.loads(program("compare", "--models", ",".join(models), "--json", str(campaign)))
    assert now["conditions"][0]["sentence"] and without_times(now) == without_times(told)
    # What is stored is taken, the times that it took with it.
    assert own.compare(models).to_dict() == told
    assert {run.run for run in own.compare().runs} == {"runs/a.csv", "runs/b.csv"}
    assert own.compare(models).to_dict() == told, "nothing was stored"
    with pytest.raises(ieap.InputError, match="models: found no-such-model. To mend it: give models of a strip as a whole"):
        own.compare(["no-such-model"])


def without_times(document: object) -> object:
    """The same without the times that fits took, which differ from call to call."""
    if isinstance(document, dict):
        return {key: without_times(own) for key, own in document.items() if key != "seconds"}
    return [without_times(own) for own in document] if isinstance(document, list) else document
