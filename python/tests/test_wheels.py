"""The workflow that builds wheels for other systems is that of python/README.md."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_workflow_builds_as_the_page_says():
    workflow = (ROOT / ".github" / "workflows" / "wheels.yml").read_text(encoding="utf-8")
    page = (ROOT / "python" / "README.md").read_text(encoding="utf-8")
    built = "maturin build --release --locked --manifest-path python/Cargo.toml"
    for command in (built, "--zig --compatibility manylinux_2_28", 'pip install "maturin>=1.9,<2" ziglang'):
        assert command in workflow and command in page, command
    # Everything that a wheel is built from is there.
    assert (ROOT / "python" / "Cargo.toml").is_file() and (ROOT / "python" / "Cargo.lock").is_file()
    for system in ("ubuntu", "macos", "windows"):
        assert f"{system}-latest" in workflow
