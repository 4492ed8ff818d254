"""Tables go to and from other libraries as Arrow, and without a copy where they are ours."""

from __future__ import annotations

import pytest
from conftest import PARAMETERS, STRIP

import ieap

pa = pytest.importorskip("pyarrow")


@pytest.fixture(scope="module")
def long_table() -> ieap.Table:
    return ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, until_s=3599.9, every_s=0.1)


def address(column) -> int:
    (chunk,) = column.chunks
    return chunk.buffers()[1].address


def test_36000_rows_are_handed_on_in_their_place(long_table):
    assert long_table.num_rows == 36_000
    arrow = pa.table(long_table)
    assert arrow.num_rows == 36_000
    for name in ("voltage_v", "current_a", "curvature_per_cm"):
        assert address(arrow[name]) == long_table._readings._address(name)
    assert pa.table(long_table)["time_s"].chunk(0).buffers()[1].address == address(arrow["time_s"])


def test_a_fit_takes_them_in_their_place(long_table):
    fit = ieap.fit(long_table, **STRIP, model="lumped-1")
    for quantity, name in (("current", "current_a"), ("curvature", "curvature_per_cm")):
        assert fit._native._address(quantity) == long_table._readings._address(name)


def test_shared_memory_outlives_the_table():
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, until_s=100, every_s=1)
    kept, arrow = table.column("current_a"), pa.table(table)
    del table
    assert arrow["current_a"].to_pylist() == kept


def test_units_and_origin_are_in_the_schema(campaign):
    schema = pa.table(ieap.read(campaign / "runs/a.csv")).schema
    assert schema.field("current_a").metadata[b"unit"] == b"A"
    assert schema.metadata[b"ieap.source"].endswith(b"runs/a.csv")


def test_a_slower_channel_leaves_empty_cells():
    columns = {"time_s": [0.0, 1.0, 2.0], "current_a": [1.0, 2.0, 3.0], "curvature_per_cm": [0.1, None, 0.3]}
    arrow = pa.table(ieap._inputs.table_of(columns))
    assert arrow["curvature_per_cm"].to_pylist() == [0.1, None, 0.3]


@pytest.mark.parametrize("library", ["pyarrow", "record batch", "pandas", "polars", "duckdb", "numpy"])
def test_tables_of_others_give_the_same_fit(table, library):
    arrow = pa.table(table)
    # A table of ours knows its drive; others have it found in the voltage.
    own = ieap.fit({name: table.column(name) for name in arrow.column_names}, **STRIP).to_dict()["parameters"]
    match library:
        case "pyarrow":
            other = arrow
        case "record batch":
            (other,) = arrow.to_batches()
        case "pandas":
            other = pytest.importorskip("pandas").DataFrame(arrow.to_pandas())
        case "polars":
            other = pytest.importorskip("polars").from_arrow(arrow)
        case "duckdb":
            other = pytest.importorskip("duckdb").sql("SELECT * FROM arrow")
        case _:
            other = {name: pytest.importorskip("numpy").asarray(arrow[name]) for name in arrow.column_names}
    assert ieap.fit(other, **STRIP).to_dict()["parameters"] == own


def test_every_kind_of_number_is_read(table):
    import decimal

    arrow = pa.table(table)
    known = {key: own.value for key, own in ieap.fit(arrow, **STRIP).parameters.items()}
    times = pa.array([round(1e6 * own) for own in table.column("time_s")], pa.duration("us"))
    cents = [decimal.Decimal(round(1e9 * own)).scaleb(-9) for own in table.column("current_a")]
    others = {
        "time": times,
        "voltage_v": arrow["voltage_v"].combine_chunks().dictionary_encode(),
        "current_a": pa.array(cents, pa.decimal128(20, 9)),
        "curvature_per_cm": arrow["curvature_per_cm"].cast(pa.float16()),
    }
    fit = ieap.fit(pa.table(others), **STRIP)
    assert not [issue for issue in fit.issues if issue.code == "column-unread"], fit.issues
    for key in ("r1_ohm_cm2", "c1_f_per_cm2"):
        assert fit[key].value == pytest.approx(known[key], rel=1e-3)


def test_a_column_that_is_no_number_is_pointed_out(table):
    arrow = pa.table(table).append_column("note", pa.array(["x"] * len(table)))
    issues = ieap.fit(arrow, **STRIP).issues
    assert any(issue.code == "column-unread" and "note" in issue.place for issue in issues)


def test_results_are_arrow_too(campaign, fits):
    fits_table = pa.table(ieap.Campaign(campaign).table("fits"))
    assert pa.types.is_floating(fits_table.schema.field("value").type)
    assert fits_table.num_rows == sum(len(fit["parameters"]) + len(fit["nuisances"]) for fit in fits["fits"])
