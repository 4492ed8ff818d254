"""Runs leave a campaign as rows, are fitted elsewhere, and come back as what the campaign itself would have stored."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from conftest import program

import ieap

pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")


def unfitted(campaign: Path, folder: Path) -> Path:
    """The same runs in a campaign that has no fits."""
    folder.mkdir()
    shutil.copy(campaign / "campaign.toml", folder)
    shutil.copytree(campaign / "runs", folder / "runs")
    program("ingest", str(folder))
    return folder


def rows_of(campaign: Path, folder: Path) -> Path:
    """Its runs, one row each."""
    program("-C", str(campaign), "export", "--what", "traces", "--partitioned", "-o", str(folder))
    return folder


def brought_back(campaign: Path, results: Path) -> dict:
    return json.loads(program("-C", str(campaign), "import-fits", str(results), "--json"))["imported"]


def same_fits(campaign: Path, fits: dict) -> None:
    """Nothing is left to fit, and the fits are those of the program."""
    own = json.loads(program("fit", "--json", str(campaign)))
    assert own["fits"] == fits["fits"] and len(own["fits"]) == 2


@pytest.fixture
def away(campaign: Path, fits: dict, tmp_path: Path) -> Path:
    return unfitted(campaign, tmp_path / "away")


def test_what_was_fitted_in_this_process_comes_back(away, fits, tmp_path):
    rows = parquet.read_table(rows_of(away, tmp_path / "rows"))
    assert rows.column("material").to_pylist() == ["M", "M"]
    fitted = pa.table(ieap.fit_many(rows))
    assert fitted.column("run").to_pylist() == ["runs/a.csv", "runs/b.csv"] and not any(fitted.column("issue").to_pylist())
    assert all(json.loads(fit)["curves"] == [] for fit in fitted.column("fit").to_pylist()), "they follow from the readings"
    parquet.write_table(fitted, tmp_path / "fits.parquet")
    summary = brought_back(away, tmp_path / "fits.parquet")
    assert (summary["imported"], summary["refused"], summary["failed"]) == (2, [], [])
    same_fits(away, fits)


def test_rows_of_a_campaign_are_those_of_the_export(away, tmp_path):
    written = parquet.read_table(rows_of(away, tmp_path / "rows"))
    rows = ieap.Campaign(away).fit_rows()
    assert set(rows.column_names) == set(written.column_names)
    in_order = lambda table: sorted(table.select(written.column_names).to_pylist(), key=lambda row: row["run"])
    assert in_order(rows) == in_order(written)
    assert pa.table(ieap.fit_many(rows)).column("run").to_pylist() == rows.column("run").to_pylist()
    one = ieap.Campaign(away).fit_rows(["runs/b.csv"])
    assert one.column("run").to_pylist() == ["runs/b.csv"]
    with pytest.raises(ieap.IeapError, match="runs/c.csv"):
        ieap.Campaign(away).fit_rows(["runs/c.csv"])


def test_another_model_is_asked_for_as_in_the_campaign(away, tmp_path):
    rows = parquet.read_table(rows_of(away, tmp_path / "rows"))
    parquet.write_table(pa.table(ieap.fit_many(rows, model="lumped-1")), tmp_path / "fits.parquet")
    assert brought_back(away, tmp_path / "fits.parquet")["imported"] == 2
    found = json.loads(program("fit", "--json", str(away)))["fits"]
    assert [fit["model"] for fit in found] == ["lumped-1", "lumped-1"]


def test_a_row_that_was_changed_is_a_row_with_the_reason(away, tmp_path):
    rows = parquet.read_table(rows_of(away, tmp_path / "rows"))
    place = rows.column_names.index("area_cm2")
    changed = rows.set_column(place, "area_cm2", pa.array([0.2, None], pa.float64()))
    found = ieap.fit_many(changed).to_dict()
    assert "input_hash" in found["refused_reason"][0] and found["refused_place"][1] == "area_cm2"
    assert found["fit"] == [None, None]


def test_a_column_for_people_that_was_changed_is_a_row_with_the_reason(away, tmp_path):
    fitted = pa.table(ieap.fit_many(parquet.read_table(rows_of(away, tmp_path / "rows"))))
    for name in ["model_version", "parameters", "r_squared_current", "issues"]:
        place = fitted.column_names.index(name)
        forged = fitted.column(name).to_pylist()
        match forged[0]:
            case [{"value": _}, *_]:
                forged[0][0]["value"] += 1.0
            case [*_]:
                forged[0].append({"severity": "note", "code": "forged", "place": "", "message": "", "mend": ""})
            case number:
                forged[0] = number + 1
        changed = fitted.set_column(place, fitted.schema.field(name), pa.array(forged, fitted.schema.field(name).type))
        parquet.write_table(changed, tmp_path / f"{name}.parquet")
        refused = json.loads(program("-C", str(away), "import-fits", str(tmp_path / f"{name}.parquet"), "--json", ok=(3,)))
        assert f"column {name} says" in refused["imported"]["refused"][0]["reason"]


def test_what_spark_fitted_comes_back(away, fits, tmp_path, spark):
    import ieap.spark

    rows = spark.read.parquet(str(rows_of(away, tmp_path / "rows")))
    ieap.spark.fit(rows).write.parquet(str(tmp_path / "results"))
    assert brought_back(away, tmp_path / "results")["imported"] == 2
    same_fits(away, fits)
