#!/usr/bin/env bash
# Times whole commands on simulated campaigns: 18 runs x 36,000 rows, and 216 runs of 491 rows.
# Usage: benches/whole_job.sh   (after `cargo build --release`; Linux, GNU time where it is there)
set -euo pipefail
cd "$(dirname "$0")/.."
ieap=$PWD/target/release/ieap
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

timed() {
    local what=$1
    shift
    if [ -x /usr/bin/time ]; then
        /usr/bin/time -f "$what: %e s, %M kB" "$@" >/dev/null
    else
        TIMEFORMAT="$what: %R s"
        time "$@" >/dev/null
    fi
}

# The same runs, sampled every 0.1 s on both channels.
mkdir "$work/long"
cp campaigns/thesis/campaign.toml "$work/long/"
awk '/^\[\[sampling\]\]/ && !done { print "[[sampling]]\nuntil_s = 3598.0\nevery_s = 0.1\n"; done = 1 }
     /^\[\[(sampling|camera)\]\]/ { skip = 1 } /^\[\[folder\]\]/ { skip = 0 } !skip' \
    campaigns/thesis/simulation.toml >"$work/long/simulation.toml"
"$ieap" --quiet simulate "$work/long/simulation.toml" >/dev/null

# Twelve of each run; every copy has noise of its own, for the place in the spec seeds it.
mkdir "$work/many"
cp campaigns/thesis/campaign.toml "$work/many/"
head=$(awk '/^\[\[run\]\]/ { exit } { print }' campaigns/thesis/simulation.toml)
runs=$(awk '/^\[\[run\]\]/ { on = 1 } on' campaigns/thesis/simulation.toml)
{ echo "$head"; for k in $(seq 12); do echo; echo "${runs//V.csv/V_$k.csv}"; done; } >"$work/many/simulation.toml"
"$ieap" --quiet simulate "$work/many/simulation.toml" >/dev/null

for campaign in long many; do
    rows=$(find "$work/$campaign/runs" -name '*.csv' -exec cat {} + | wc -l)
    files=$(find "$work/$campaign/runs" -name '*.csv' | wc -l)
    echo "$campaign: $files files, $rows lines"
    timed "  run, empty database to report" "$ieap" run "$work/$campaign"
    timed "  run with nothing new" "$ieap" run "$work/$campaign"
    timed "  report" "$ieap" report --again "$work/$campaign"
done
