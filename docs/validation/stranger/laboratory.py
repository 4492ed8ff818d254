"""A laboratory with known truth, written from the equations alone: two materials, two strips each, dry and at four
humidities, two voltages, three repeats that scatter by 1.5 %; headers and run sheet in Chinese. Two rows of the sheet
are swapped (the file names are right), and one run is of another strip than name and sheet say.

    python laboratory.py FOLDER --seed 1
"""
import argparse
import json
import math
import random
from pathlib import Path

AREA_CM2 = 0.1
SCATTER, STRIPS, NOISE = 0.015, 0.05, 0.004
BASE = {"R1": 300.0, "C1": 0.05, "R2": 900.0, "C2": 0.11, "R_ss": 9000.0, "alpha": 14.0, "lambda": 2.0e-4}
# Relative change for each percent of humidity.
LAWS = {"聚合物A": {"lambda": 0.025, "R_ss": -0.020}, "聚合物B": {"lambda": 0.012}}
HUMIDITIES, VOLTAGES, REPEATS = [20, 40, 60, 80], [1.0, 2.0], 3
TIMES = [-30.0 + 3.0 * k for k in range(10)] + [9.0 * k + 0.5 for k in range(400)]


def step(p, volts, t):
    """Current in A and curvature in 1/cm at a time after a step from rest."""
    if t < 0:
        return 0.0, 0.0
    current, strain = volts / p["R_ss"], 0.0
    for k in "12":
        r, rate = p["R" + k], 1 / (p["R" + k] * p["C" + k])
        current += volts / r * math.exp(-rate * t)
        strain += volts / r * (math.exp(-p["lambda"] * t) - math.exp(-rate * t)) / (rate - p["lambda"])
    return AREA_CM2 * current, p["alpha"] * AREA_CM2 * strain


def make(folder, seed):
    rng, folder = random.Random(seed), Path(folder)
    (folder / "数据").mkdir(parents=True, exist_ok=True)
    rows, day = [], 1
    for material, laws in LAWS.items():
        for number in (1, 2):
            own = {k: x * math.exp(STRIPS * rng.gauss(0, 1)) for k, x in BASE.items()}
            for humidity in [0, *HUMIDITIES]:
                for volts in VOLTAGES:
                    for repeat in range(1, REPEATS + 1):
                        p = {k: x * math.exp(laws.get(k, 0.0) * humidity + SCATTER * rng.gauss(0, 1)) for k, x in own.items()}
                        where = "真空" if humidity == 0 else "空气"
                        sample = f"{material[-1]}{number}"
                        rows.append([sample, where, humidity, volts, repeat, p, f"2026-05-{1 + day % 28:02}"])
                        day += 1
    # Of another strip than anybody says: a run of A in humid air is recorded as one of B.
    at = {(r[0], r[2], r[3], r[4]): k for k, r in enumerate(rows)}
    wrong = (at["B2", 80, 2.0, 3], at["A2", 80, 2.0, 1])
    rows[wrong[0]][5] = dict(rows[wrong[1]][5])
    names = [f"{s}_{w}_{h}_{v:.1f}V_{n}.csv" for s, w, h, v, n, *_ in rows]
    for (_, _, _, volts, _, p, _), name in zip(rows, names):
        exact = [step(p, volts, t) for t in TIMES]
        peaks = [max(abs(x[c]) for x in exact) for c in (0, 1)]
        lines = ["时间(s),电压(V),电流(mA),曲率(1/cm)"]
        for t, (i, k) in zip(TIMES, exact):
            i, k = i + NOISE * peaks[0] * rng.gauss(0, 1), k + NOISE * peaks[1] * rng.gauss(0, 1)
            lines.append(f"{t:.1f},{volts if t >= 0 else 0.0:.1f},{1e3 * i:.6g},{k:.6g}")
        (folder / "数据" / name).write_text("\n".join(lines) + "\n")
    swapped = [at["A1", 40, 2.0, 2], at["B1", 40, 2.0, 2]]
    said = [r[0] for r in rows]
    said[swapped[0]], said[swapped[1]] = said[swapped[1]], said[swapped[0]]
    sheet = ["文件,样品,环境,相对湿度(%),电压(V),日期"]
    sheet += [f"{n},{s},{r[1]},{r[2]},{r[3]},{r[6]}" for n, s, r in zip(names, said, rows)]
    (folder / "实验记录.csv").write_text("\n".join(sheet) + "\n")
    truth = {"laws": LAWS, "scatter": SCATTER, "swapped": [names[k] for k in swapped], "of another strip": names[wrong[0]]}
    (folder.parent / "truth.json").write_text(json.dumps(truth, ensure_ascii=False, indent=1))


if __name__ == "__main__":
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("folder")
    cli.add_argument("--seed", type=int, default=1)
    o = cli.parse_args()
    make(o.folder, o.seed)
