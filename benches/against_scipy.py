#!/usr/bin/env python3
"""A fit of a run of 3,600 x 2 readings beside SciPy, in one sitting: times, and how well each fits the current.

Usage: benches/against_scipy.py [RUNS]
After `cargo build --release` and `cargo build --release -p ieap-fit --example throughput`.
Needs Python 3.9, numpy and scipy (`pip install numpy scipy`; nothing of ieap needs them).

ieap fits current and bending, with covariance; SciPy fits the current alone, without: by differential evolution over the
logarithms of R1, C1, R2, C2 and R_ss, and by variable projection (two time constants searched, three conductances solved
for). Four conditions of table 5 of V. Vunder's thesis, an hour, 1 % noise of the peak. Costs are sums of squares of the
current over those of the truth: 1 within the noise.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.optimize import differential_evolution, least_squares

HOUSE = pathlib.Path(__file__).resolve().parent.parent
# R1, C1, R2, C2, R_ss, alpha, lambda, step: as in crates/fit/examples/throughput.rs.
ROWS = [
    (521.4, 0.098, 2629.9, 0.13, 5660.0, 13.88, 3.8e-4, 2.0),
    (92.8, 0.137, 1533.7, 0.06, 67590.0, 17.57, 9.4e-5, 2.5),
    (158.1, 0.146, 638.1, 0.17, 1910.0, 12.28, 1.8e-3, 2.5),
    (20.7, 0.067, 37.8, 1.87, 1000.0, 3.41, 1.1e-4, 2.0),
]
AREA_CM2, READINGS = 0.1, 3600
BOUNDS = np.log([(1, 1e4), (1e-3, 10), (1, 1e5), (1e-3, 10), (100, 1e6)])


def current_a(parameters, step_v, time_s):
    r1, c1, r2, c2, rss = parameters
    return AREA_CM2 * step_v * (np.exp(-time_s / (r1 * c1)) / r1 + np.exp(-time_s / (r2 * c2)) / r2 + 1 / rss)


def curvature_per_cm(row, time_s):
    alpha, rate, step_v = row[5:]
    charge = 0.0
    for r, c in (row[0:2], row[2:4]):
        fast = 1 / (r * c)
        charge += c * step_v * fast / (fast - rate) * (np.exp(-rate * time_s) - np.exp(-fast * time_s))
    return alpha * AREA_CM2 * charge


def evolved(step_v, time_s, current):
    cost = lambda logs: np.sum((current_a(np.exp(logs), step_v, time_s) - current) ** 2)
    return np.exp(differential_evolution(cost, BOUNDS, seed=1, tol=1e-8, maxiter=1000).x)


def projected(step_v, time_s, current):
    def solved(logs):
        columns = np.exp(-time_s[:, None] / np.exp(logs))
        design = AREA_CM2 * step_v * np.column_stack([columns, np.ones_like(time_s)])
        conductances = np.linalg.lstsq(design, current, rcond=None)[0]
        return conductances, design @ conductances - current

    begin = np.log([30.0, 400.0])
    found = least_squares(lambda logs: solved(logs)[1], begin, method="lm")
    taus, (g1, g2, g3) = np.exp(found.x), solved(found.x)[0]
    return 1 / g1, taus[0] * g1, 1 / g2, taus[1] * g2, 1 / g3


def timed(search, times, *given):
    taken = []
    for _ in range(times):
        begun = time.perf_counter()
        parameters = search(*given)
        taken.append(time.perf_counter() - begun)
    return float(np.median(taken)), parameters


def by_ieap(runs, readings):
    """Seconds a fit on one core, in one process over many; and the parameters of each of the four runs."""
    said = subprocess.run(
        [HOUSE / "target/release/examples/throughput", str(runs), str(READINGS)],
        env={**os.environ, "RAYON_NUM_THREADS": "1"}, check=True, capture_output=True, text=True,
    ).stdout
    seconds = float(said.split(" s")[0].split()[-1]) / runs
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "campaign.toml").write_text(
            '[campaign]\nid = "scipy"\ntitle = "Beside SciPy"\n[[sample]]\nid = "S"\nmaterial = "CNaf"\n'
            "length_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.22\n"
        )
        (folder / "runs").mkdir(exist_ok=True)
        (folder / "runs" / "tags.toml").write_text("sample = \"S\"\nenvironment = \"air\"\n")
        for k, (row, time_s, current, curvature) in enumerate(readings):
            table = np.column_stack([time_s, np.full_like(time_s, row[7]), current, curvature])
            header = "time_s,voltage_v,current_a,curvature_per_cm"
            np.savetxt(folder / "runs" / f"S_{k}.csv", table, fmt="%.17g", delimiter=",", header=header, comments="")
        ieap = [HOUSE / "target/release/ieap", "--quiet"]
        subprocess.run([*ieap, "ingest", folder], capture_output=True)
        fits = json.loads(subprocess.run([*ieap, "fit", "--json", folder], capture_output=True, text=True).stdout)
    found = {}
    for fit in fits["fits"]:
        value = lambda key: fit["parameters"][key]["value"] or np.inf
        keys = ["r1_ohm_cm2", "c1_f_per_cm2", "r2_ohm_cm2", "c2_f_per_cm2", "rss_ohm_cm2"]
        found[pathlib.Path(fit["run"]).stem] = [value(key) for key in keys]
    return seconds, [found[f"S_{k}"] for k in range(len(readings))]


def main():
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    random = np.random.default_rng(20261123)
    time_s = np.arange(READINGS) * 3600.0 / READINGS
    readings = []
    for row in ROWS:
        exact = current_a(row[:5], row[7], time_s), curvature_per_cm(row, time_s)
        noisy = [v + 0.01 * np.max(np.abs(v)) * random.standard_normal(READINGS) for v in exact]
        readings.append((row, time_s, *noisy))
    seconds, parameters = by_ieap(runs, readings)
    rows = {"ieap, current and bending": [], "variable projection": [], "differential evolution": []}
    for (row, _, current, _), own in zip(readings, parameters):
        cost = lambda p: np.sum((current_a(p, row[7], time_s) - current) ** 2)
        rows["ieap, current and bending"].append((seconds, cost(own) / cost(row[:5])))
        for name, search, times in [("variable projection", projected, 5), ("differential evolution", evolved, 1)]:
            taken, found = timed(search, times, row[7], time_s, current)
            rows[name].append((taken, cost(found) / cost(row[:5])))
    for name, found in rows.items():
        taken, costs = zip(*found)
        mean = float(np.mean(taken))
        print(f"{name:28} {1e3 * mean:9.3f} ms a fit, {mean / seconds:7.0f} times as long, cost {min(costs):.4f} to {max(costs):.4f}")


if __name__ == "__main__":
    main()
