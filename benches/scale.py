#!/usr/bin/env python3
"""How the cost grows with the number of runs: ingest, fit, diagnosis, report, status, a tag, a run more, nothing new; time,
memory, size. One line of JSON a campaign; `benches/cost_table.py` makes the tables of the docs of them.

Usage: benches/scale.py [--runs 100,1000,10000,100000] [--diagnose-up-to 1000] [--work FOLDER]
After `cargo build --release`. Needs Python 3.8 and nothing else; Linux (peak memory as the kernel counts it).

100,000 runs take hours and 15 GB; leave them out with --runs where that is too much.

Simulated campaigns of 700 readings of current and of bending a run, 25 runs a sample (five humidities, five voltages).
Every command is a process of its own; the first campaign is made by `ieap simulate`, whose time is not counted.
"""

import argparse
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

HOUSE = pathlib.Path(__file__).resolve().parent.parent
HUMIDITIES_PERCENT = [20, 35, 50, 65, 80]
VOLTAGES_V = [0.8, 1.2, 1.6, 2.0, 2.5]
SIMULATION = """[simulation]
seed = 20261123
statement = ["SIMULATED, not measured."]
folder = "runs"
baseline_s = 20.0
baseline_every_s = 5.0
[noise]
current_a = 2e-6
curvature_per_cm = 0.004
[[sampling]]
until_s = 3480.0
every_s = 5.0
[[camera]]
until_s = 3480.0
every_s = 5.0
"""
MATERIALS = ["CNaf", "CPvf", "PtNaf", "AuAq"]


def timed(command):
    """Seconds on the clock, of processor time, and MB of memory at most, of one process; told as it ends."""
    begun = time.monotonic()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    said = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        sys.exit(f"{' '.join(map(str, command))}\n{said}")
    took = {
        "seconds": round(time.monotonic() - begun, 3),
        "processor_seconds": round(usage.ru_utime + usage.ru_stime, 3),
        "memory_mb": round(usage.ru_maxrss / 1024, 1),
    }
    print(*[word for word in command[1:] if not str(word).startswith("--")], took, file=sys.stderr, flush=True)
    return took


def parameters(run, sample, humidity, kind):
    own, wet = 1 + 0.02 * (sample % 7), (humidity - 20) / 60
    r1, c1, r2, c2, rss, alpha, rate = [
        (200, 0.1, 600, 0.15, 20000, 16, 4e-4),
        (40, 0.3, 90, 1.4, 1700, 4, 2e-4),
    ][kind % 2]
    values = {
        "r1_ohm_cm2": r1 * own * math.exp(-0.4 * wet),
        "c1_f_per_cm2": c1,
        "r2_ohm_cm2": r2 * own,
        "c2_f_per_cm2": c2 * own,
        "rss_ohm_cm2": rss * math.exp(-0.8 * wet),
        "alpha_per_c_cm": alpha / own,
        "lambda_per_s": rate * math.exp(0.03 * (humidity - 20)),
    }
    return ", ".join(f"{key} = {value:.6g}" for key, value in values.items())


def write_campaign(folder, runs):
    folder.mkdir(parents=True)
    samples = math.ceil(runs / 25)
    name = lambda sample: f"{MATERIALS[sample % len(MATERIALS)]}-{sample // len(MATERIALS) + 1}"
    with open(folder / "campaign.toml", "w") as out:
        out.write('[campaign]\nid = "scale"\ntitle = "Many samples under humidity"\n')
        out.write('timezone = "Europe/Tallinn"\nnotice = "Simulated, not measured."\n')
        for sample in range(samples):
            out.write(f'\n[[sample]]\nid = "{name(sample)}"\nmaterial = "{MATERIALS[sample % len(MATERIALS)]}"\n')
            out.write("length_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.22\n")
    with open(folder / "simulation.toml", "w") as out:
        out.write(SIMULATION)
        for run in range(runs):
            sample, place = divmod(run, 25)
            humidity, voltage = HUMIDITIES_PERCENT[place // 5], VOLTAGES_V[place % 5]
            day, hour = divmod(run, 24)
            start = time.strftime("%Y-%m-%dT%H:00:00Z", time.gmtime(1577836800 + 86400 * day + 3600 * hour))
            out.write(f'\n[[run]]\nfile = "{run // 1000:03}/{name(sample)}_air_rh{humidity}_{voltage}V.csv"\n')
            out.write(f"area_cm2 = 0.1\nvoltage_v = {voltage}\n")
            out.write(f"parameters = {{ {parameters(run, sample, humidity, sample % len(MATERIALS))} }}\n")
            out.write(f'tags = {{ sample = "{name(sample)}", environment = "air", voltage_v = {voltage}, ')
            out.write(f'relative_humidity_percent = {humidity}, started_at = "{start}" }}\n')


def size_mb(folder, names):
    return round(sum(path.stat().st_size for name in names for path in folder.glob(name)) / 1e6, 2)


def both(one, other):
    """What two commands take, one after the other."""
    return {key: max(one[key], other[key]) if key == "memory_mb" else round(one[key] + other[key], 3) for key in one}


def measured(ieap, work, runs, diagnose):
    """What every command takes on a new campaign of so many runs."""
    folder = work / str(runs)
    if folder.exists():
        shutil.rmtree(folder)
    write_campaign(folder, runs + 1)
    subprocess.run([ieap, "--quiet", "simulate", folder / "simulation.toml"], check=True, stdout=subprocess.DEVNULL)
    last = max((folder / "runs").rglob("*.csv"), key=lambda path: (path.parent.name, path.stat().st_mtime_ns))
    # With the file of its tags, which says nothing without it.
    own = [last, last.with_name(f"{last.name}.toml")]
    for path in own:
        shutil.move(path, work / path.name)
    quiet = [ieap, "--quiet", "--no-progress"]
    found = {
        "ingest": timed(quiet + ["ingest", folder]),
        "fit": timed(quiet + ["fit", folder]),
    }
    if diagnose:
        found["diagnose"] = timed(quiet + ["diagnose", folder])
    found["report"] = timed(quiet + ["report", folder])
    found["status"] = timed(quiet + ["status", folder])
    some = min((folder / "runs").rglob("*.csv")).relative_to(folder)
    tag = timed(quiet + ["tag", some, "note=looked at", folder])
    found["tag and report"] = both(tag, timed(quiet + ["report", folder]))
    for path in own:
        shutil.move(work / path.name, path)
    found["one run more"] = timed(quiet + ["run", "--no-diagnose", folder])
    found["nothing new"] = timed(quiet + ["run", "--no-diagnose", folder])
    return {
        "runs": runs,
        "commands": found,
        "files_mb": size_mb(folder, ["runs/**/*.csv"]),
        "database_mb": size_mb(folder, ["campaign.db*"]),
        "archive_mb": size_mb(folder / "archive", ["**/*.*"]),
        "report_mb": size_mb(folder / "report", ["**/*.*"]),
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--runs", default="100,1000,10000,100000")
    arguments.add_argument("--diagnose-up-to", type=int, default=1000)
    arguments.add_argument("--work", type=pathlib.Path)
    given = arguments.parse_args()
    ieap = pathlib.Path(os.environ.get("IEAP", HOUSE / "target/release/ieap"))
    with tempfile.TemporaryDirectory() as scratch:
        work = given.work or pathlib.Path(scratch)
        work.mkdir(parents=True, exist_ok=True)
        for runs in map(int, given.runs.split(",")):
            print(json.dumps(measured(ieap, work, runs, runs <= given.diagnose_up_to)), flush=True)
            if not given.work:
                shutil.rmtree(work / str(runs))


if __name__ == "__main__":
    main()
