"""Fits and diagnoses of data frames of Apache Spark, one row a run, on every core of a cluster.

    import ieap.spark
    fits = ieap.spark.fit(spark.read.parquet("traces"))

The columns are those that `ieap.fit_many` takes, or those of `ieap export --what traces --partitioned`; what is made of the
latter is written as Parquet and brought back by `ieap import-fits`. A row that cannot be used gives a row with the reason and never ends the
job. The same rows give the same numbers as one process, to the last bit, and as often as a task is tried again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Sequence

import ieap

if TYPE_CHECKING:
    import pyarrow
    from pyspark.sql import DataFrame
    from pyspark.sql.types import StructType

_PARAMETER = (
    "struct<key: string, value: double, standard_error: double, low_95: double, high_95: double, "
    "at_bound: boolean, reason: string>"
)
_ISSUE = "struct<severity: string, code: string, place: string, message: string, mend: string>"

FIT_COLUMNS: dict[str, tuple[str, str]] = {
    "run": ("string", "name of the run"),
    "model": ("string", "id of the model"),
    "model_version": ("bigint", "version of the model's equations and identification"),
    "code_version": ("string", "version of ieap"),
    "built_from": ("string", "commit that it was built from"),
    "data_hash": ("string", "hash of the readings"),
    "input_hash": ("string", "hash of everything that the fit depends on"),
    "converged": ("boolean", "whether the search converged"),
    "why_stopped": ("string", "why the search stopped"),
    "method": ("string", "how the minimum was searched"),
    "n_samples": ("bigint", "readings used"),
    "parameters": (f"array<{_PARAMETER}>", "estimates with 95 % intervals, in the units that the keys name"),
    "nuisances": (f"array<{_PARAMETER}>", "what was estimated beside them: edges, zeros, clocks, charge that no reading saw"),
    "r_squared_current": ("double", "coefficient of determination of the current"),
    "r_squared_curvature": ("double", "coefficient of determination of the curvature"),
    "issues": (f"array<{_ISSUE}>", "what a reader must know"),
    "refused_place": ("string", "where, of a run that could not be fitted"),
    "refused_reason": ("string", "why it could not be fitted; null where it was"),
    "refused_remedy": ("string", "how to mend it"),
    "asked": ("string", "of a run of a campaign: what this call asked for, as JSON; for `ieap import-fits`"),
    "fit": ("string", "of a run of a campaign: the fit in full, as JSON; for `ieap import-fits`"),
    "issue": ("string", "of a run of a campaign: why it could not be fitted, as JSON; for `ieap import-fits`"),
    "checksum": ("string", "of a run of a campaign: that of its row, which `ieap import-fits` holds it against"),
}
"""Type and comment of every column that `fit` gives."""

FINDING_COLUMNS: dict[str, tuple[str, str]] = {
    "group": ("string", "values of the columns that the runs were grouped by"),
    "runs": ("array<string>", "runs of the group"),
    "left_out": ("array<string>", "runs that could not be used, each with the reason"),
    "verdict": ("string", "right, undecided, differs, law, instrument, unexplained or data-problem"),
    "sentence": ("string", "the finding in a sentence"),
    "p_misfit": ("double", "probability of residuals at least as bad by chance"),
    "q_misfit": ("double", "the same over all groups judged together: here of this group alone"),
    "causes": ("array<string>", "effects that may be the cause: 95 % of the probability"),
    "most_probable": ("string", "what is most probable"),
    "most_probable_mass": ("double", "its probability"),
    "gain_deviance": ("double", "fall of the deviance of held-out readings by the extended model"),
    "next_run": ("string", "what to measure next"),
    "document": ("string", "the finding as a group of `ieap diagnose --json`"),
    "refused_place": ("string", "where, of a group that could not be diagnosed"),
    "refused_reason": ("string", "why it could not be diagnosed; null where it was"),
    "refused_remedy": ("string", "how to mend it"),
}
"""Type and comment of every column that `diagnose` gives."""


def fit(
    df: DataFrame, *, model: str | None = None, seed: int | None = None, threads: int = 1
) -> DataFrame:
    """Fits every row; columns as `FIT_COLUMNS` says.

    Args:
        df: one row a run, as `ieap.fit_many` takes it. Keep some hundred rows a partition: a task that is lost is done
            again as a whole.
        threads: threads of each task; 1, for Spark runs a task a core.
    """

    # Without annotations: Spark would take them for a choice between its ways of handing over rows.
    def fitted(batches):  # type: ignore[no-untyped-def]
        for batch in batches:
            yield from _batches(ieap.fit_many(batch, model=model, seed=seed, threads=threads))

    return df.mapInArrow(fitted, _schema(FIT_COLUMNS))


def diagnose(
    df: DataFrame,
    by: str | Sequence[str],
    *,
    model: str | None = None,
    draws: int | None = None,
    seed: int | None = None,
    threads: int = 1,
) -> DataFrame:
    """Diagnoses every group of rows; columns as `FINDING_COLUMNS` says.

    Args:
        df: one row a run, as `ieap.fit_many` takes it.
        by: the columns whose values make a group, such as ``["sample", "environment"]``.
    """
    keys = [by] if isinstance(by, str) else list(by)

    def diagnosed(key, rows):  # type: ignore[no-untyped-def]
        name = ",".join(f"{name}={value.as_py()}" for name, value in zip(keys, key))
        # Rows come in the order in which the cluster delivers them: a group has one order, that of the names.
        ordered = rows.sort_by("run") if "run" in rows.column_names else rows
        import pyarrow

        found = ieap.diagnose_rows(
            ordered.combine_chunks(), group=name, model=model, draws=draws, seed=seed, threads=threads
        )
        return pyarrow.table(found)

    return df.groupBy(*keys).applyInArrow(diagnosed, _schema(FINDING_COLUMNS))


def _batches(table: ieap.Table) -> list[pyarrow.RecordBatch]:
    import pyarrow

    batches: list[pyarrow.RecordBatch] = pyarrow.table(table).to_batches()
    return batches


def _schema(columns: dict[str, tuple[str, str]]) -> StructType:
    from pyspark.sql.types import StructField, StructType, _parse_datatype_string

    fields = [
        StructField(name, _parse_datatype_string(kind), True, {"comment": comment})
        for name, (kind, comment) in columns.items()
    ]
    return StructType(fields)
