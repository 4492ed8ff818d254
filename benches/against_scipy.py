#!/usr/bin/env python3
"""A fit of a run of 3,600 x 2 readings beside lmfit and SciPy, in one sitting: times, and how well each fits.

Usage: benches/against_scipy.py [RUNS]
After `cargo build --release -p ieap-fit --example throughput`.
Needs Python 3.9 and `pip install numpy scipy lmfit` (nothing of ieap needs them).

All fit current and bending together, seven parameters and the moment of the step, which lies between two readings. ieap and
lmfit give errors as well. lmfit and variable projection begin at twice what was simulated, ieap and differential evolution from
nothing. Variable projection searches the two time constants, the relaxation and the moment, and solves for the rest.
Four conditions of table 5 of V. Vunder's thesis, an hour, 1 % noise of the peak. Costs are sums of squares over the noise,
against those of the truth: 1 within the noise.
"""

import os
import pathlib
import subprocess
import sys
import time

import lmfit
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
NAMES = ["tau1", "tau2", "rate", "moment", "g1", "g2", "g3", "alpha"]
AREA_CM2, READINGS = 0.1, 3600
# Seconds of the interval in which the step lies, as the last reading before it and the first after it tell.
INTERVAL_S = (-1.0, 0.0)


def shapes(searched, time_s):
    """Currents of two branches and a leak of conductance one, and bending by the charge of the branches."""
    taus, rate, since = searched[:2], searched[2], time_s - searched[3]
    falls = np.exp(-since[:, None] / taus)
    bends = (np.exp(-rate * since)[:, None] - falls) / (1.0 / taus - rate)
    return np.column_stack([falls, np.ones_like(since)]), bends


def residuals(of, run):
    time_s, current, curvature, noise = run
    currents, bends = shapes(of[:4], time_s)
    left = (currents @ of[4:7] - current) / noise[0]
    return np.concatenate([left, (of[7] * (bends @ of[4:6]) - curvature) / noise[1]])


def truth(row):
    r1, c1, r2, c2, rss, alpha, rate, step_v = row
    volts = AREA_CM2 * step_v
    return np.array([r1 * c1, r2 * c2, rate, 0.0, volts / r1, volts / r2, volts / rss, alpha])


def simulated(row, random):
    time_s = np.arange(READINGS) * 3600.0 / READINGS
    currents, bends = shapes(truth(row)[:4], time_s)
    exact = currents @ truth(row)[4:7], row[5] * (bends @ truth(row)[4:6])
    noise = [0.01 * np.max(np.abs(values)) for values in exact]
    current, curvature = [v + size * random.standard_normal(READINGS) for v, size in zip(exact, noise)]
    return time_s, current, curvature, noise


def start(row):
    return np.where(np.array(NAMES) == "moment", np.mean(INTERVAL_S), 2.0 * truth(row))


def by_lmfit(row, run):
    begin = lmfit.Parameters()
    for name, value in zip(NAMES, start(row)):
        low, high = INTERVAL_S if name == "moment" else (1e-9, np.inf)
        begin.add(name, value, min=low, max=high)
    found = lmfit.minimize(lambda own: residuals(np.array([own[name].value for name in NAMES]), run), begin)
    return np.array([found.params[name].value for name in NAMES])


def solved(searched, run):
    """Conductances by the current and what bending adds to them, and the coupling: they are linear in turn."""
    time_s, current, curvature, noise = run
    currents, bends = shapes(searched, time_s)
    g = np.linalg.lstsq(currents, current, rcond=None)[0]
    alpha = 1.0
    for _ in range(3):
        bent = bends @ g[:2]
        alpha = (bent @ curvature) / (bent @ bent)
        both = np.vstack([currents / noise[0], np.column_stack([alpha * bends, np.zeros(len(bends))]) / noise[1]])
        g = np.linalg.lstsq(both, np.concatenate([current / noise[0], curvature / noise[1]]), rcond=None)[0]
    return np.concatenate([searched, g, [alpha]])


def by_projection(row, run):
    back = lambda logs: np.concatenate([np.exp(logs[:3]), logs[3:]])
    begin = np.concatenate([np.log(start(row)[:3]), start(row)[3:4]])
    low, high = [-20, -20, -20, INTERVAL_S[0]], [20, 20, 20, INTERVAL_S[1]]
    found = least_squares(lambda logs: residuals(solved(back(logs), run), run), begin, bounds=(low, high))
    return solved(back(found.x), run)


def by_evolution(_, run):
    logs = np.log([(0.1, 1e4), (0.1, 1e4), (1e-6, 1e-1), (1e-9, 1), (1e-9, 1), (1e-9, 1), (1e-2, 1e3)])
    back = lambda own: np.concatenate([np.exp(own[:3]), own[3:4], np.exp(own[4:])])
    bounds = [*logs[:3], INTERVAL_S, *logs[3:]]
    cost = lambda own: np.sum(residuals(back(own), run) ** 2)
    return back(differential_evolution(cost, bounds, seed=1, tol=1e-8, maxiter=1000).x)


def by_ieap(runs):
    """Seconds a fit on one core, in one process over many."""
    said = subprocess.run(
        [HOUSE / "target/release/examples/throughput", str(runs), str(READINGS), "variable-projection", "between"],
        env={**os.environ, "RAYON_NUM_THREADS": "1"}, check=True, capture_output=True, text=True,
    ).stdout
    return float(said.split(" s")[0].split()[-1]) / runs


def timed(search, times, *given):
    taken = []
    for _ in range(times):
        begun = time.perf_counter()
        found = search(*given)
        taken.append(time.perf_counter() - begun)
    return float(np.median(taken)), found


def main():
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    random = np.random.default_rng(20261123)
    seconds = by_ieap(runs)
    print(f"{'ieap':24} {1e3 * seconds:10.3f} ms a fit")
    measured = [(row, simulated(row, random)) for row in ROWS]
    for name, search, times in [("lmfit", by_lmfit, 5), ("variable projection", by_projection, 5), ("differential evolution", by_evolution, 1)]:
        taken, costs = [], []
        for row, run in measured:
            one, found = timed(search, times, row, run)
            taken.append(one)
            costs.append(np.sum(residuals(found, run) ** 2) / np.sum(residuals(truth(row), run) ** 2))
        mean = float(np.mean(taken))
        print(f"{name:24} {1e3 * mean:10.3f} ms a fit, {mean / seconds:7.0f} times as long, cost {min(costs):.4f} to {max(costs):.4f}")


if __name__ == "__main__":
    main()
