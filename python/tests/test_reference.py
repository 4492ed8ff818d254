"""The reference page is made of the docstrings: `IEAP_UPDATE_EXPECTED=1 pytest tests/test_reference.py` writes it anew."""

from __future__ import annotations

import inspect
import os
import re
from pathlib import Path

import ieap

PAGE = Path(__file__).parents[2] / "docs" / "python-reference.md"
HEAD = """# Python reference

Made of the docstrings of the package by a test; [python.md](python.md) shows how it is used.
"""


def shown(docstring: str | None, name: str) -> str:
    text = inspect.cleandoc(docstring or "")
    assert text, f"{name} has no docstring"
    # Double backquotes are of Python's docstrings, and blocks of code keep their indent.
    return text.replace("``", "`")


def signature(name: str, own: object) -> str:
    try:
        # Annotations are texts, whose quotes say nothing.
        text = re.sub(r"(: |-> )'([^']*)'", r"\1\2", str(inspect.signature(own)))
    except (TypeError, ValueError):
        text = "(...)"
    return f"    {name}{text.replace('(self, ', '(').replace('(self)', '()')}"


def parts(owner: type) -> list[str]:
    lines = []
    # By name: the order in which a compiled class lists its parts changes from build to build.
    for name, own in sorted(vars(owner).items()):
        if name.startswith("_"):
            continue
        if isinstance(own, property):
            lines += [f"- `{name}`: {' '.join(shown(own.fget.__doc__, name).split())}"]
        elif inspect.isgetsetdescriptor(own):
            lines += [f"- `{name}`"]
        elif callable(own):
            lines += [f"- `{signature(name, own).strip()}`: {' '.join(shown(own.__doc__, name).split())}"]
    return lines


def page() -> str:
    functions = [name for name in ieap.__all__ if inspect.isfunction(getattr(ieap, name))]
    classes = [name for name in ieap.__all__ if inspect.isclass(getattr(ieap, name))]
    blocks = [HEAD]
    for name in functions:
        own = getattr(ieap, name)
        blocks += [f"## {name}", signature(name, own), "```text\n" + shown(own.__doc__, name) + "\n```"]
    for name in classes:
        own = getattr(ieap, name)
        blocks += [f"## {name}", "```text\n" + shown(own.__doc__, name) + "\n```"]
        own_parts = [] if issubclass(own, BaseException) else parts(own)
        blocks += ["\n".join(own_parts)] if own_parts else []
    assert len(functions) + len(classes) == len(ieap.__all__)
    return "\n\n".join(block.strip("\n") for block in blocks) + "\n"


def test_the_reference_is_that_of_the_docstrings():
    made = page()
    if os.environ.get("IEAP_UPDATE_EXPECTED"):
        PAGE.write_text(made, encoding="utf-8")
    assert PAGE.read_text(encoding="utf-8") == made, "write it anew: IEAP_UPDATE_EXPECTED=1 pytest tests/test_reference.py"
