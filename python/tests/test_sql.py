"""The database as DuckDB and sqlite3 read it: the questions of docs/schema.md get the same answers from both."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from conftest import program

import ieap

PAGE = Path(__file__).parents[2] / "docs" / "schema.md"


def questions() -> list[str]:
    blocks = PAGE.read_text(encoding="utf-8").split("\n\n")
    return [block for block in blocks if block.startswith("    SELECT")]


@pytest.fixture(scope="module")
def duck(campaign, findings):
    duckdb = pytest.importorskip("duckdb")
    try:
        from duckdb_extensions import import_extension

        import_extension("sqlite_scanner")
    except ImportError:
        pass
    try:
        duckdb.sql("LOAD sqlite")
    except duckdb.Error:
        try:
            duckdb.sql("INSTALL sqlite")
            duckdb.sql("LOAD sqlite")
        except duckdb.Error as error:
            pytest.skip(f"DuckDB has no extension for SQLite here: {str(error).splitlines()[0]}")
    program("report", str(campaign))
    connection = duckdb.connect()
    connection.sql("LOAD sqlite")
    connection.sql(f"ATTACH '{campaign}/campaign.db' AS campaign (TYPE sqlite, READ_ONLY)")
    connection.sql("USE campaign")
    yield connection
    connection.close()


def test_the_questions_have_one_answer(campaign, duck):
    lite = sqlite3.connect(f"file:{campaign}/campaign.db?mode=ro", uri=True)
    asked = questions()
    assert len(asked) == 14
    for question in asked:
        of_lite, of_duck = lite.execute(question).fetchall(), duck.sql(question).fetchall()
        assert len(of_lite) == len(of_duck), question
        for one, other in zip(of_lite, of_duck):
            assert one == pytest.approx(other, nan_ok=True) if None not in one else one == other, question
    assert duck.sql(asked[0]).fetchall(), "a campaign with fits has an alpha"


def test_types_are_those_of_the_columns(duck):
    def kinds(view: str) -> dict[str, str]:
        found = duck.sql(f"SELECT * FROM {view}")
        return {name: str(kind) for name, kind in zip(found.columns, found.types)}

    assert kinds("runs_view")["voltage_v"] == "DOUBLE"
    assert kinds("findings_view")["p_misfit"] == "DOUBLE"
    assert kinds("findings_view")["verdict"] == "VARCHAR"
    assert kinds("laws_view")["q"] == "DOUBLE"
    volts = [row[0] for row in duck.sql("SELECT DISTINCT voltage_v FROM runs_view ORDER BY 1").fetchall()]
    assert volts == [1.5, 2.0] or all(round(own, 3) == own for own in volts), volts
    duck.sql("SELECT avg(p_misfit) FROM findings_view").fetchall()
    duck.sql("SELECT * FROM findings_view WHERE verdict = 'law'").fetchall()


def test_a_campaign_gives_findings_laws_and_monitoring(campaign):
    opened = ieap.Campaign(campaign)
    for table, column in [("laws", "covariate"), ("monitoring", "axis"), ("findings", "verdict")]:
        assert column in opened.table(table)
