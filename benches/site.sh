#!/usr/bin/env bash
# Time and size of the report of simulated campaigns of 200 and 2,000 runs: four samples of two materials at five
# humidities and five voltages, in two or twenty cycles.
# Usage: benches/site.sh [FOLDER]   (after `cargo build --release`; FOLDER keeps the campaigns; IEAP: the program)
set -euo pipefail
cd "$(dirname "$0")/.."
ieap=${IEAP:-$PWD/target/release/ieap}
work=${1:-$(mktemp -d)}
[ $# -gt 0 ] || trap 'rm -rf "$work"' EXIT

# campaign FOLDER CYCLES
campaign() {
    mkdir -p "$1"
    {
        printf '[campaign]\nid = "humid"\ntitle = "Four samples under humidity"\ntimezone = "Europe/Tallinn"\nnotice = "Simulated, not measured."\n'
        for sample in CNaf-1 CNaf-2 CPvf-1 CPvf-2; do
            printf '\n[[sample]]\nid = "%s"\nmaterial = "%s"\nlength_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.22\n' "$sample" "${sample%-*}"
        done
    } >"$1/campaign.toml"
    awk '/^\[simulation\]/ { on = 1 } /^\[\[folder\]\]/ { exit } on' campaigns/thesis/simulation.toml >"$1/simulation.toml"
    awk -v cycles="$2" 'BEGIN {
        split("CNaf-1 CNaf-2 CPvf-1 CPvf-2", samples, " "); split("20 35 50 65 80", humidities, " "); split("0.8 1.2 1.6 2.0 2.5", volts, " ")
        for (cycle = 1; cycle <= cycles; cycle++) for (h = 1; h <= 5; h++) for (v = 1; v <= 5; v++) for (s = 1; s <= 4; s++) {
            run++
            ionic = s <= 2; own = s % 2 ? 1 : 1.15; rh = humidities[h] + 0.3 * (run * 7 % 5 - 2); wet = (rh - 20) / 60
            printf "\n[[run]]\nfile = \"%s_air_rh%s_%sV_%d.csv\"\narea_cm2 = 0.1\nvoltage_v = %s\n", samples[s], humidities[h], volts[v], cycle, volts[v]
            printf "parameters = { r1_ohm_cm2 = %.6g, c1_f_per_cm2 = %.6g, r2_ohm_cm2 = %.6g, c2_f_per_cm2 = %.6g, rss_ohm_cm2 = %.6g, alpha_per_c_cm = %.6g, lambda_per_s = %.6g }\n", \
                (ionic ? 200 : 40) * own * exp(-0.4 * wet), ionic ? 0.1 : 0.3, (ionic ? 600 : 90) * own, (ionic ? 0.15 : 1.4) * own, (ionic ? 20000 : 1700) * exp(-0.8 * wet), (ionic ? 16 : 4) / own, (ionic ? 4e-4 : 2e-4) * exp(0.03 * (rh - 20))
            day = int((run - 1) / 24)
            printf "tags = { sample = \"%s\", environment = \"air\", voltage_v = %s, relative_humidity_percent = %.1f, cycle = %d, operator = \"%s\", started_at = \"2026-%02d-%02dT%02d:00:00Z\" }\n", \
                samples[s], volts[v], rh, cycle, run % 3 ? "mk" : "tr", 1 + int(day / 28), 1 + day % 28, (run - 1) % 24
        }
    }' >>"$1/simulation.toml"
    "$ieap" --quiet simulate "$1/simulation.toml" >/dev/null
    "$ieap" --quiet --no-progress run "$1" --no-diagnose >/dev/null
}

for cycles in 2 20; do
    runs=$((100 * cycles))
    [ -f "$work/$runs/campaign.db" ] || campaign "$work/$runs" "$cycles"
    TIMEFORMAT="$runs runs: %R s, %U s of processor time"
    time "$ieap" --quiet report --again "$work/$runs" >/dev/null
    echo "  $(find "$work/$runs/report" -type f -printf '%s\n' | awk '{ sum += $1 } END { printf "%.2f MB in %d files", sum / 1e6, NR }')"
    first=$(cd "$work/$runs/report" && find . -type f -exec sha256sum {} + | sort | sha256sum)
    "$ieap" --quiet report --again "$work/$runs" >/dev/null
    second=$(cd "$work/$runs/report" && find . -type f -exec sha256sum {} + | sort | sha256sum)
    [ "$first" = "$second" ] && echo "  the same bytes again" || { echo "  OTHER BYTES"; exit 1; }
done
