"""Results as people of lmfit and pandas use them."""

from __future__ import annotations

import copy
import pickle

import pytest
from conftest import NOISE, PARAMETERS, STRIP, program

import ieap


@pytest.fixture(scope="module")
def fit():
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5), (900, 0.0)], **STRIP, every_s=0.5, noise=NOISE)
    return ieap.fit(table, run="one <run>")


def test_a_fit_is_gone_over_as_a_mapping(fit):
    assert list(fit) == list(fit.parameters) and len(fit) == len(fit.parameters)
    assert "r1_ohm_cm2" in fit and "r1" in fit and "lambda" in fit
    assert fit["r1"] == fit["r1_ohm_cm2"]
    assert "q" not in fit and "volts" not in fit and 3 not in fit
    with pytest.raises(KeyError, match="alpha_per_c_cm"):
        fit["volts"]
    for kind in ("pandas", "polars"):
        pytest.importorskip(kind)
        frame = fit.to_dataframe(kind)
        assert list(frame["parameter"]) == list(fit) and frame["value"][0] == fit["r1"].value
    with pytest.raises(ieap.InputError, match="pandas or polars"):
        fit.to_dataframe("excel")
    assert "r1_ohm_cm2" in fit.summary()
    assert "one &lt;run&gt;" in fit._repr_html_() and "<run>" not in fit._repr_html_()


def test_an_estimate_is_a_number_among_numbers(fit):
    r1, c1 = fit["r1"], fit["c1"]
    assert f"{r1:.3g}" == f"{float(r1):.3g}" and f"{r1}" == str(r1)
    assert 2 * r1 == r1 * 2 == r1 + r1 == 2 * r1.value and r1 / r1 == 1.0 and 1 / r1 == r1**-1
    assert r1 - c1 == -(c1 - r1) and abs(-r1) == r1.value


def test_what_errs_together_is_calculated_together(fit):
    pytest.importorskip("uncertainties")
    found = fit.correlated_values()
    assert found["r1_ohm_cm2"].n == fit["r1"].value
    product = found["r1_ohm_cm2"] * found["c1_f_per_cm2"]
    assert product.s == pytest.approx(fit["tau1"].standard_error, rel=0.05), "tau1 is their product, but for what the noise remembers"


def test_curves_have_every_reading(fit):
    rows = 3601
    for curve, key in [(fit.current, "current_a"), (fit.curvature, "curvature_per_cm")]:
        assert len(curve) == rows, "no reading is thinned away"
        sigma = next(own.standard_deviation for own in fit.noise if own.quantity in key)
        pairs = zip(curve.column(key), curve.column("fitted"), curve.column("residual_sigma"))
        assert all(abs((own - fitted) / sigma - left) < 1e-9 for own, fitted, left in pairs)


def test_what_is_known_is_taken_and_said():
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5), (900, 0.0)], **STRIP, every_s=0.5, noise=NOISE)
    r1 = PARAMETERS["r1_ohm_cm2"]
    held = ieap.fit(table, known={"r1_ohm_cm2": r1})
    assert ieap.fit(table, known={"r1": r1})["r1"] == held["r1"]
    assert held["r1"].value == pytest.approx(r1) and held["r1"].standard_error == 0.0
    about = ieap.fit(table, known={"r1_ohm_cm2": (r1, 0.01 * r1), "lambda_per_s": "1e-5..1"})
    assert {issue.code for issue in about.issues} >= {"known-parameter"}
    wrong = ieap.fit(table, known={"r1_ohm_cm2": (3.0 * r1, 0.01 * r1)})
    assert "known-contradicted" in {issue.code for issue in wrong.issues}
    rows = ieap.fit_many(_rows(table), known={"r1_ohm_cm2": r1})
    assert rows.column("converged") == [True]
    for known in ({"r1_ohm_cm2": "much"}, {"r1_ohm_cm2": (1.0, -1.0)}, {"volts": 1.0}):
        with pytest.raises(ieap.InputError):
            ieap.fit(table, known=known)
    # Two limits are no number with its error.
    with pytest.raises(ieap.InputError, match="standard error of 200") as raised:
        ieap.fit(table, known={"r1_ohm_cm2": (60, 200)})
    assert '"60..200"' in raised.value.remedy
    between = ieap.fit(table, known={"r1_ohm_cm2": "60..200"})
    assert "known-parameter" in {issue.code for issue in between.issues}


def _rows(table):
    pyarrow = pytest.importorskip("pyarrow")
    names = ["time_s", "current_a", "curvature_per_cm"]
    lists = {name: pyarrow.array([list(table.column(name))]) for name in names}
    drive = {"drive_start_s": pyarrow.array([[0.0, 900.0]]), "drive_voltage_v": pyarrow.array([[1.5, 0.0]])}
    strip = {name: [value] for name, value in STRIP.items()}
    return pyarrow.table({**lists, **drive, **strip, "run": ["a"]})


def test_a_fit_gives_its_model_at_other_times_and_drives(fit):
    own = fit.eval()
    fitted = fit.current.column("fitted")
    largest = max(map(abs, fitted))
    assert all(abs(one - other) < 2e-4 * largest for one, other in zip(own.column("current_a"), fitted))
    other = fit.eval(time_s=[0.0, 10.0, 20.0], drive=[(0, -1.5)])
    first = fit.eval(time_s=[0.0, 10.0, 20.0], drive=[(0, 1.5)])
    assert other.column("current_a") == pytest.approx([-own for own in first.column("current_a")])


def test_everything_is_pickled_and_copied(fit, campaign, findings):
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, noise=NOISE)
    for again in (pickle.loads(pickle.dumps(table)), copy.deepcopy(table)):
        assert again.describe() == table.describe()
        assert all(again.column(name) == table.column(name) for name in table.column_names)
        assert ieap.fit(again).parameters == ieap.fit(table).parameters
    for again in (pickle.loads(pickle.dumps(fit)), copy.deepcopy(fit)):
        assert again.to_dict() == fit.to_dict() and again.drive == fit.drive
        assert again.current.to_dict() == fit.current.to_dict()
    opened = ieap.Campaign(campaign)
    finding = ieap.Finding(findings["groups"][0])
    assert pickle.loads(pickle.dumps(finding)).to_dict() == finding.to_dict()
    assert repr(pickle.loads(pickle.dumps(opened))) == repr(opened)
    pytest.importorskip("pyarrow")
    runs = opened.table("runs")
    assert pickle.loads(pickle.dumps(runs)).to_dict() == runs.to_dict()
    assert pickle.loads(pickle.dumps(fit["r1"])) == fit["r1"]


def test_findings_and_campaigns_show_themselves(campaign, findings):
    finding = ieap.Finding(findings["groups"][0])
    assert finding.verdict in finding._repr_html_() and finding.verdict in finding.summary()
    assert set(finding.rows()) == {"cause", "probability"}
    opened = ieap.Campaign(campaign)
    assert "runs/a.csv" in opened._repr_html_()
    many = opened.readings_many()
    assert list(many) == ["runs/a.csv", "runs/b.csv"]
    one = opened.readings("runs/a.csv")
    assert many["runs/a.csv"].column("current_a") == one.column("current_a")
    stored = next(own for own in opened.fits().fits if own.run == "runs/a.csv")
    assert ieap.fit(one).parameters == stored.parameters
    assert program("export", str(campaign), "--what", "laws", "-o", "-")


def test_a_fit_is_drawn(fit, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    figure = fit.plot()
    assert len(figure.axes) == 4
    drawn = figure.axes[0].lines[0].get_xydata()
    assert drawn[:, 1].tolist() == fit.current["current_a"].tolist()
    figure.savefig(tmp_path / "fit.png")


def test_covariance_and_correlation(table):
    fit = ieap.fit(table, **STRIP)
    covariance, correlation = fit.covariance, fit.correlation
    assert {"r1_ohm_cm2", "alpha_per_c_cm"} <= set(covariance) <= set(fit)
    for key, row in covariance.items():
        assert row[key] == pytest.approx(fit[key].standard_error ** 2)
        assert correlation[key][key] == pytest.approx(1.0)
        assert all(row[other] == pytest.approx(covariance[other][key]) and abs(correlation[key][other]) < 1.0 + 1e-12 for other in row)
    # What grows the charge shrinks the bending per charge.
    assert correlation["alpha_per_c_cm"]["lambda_per_s"] > 0.0
    assert ieap.fit(table, **STRIP, model="distributed").covariance is None
