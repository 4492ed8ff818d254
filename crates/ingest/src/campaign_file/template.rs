//! The campaign.toml that `ieap init` writes.

/// A commented campaign.toml for a campaign of that id. Samples and environments stand as comments, so that
/// no invented dimension is ever taken for a measured one.
pub fn template(id: &str) -> String {
    let id = toml::Value::String(id.to_owned());
    format!(
        r#"# A campaign of runs on ionic electroactive polymer actuators. Lines that start with # are comments:
# take the # away from a line to use it. Units stand in the names.

[campaign]
id = {id}                               # short name, for files and pages
title = {id}                            # what stands above the report
# timezone = "Europe/Tallinn"            # for times in files that state no offset, and on pages
# date_order = "day-first"               # of dates that may be read in several orders, such as 02/03/2026
# notice = "simulated, not measured"     # printed on every page of the report
# model = "lumped-2"                     # model that runs are fitted with; effects extend it: "lumped-2 + faradaic-leak"
# Runs that `ieap diagnose` takes together, one parameter set for all: those that agree in these tags.
# group_by = ["sample", "environment", "relative_humidity_percent"]
# tolerance_percent = 1                  # a simulation that is off by less is right

# How all runs are fitted; without it `ieap run --only fit --method ..` or `--simultaneous` holds for the runs that were there.
# [fit]
# method = "variable-projection"         # `ieap list models` lists the methods
# simultaneous = true                    # both responses at once, instead of one after the other

# What tables leave open, answered once for all files; `ieap status` asks (docs/profiles.md lists the questions).
# [answers]
# clock = "mm:ss"                        # what 2:01 is; or "hh:mm"
# humidity = "percent"                   # of logs that name no unit; or "fraction"

# One entry for each strip. Runs name it by the tag `sample`.
# [[sample]]
# id = "CNaf-01"
# material = "CNaf"                      # one column group in the tables
# length_mm = 5.0                        # free length
# width_mm = 2.0
# thickness_mm = 0.22
# area_cm2 = 0.1                         # only where it is not length times width
# electrode_resistance_ohm_per_sq = 2.5  # of both electrodes along the strip, for model = "distributed"
# batch = "2026-03"

# What the tables say of a material (optional).
# [[material]]
# id = "CNaf"
# electrode = "CDC + Nafion"
# membrane = "Nafion 117"
# electrolyte = "EMImTFS"
# current_collector = "gold foil"
# reinforcement = "none"
# electrode_thickness_um = 30.0
# membrane_thickness_um = 200.0

# vacuum, inert and air are known without an entry. An entry gives what holds where nothing was measured.
# [[environment]]
# id = "air"
# relative_humidity_percent = 34.0
# temperature_c = 22.0
# pressure_pa = 101325.0

# Climate loggers: copy their files into ambient/. Each sensor may be described (all optional but id).
# [[sensor]]
# id = "10173910"                        # serial number, or the name that the Climate page shows
# place = "bench"                        # sensors of one place are compared
# environments = ["air"]                 # runs that it speaks for; none stated: all but vacuum and inert
# relative_humidity_accuracy_percent = 2.5
# temperature_accuracy_c = 0.3
# relative_humidity_correction_percent = -1.2   # added to its readings, from the calibration
# calibration = "2026-02, saturated salts"
# utc_offset = "+02:00"                  # of its clock, where its files do not say

[climate]                                # rules for the climate of runs; what stands here are the defaults
# relative_humidity_tolerance_percent = 3.0     # largest deviation from the mean of a run
# temperature_tolerance_c = 1.0
# longest_gap_s = 3600                   # between two readings that a run may contain
# exposure_above_percent = 60            # hours above it accumulate per sample

# What the study asks; its answers lead the report (docs/study.md).
# [study]                                # without it: whatever the campaign varies
# compare = ["environment", "humidity"]  # also "voltage", "material"
# within = ["material"]                  # []: materials are put together, as samples of one
# at_equal = ["voltage"]                 # []: over all voltages of a condition
# scatter_percent = 10                   # from run to run, where every condition has one run
# alike_percent = 25                     # an effect that is no larger is none

# Materials that are put together by what [[material]] states of them (docs/study.md).
# [compare]
# by = "electrode"                       # or "membrane", "electrolyte"

# Long-term monitoring: repeat a run in one condition now and then (docs/monitoring.md).
# [monitoring]
# reference = {{ environment = "air", voltage_v = 2.0, relative_humidity_percent = 35 }}
# false_alarm_runs = 500                 # reference runs of a sample between two false alarms of all its charts, on average
# command = ["notify-lab", "--urgent"]   # hears of every new alarm, in variables IEAP_ALARM_...; runs where you allowed it (`ieap run --allow-command`)
# command_time_limit_s = 60              # then it is ended
# acknowledged = []                      # ids of alarms that are known
# [[monitoring.limit]]
# parameter = "alpha_per_c_cm"
# below = 12.0                           # or above

# Tags of your own, such as the specimen of a sample: declared once, they are known, and laws are sought in them.
# [tags]
# extra = ["specimen", "pre_charge_s"]

[runs]
folder = "runs"                          # every file in it and below it is looked at
# Reads tags from file names, here CNaf-01_air_rh34_2.5V_1.csv; {{_}} ignores a word:
# name_pattern = "{{sample}}_{{environment}}_rh{{relative_humidity_percent}}_{{voltage_v}}V_{{cycle}}"

# [dma]
# folder = "dma"                         # modulus logs of dynamic mechanical analysis, where there are any
# name_pattern = "{{sample}}_{{cycle}}"    # reads tags from their file names

# [impedance]
# folder = "impedance"                   # impedance spectra; they may lie among the runs as well
# name_pattern = "{{sample}}_{{environment}}"  # reads tags from their file names; that of [runs] where there is none
# circuits = ["R0-p(R1,CPE1)-W1"]        # fitted beside those that every spectrum is fitted with (docs/impedance.md)

# [report]
# templates = "templates"                # folder with templates of pages that take the place of the program's (docs/site.md)

# What only you can say of the data when they are published: `ieap export --what crate` asks for it (docs/publish.md).
# [publication]
# license = "CC-BY-4.0"
# description = "What was measured, and why"
# publisher = "Your university, or the repository"
# [[publication.author]]
# name = "Family, Given"
# orcid = "0000-0002-1825-0097"          # optional
"#
    )
}
