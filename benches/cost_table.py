#!/usr/bin/env python3
"""Makes the tables of docs/benchmarks.md: times the user's own commands and reads what `cargo bench` says.

Usage: benches/cost_table.py [--parts single,growth] [--runs 100,1000,4000,10000] [--diagnose-up-to 1000] [--work FOLDER]
After `cargo build --release`; builds the benches itself. Needs Python 3.9 and nothing else; Linux.

Each part stands between two marker lines of the page, and everything between them is written anew.
IEAP names another program than target/release/ieap. A table of 10,000 runs takes about half an hour.
"""

import argparse
import datetime
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import scale

HOUSE = pathlib.Path(__file__).resolve().parent.parent
PAGE = HOUSE / "docs/benchmarks.md"
BEGIN, END = "<!-- {}: made by benches/cost_table.py -->", "<!-- to here -->"
# What a row says, the bench, and the names that its numbers have there.
BENCHES = [
    ("fit of 3,600 readings x 2 channels, step stated; between two readings", "fit",
     ["fit 3600 samples x 2 channels", "fit 3600 samples x 2 channels, step between readings"]),
    ("fit of 36,000 readings x 2 channels, the same", "fit",
     ["fit 36000 samples x 2 channels", "fit 36000 samples x 2 channels, step between readings"]),
    ("distributed model at 100 places x 1,000 times: voltage; curvature", "distributed",
     ["voltage, 100 positions x 1,000 times", "curvature, 100 positions x 1,000 times"]),
    ("distributed fit of 50 places x 500 times and a current", "distributed",
     ["distributed fit, 50 positions x 500 times and a current"]),
    ("frame of 1280 x 1024 pixels traced; its PNG decoded", "frames",
     ["trace 1280 x 1024, decoded", "decode 1280 x 1024 PNG"]),
    ("plain tables of 200,000 rows", "ingest", ["long/plain table"]),
    ("Gamry; BioLogic; CH Instruments text; TDMS", "ingest",
     ["long/Gamry", "long/BioLogic text", "long/CH Instruments", "long/TDMS"]),
    ("climate log of a year, 525,600 readings x 2", "ingest", ["climate/a year of minutes, 525600 x 2"]),
    ("pages of 200 runs", "report", ["report/200 runs, 2 curves each"]),
]
COLUMNS = ["ingest", "fit", "diagnose", "report", "one run more", "tag and report", "status", "nothing new"]


def rounded(number):
    """Three digits at most, of what is below one hundred two."""
    return f"{number:,.0f}" if number >= 100 else f"{float(f'{number:.2g}'):g}"


def said_by(bench):
    """Middle of the time, or the speed where the bench states bytes, by the name of each measurement."""
    command = ["cargo", "bench", "--quiet", "--bench", bench]
    print(*command, file=sys.stderr, flush=True)
    text = subprocess.run(command, cwd=HOUSE, check=True, capture_output=True, text=True).stdout
    number = r"\s+\[\S+ \S+ (\S+) (\S+) \S+ \S+\]"
    found = re.findall(rf"^(\S[^\n]*?)\s+time:{number}(?:\s+thrpt:{number})?", text, re.MULTILINE)
    to_mb = {"KiB/s": 1.024e-3, "MiB/s": 1.048576, "GiB/s": 1073.741824}
    def shown(time, unit, speed, per):
        return f"{rounded(float(speed) * to_mb[per])} MB/s" if speed else f"{rounded(float(time))} {unit}"
    return {name: shown(*numbers) for name, *numbers in found}


def of_benches():
    said = {bench: said_by(bench) for bench in dict.fromkeys(bench for _, bench, _ in BENCHES)}
    for what, bench, names in BENCHES:
        yield f"| {what} | {'; '.join(said[bench][name] for name in names)} | `{bench}` |"


def of_main_job(ieap, work):
    """The main job on a copy of the thesis campaign, from an empty database."""
    campaign = work / "thesis"
    made = shutil.ignore_patterns("campaign.db*", "archive", "report")
    shutil.copytree(HOUSE / "campaigns/thesis", campaign, ignore=made)
    took = scale.timed([ieap, "--quiet", "--no-progress", "run", campaign])
    shutil.rmtree(campaign)
    time = f"{rounded(took['seconds'])} s, {rounded(took['processor_seconds'])} s of processor time"
    return f"| main job of 21 runs with diagnosis | {time} | none: README's first command |"


def of_growth(ieap, work, runs, diagnose):
    found = scale.measured(ieap, work, runs, diagnose)
    shutil.rmtree(work / str(runs))
    commands = found["commands"]
    times = [rounded(commands[name]["processor_seconds"]) if name in commands else "-" for name in COLUMNS]
    memory = max(took["memory_mb"] for took in commands.values())
    sizes = [rounded(found[f"{what}_mb"]) for what in ("database", "archive", "report")]
    return f"| {runs:,} | {' | '.join(times)} | {rounded(memory)} | {', '.join(sizes)} |"


def machine():
    text = pathlib.Path("/proc/cpuinfo").read_text()
    model = re.search(r"model name\s*: (.*)", text)
    return f"{os.cpu_count()} cores, {model.group(1) if model else 'of a kind that is not said'}"


def where(ieap):
    version = subprocess.run([ieap, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    return f"{version}, release profile, {machine()}, {datetime.date.today()}:"


def parts(ieap, work, given):
    """The tables of the page by the names in their marker lines, made as they are asked for."""
    sizes = [int(runs) for runs in given.runs.split(",")]
    heads = [f"| runs | {' | '.join(COLUMNS)} | memory at most, MB | database, archive, report, MB |"]
    heads += ["|---" * (len(COLUMNS) + 3) + "|"]
    growth = lambda: heads + [of_growth(ieap, work, runs, runs <= given.diagnose_up_to) for runs in sizes]
    single = lambda: ["| what | measured | `cargo bench --bench` |", "|---|---|---|", *of_benches(), of_main_job(ieap, work)]
    return {"single": single, "growth": growth}


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--parts", default="single,growth")
    arguments.add_argument("--runs", default="100,1000,4000,10000")
    arguments.add_argument("--diagnose-up-to", type=int, default=1000)
    arguments.add_argument("--work", type=pathlib.Path)
    given = arguments.parse_args()
    ieap = pathlib.Path(os.environ.get("IEAP", HOUSE / "target/release/ieap"))
    with tempfile.TemporaryDirectory(dir=given.work) as work:
        make = parts(ieap, pathlib.Path(work), given)
        for part in given.parts.split(","):
            made = "\n".join([where(ieap), "", *make[part]()])
            before, rest = PAGE.read_text().split(BEGIN.format(part))
            after = rest.split(END, 1)[1]
            PAGE.write_text(f"{before}{BEGIN.format(part)}\n{made}\n{END}{after}")


if __name__ == "__main__":
    main()
