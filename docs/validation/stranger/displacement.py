"""Displacements of a strip that a laser saw beside its free end, with known truth: sensors that were not zeroed, strips that were
bent at rest, records that begin under voltage. Counts how often 95 % intervals of a campaign's fits hold.

    python displacement.py --ieap PATH --seed 100
"""
import argparse
import csv
import math
import random
import subprocess
import tempfile
from pathlib import Path

from laboratory import AREA_CM2, step

KEYS = {
    "R1": "r1_ohm_cm2",
    "C1": "c1_f_per_cm2",
    "R2": "r2_ohm_cm2",
    "C2": "c2_f_per_cm2",
    "R_ss": "rss_ohm_cm2",
    "alpha": "alpha_per_c_cm",
    "lambda": "lambda_per_s",
}
MEAN = {"R1": 300.0, "C1": 0.05, "R2": 900.0, "C2": 0.11, "R_ss": 9000.0, "lambda": 2e-4}
NOISE, RUNS, LENGTHS_MM, PARTS_OF_STROKE = 0.004, 12, (2, 10, 30), (0.0, 0.1, 0.2)


def seen_cm(curvature, length_cm):
    """What a laser at the free length sees of a circle that begins at the clamp."""
    if abs(curvature) < 1e-9:
        return curvature * length_cm**2 / 2
    return (1 - math.sqrt(1 - (curvature * length_cm) ** 2)) / curvature


def make(folder, seed, length_mm, part, is_bent, has_rest):
    """Writes a campaign of one strip; at rest it is bent, or its laser off, by that part of the first stroke."""
    rng, length_cm, offset_cm, truth = random.Random(seed), length_mm / 10, None, {}
    (folder / "runs").mkdir()
    width_mm = 100 * AREA_CM2 / length_mm
    sample = f'[[sample]]\nid = "A"\nmaterial = "CNaf"\nlength_mm = {length_mm}\nwidth_mm = {width_mm}\n'
    (folder / "campaign.toml").write_text('[campaign]\nid = "displacement"\ntitle = "Displacements"\n' + sample)
    (folder / "runs" / "tags.toml").write_text('sample = "A"\nenvironment = "air"\n')
    times = [-30.0 + 3 * k for k in range(10 if has_rest else 0)] + [9.0 * k + 0.5 for k in range(400)]
    for number in range(RUNS):
        p = {k: x * math.exp(0.3 * rng.gauss(0, 1)) for k, x in MEAN.items()}
        volts = (1.0, 2.0, -1.5)[number % 3]
        peak = max(abs(step({**p, "alpha": 1.0}, volts, t)[1]) for t in times)
        p["alpha"] = 0.5 / length_cm / peak * math.exp(0.2 * rng.gauss(0, 1))
        exact = [step(p, volts, t) for t in times]
        stroke = abs(seen_cm(p["alpha"] * peak, length_cm))
        offset_cm = part * stroke if offset_cm is None else offset_cm
        rest, laser = (2 * offset_cm / length_cm**2, 0.0) if is_bent else (0.0, offset_cm)
        most = max(abs(i) for i, _ in exact)
        lines = ["Time (s),Voltage (V),Current (mA),Tip displacement (mm)"]
        for t, (i, k) in zip(times, exact):
            i += NOISE * most * rng.gauss(0, 1)
            d = seen_cm(k + rest, length_cm) + laser + NOISE * stroke * rng.gauss(0, 1)
            lines.append(f"{t:.1f},{volts if t >= 0 else 0.0:.1f},{1e3 * i:.7g},{10 * d:.7g}")
        name = f"runs/{number:02}.csv"
        (folder / name).write_text("\n".join(lines) + "\n")
        truth[name] = p
    return truth


def held(ieap, folder, truth):
    """For each parameter how many of its intervals hold, of how many."""
    for words in (["ingest", folder], ["run", "--only", "fit", folder], ["export", folder, "-o", folder / "fits.csv"]):
        subprocess.run([ieap, *words], check=True, capture_output=True)
    found = {name: [0, 0] for name in KEYS}
    with open(folder / "fits.csv", newline="") as rows:
        for row in csv.DictReader(rows):
            for name, key in KEYS.items():
                if row["parameter"] == key and row["low_95"] and row["high_95"]:
                    found[name][0] += float(row["low_95"]) <= truth[row["run"]][name] <= float(row["high_95"])
                    found[name][1] += 1
    return found


def main():
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--ieap", required=True, help="the program")
    cli.add_argument("--seed", type=int, default=100)
    o = cli.parse_args()
    for has_rest in (True, False):
        for is_bent in (False, True):
            sums = {name: [0, 0] for name in KEYS}
            for number, (length_mm, part) in enumerate((a, b) for a in LENGTHS_MM for b in PARTS_OF_STROKE):
                with tempfile.TemporaryDirectory() as folder:
                    folder = Path(folder)
                    truth = make(folder, o.seed + number, length_mm, part, is_bent, has_rest)
                    for name, (holds, of) in held(o.ieap, folder, truth).items():
                        sums[name][0] += holds
                        sums[name][1] += of
            case = ("rest read" if has_rest else "no rest", "bent" if is_bent else "laser off")
            print(*case, *(f"{name} {holds} of {of}" for name, (holds, of) in sums.items()), sep=" | ", flush=True)


if __name__ == "__main__":
    main()
