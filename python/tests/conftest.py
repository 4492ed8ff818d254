"""A small simulated campaign, and the program to compare with."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import ieap

STRIP = {"length_mm": 5.0, "width_mm": 2.0}
PARAMETERS = {
    "r1_ohm_cm2": 30.0,
    "c1_f_per_cm2": 0.02,
    "r2_ohm_cm2": 300.0,
    "c2_f_per_cm2": 0.03,
    "rss_ohm_cm2": 9000.0,
    "alpha_per_c_cm": 120.0,
    "lambda_per_s": 0.002,
}
NOISE = {"current_a": 2e-6, "curvature_per_cm": 0.004}

CAMPAIGN = """
[campaign]
id = "small"
notice = "SIMULATED"
[[sample]]
id = "S"
material = "M"
length_mm = 5.0
width_mm = 2.0
"""
SPEC = """
[simulation]
seed = 7
folder = "runs"
statement = ["SIMULATED, not measured"]
baseline_s = 10.0
[noise]
current_a = 2e-6
curvature_per_cm = 0.004
[[sampling]]
until_s = 300.0
every_s = 1.0
"""
RUN = """
[[run]]
file = "{name}.csv"
area_cm2 = 0.1
voltage_v = {voltage_v}
parameters = {{ {parameters} }}
tags = {{ sample = "S", environment = "air", instrument = "{name}" }}
"""
LEAK = 'effect = [{ id = "faradaic-leak", leak_current_a_per_cm2 = 2e-4, onset_v = 1.2, slope_v = 0.15 }]\n'


def program(*arguments: str, ok: tuple[int, ...] = (0,)) -> str:
    """What the program prints: `IEAP_PROGRAM`, or that of this package."""
    own = os.environ.get("IEAP_PROGRAM")
    command = [own] if own else [sys.executable, "-m", "ieap"]
    done = subprocess.run([*command, *arguments], capture_output=True, text=True)
    assert done.returncode in ok, done.stderr
    return done.stdout


def in_toml(parameters: dict[str, float]) -> str:
    return ", ".join(f"{key} = {value}" for key, value in parameters.items())


@pytest.fixture(scope="session")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs at 1.5 and 2 V, fitted, and diagnosed with few draws. Each is alone of its instrument, as readings in memory are."""
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "campaign.toml").write_text(CAMPAIGN)
    runs = [RUN.format(name=name, voltage_v=v, parameters=in_toml(PARAMETERS)) for name, v in (("a", 1.5), ("b", 2.0))]
    (folder / "simulation.toml").write_text(SPEC + "".join(runs))
    program("simulate", str(folder / "simulation.toml"))
    return folder


@pytest.fixture(scope="session")
def fits(campaign: Path) -> dict:
    """What `ieap fit --json` prints."""
    return json.loads(program("fit", "--json", str(campaign)))


@pytest.fixture(scope="session")
def findings(campaign: Path, fits: dict) -> dict:
    """What `ieap diagnose --json` prints."""
    return json.loads(program("diagnose", "--draws", "99", "--json", str(campaign)))


@pytest.fixture(scope="session")
def table() -> ieap.Table:
    """A simulated run of 301 readings."""
    return ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, until_s=300, every_s=1, noise=NOISE)


@pytest.fixture(scope="session")
def spark():
    """A cluster of two executors on this machine."""
    pytest.importorskip("pyspark")
    pytest.importorskip("pandas")
    if shutil.which("java") is None:
        pytest.skip("there is no Java")
    from pyspark.sql import SparkSession

    # The executors fit with this environment, not with the first Python on the path.
    os.environ["PYSPARK_PYTHON"] = sys.executable

    builder = SparkSession.builder.master("local-cluster[2,1,1024]").appName("ieap")
    for key, value in {
        "spark.ui.enabled": "false",
        "spark.sql.execution.arrow.maxRecordsPerBatch": "50",
        "spark.driver.host": "127.0.0.1",
        "spark.task.maxFailures": "8",
        # A task for each of the files, which are small.
        "spark.sql.files.maxPartitionBytes": "65536",
        "spark.sql.files.openCostInBytes": "65536",
    }.items():
        builder = builder.config(key, value)
    session = builder.getOrCreate()
    yield session
    session.stop()
