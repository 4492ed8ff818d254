"""Simulate step responses of strips with a hidden law, written from the equations alone.

Two R-C branches and R_ss in parallel; the spring strain follows s' = q' - lambda s and the curvature is
alpha area s. Charges and strain are integrated by RK4; a hidden law multiplies one part by exp(size shape(x)),
or adds size peak shape(x), with x the variable in parts of its largest value in the plain group. The size is
sought so that `d` standard deviations of the noise are left after the plain model's parameters (and zeros and
drifts, where there are any) are refitted.

    python simulate.py FOLDER --first 1000 --groups 4 --kind laws --d 32
"""
import argparse
import json
from pathlib import Path

import numpy as np

AREA_CM2 = 0.1          # 10 mm x 1 mm
STEPS = 2400            # of the integration, a run
REST = 240              # of them before the first edge
READINGS = 600
NOISE = 0.002           # standard deviation, parts of the peak of the group
ZERO = 0.003            # standard deviation of a run's zero of the current, parts of the peak
DRIFT = 0.01            # standard deviation of a run's drift of the curvature over the run, parts of the peak
SCATTER = 0.01          # standard deviation of every parameter between repeats
LARGEST = 1.2           # largest size of a law
AS_WRITTEN = argparse.RawDescriptionHelpFormatter
KINDS = "laws one-step zero drift repeats between nothing".split()
# (voltage in V, part of the run under voltage at which it begins)
DRIVES = [[(2, 0)], [(1, 0)], [(-2, 0)], [(1.5, 0), (0, 0.5)],
          [(1.5, 0), (0, 1 / 6), (-1.5, 1 / 3), (0, 1 / 2), (1.5, 2 / 3), (0, 5 / 6)]]
PARAMETERS = ["R1", "C1", "R2", "C2", "R_ss", "alpha", "lambda"]
ANY = ["voltage", "|voltage|", "charge", "|charge|", "bending", "|bending|", "time", "|current|"]
CELLS = {"R1": ANY, "R2": ANY, "alpha": ANY, "lambda": ANY, "R_ss": [v for v in ANY if v != "|current|"],
         # voltage and charge of a capacitance are its own
         "C1": ["voltage", "|voltage|", "charge", "|charge|", "bending", "time"],
         "C2": ["voltage", "|voltage|", "charge", "|charge|", "bending", "time"],
         "added current": ["voltage", "|voltage|", "charge", "bending", "time", "|current|"],
         "added bending": ["voltage", "|voltage|", "charge", "|charge|", "time", "current"]}


def shape(rng):
    """A random curve that is 0 at 0: its name and the function."""
    name = rng.choice(["power", "saturating", "threshold", "exponential", "bell"])
    a, b = rng.uniform(0.3, 0.8), rng.uniform(0.1, 0.3)
    if name == "power":
        p = rng.uniform(0.6, 3)
        raw = lambda x: np.sign(x) * np.abs(x) ** p
    elif name == "saturating":
        raw = lambda x: np.tanh(x / (2 * b))
    elif name == "threshold":
        raw = lambda x: np.logaddexp(0, (x - a) * 5 / b) * b / 5
    elif name == "exponential":
        k = rng.choice([-1, 1]) * rng.uniform(1, 3)
        raw = lambda x: np.expm1(k * x) / np.expm1(k)
    else:
        raw = lambda x: np.exp(-0.5 * ((x - a) / b) ** 2)
    return str(name), lambda x: raw(x) - raw(0.0)


def parameters(rng, span_s):
    """Random parameters of a strip for runs of that length; ohm cm2, F/cm2, 1/(C cm), 1/s."""
    r1, r2 = rng.uniform(100, 400), rng.uniform(200, 800)
    tau1, tau2 = span_s * rng.uniform(0.012, 0.03), span_s * rng.uniform(0.1, 0.25)
    return {"R1": r1, "C1": tau1 / r1, "R2": r2, "C2": tau2 / r2, "R_ss": rng.uniform(8, 30) * r2,
            "alpha": rng.uniform(10, 25), "lambda": rng.uniform(0.5, 5) / span_s}


class Law:
    """What is hidden: a part, its variable, a shape and sizes (one a row of what is integrated)."""

    def __init__(self, part=None, variable="", f=None, size=0.0, scales=None):
        self.part, self.variable, self.f, self.scales = part, variable, f, scales
        self.size = np.atleast_1d(size)[:, None]

    def of(self, known):
        key = self.variable.strip("|")
        x = known[key] / self.scales[key]
        return self.size * self.f(np.abs(x) if "|" in self.variable else x)


def capacitor_voltage(q, c, part, law, known):
    """The voltage at which a capacitor C(.) holds the charge q."""
    if law.part != part:
        return q / c
    if law.variable.strip("|") != "voltage":
        return q / (c * np.exp(law.of({**known, "charge": q * law.scales["charge"] / law.scales[part]})))
    v, charge = q / c, lambda v: c * v * np.exp(law.of({"voltage": v}))
    for _ in range(5):  # Newton
        v = v - (charge(v) - q) / np.maximum((charge(v + 1e-6) - charge(v - 1e-6)) / 2e-6, 0.2 * c)
    return v


def strip(state, v, t, p, law):
    """Rates of the charges and the strain, current in A, curvature in 1/cm."""
    q1, q2, s = state
    known = {"voltage": v, "charge": q1 + q2, "bending": p["alpha"] * AREA_CM2 * s, "time": max(t, 0.0), "current": 0.0}
    for _ in range(5 if "current" in law.variable else 1):  # the current that a law follows is sought with it
        p_now, added = dict(p), 0.0
        if law.part and law.part[0] != "C":
            change = law.of(known)
            if law.part.startswith("added"):
                added = change * law.scales[law.part.split()[1]]
            else:
                p_now[law.part] = p[law.part] * np.exp(change)
        i1 = (v - capacitor_voltage(q1, p["C1"], "C1", law, known)) / p_now["R1"]
        i2 = (v - capacitor_voltage(q2, p["C2"], "C2", law, known)) / p_now["R2"]
        total = AREA_CM2 * (i1 + i2 + v / p_now["R_ss"]) + (added if law.part == "added current" else 0.0)
        known["current"] = total
    curvature = p_now["alpha"] * AREA_CM2 * s + (added if law.part == "added bending" else 0.0)
    return np.array([i1, i2, i1 + i2 - p_now["lambda"] * s]), total, curvature


def integrate(p, law, volts, h):
    """Current, curvature and charges at every step; parameters are (rows, runs) or (rows, 1), volts (steps, runs)."""
    rows = max([len(law.size)] + [np.shape(x)[0] for x in p.values() if np.ndim(x)])
    state = np.zeros((3, rows, volts.shape[1]))
    out = np.zeros((len(volts), 4, rows, volts.shape[1]))
    for n, v in enumerate(volts):
        t = (n - REST) * h
        k1, current, curvature = strip(state, v, t, p, law)
        out[n] = np.broadcast_arrays(current, curvature, *state[:2])
        k2 = strip(state + h / 2 * k1, v, t + h / 2, p, law)[0]
        k3 = strip(state + h / 2 * k2, v, t + h / 2, p, law)[0]
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + strip(state + h * k3, v, t + h, p, law)[0])
    return out


def readings(drive, clock, rng):
    """Steps at which a run is read: evenly at rest, by the clock after every edge."""
    edges = [REST + round(at * (STEPS - REST)) for _, at in drive] + [STEPS]
    rest = READINGS * REST // STEPS
    taken = [np.arange(rest) * REST // rest]
    for a, b in zip(edges, edges[1:]):
        m = round((READINGS - rest) * (b - a) / (STEPS - REST))
        u = np.arange(m) / m
        if clock == "log":
            u = np.expm1(3 * u) / np.expm1(3)
        elif clock == "jittered":
            u = u + rng.uniform(0, 0.8, m) / m
        elif clock == "three rates":
            u = np.interp(u, [0, 1 / 3, 2 / 3, 1], [0, 0.1, 0.4, 1])
        taken.append(a + np.floor(u * (b - a)).astype(int))
    return np.unique(np.concatenate(taken))


def size_for(norms, d):
    """The size of a law that leaves d: a bracket, made smaller twice; none where no size does."""
    sizes = np.geomspace(1e-3, LARGEST, 16)
    for _ in range(3):
        with np.errstate(all="ignore"):
            left = norms(sizes)
        if not np.isfinite(left).all() or left[0] > d or left[-1] < d:
            return None
        k = max(int(np.argmax(left >= d)), 1)
        best, sizes = np.interp(d, left[k - 1:k + 1], sizes[k - 1:k + 1]), np.linspace(sizes[k - 1], sizes[k], 6)
    return best


def group(seed, kind="laws", d=32.0, clocks=False, noise=NOISE):
    """Runs (a dict each) of one strip and the truth. Of zero, drift and repeats every odd seed hides nothing."""
    rng = np.random.default_rng(seed)
    h = rng.uniform(500, 1500) / (STEPS - REST)
    base = parameters(rng, h * STEPS)
    clock = str(rng.choice(["log", "jittered", "three rates"])) if clocks else "even"
    drives = DRIVES[:1] if kind == "one-step" else DRIVES * 2 if kind == "repeats" else DRIVES
    volts = np.zeros((STEPS, len(drives)))
    for r, drive in enumerate(drives):
        for level, at in drive:
            volts[REST + round(at * (STEPS - REST)):, r] = level
    taken = [readings(drive, clock, rng) for drive in drives]

    # The plain group, its scales and what its parameters can take.
    rows = [dict(base)] + [{**base, k: base[k] * np.exp(e)} for k in PARAMETERS for e in (1e-3, -1e-3)]
    plain = integrate({k: np.array([[row[k]] for row in rows]) for k in PARAMETERS}, Law(), volts, h)
    peak = np.abs(plain[:, :2, 0]).max(axis=(0, 2))
    sigma = noise * peak
    largest = np.abs(plain[:, :, 0]).max(axis=(0, 2))
    scales = {"voltage": 2.0, "time": h * (STEPS - REST), "current": peak[0], "bending": peak[1],
              "charge": np.abs(plain[:, 2, 0] + plain[:, 3, 0]).max(), "C1": largest[2], "C2": largest[3]}
    seen = lambda out: np.concatenate([out[t, c, :, r] / sigma[c] for r, t in enumerate(taken) for c in (0, 1)])
    y = seen(plain)
    columns = [(y[:, 1 + 2 * k] - y[:, 2 + 2 * k]) / 2e-3 for k in range(len(PARAMETERS))]
    place = np.concatenate([np.full(len(t), 2 * r + c) for r, t in enumerate(taken) for c in (0, 1)])
    clock_of = np.concatenate([t for t in taken for _ in (0, 1)])
    columns += [(place == 2 * r) * 1.0 for r in range(len(drives)) if kind == "zero"]
    columns += [(place == 2 * r + 1) * clock_of for r in range(len(drives)) if kind == "drift"]
    space = np.linalg.qr(np.array(columns).T)[0]

    take = np.linalg.pinv(np.array(columns).T)

    def left(sizes, of):
        """Standard deviations that laws of these sizes leave after the refit (Gauss-Newton, one Jacobian)."""
        target, x = seen(integrate(*of(sizes), volts, h)), np.zeros((len(PARAMETERS), len(sizes)))
        for _ in range(3):
            refit = {k: base[k] * np.exp(x[i])[:, None] for i, k in enumerate(PARAMETERS)}
            change = target - (y[:, :1] if not x.any() else seen(integrate(refit, Law(), volts, h)))
            x = x + (take @ change)[:len(PARAMETERS)]
        return np.linalg.norm(change - space @ (space.T @ change), axis=0)

    nothing = kind == "nothing" or (kind in ("zero", "drift", "repeats") and seed % 2 == 1)
    truth = {"seed": seed, "kind": kind, "hidden": "nothing", "clock": clock, "parameters": base}
    of = lambda size: (base, Law())
    while not nothing:
        sign = rng.choice([-1, 1])
        if kind == "between":
            which = [str(k) for k in rng.choice(PARAMETERS, rng.integers(1, 3), replace=False)]
            follows = "voltage" if rng.random() < 0.5 else "run"
            ways = {k: rng.uniform(0.5, 1) * rng.choice([-1, 1]) * np.log(np.array([abs(x[0][0]) for x in drives]))
                    if follows == "voltage" else rng.normal(size=len(drives)) for k in which}
            of = lambda size: ({k: base[k] * np.exp(np.atleast_1d(size)[:, None] * ways[k]) if k in ways
                                else np.full((np.size(size), 1), base[k]) for k in PARAMETERS}, Law())
            what = {"hidden": "differs", "parts": which, "with": follows,
                    "words": f"{' and '.join(which)} by {follows}"}
        else:
            part = str(rng.choice(list(CELLS)))
            variable = str(rng.choice([v for v in CELLS[part] if kind != "one-step" or "voltage" not in v
                                       or part in ("C1", "C2", "added bending")]))  # one level is no variable
            name, f = shape(rng)
            of = lambda size: (base, Law(part, variable, f, size, scales))
            what = {"hidden": "law", "part": part, "variable": variable, "shape": name,
                    "words": f"{part} by {variable} ({name})"}
        size = size_for(lambda sizes: left(sign * sizes, of), d)
        if size is not None:
            truth |= {**what, "size": float(sign * size), "d": float(d)}
            break
    p, law = of(truth.get("size", 0.0))
    if kind == "repeats":
        p = {k: x * np.exp(SCATTER * rng.normal(size=(1, len(drives)))) for k, x in p.items()}
    out = integrate(p, law, volts, h)[:, :2, 0]
    runs = []
    for r, t in enumerate(taken):
        current, curvature = (out[t, c, r] + sigma[c] * rng.normal(size=len(t)) for c in (0, 1))
        if kind == "zero":
            current = current + peak[0] * ZERO * rng.normal()
        if kind == "drift":
            curvature = curvature + peak[1] * DRIFT * rng.normal() * t / STEPS
        runs.append({"voltage_v": drives[r][0][0], "cycle": r + 1,
                     "rows": np.column_stack([(t - REST) * h, volts[t, r], current, curvature])})
    return runs, truth


def write(folder, groups):
    """A campaign of (runs, truth), a sample each, and truth.json."""
    folder = Path(folder)
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    text = ['[campaign]', 'id = "stranger"', 'title = "Simulated strips"', 'timezone = "UTC"',
            '[runs]', 'folder = "runs"',
            'name_pattern = "{sample}_{environment}_{voltage_v}V_{cycle}"']
    for runs, truth in groups:
        sample = f"S{truth['seed']}"
        text += ['[[sample]]', f'id = "{sample}"', 'material = "M"', 'length_mm = 10.0', 'width_mm = 1.0']
        for run in runs:
            np.savetxt(folder / "runs" / f"{sample}_air_{run['voltage_v']}V_{run['cycle']}.csv", run["rows"], "%.7g",
                       ",", header="time_s,voltage_v,current_a,curvature_per_cm", comments="")
    (folder / "campaign.toml").write_text("\n".join(text) + "\n")
    (folder / "truth.json").write_text(json.dumps([truth for _, truth in groups], indent=1))


def options(parser):
    """Options that both scripts share."""
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--groups", type=int, default=1)
    parser.add_argument("--kind", choices=KINDS, default="laws")
    parser.add_argument("--d", type=float, default=32, help="standard deviations left after the refit")
    parser.add_argument("--clocks", action="store_true", help="a random clock a group in place of an even one")
    parser.add_argument("--noise", type=float, default=NOISE, help="parts of the peak")
    return parser


if __name__ == "__main__":
    cli = options(argparse.ArgumentParser(description=__doc__, formatter_class=AS_WRITTEN))
    cli.add_argument("folder")
    o = cli.parse_args()
    write(o.folder, [group(s, o.kind, o.d, o.clocks, o.noise) for s in range(o.first, o.first + o.groups)])
