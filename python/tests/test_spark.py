"""Spark gives what one process gives, also where an executor is killed and where rows are broken.

`IEAP_LONG=1` fits 20,000 runs; the short form some hundred.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import threading
import time

import pytest
from conftest import NOISE, PARAMETERS, STRIP

import ieap

pytest.importorskip("pyspark")
pa = pytest.importorskip("pyarrow")
pytest.importorskip("pandas")
if shutil.which("java") is None:
    pytest.skip("there is no Java", allow_module_level=True)

RUNS = 20_000 if os.environ.get("IEAP_LONG") else 240
KINDS = 12
COLUMNS = ("time_s", "voltage_v", "current_a", "curvature_per_cm")


@pytest.fixture(scope="module")
def rows() -> pa.Table:
    tables = [
        ieap.simulate(PARAMETERS, drive=[(0, 1 + kind / 10)], **STRIP, until_s=60, every_s=1, noise=NOISE, seed=kind)
        for kind in range(KINDS)
    ]
    columns = {name: [table.column(name) for table in tables] for name in COLUMNS}
    order = [number % KINDS for number in range(RUNS)]
    picked = {name: [cells[kind] for kind in order] for name, cells in columns.items()}
    table = pa.table(picked | {"run": [f"r{number:05}" for number in range(RUNS)], "area_cm2": [0.1] * RUNS})
    # Some rows are broken: they must give a row with the reason.
    area = [None if number % 50 == 7 else 0.1 for number in range(RUNS)]
    return table.set_column(table.column_names.index("area_cm2"), "area_cm2", pa.array(area, pa.float64()))


def executors(application: str) -> list[int]:
    """Processes of the executors of this application, and of no other."""
    listed = subprocess.run(["ps", "-ewwo", "pid,args"], capture_output=True, text=True).stdout.splitlines()
    return [int(line.split()[0]) for line in listed if "CoarseGrainedExecutorBackend" in line and f"--app-id {application}" in line]


def in_order(table: pa.Table) -> list[dict]:
    return table.sort_by("run").to_pylist()


def test_a_cluster_that_loses_an_executor_gives_the_same_bits(spark, rows, tmp_path):
    import ieap.spark

    parquet = str(tmp_path / "runs")
    spark.createDataFrame(rows).repartition(8, "run").write.parquet(parquet)
    killed: list[int] = []

    def kill() -> None:
        tracker, until = spark.sparkContext.statusTracker(), time.monotonic() + 120
        while not killed and time.monotonic() < until:
            stages = [tracker.getStageInfo(stage) for stage in tracker.getActiveStageIds()]
            if any(stage and stage.numActiveTasks for stage in stages):
                found = executors(spark.sparkContext.applicationId)
                os.kill(found[0], signal.SIGKILL)
                killed.append(found[0])
            time.sleep(0.02)

    killer = threading.Thread(target=kill)
    killer.start()
    fitted = ieap.spark.fit(spark.read.parquet(parquet), model="lumped-1")
    found = fitted.toArrow()
    killer.join()
    assert killed, "an executor was killed while the job ran"
    own = pa.table(ieap.fit_many(rows, model="lumped-1"))
    assert in_order(found) == in_order(own)
    refused = [row for row in in_order(found) if row["refused_reason"]]
    assert len(refused) == len([n for n in range(RUNS) if n % 50 == 7]) and refused[0]["refused_place"] == "area_cm2"
    comments = {field.name: field.metadata.get("comment") for field in fitted.schema.fields}
    assert all(comments.values()) and "95 %" in comments["parameters"]


def test_groups_are_diagnosed_as_in_one_process(spark, rows):
    import ieap.spark

    two = rows.slice(0, 4).append_column("sample", pa.array(["A", "A", "B", "B"]))
    found = ieap.spark.diagnose(spark.createDataFrame(two), "sample", draws=99).toArrow().sort_by("group").to_pylist()
    assert [row["group"] for row in found] == ["sample=A", "sample=B"]
    for start, row in zip((0, 2), found):
        own = ieap.diagnose_rows(two.slice(start, 2), group=row["group"], draws=99).to_dict()
        assert {key: values[0] for key, values in own.items()} == row
