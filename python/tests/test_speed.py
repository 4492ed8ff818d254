"""What Python costs over the engine.

`IEAP_MEASURE=1 pytest -s tests/test_speed.py` measures it over many calls, prints it and holds its median to its limit: that
needs a machine that does nothing else, for caches that others emptied cost as much as the call.
"""

from __future__ import annotations

import os
import statistics
import time

import pytest
from conftest import PARAMETERS, STRIP

import ieap

MOST_OVERHEAD_S = 50e-6
"""Time that a call may take beside the engine's own."""

CALLS = 300


def overheads_s(readings: object) -> list[float]:
    """What each of some calls took, in order of size. What else the machine does only adds: the least says what the call needs."""

    def once() -> float:
        begun = time.perf_counter()
        fit = ieap.fit(readings, **STRIP, model="lumped-1")
        return time.perf_counter() - begun - fit.seconds

    return sorted(once() for _ in range(CALLS))


def run_of(rows: int) -> ieap.Table:
    """A short run, and empty cells up to so many rows: what a fit takes is the same."""
    times = [float(n) for n in range(40)]
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, time_s=times)
    columns = {name: table.column(name) + [None] * (rows - 40) for name in table.column_names}
    columns["time_s"] = [float(n) for n in range(rows)]
    columns["temperature_c"] = [20.0] * rows
    return ieap._inputs.table_of(columns)


@pytest.mark.skipif(not os.environ.get("IEAP_MEASURE"), reason="a measurement: IEAP_MEASURE=1 pytest -s tests/test_speed.py")
def test_what_a_call_costs_over_the_engine():
    load = " ".join(f"{load:.1f}" for load in os.getloadavg()) if hasattr(os, "getloadavg") else "unknown"
    print(f"\n{CALLS} calls, load of the machine {load}, {os.cpu_count()} cores")
    medians = []
    # A table is not copied (tests/test_arrow.py): its length costs nothing.
    for rows in (40, 36_000):
        took = overheads_s(run_of(rows))
        medians.append(statistics.median(took))
        shown = {"median": medians[-1], "a tenth below": took[len(took) // 10], "least": took[0]}
        print(f"{rows} rows: " + ", ".join(f"{name} {second * 1e6:.0f} us" for name, second in shown.items()))
    whole = ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, until_s=3599.9, every_s=0.1)
    arrow = pytest.importorskip("pyarrow").table(whole)
    begun = time.perf_counter()
    ieap._inputs.table_of(arrow)
    print(f"an Arrow table of {arrow.num_rows} rows from elsewhere: {(time.perf_counter() - begun) * 1e3:.2f} ms")
    assert max(medians) < MOST_OVERHEAD_S
