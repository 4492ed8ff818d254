"""One run of 3,600 x 2 readings fitted by ieap, lmfit, variable projection with SciPy, and SciPy's differential evolution.

    pip install ieap-*.whl lmfit scipy && python python/benchmarks/beside_others.py

All have the same readings and the same seven parameters. The others begin at twice what was simulated (differential evolution
searches time constants over four decades) and give standard errors of white noise; ieap begins from nothing, and finds where
the edge lies, noise with its memory, outliers, intervals and issues as well.
"""

from __future__ import annotations

import statistics
import time

import lmfit
import numpy as np
from scipy.optimize import differential_evolution, least_squares

import ieap

TRUTH = {"r1_ohm_cm2": 521.4, "c1_f_per_cm2": 0.098, "r2_ohm_cm2": 2629.9, "c2_f_per_cm2": 0.13, "rss_ohm_cm2": 5660.0,
         "alpha_per_c_cm": 13.88, "lambda_per_s": 3.8e-4}
AREA_CM2, STEP_V = 0.1, 2.0
NOISE = {"current_a": 4e-6, "curvature_per_cm": 4e-3}


def readings(every_s: float, before: int) -> dict[str, np.ndarray]:
    """An hour at 2 V as a logger has it, with so many readings before the step."""
    times = every_s * (np.arange(3600 / every_s) + 0.5)
    times = np.concatenate([every_s * (np.arange(-before, 0) + 0.5), times])
    return dict(ieap.simulate(TRUTH, drive=[(0, STEP_V)], area_cm2=AREA_CM2, time_s=times, noise=NOISE))


def columns(t: np.ndarray, taus: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Current and bending of branches of unit conductance, and of the leak."""
    falls = np.exp(-t[:, None] / taus)
    bends = (np.exp(-rate * t)[:, None] - falls) / (1.0 / taus - rate)
    return np.column_stack([falls, np.ones(len(t))]), bends


def residual(p, t, current, curvature):
    currents, bends = columns(t, np.array([p["tau1"], p["tau2"]]), p["rate"])
    g = np.array([p["g1"], p["g2"], p["g3"]])
    left = (current - currents @ g) / NOISE["current_a"]
    return np.concatenate([left, (curvature - p["alpha"] * (bends @ g[:2])) / NOISE["curvature_per_cm"]])


def start(factor: float) -> lmfit.Parameters:
    own = lmfit.Parameters()
    volts = AREA_CM2 * STEP_V
    for k in (1, 2):
        r, c = TRUTH[f"r{k}_ohm_cm2"], TRUTH[f"c{k}_f_per_cm2"]
        own.add(f"g{k}", factor * volts / r, min=0)
        own.add(f"tau{k}", factor * r * c, min=0.1)
    own.add("g3", factor * volts / TRUTH["rss_ohm_cm2"], min=0)
    own.add("alpha", factor * TRUTH["alpha_per_c_cm"])
    own.add("rate", factor * TRUTH["lambda_per_s"], min=0)
    return own


def projected(taus, t, current):
    """What the best amplitudes leave: variable projection."""
    currents, _ = columns(t, np.asarray(taus), 0.0)
    return (current - currents @ np.linalg.lstsq(currents, current, rcond=None)[0]) / NOISE["current_a"]


def in_two_steps(t, current, curvature):
    taus = np.exp(least_squares(lambda logs: projected(np.exp(logs), t, current), np.log([102.0, 684.0])).x)
    g = np.linalg.lstsq(columns(t, taus, 0.0)[0], current, rcond=None)[0]
    bent = lambda p: (curvature - p[0] * (columns(t, taus, p[1])[1] @ g[:2])) / NOISE["curvature_per_cm"]
    return least_squares(bent, [27.8, 7.6e-4], x_scale=[10, 1e-3])


def by_evolution(t, current):
    square = lambda logs: float((projected(np.exp(logs), t, current) ** 2).sum())
    return differential_evolution(square, [(0.0, 9.2)] * 2, seed=1)


def median_ms(work, calls: int) -> float:
    took = []
    for _ in range(calls):
        begun = time.perf_counter()
        work()
        took.append(time.perf_counter() - begun)
    return 1e3 * statistics.median(took)


def main() -> None:
    for every_s in (36.0, 3.6, 1.0):
        log = readings(every_s, 20)
        after = {name: values[20:] for name, values in log.items()}
        t, current, curvature = after["time_s"], after["current_a"], after["curvature_per_cm"]
        stated = {name: values for name, values in after.items() if name != "voltage_v"}
        rows = {
            "ieap, step stated": lambda: ieap.fit(stated, area_cm2=AREA_CM2, drive=[(0, STEP_V)]),
            "ieap, step between two readings": lambda: ieap.fit(log, area_cm2=AREA_CM2),
            "lmfit, step known": lambda: lmfit.minimize(residual, start(2.0), args=(t, current, curvature)),
            "variable projection (SciPy), step known": lambda: in_two_steps(t, current, curvature),
        }
        print(f"{len(t)} readings x 2")
        for name, work in rows.items():
            print(f"  {name:40} {median_ms(work, 15):9.2f} ms")
        if every_s == 1.0:
            print(f"  {'differential evolution (SciPy), current':40} {median_ms(lambda: by_evolution(t, current), 1):9.2f} ms")


if __name__ == "__main__":
    main()
