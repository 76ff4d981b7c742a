"""Shaders for Blender: the package's calls of the program, and its messages when they fail."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest

import realistic
from realistic import blender


def fake_program(folder: Path, script: str) -> Path:
    """Makes a program that consists of these shell commands."""
    program = folder / "realistic"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return program


def test_arguments_become_options_of_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("REALISTIC_PROGRAM", str(fake_program(tmp_path, f'echo "$@" > {tmp_path}/asked')))
    out = tmp_path / "lens.osl"
    assert blender.write_shader("wide.22mm", out, dispersion=True, film_diagonal=30, zoom=35) == out
    arguments = (tmp_path / "asked").read_text().strip()
    assert arguments == f"blender wide.22mm --out {out} --dispersion --film-diagonal 30.0 --zoom 35"


def test_what_the_program_refuses_is_an_error_in_its_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = fake_program(tmp_path, "echo 'realistic: error: no such lens' >&2; exit 1")
    monkeypatch.setenv("REALISTIC_PROGRAM", str(program))
    with pytest.raises(realistic.Error, match="^no such lens$"):
        blender.write_shader("none", tmp_path / "lens.osl")


def test_without_a_program_the_error_names_the_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("REALISTIC_PROGRAM", str(tmp_path / "nowhere"))
    with pytest.raises(FileNotFoundError, match="REALISTIC_PROGRAM names .*nowhere, where there is no file"):
        blender.program()
    monkeypatch.delenv("REALISTIC_PROGRAM")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("realistic._program.own", lambda: None)
    with pytest.raises(FileNotFoundError, match="cargo install"):
        blender.program()
