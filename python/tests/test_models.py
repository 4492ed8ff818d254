"""Every model that runs are fitted with is simulated as its fit draws it."""

from __future__ import annotations

import json

import pytest
from conftest import NOISE, PARAMETERS, STRIP, program

import ieap

CIRCUIT = {key: value for key, value in PARAMETERS.items() if key not in ("alpha_per_c_cm", "lambda_per_s")}
ALONG = {
    "re_ohm_per_sq": 60.0,
    "rc_ohm_cm2": 300.0,
    "c_f_per_cm2": 0.1,
    "rss_ohm_cm2": 9000.0,
    "mu_per_c": 60.0,
    "lambda_per_s": 0.004,
}
OF_MODEL = {
    "lumped-1": {key: value for key, value in PARAMETERS.items() if key not in ("r2_ohm_cm2", "c2_f_per_cm2")},
    "lumped-2": PARAMETERS,
    "lumped-3": PARAMETERS | {"r3_ohm_cm2": 3000.0, "c3_f_per_cm2": 0.06},
    "lumped-4": PARAMETERS,
    "distributed": ALONG,
    "yagasaki-tamagawa": CIRCUIT
    | {"alpha_final_per_c_cm": 120.0, "e1_per_e0_per_s": 0.01, "e2_per_e0": 0.5, "stiffening_rate_per_s": 0.02},
    "bao-two-way": CIRCUIT | {"k1_per_c_cm": 120.0, "k2_per_c_cm": 40.0, "transport_s": 60.0},
    "kelvin-voigt": CIRCUIT | {"alpha_final_per_c_cm": 120.0, "retardation_s": 40.0},
    "maxwell": CIRCUIT | {"alpha_first_per_c_cm": 120.0, "flow_rate_per_s": 0.003},
    "standard-linear-solid": CIRCUIT
    | {"alpha_first_per_c_cm": 80.0, "alpha_final_per_c_cm": 120.0, "retardation_s": 60.0},
}


def made(model: str) -> ieap.Table:
    """Readings of a model with a little noise."""
    noise = {key: value / 100 for key, value in NOISE.items()}
    if model == "distributed":
        along = {"length_mm": 10, "width_mm": 2, "places_mm": [2, 5, 8], "every_s": 10}
        return ieap.simulate(ALONG, model=model, drive=[(0, 1.5), (400, 0)], **along, noise=noise)
    drive = [(0, 1.5)] if model == "yagasaki-tamagawa" else [(0, 1.5), (400, 0)]
    return ieap.simulate(OF_MODEL[model], model=model, drive=drive, **STRIP, until_s=900, every_s=1, noise=noise)


def furthest(simulated: list[float], fitted: list[float]) -> float:
    """The largest difference, over the largest value."""
    assert len(simulated) == len(fitted) > 50
    return max(abs(one - other) for one, other in zip(simulated, fitted)) / max(map(abs, fitted))


def of_strip(table: ieap.Table, name: str) -> list[float]:
    """A column, or the mean over those at places."""
    columns = [table.column(own) for own in table.column_names if own.split("@")[0] == name]
    return [sum(row) / len(row) for row in zip(*columns)]


def holds_its_curves(fit: ieap.Fit) -> None:
    """The curves are the model's, and the zeros of the instruments that were estimated beside it."""
    zeros = {"current_a": "current_zero_a", "curvature_per_cm": "curvature_zero_per_cm"}
    for name, curve in (("current_a", fit.current), ("curvature_per_cm", fit.curvature)):
        own = fit.eval(time_s=curve.column("time_s"))
        zero = fit.nuisances[zeros[name]].value if zeros[name] in fit.nuisances else 0.0
        fitted = [value - zero for value in curve.column("fitted")]
        assert furthest(of_strip(own, name), fitted) < 1e-9, (fit.model, name)


def test_every_model_is_tried():
    listed = json.loads(program("models", "--json"))["models"]
    assert sorted(OF_MODEL) == sorted(own["id"] for own in listed)


@pytest.mark.parametrize("model", OF_MODEL)
def test_a_fit_is_simulated_as_it_is_drawn(model):
    fit = ieap.fit(made(model), model=model)
    holds_its_curves(fit)
    # Another drive is one call away, and what comes of it can be fitted.
    again = ieap.simulate(fit, drive=[(0, 1.0)], until_s=900, every_s=10, noise={"current_a": 1e-8})
    assert again.num_rows == 91 and ieap.fit(again, model=model).model == model


@pytest.mark.parametrize("model", ["lumped-2", "bao-two-way"])
def test_edges_that_only_readings_tell_are_where_the_fit_takes_them(model):
    table = made(model)
    columns = {name: table.column(name) for name in table.column_names}
    columns["time_s"] = [time_s + 0.3 for time_s in columns["time_s"]]
    holds_its_curves(ieap.fit(columns, area_cm2=0.1, model=model))


@pytest.mark.parametrize("model", ["lumped-2", "lumped-3", "lumped-4"])
def test_branches_that_are_not_there_are_not_asked_for(model):
    fit = ieap.fit(made("lumped-1"), model=model)
    assert fit["r2_ohm_cm2"].value is None
    if fit["r1_ohm_cm2"].value is None:  # A branch more may be there or chance: then nothing is drawn of the parts.
        with pytest.raises(ieap.InputError, match="not determined: r1_ohm_cm2"):
            fit.eval()
    else:
        holds_its_curves(fit)


def test_what_is_needed_and_not_known_is_said():
    table = made("lumped-2")
    bare = ieap.fit({name: table.column(name) for name in ("time_s", "voltage_v", "current_a")}, area_cm2=0.1, model="maxwell")
    with pytest.raises(ieap.InputError, match="not determined: alpha_first_per_c_cm: .*no curvature.*model='maxwell'"):
        ieap.simulate(bare)
    with pytest.raises(ieap.InputError, match="there is no flow_rate_per_s, which maxwell needs"):
        ieap.simulate(CIRCUIT | {"alpha_first_per_c_cm": 1.0}, model="maxwell", drive=[(0, 1)], **STRIP)
    with pytest.raises(ieap.InputError, match="found alpha_per_c_cm"):
        ieap.simulate(PARAMETERS, model="maxwell", drive=[(0, 1)], **STRIP)
    with pytest.raises(ieap.InputError, match="give one of lumped-1"):
        ieap.simulate(PARAMETERS, model="no-such-model", drive=[(0, 1)], **STRIP)
    with pytest.raises(ieap.InputError, match="the drive of this run has several"):
        ieap.simulate(OF_MODEL["yagasaki-tamagawa"], model="yagasaki-tamagawa", drive=[(0, 1), (9, 0)], **STRIP)
    with pytest.raises(ieap.InputError, match="effects act on lumped models"):
        ieap.simulate(OF_MODEL["maxwell"], model="maxwell", drive=[(0, 1)], **STRIP, effects={"creep": {}})
    with pytest.raises(ieap.InputError, match="needs the free length"):
        ieap.simulate(ALONG, model="distributed", drive=[(0, 1)], area_cm2=0.2)
    with pytest.raises(ieap.InputError, match="an open circuit from 9 s on"):
        ieap.simulate(ALONG, model="distributed", drive=[(0, 1), (9, None)], **STRIP)
    with pytest.raises(ieap.InputError, match="give places from 0 to 5 mm"):
        ieap.simulate(ALONG, model="distributed", drive=[(0, 1)], **STRIP, places_mm=[7])
    with pytest.raises(ieap.InputError, match="leave it out"):
        ieap.simulate(ieap.fit(table), model="maxwell")


def test_a_break_of_the_electrodes_is_simulated_with_the_strip():
    broken = ALONG | {"contact-break.place_mm": 4.0, "contact-break.resistance_factor": 8.0}
    strip = {"length_mm": 10, "width_mm": 2, "places_mm": [1, 2, 3, 4, 5, 6, 7, 8, 9], "every_s": 10}
    table = ieap.simulate(broken, model="distributed", drive=[(0, 1.5), (400, 0)], **strip, noise=NOISE)
    fit = ieap.fit(table, model="distributed")
    assert fit["contact-break.place_mm"].value == pytest.approx(4.0, abs=1.0)
    holds_its_curves(fit)
    with pytest.raises(ieap.InputError, match="there is no contact-break.resistance_factor"):
        ieap.simulate(ALONG | {"contact-break.place_mm": 4.0}, model="distributed", drive=[(0, 1)], **STRIP)
