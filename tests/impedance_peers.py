"""Holds the spectra of `ieap impedance` against impedance.py and pyimpspec on the same files.

    python3 -m venv target/peers && target/peers/bin/pip install -r tests/impedance_peers.requirements.txt
    target/peers/bin/python tests/impedance_peers.py target/debug/ieap [FILE ...]

It makes a campaign in a temporary folder: spectra simulated from the circuits of the thesis's figures 7 and 8 and from a
constant-phase element, with noise and a fixed seed, and the FILEs, read by ieap as they are. The peers get the readings as
ieap has them. Prints one row a comparison, and ends with status 1 where a number differs by more than its limit.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import warnings

import numpy as np

warnings.filterwarnings("ignore")

# Limits of relative differences, per kind of number.
TEST_LIMIT = 1e-4  # residuals of the Kramers-Kronig test with the same elements: the same least squares
FIT_LIMIT = 2e-3  # parameters: the same minimum
Z_HIT_LIMIT = 3.0  # percent of |Z|: pyimpspec cuts the series after the first derivative, which strays by so much
DRT_LIMIT = 0.15  # a peak's time: regularisations differ
# A circuit as a text that every spectrum is fitted with, by ieap without first guesses.
TEXT = "R0-p(R1,CPE1)-p(R2,CPE2)"
TEXT_KEYS = ["r0_ohm", "r1_ohm", "cpe1_s_sn", "cpe1_exponent", "r2_ohm", "cpe2_s_sn", "cpe2_exponent"]
OWN_SEED = 20261123


def simulate(folder):
    rng = np.random.default_rng(OWN_SEED)
    hz = np.logspace(4, -2.5, 45)
    s = 2j * np.pi * hz
    chain = lambda r, c: 1 / (r + 1 / (s * c))
    circuits = {
        "figure-7": 1 / (chain(220, 4e-3) + 1 / 3e4),
        "figure-8": 1 / (chain(220, 4e-3) + chain(1500, 1.2e-2) + 1 / 3e4),
        "two-arcs": 50 + 1 / (1 / 100 + s * 2e-5) + 1 / (1 / 300 + s * 2e-3),
        "two-depressed-arcs": 50 + 1 / (1 / 300 + 2e-5 * s**0.9) + 1 / (1 / 2000 + 2e-3 * s**0.8),
        "constant-phase": 1 / (1 / (220 + 1 / (5e-3 * s**0.8)) + 1 / 3e4),
    }
    circuits["figure-8-exact"] = circuits["figure-8"]
    for name, z in circuits.items():
        noise = 0.0 if name.endswith("exact") else 0.005
        z = z + noise * abs(z) * (rng.standard_normal(45) + 1j * rng.standard_normal(45))
        rows = "\n".join(f"{f:.9e},{v.real:.9e},{v.imag:.9e}" for f, v in zip(hz, z))
        text = f"frequency_hz,impedance_real_ohm,impedance_imaginary_ohm\n{rows}\n"
        (folder / f"{name}.csv").write_text(text)


def run(ieap, folder):
    ended = subprocess.run([ieap, "impedance", "--json", "--all", "--circuit", TEXT, "-C", str(folder)], capture_output=True, text=True)
    if ended.returncode not in (0, 3):
        sys.exit(ended.stderr)
    print(ended.stderr.strip(), file=sys.stderr)
    return json.loads(ended.stdout)


def values(entry, circuit):
    fit = next(fit for fit in entry["circuits"] if fit["circuit"] == circuit)
    return {key: own["value"] for key, own in fit["parameters"].items()}


def impedance_py_test(f, z, elements):
    from impedance.models.circuits.elements import circuit_elements
    from impedance.validation import linKK

    circuit_elements["np"] = np  # it evaluates a text that names numpy, and does not import it

    _, mu, _, real, imaginary = linKK(f, z, c=None, max_M=elements, fit_type="complex", add_cap=True)
    return mu, 100 * np.sqrt(np.mean(np.concatenate([real, imaginary]) ** 2))


def impedance_py_fit(f, z, start):
    from impedance.models.circuits import CustomCircuit

    names = ["r1_ohm", "c1_f", "r2_ohm", "c2_f", "rss_ohm"]
    guess = [1.2 * start[name] for name in names]
    circuit = CustomCircuit("p(R0-C0,R1-C1,R2)", initial_guess=guess)
    circuit.fit(f, z, weight_by_modulus=True, ftol=1e-14, xtol=1e-14, maxfev=100000)
    return dict(zip(names, circuit.parameters_))


def impedance_py_text(f, z, start):
    """The same text, from the place that ieap found moved by a tenth: does it lead back?"""
    from impedance.models.circuits import CustomCircuit

    guess = [start[key] * (1.0 if key.endswith("exponent") else 1.1) for key in TEXT_KEYS]
    circuit = CustomCircuit(TEXT, initial_guess=guess)
    circuit.fit(f, z, weight_by_modulus=True, ftol=1e-14, xtol=1e-14, maxfev=100000)
    left = (circuit.predict(f) - z) / abs(z)
    return 100 * np.sqrt(np.mean(np.concatenate([left.real, left.imag]) ** 2)), dict(zip(TEXT_KEYS, circuit.parameters_))


def pyimpspec_z_hit(f, z):
    """Mean of ln |Z| over what the phase gives in the lowest half decade, with none above the lowest decade, percent."""
    import pyimpspec

    f, z = np.array(f), np.array(z)
    data = pyimpspec.DataSet(frequencies=f, impedances=z)
    given = pyimpspec.perform_zhit(data, smoothing="none", interpolation="makima", num_procs=1).get_impedances()
    order = np.argsort(f)
    x, apart = np.log10(f[order]), np.log(abs(z[order]) / abs(given[np.argsort(data.get_frequencies())]))
    high = x > x[0] + 1
    constant = np.trapezoid(apart[high], x[high]) / (x[high][-1] - x[high][0])
    return 100 * (np.mean(apart[x <= x[0] + 0.5]) - constant)


def pyimpspec_peaks(f, z):
    import pyimpspec

    data = pyimpspec.DataSet(frequencies=np.array(f), impedances=np.array(z))
    drt = pyimpspec.calculate_drt(data, method="tr-rbf", num_procs=1)
    tau, gamma = drt.get_peaks(threshold=0.1)[:2]
    return sorted(tau)


def pyimpspec_fit(f, z, start):
    import pyimpspec

    names = ["r1_ohm", "c1_f", "r2_ohm", "c2_f", "rss_ohm"]
    g = [1.2 * start[name] for name in names]
    code = "([R{R=%.6e}C{C=%.6e}][R{R=%.6e}C{C=%.6e}]R{R=%.6e})" % tuple(g)
    data = pyimpspec.DataSet(frequencies=np.array(f), impedances=np.array(z))
    fit = pyimpspec.fit_circuit(pyimpspec.parse_cdc(code), data, method="least_squares", weight="modulus", num_procs=1)
    resistances = [element.get_value("R") for element in fit.circuit.get_elements() if "R" in element.get_values()]
    capacitances = [element.get_value("C") for element in fit.circuit.get_elements() if "C" in element.get_values()]
    return dict(zip(names, [resistances[0], capacitances[0], resistances[1], capacitances[1], resistances[2]]))


def readings(folder, entry, ieap):
    """The readings of a spectrum as ieap stores them, through its export of the file's own table."""
    path = folder / entry["run"]
    if path.suffix == ".csv" and path.parent.name == "impedance":
        table = np.genfromtxt(path, delimiter=",", skip_header=1)
        return table[:, 0], table[:, 1] + 1j * table[:, 2]
    import pyimpspec

    data = pyimpspec.parse_data(str(path))[0]
    return data.get_frequencies(), data.get_impedances()


def main():
    ieap, files = os.path.abspath(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
    wrong = 0
    with tempfile.TemporaryDirectory() as root:
        folder = pathlib.Path(root)
        (folder / "runs").mkdir()
        own = folder / "impedance"
        own.mkdir()
        (folder / "campaign.toml").write_text('[campaign]\nid = "peers"\ntitle = "Peers"\n\n[[sample]]\nid = "S"\nmaterial = "M"\n')
        (own / "tags.toml").write_text('sample = "S"\nenvironment = "air"\n')
        simulate(own)
        for file in files:
            shutil.copy(file, own / file.name)
        document = run(ieap, folder)
        print(f"{'spectrum':34} {'number':26} {'ieap':>13} {'peer':>13} {'difference':>11}")

        def row(name, number, mine, theirs, limit):
            nonlocal wrong
            difference = abs(mine - theirs) / max(abs(theirs), 1e-30)
            verdict = "" if difference <= limit else "  DIFFERS"
            wrong += difference > limit
            print(f"{name:34} {number:26} {mine:13.6g} {theirs:13.6g} {difference:11.1e}{verdict}")

        for entry in document["spectra"]:
            name = pathlib.Path(entry["run"]).name
            if entry["kramers_kronig"] is None:
                continue
            f, z = readings(folder, entry, ieap)
            test = entry["kramers_kronig"]
            mu, rms = impedance_py_test(f, z, test["elements"])
            row(name, "test, mu (impedance.py)", test["mu"], mu, TEST_LIMIT)
            row(name, "test, rms % (impedance.py)", test["residual_rms_percent"], rms, TEST_LIMIT)
            own = values(entry, TEXT)
            if all(own[key] is not None for key in TEXT_KEYS):
                left, theirs = impedance_py_text(f, z, own)
                mine = next(fit for fit in entry["circuits"] if fit["circuit"] == TEXT)["residual_rms_percent"]
                if mine > 1e-4:  # below it both leave nothing but where they stopped
                    row(name, "text, rms % (impedance.py)", mine, left, FIT_LIMIT)
                for key, value in theirs.items():
                    row(name, f"text, {key}", own[key], value, FIT_LIMIT)
            if entry["z_hit"]:
                mine, theirs = entry["z_hit"]["lowest_percent"], pyimpspec_z_hit(f, z)
                wrong += abs(mine - theirs) > Z_HIT_LIMIT
                print(f"{name:34} {'Z-HIT, lowest, %':26} {mine:13.3f} {theirs:13.3f} {abs(mine - theirs):11.2f}")
            mine = [peak["tau_s"] for peak in entry["relaxation"]["peaks"]]
            theirs = pyimpspec_peaks(f, z)
            print(f"{name:34} DRT peaks, s: {[f'{tau:.3g}' for tau in mine]}, pyimpspec {[f'{tau:.3g}' for tau in theirs]}")
            if name.startswith("two-arcs"):
                for tau in (2e-3, 0.6):
                    nearest = min(mine, key=lambda own: abs(np.log(own / tau)))
                    row(name, f"peak at {tau} s (truth)", nearest, tau, DRT_LIMIT)
            # pyimpspec hands weighted squares to a minimiser that squares them again: its minimum is another where
            # there is noise, and the same where there is none.
            peers = {
                "figure-8.csv": [("impedance.py", impedance_py_fit)],
                "figure-8-exact.csv": [("impedance.py", impedance_py_fit), ("pyimpspec", pyimpspec_fit)],
            }
            mine = values(entry, "lumped-2") if name in peers else {}
            for peer, fit in peers.get(name, []):
                theirs = fit(f, z, mine)
                for key, value in theirs.items():
                    row(name, f"{key} ({peer})", mine[key], value, FIT_LIMIT)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
