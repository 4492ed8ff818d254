"""Count how often `ieap diagnose` tells the truth about strips that simulate.py makes.

    python count.py --ieap PATH --first 1000 --groups 16 --d 32 --kind laws --jobs 2

Every group is a campaign of its own. Right: all that is said is true down to the deepest of place, law with
variable, and name. Wrong: something that is said is false. Rest: nothing is told of a place, or `differs`.
"""
import argparse
import collections
import json
import os
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

import simulate

PLACE = {"alpha": "bending", "lambda": "bending", "added bending": "bending"}  # all others: current
LAW = {"R1": {"resistance"}, "R2": {"resistance"}, "C1": {"capacitance"}, "C2": {"capacitance"}, "R_ss": {"leak"},
       "alpha": {"coupling"}, "lambda": {"relaxation"}, "added bending": {"added-bending"},
       "added current": {"current-reading", "leak"}}  # a leak where it follows the voltage
BRANCH = {"1": "fast-branch", "2": "slow-branch"}
KEY = {"R1": "r1_ohm_cm2", "C1": "c1_f_per_cm2", "R2": "r2_ohm_cm2", "C2": "c2_f_per_cm2", "R_ss": "rss_ohm_cm2",
       "alpha": "alpha_per_c_cm", "lambda": "lambda_per_s"}
# What a name says of the shape; a name that is not here is true where law and variable are.
SHAPES = {"faradaic-leak": {"threshold", "exponential", "saturating"}, "threshold-relaxation": {"threshold", "power"},
          "coupling-saturation": {"saturating", "exponential"}, "voltage-dependent-capacitance": {"power"},
          "asymmetric-capacitance": {"power", "saturating"}, "redox-peak": {"bell"}, "resistance-drift": {"power"},
          "piezoresistive-electrode": {"power"}, "polarity-coupling": {"saturating"}, "creep": {"power"}}


def variables(truth):
    """Keys of the variables that say the same as the truth's: a curve over x may be even, one over |x| only is."""
    v, sized = truth["variable"].strip("|"), "|" in truth["variable"]
    names = {"voltage": "voltage", "charge": "charge", "bending": "curvature", "time": "time", "current": "current"}
    # In this model the curvature *is* the charge that flowed of late, with a memory of 1/lambda.
    same = {names[v]} | ({"flow"} if v == "bending" else set())
    if sized or truth["kind"] == "one-step":
        same |= {f"{names[v]}-size"}
    if truth["part"][0] == "C" and v in ("voltage", "charge"):  # its own: each is a function of the other
        same |= {"voltage", "charge"} | ({"voltage-size", "charge-size"} if sized else set())
    return same | ({"since-edge"} if v == "time" and truth["kind"] == "one-step" else set())


def variable(key):
    """A variable of the JSON as those above, without its unit."""
    size = "-size" if any(w in key for w in ("size", "abs", "|", "magnitude")) else ""
    for word, name in (("since_edge", "since-edge"), ("time_s", "time"), ("voltage", "voltage"), ("charge", "charge"),
                       ("curvature", "curvature"), ("current", "current")):
        if word in key:
            return name + size
    return key


def false_of(law, truth):
    """What a told law says that is not so: none, `place`, `law`, `branch`, `variable` or `name`."""
    parts = [truth["part"]] if truth["hidden"] == "law" else truth.get("parts", [])
    for part in parts:
        if law["place"] != PLACE.get(part, "current"):
            found = "place"
        elif law["law"] is None:
            return "name" if law["name"] else None
        elif law["law"] not in LAW[part] or (part == "added current" and law["law"] == "leak"
                                             and truth.get("variable") not in ("voltage", "|voltage|")):
            found = "law"
        elif law["of"] and part[-1] in BRANCH and law["of"] != BRANCH[part[-1]]:
            found = "branch"
        elif truth["hidden"] == "differs":
            if truth["with"] == "voltage" and "voltage" in (law["variable"] or ""):
                return None
            found = "variable"
        elif variable(law["variable"] or "") not in variables(truth):
            found = "variable"
        elif law["name"] in SHAPES and truth["shape"] not in SHAPES[law["name"]]:
            found = "name"
        else:
            return None
    return found if parts else "law"


def judge(truth, found):
    """Right, wrong or rest, and why."""
    verdict, hidden, told = found["verdict"], truth["hidden"], found["missing"]
    if told:
        false = [w for w in (false_of(law, truth) for law in told) if w]
        depth = "name" if told[0]["name"] else "law" if told[0]["law"] else "place"
        return ("wrong", false[0]) if false else ("right", depth)
    if verdict in ("right", "undecided"):
        return ("right", "nothing") if hidden == "nothing" else ("rest", "not seen")
    if verdict == "differs" and hidden == "differs":
        keys = {d["key"] for d in found["differs"]}
        return ("right", "differs") if not keys or keys & {KEY[p] for p in truth["parts"]} else ("wrong", "parameter")
    if verdict == "instrument":
        return ("right", verdict) if hidden == "nothing" and truth["kind"] in ("zero", "drift") else ("wrong", verdict)
    if hidden == "nothing" and truth["kind"] != "repeats":
        return "wrong", verdict
    return "rest", verdict


def words(found):
    if found["verdict"] == "differs":
        return "differs: " + ", ".join(f"{d['key']} with {d['with']}" for d in found["differs"])
    if not found["missing"]:
        likeliest = [f"{p['effect'] or p['kind']} {p['mass']:.2f}" for p in found["posterior"][:1]]
        return ", likeliest ".join([found["verdict"], *likeliest])
    return " + ".join(" ".join(filter(None, [
        m["place"] + ":", m["law"], m["of"], m["variable"] and "by " + m["variable"], m["name"] and f"({m['name']})",
        f"p={m['probability']:.3f}"])) for m in found["missing"])


def one(o, seed):
    runs, truth = simulate.group(seed, o.kind, o.d, o.clocks, o.noise)
    with tempfile.TemporaryDirectory() as folder:
        simulate.write(folder, [(runs, truth)])
        begun = time.monotonic()
        done = subprocess.run([o.ieap, "--json", "--quiet", "--threads", "1", "diagnose", folder],
                              capture_output=True, text=True)
        seconds = time.monotonic() - begun
    try:
        found = json.loads(done.stdout)["groups"][0]
    except (ValueError, LookupError):
        return seed, truth, None, ("rest", "no answer"), seconds, done.stderr[-300:]
    return seed, truth, found, judge(truth, found), seconds, ""


def main():
    cli = simulate.options(argparse.ArgumentParser(description=__doc__, formatter_class=simulate.AS_WRITTEN))
    cli.add_argument("--ieap", required=True, help="the program")
    cli.add_argument("--jobs", type=int, default=2)
    cli.add_argument("--json", default=os.devnull, help="file for truths and answers, a line each")
    o = cli.parse_args()
    total, stated, spent = collections.Counter(), [], []
    with ThreadPoolExecutor(o.jobs) as pool, open(o.json, "w") as keep:
        answers = pool.map(lambda seed: one(o, seed), range(o.first, o.first + o.groups))
        for seed, truth, found, judged, seconds, error in answers:
            hidden, answer = truth.get("words", "nothing"), words(found) if found else error
            print(f"{seed} | {hidden} | {answer} | {judged[0]} ({judged[1]}) | {seconds:.0f} s", flush=True)
            total["nothing" if hidden == "nothing" else "a law", *judged] += 1
            spent.append(seconds)
            if found and found["missing"]:
                stated.append((found["missing"][0]["probability"], judged[0] == "right"))
            keep.write(json.dumps({"truth": truth, "found": found, "judged": judged}) + "\n")
    for hidden in ("a law", "nothing"):
        parts = [(kind, {w: n for (h, k, w), n in sorted(total.items()) if (h, k) == (hidden, kind)})
                 for kind in ("right", "wrong", "rest")]
        if any(part for _, part in parts):
            told = [f"{kind} {sum(part.values())} ({', '.join(f'{w} {n}' for w, n in part.items())})"
                    for kind, part in parts]
            print(f"hidden {hidden}: " + "; ".join(told))
    if stated:
        mean = sum(p for p, _ in stated) / len(stated)
        print(f"told: {len(stated)}, stated probability {mean:.3f} in the mean, true {sum(t for _, t in stated)}")
    print(f"seconds a group: {sum(spent) / len(spent):.1f}, at most {max(spent):.1f}")


if __name__ == "__main__":
    main()
