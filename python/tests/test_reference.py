"""The reference page is made of the docstrings: `IEAP_UPDATE_EXPECTED=1 pytest tests/test_reference.py` writes it anew."""

from __future__ import annotations

import inspect
import os
from pathlib import Path

import ieap

PAGE = Path(__file__).parents[2] / "docs" / "python-reference.md"
HEAD = """# Python reference

Made of the docstrings of the package by a test; [python.md](python.md) shows how it is used.
`help(ieap.fit)` says what each argument is, in which unit, what comes back and what is refused.
"""


def shown(docstring: str | None, name: str) -> str:
    text = inspect.cleandoc(docstring or "")
    assert text, f"{name} has no docstring"
    # Double backquotes are of Python's docstrings, and blocks of code keep their indent.
    return text.replace("``", "`")


def summary(docstring: str | None, name: str) -> str:
    """The first paragraph, for a cell of a table."""
    return " ".join(shown(docstring, name).split("\n\n")[0].split()).replace("|", "\\|")


def names(function: object) -> str:
    """The names of its arguments; their types and meanings are in `help(ieap.fit)`."""
    try:
        own = [name for name in inspect.signature(function).parameters if name not in ("self", "cls")]
    except (TypeError, ValueError):
        return "..."
    return ", ".join(own)


def is_of_document(part: object) -> bool:
    """Whether an attribute is one of those that a document's schema says."""
    return isinstance(part, property) and part.fget.__module__ == "ieap._records"


def parts(owner: type) -> str:
    # By name: the order in which a compiled class lists its parts changes from build to build.
    public = sorted(name for name, own in vars(owner).items() if not name.startswith("_") and not is_of_document(own))
    for name in public:
        if callable(vars(owner)[name]) or isinstance(vars(owner)[name], property):
            shown(getattr(vars(owner)[name], "__doc__", None), name)
    return ", ".join(f"`{name}`" for name in public)


def page() -> str:
    functions = [name for name in ieap.__all__ if inspect.isfunction(getattr(ieap, name))]
    classes = [name for name in ieap.__all__ if inspect.isclass(getattr(ieap, name))]
    lines = [HEAD, "| function | arguments | what it does |", "|---|---|---|"]
    for name in functions:
        own = getattr(ieap, name)
        lines += [f"| `{name}` | {names(own)} | {summary(own.__doc__, name)} |"]
    lines += ["", "| class | what it is | parts |", "|---|---|---|"]
    for name in classes:
        own = getattr(ieap, name)
        own_parts = "" if issubclass(own, BaseException) else parts(own)
        lines += [f"| `{name}` | {summary(own.__doc__, name)} | {own_parts} |"]
    assert len(functions) + len(classes) == len(ieap.__all__)
    return "\n".join(lines) + "\n"


def test_the_reference_is_that_of_the_docstrings():
    made = page()
    if os.environ.get("IEAP_UPDATE_EXPECTED"):
        PAGE.write_text(made, encoding="utf-8")
    assert PAGE.read_text(encoding="utf-8") == made, "write it anew: IEAP_UPDATE_EXPECTED=1 pytest tests/test_reference.py"
