"""Fits and findings as people read them. Everything here shows what the engine found; nothing is calculated."""

from __future__ import annotations

import json
from typing import Any, Iterator, Mapping

from . import _native
from ._errors import EngineFault, InputError
from ._estimate import Estimate
from ._records import Record, own, record
from ._table import Table, html_table


def data_frame(columns: Mapping[str, list[Any]], library: str) -> Any:
    """Columns as a data frame of pandas or polars."""
    if library == "pandas":
        import pandas

        return pandas.DataFrame(columns)
    if library == "polars":
        import polars

        return polars.DataFrame(columns, strict=False)
    raise InputError(f"found {library!r}", "library", "pandas or polars", "bad-argument")


class Fit:
    """Parameters of one run under one model, with everything needed to judge them.

    ``fit["r1_ohm_cm2"]`` is an `Estimate`; the keys carry the units, and ``fit["r1"]`` is the same where one key only begins
    so. ``for key in fit`` goes over the keys, in the model's order, derived ones last.
    """

    __slots__ = ("_made", "_recipe", "_brief", "_document", "_parameters")

    def __init__(self, native: _native.Fit, recipe: tuple[Any, ...]) -> None:
        self._made: _native.Fit | None = native
        self._recipe = recipe
        self._brief: dict[str, Any] | None = None
        self._document: dict[str, Any] | None = None
        self._parameters: dict[str, Estimate] | None = None

    @property
    def _native(self) -> _native.Fit:
        # A fit that was pickled is made again where its curves are asked for: the same readings give the same bits.
        if self._made is None:
            made = _native.fit(*self._recipe)
            if json.loads(made.document(False))["input_hash"] != self.to_dict()["input_hash"]:
                raise EngineFault("another version of ieap makes another fit of it", self.run, "fit the readings again")
            self._made = made
        return self._made

    def __getstate__(self) -> dict[str, Any]:
        return {"recipe": self._recipe, "document": self.to_dict()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._made, self._recipe = None, state["recipe"]
        self._brief = self._document = state["document"]
        self._parameters = None

    def to_dict(self) -> dict[str, Any]:
        """The fit as ``ieap fit --json`` states it, less what only a campaign knows."""
        if self._document is None:
            self._document = json.loads(self._native.document(True))
        assert self._document is not None
        return self._document

    @property
    def nuisances(self) -> Mapping[str, Estimate]:
        """What was estimated beside the parameters, by key: edges, zeros, clocks, charge that no reading saw. With both the fit
        can be made again."""
        found = self._stated("nuisances")
        return {own["key"]: Estimate(**own["estimate"], unit=_native.unit_of_key(own["key"])) for own in found}

    @property
    def parameters(self) -> Mapping[str, Estimate]:
        """Estimates by key, in the model's order, derived ones last."""
        if self._parameters is None:
            stated = self._stated("parameters")
            self._parameters = {key: Estimate(**found, unit=_native.unit_of_key(key)) for key, found in stated.items()}
        return self._parameters

    def _key(self, name: str) -> str | None:
        """The key of that name, or the only one that begins so."""
        if name in self.parameters:
            return name
        begun = [key for key in self.parameters if key.startswith(f"{name}_")]
        return begun[0] if len(begun) == 1 else None

    def __getitem__(self, key: str) -> Estimate:
        known = self._key(key)
        if known is None:
            raise KeyError(f"{key}: one of {', '.join(self.parameters)}")
        return self.parameters[known]

    def __contains__(self, key: object) -> bool:
        return isinstance(key, str) and self._key(key) is not None

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __len__(self) -> int:
        return len(self.parameters)

    def _stated(self, name: str) -> Any:
        # What noise is like takes longer than the fit: only `noise` and `to_dict` have it.
        if self._brief is None:
            self._brief = json.loads(self._native.document(False))
        assert self._brief is not None
        return self._brief[name]

    @property
    def run(self) -> str:
        """Name of the run."""
        return str(self._stated("run"))

    @property
    def model(self) -> str:
        """Id of the model, such as ``lumped-2``."""
        return str(self._stated("model"))

    @property
    def converged(self) -> bool:
        """Whether the search converged."""
        return bool(self._stated("converged"))

    @property
    def why_stopped(self) -> str:
        """Why the search stopped, in words."""
        return str(self._stated("why_stopped"))

    @property
    def n_samples(self) -> int:
        """Number of readings used, over all fitted channels."""
        return int(self._stated("n_samples"))

    @property
    def r_squared_current(self) -> float | None:
        """Coefficient of determination of the current; None where it was not fitted."""
        found: float | None = self._stated("r_squared_current")
        return found

    @property
    def r_squared_curvature(self) -> float | None:
        """Coefficient of determination of the curvature; None where it was not fitted."""
        found: float | None = self._stated("r_squared_curvature")
        return found

    @property
    def noise(self) -> list[Record]:
        """Noise and residual of each channel (``quantity``, ``standard_deviation``, ``residual_rms``, ...), in its unit."""
        return [record("fits", "ChannelNoise", found) for found in self.to_dict()["noise"]]

    @property
    def issues(self) -> list[Record]:
        """What a reader must know: ``severity``, ``code``, ``place``, ``message``, ``mend``."""
        return [record("fits", "Issue", found) for found in self._stated("issues")]

    def _criteria(self) -> tuple[int, float, float] | None:
        return self._native.criteria()

    @property
    def n_parameters(self) -> int | None:
        """Number of parameters that were searched, zeros of instruments apart; None where the noise is not known."""
        found = self._criteria()
        return found and found[0]

    @property
    def aic(self) -> float | None:
        """Akaike's information criterion, under noise of the size and memory that was found without the model. What all fits
        of the same readings have in common is left out: only differences mean something. None where the noise is not known."""
        found = self._criteria()
        return found and found[1]

    @property
    def bic(self) -> float | None:
        """Bayesian information criterion likewise, with the number of independent readings."""
        found = self._criteria()
        return found and found[2]

    def _curve(self, quantity: str) -> Table | None:
        found = self._native.curve(quantity)
        return Table(found) if found is not None else None

    @property
    def current(self) -> Table | None:
        """Every reading of the current that was fitted: ``time_s``, ``current_a``, ``fitted`` and ``residual`` (A) and
        ``residual_sigma`` (standard deviations of the noise). None where there is none. Of `distributed` a longer curve
        is thinned as it is drawn."""
        return self._curve("current")

    @property
    def curvature(self) -> Table | None:
        """The curvature likewise: ``time_s``, ``curvature_per_cm``, ``fitted``, ``residual`` (1/cm), ``residual_sigma``."""
        return self._curve("curvature")

    @property
    def residuals(self) -> dict[str, Any]:
        """Measured minus fitted, an array for ``current_a`` (A) and for ``curvature_per_cm`` (1/cm), where they were fitted."""
        curves = {"current_a": self.current, "curvature_per_cm": self.curvature}
        return {key: curve["residual"] for key, curve in curves.items() if curve is not None and "residual" in curve}

    @property
    def area_cm2(self) -> float:
        """Active area of the strip, cm2."""
        return self._native.area_cm2

    @property
    def length_mm(self) -> float | None:
        """Free length of the strip, mm."""
        return self._native.length_mm

    @property
    def drive(self) -> list[tuple[float, float | None]]:
        """Start (s) and voltage (V; None: open circuit) of each segment of the drive."""
        return self._native.drive[1]

    @property
    def baseline_v(self) -> float:
        """Voltage held before the drive, V."""
        return self._native.drive[0]

    @property
    def seconds(self) -> float:
        """Time that the engine took, s."""
        return self._native.seconds

    @property
    def covariance(self) -> dict[str, dict[str, float]] | None:
        """Covariance of the parameters that are determined, by their keys, in the product of their units. Its diagonal are the
        fit's standard errors squared; the correlations are those that the readings leave, their noise taken as white. None of
        `distributed`, and of what bends alone."""
        found = self._native.covariance()
        return found and {key: dict(zip(found[0], row)) for key, row in zip(*found)}

    @property
    def correlation(self) -> dict[str, dict[str, float]] | None:
        """The same as correlations, from -1 to 1."""
        all = self.covariance
        return all and {
            key: {other: value / (all[key][key] * all[other][other]) ** 0.5 for other, value in row.items()}
            for key, row in all.items()
        }

    def correlated_values(self) -> dict[str, Any]:
        """The parameters that are determined as numbers of the package `uncertainties`, by their keys, with their correlations:
        what is calculated of several has the right error.

        Raises:
            InputError: `uncertainties` is not installed, or the model has no covariance.
        """
        try:
            from uncertainties import correlated_values
        except ImportError:
            raise InputError("uncertainties is not installed", "correlated_values", "pip install uncertainties", "bad-argument") from None
        found = self.covariance
        if not found:
            raise InputError(f"{self.model} has no covariance", "correlated_values", "take each estimate's own error", "bad-argument")
        values = correlated_values([float(self[key]) for key in found], [list(row.values()) for row in found.values()])
        return dict(zip(found, values))

    def eval(self, time_s: Any = None, drive: Any = None, **options: Any) -> Table:
        """What the fitted model gives at `time_s` (s) under `drive`; as `ieap.simulate` of this fit, whose options it takes.
        None: the readings' own times and drive, which give the curve of the fit."""
        from . import simulate

        if time_s is None and drive is None:
            curve = self.current if self.current is not None else self.curvature
            time_s = curve["time_s"] if curve is not None else None
        return simulate(self, time_s=time_s, drive=drive, **options)

    def summary(self) -> str:
        """The fit in lines for people: parameters, goodness, issues."""
        return repr(self)

    def rows(self) -> dict[str, list[Any]]:
        """The parameters as columns: ``parameter``, ``value``, ``standard_error``, ``low_95``, ``high_95``, ``at_bound``,
        ``reason``."""
        names = ("value", "standard_error", "low_95", "high_95", "at_bound", "reason")
        columns = {name: [getattr(one, name) for one in self.parameters.values()] for name in names}
        return {"parameter": list(self.parameters), **columns}

    def to_dataframe(self, library: str = "pandas") -> Any:
        """The parameters as a data frame, one row each; `library` is ``"pandas"`` or ``"polars"``."""
        return data_frame(self.rows(), library)

    def plot(self, axes: Any = None) -> Any:
        """Readings, fitted curve and residuals, one column a response; gives the matplotlib figure.

        Args:
            axes: two axes for each response (curve, residuals), in an array of two rows; None: a figure of its own.
        """
        from ._plot import plot_fit

        return plot_fit(self, axes)

    def _repr_html_(self) -> str:
        head = f"{self.run} with {self.model}: {self.why_stopped}"
        rows = [(key, *one._cells()) for key, one in self.parameters.items()]
        notes = [
            f"R2 of the {name}: {found:.5f}"
            for name in ("current", "curvature")
            if (found := self._stated(f"r_squared_{name}")) is not None
        ]
        notes += [f"{issue.severity}: {issue.message}" for issue in self.issues]
        return html_table(head, ("parameter", "value", "standard error", "95 %", ""), rows, notes)

    def __repr__(self) -> str:
        lines = [f"<ieap.Fit of {self.run!r} with {self.model}: {self.why_stopped}>"]
        width = max(len(key) for key in self.parameters)
        lines += [f"  {key:<{width}}  {one}" for key, one in self.parameters.items()]
        for name in ("current", "curvature"):
            if (r_squared := self._stated(f"r_squared_{name}")) is not None:
                lines.append(f"  R2 of the {name}: {r_squared:.5f}")
        lines += [f"  {issue.severity}: {issue.message}" for issue in self.issues]
        return "\n".join(lines)


@own
class Finding(Record, of=("diagnosis", "GroupEntry")):
    """What the model gets wrong in a group of runs, and why: attributes are those of a group of ``ieap diagnose --json``."""

    __slots__ = ()

    group: str
    runs: list[str]
    verdict: str
    sentence: str
    p_misfit: float | None
    posterior: list[Record]
    next_run: Record | None
    remarks: list[str]

    @property
    def causes(self) -> list[str]:
        """Ids of the textbook curves that lie within the band of the missing law."""
        return list(self._stated["set"])

    def summary(self) -> str:
        """The finding in lines for people: verdict, what is probable, what to measure next."""
        return repr(self)

    def rows(self) -> dict[str, list[Any]]:
        """What may be behind the misfit as columns, the most probable first: ``cause``, ``probability``."""
        return {
            "cause": [_cause(one) for one in self.posterior],
            "probability": [one.mass for one in self.posterior],
        }

    def to_dataframe(self, library: str = "pandas") -> Any:
        """What may be behind the misfit as a data frame; `library` is ``"pandas"`` or ``"polars"``."""
        return data_frame(self.rows(), library)

    def _repr_html_(self) -> str:
        head = f"{self.group}, {len(self.runs)} runs: {self.verdict}"
        rows = [(_cause(one), f"{one.mass:.2f}") for one in self.posterior[:5]]
        notes = [self.sentence] + ([f"next: {self.next_run.drive}"] if self.next_run else []) + self.remarks
        return html_table(head, ("what may be behind it", "probability"), rows, notes)

    def __repr__(self) -> str:
        lines = [f"<ieap.Finding of {self.group!r}, {len(self.runs)} runs: {self.verdict}>", f"  {self.sentence}"]
        lines += [f"  {one.mass:.2f}  {_cause(one)}" for one in self.posterior[:3]]
        lines += [f"  next: {self.next_run.drive}"] if self.next_run else []
        return "\n".join([*lines, *(f"  {remark}" for remark in self.remarks)])


def _cause(hypothesis: Record) -> str:
    """What a row of the posterior speaks of, in words."""
    return str(hypothesis.effect or ", ".join(hypothesis.parameters_that_differ) or hypothesis.kind)
