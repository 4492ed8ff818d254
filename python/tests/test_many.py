"""Many runs at once: the same fits, a reason for what cannot be fitted, and Python goes on meanwhile."""

from __future__ import annotations

import signal
import threading
import time

import pytest
from conftest import NOISE, PARAMETERS, STRIP

import ieap

pa = pytest.importorskip("pyarrow")
COLUMNS = ("time_s", "voltage_v", "current_a", "curvature_per_cm")


def rows_of(tables: list[ieap.Table]) -> dict[str, list]:
    rows = {name: [table.column(name) for table in tables] for name in COLUMNS}
    sizes = {"area_cm2": 0.1, **STRIP}
    strips = {name: [size] * len(tables) for name, size in sizes.items()}
    return rows | {"run": [f"r{n}" for n in range(len(tables))], **strips}


def columns_of(table: ieap.Table, names=COLUMNS) -> dict[str, list]:
    """Without the drive that a simulated table states."""
    return {name: table.column(name) for name in names}


@pytest.fixture(scope="module")
def tables() -> list[ieap.Table]:
    made = lambda seed: ieap.simulate(  # noqa: E731
        PARAMETERS, drive=[(0, 1 + seed / 10)], **STRIP, until_s=200, every_s=1, noise=NOISE, seed=seed
    )
    return [made(seed) for seed in range(8)]


def test_each_row_is_the_fit_of_its_run(tables):
    found = ieap.fit_many(pa.table(rows_of(tables))).to_dict()
    for n, table in enumerate(tables):
        own = ieap.fit(columns_of(table), area_cm2=0.1, **STRIP, run=f"r{n}").to_dict()
        assert {key: found[key][n] for key in ("run", "model", "data_hash", "input_hash", "n_samples")} == {
            key: own[key] for key in ("run", "model", "data_hash", "input_hash", "n_samples")
        }
        parameters = {one.pop("key"): one for one in found["parameters"][n]}
        assert parameters == own["parameters"]
        assert found["issues"][n] == own["issues"] and found["refused_reason"][n] is None


def test_threads_and_cuts_change_nothing(tables):
    table = pa.table(rows_of(tables))
    whole = pa.table(ieap.fit_many(table))
    assert whole == pa.table(ieap.fit_many(table, threads=1))
    parts = [pa.table(ieap.fit_many(batch)) for batch in table.to_batches(max_chunksize=3)]
    assert whole == pa.concat_tables(parts).combine_chunks()


def test_a_row_that_is_none_has_its_reason(tables):
    rows = rows_of(tables[:4])
    rows["area_cm2"][0] = rows["length_mm"][0] = None
    rows["time_s"][1] = rows["time_s"][1][:-1]
    rows["current_a"][2] = None
    rows["curvature_per_cm"][2] = None
    found = ieap.fit_many(pa.table(rows)).to_dict()
    assert found["refused_place"][0] == "area_cm2" and "length_mm" in found["refused_remedy"][0]
    assert "values" in found["refused_reason"][1]
    assert found["refused_reason"][2] and found["model"][2] is None and found["parameters"][2] == []
    assert found["refused_reason"][3] is None and found["model"][3] == "lumped-2"


def test_the_drive_may_be_stated_by_the_row(tables):
    rows = rows_of(tables[:2])
    del rows["voltage_v"]
    stated = rows | {"drive_start_s": [[0.0]] * 2, "drive_voltage_v": [[1.0], [1.1]]}
    found = ieap.fit_many(pa.table(stated)).to_dict()
    for n, volts in enumerate([1.0, 1.1]):
        columns = columns_of(tables[n], [name for name in COLUMNS if name != "voltage_v"])
        own = ieap.fit(columns, area_cm2=0.1, **STRIP, drive=[(0.0, volts)], run=f"r{n}").to_dict()
        assert {one.pop("key"): one for one in found["parameters"][n]} == own["parameters"]


def test_an_empty_table_gives_an_empty_table(tables):
    found = ieap.fit_many(pa.table(rows_of(tables)).slice(0, 0))
    assert found.num_rows == 0 and "parameters" in found.column_names


def test_a_group_in_rows_is_the_group(tables):
    rows = pa.table(rows_of(tables[5:7]))
    found = ieap.diagnose_rows(rows, group="g", draws=99).to_dict()
    runs = {"r0": columns_of(tables[5]), "r1": columns_of(tables[6])}
    own = ieap.diagnose(runs, area_cm2=0.1, **STRIP, group="g", draws=99)
    import json

    assert json.loads(found["document"][0]) == own.to_dict()
    # A run that cannot be used is named, and the others are diagnosed.
    three = pa.table(rows_of(tables[5:8])).drop_columns(list(STRIP))
    broken = three.set_column(three.column_names.index("area_cm2"), "area_cm2", pa.array([0.1, 0.1, None]))
    found = ieap.diagnose_rows(broken, group="g", draws=99).to_dict()
    assert found["runs"] == [["r0", "r1"]] and found["verdict"][0] and found["refused_reason"] == [None]
    assert found["left_out"] == [["r2, area_cm2: the active area of the strip is not stated"]]
    none = ieap.diagnose_rows(broken.slice(2, 1), group="g", draws=99).to_dict()
    assert none["refused_place"] == ["r2, area_cm2"] and none["verdict"] == [None]


def test_python_goes_on_meanwhile(tables):
    rows = pa.table(rows_of(tables * 5))
    counted, done = [0], threading.Event()

    def count() -> None:
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    beside = threading.Thread(target=count)
    beside.start()
    ieap.fit_many(rows)
    done.set()
    beside.join()
    assert counted[0] > 5


def test_ctrl_c_ends_it(tables):
    rows = pa.table(rows_of(tables * 100))

    def ring(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    begun = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            ieap.fit_many(rows)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert time.monotonic() - begun < 20
