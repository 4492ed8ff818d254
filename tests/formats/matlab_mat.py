"""Writes the .mat files of tests/formats/matlab-mat with scipy: python3 matlab_mat.py (scipy 1.17 wrote those that are here)."""

from pathlib import Path

import numpy as np
from scipy.io import savemat

FOLDER = Path(__file__).parent / "matlab-mat"
HEAD = b"MATLAB 5.0 MAT-file, written by scipy for a test of ieap"
TIME_S = np.array([-0.5, 0.0, 0.5, 1.0, 1.5])
VOLTAGE_V = np.array([0.0, 2.5, 2.5, 2.5, 2.5])
CURRENT_MA = np.array([0.0125, 12.75, -3.25, 1.125, 0.5])


def column(numbers, kind="float64"):
    return numbers.astype(kind).reshape(-1, 1)


def write(name, variables, packed):
    """One file, with a head that does not depend on the day."""
    path = FOLDER / name
    savemat(path, variables, do_compression=packed, oned_as="column")
    path.write_bytes(HEAD.ljust(116) + path.read_bytes()[116:])


# What a script saves that has a vector for each channel; the time comes last, so that no beginning of the file is a run.
vectors = {
    "operator": "VK",
    "area_cm2": 0.1,
    "voltage_V": column(VOLTAGE_V, "float32"),
    "current_mA": column(CURRENT_MA),
    "time_s": column(TIME_S),
}
write("step.vectors.mat", vectors, packed=False)
write("step.vectors_packed.mat", vectors, packed=True)

# A struct, its channels as the integers of a converter and as single numbers, and a calibration that is no channel.
write(
    "step.struct_of_integers.mat",
    {
        "data": {
            "time_ms": column(1000 * TIME_S, "int32"),
            "voltage_mV": column(1000 * VOLTAGE_V, "int16"),
            "current_mA": column(CURRENT_MA, "float32"),
            "range": column(np.arange(5), "uint8"),
            "gains": column(np.array([1.0, 10.0])),
            "notes": {"cell": "glass", "spectrum": np.array([1 + 2j, 3 - 4j])},
        }
    },
    packed=True,
)

# A matrix with its names, as MATLAB spells those of a table that it read.
names = np.array(["Time_s_", "Voltage_V_", "Current_mA_", "curvature_1_cm_"], dtype=object)
curvature = np.array([0.0, 0.0, 0.25, 0.5, 0.625])
write(
    "step.matrix_with_names.mat",
    {"names": names, "run": np.column_stack([TIME_S, VOLTAGE_V, CURRENT_MA, curvature])},
    packed=True,
)

# A list of structs, one for each step.
step = np.dtype([("time_s", object), ("voltage_V", object), ("current_mA", object)])
steps = np.zeros((1, 2), dtype=step)
for place, volts in enumerate([2.5, 1.0]):
    steps[0, place] = (column(TIME_S), column(VOLTAGE_V * volts / 2.5), column(CURRENT_MA * volts / 2.5))
write("step.list_of_structs.mat", {"step": steps}, packed=False)

# Names without units, and a matrix without names.
bare = {"t": column(TIME_S), "I": column(CURRENT_MA), "raw": np.column_stack([TIME_S, CURRENT_MA])}
write("refused.names_without_units.mat", bare, packed=False)

# What MATLAB writes with -v7.3 begins so; the rest is HDF5.
head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(124) + b"\x00\x02IM"
(FOLDER / "refused.version_7_3.mat").write_bytes(head.ljust(512, b"\0") + b"\x89HDF\r\n\x1a\n")
