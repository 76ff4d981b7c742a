"""Fixtures with Mitsuba 3, if it is available; skipped tests state what is missing."""

import importlib
import os
import subprocess
import sys

import pytest

VARIANTS = ("scalar_rgb", "llvm_ad_rgb", "llvm_ad_spectral")

# A libLLVM that Dr.Jit does not support ends the process.
PROBE = """
import drjit as dr, mitsuba as mi
mi.set_variant("llvm_ad_rgb")
assert dr.sum(dr.minimum(mi.Float(1, 2, 3), dr.arange(mi.Float, 3))) == 3
"""


@pytest.fixture(scope="session")
def llvm() -> str:
    """The reason why variants with LLVM cannot run here; empty if they can."""
    done = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, text=True)
    if done.returncode == 0:
        return ""
    named = os.environ.get("DRJIT_LIBLLVM_PATH", "none")
    return f"Mitsuba has no LLVM that it can use (libLLVM 19 named by DRJIT_LIBLLVM_PATH, which names {named})"


def _mitsuba(variant, llvm):
    mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed (pip install mitsuba)")
    if variant.startswith("llvm") and llvm:
        pytest.skip(llvm)
    mi.set_variant(variant)
    importlib.import_module("realistic.mitsuba")
    mi.set_log_level(mi.LogLevel.Error)
    return mi


@pytest.fixture(params=VARIANTS)
def mi(request, llvm):
    """Mitsuba's module, in each variant in turn, with the sensors registered."""
    return _mitsuba(request.param, llvm)


@pytest.fixture
def fast(llvm):
    """Mitsuba's module, in the variant for pictures."""
    return _mitsuba("llvm_ad_rgb", llvm)


@pytest.fixture
def spectral(llvm):
    """Mitsuba's module, in the variant with spectral rays."""
    return _mitsuba("llvm_ad_spectral", llvm)
