"""Sensors for Mitsuba 3: `import realistic.mitsuba` registers the sensors `realistic` and `thick` (docs/mitsuba.md).

Importing registers them for Mitsuba's current variant, and setting another variant registers them again.

>>> import mitsuba as mi                                                       # doctest: +SKIP
>>> mi.set_variant("llvm_ad_rgb")                                              # doctest: +SKIP
>>> import realistic.mitsuba                                                   # doctest: +SKIP
>>> sensor = mi.load_dict({"type": "realistic", "lens_file": "wide.22mm", "focus_distance": 1500.0})  # doctest: +SKIP
"""

from __future__ import annotations

import platform

import drjit as dr
import mitsuba as mi
from mitsuba.detail import add_variant_callback

from .sensor import sensor_class

__all__ = ["register"]


def register() -> None:
    """Registers the sensors for Mitsuba's current variant; importing this module does so, too.

    Raises
    ------
    ImportError
        For variants that do not support tracing the lens, and for a libLLVM that would end the process.
    """
    variant = mi.variant()
    if variant.startswith("llvm"):
        _check_llvm()
    if "double" in variant or variant.startswith(("cuda", "metal")):
        raise ImportError(
            f"realistic.mitsuba has no sensor for Mitsuba's variant {variant}: lenses are traced on the processor, and rays "
            "come in single precision. Use one of the variants scalar_*, llvm_* without double"
        )
    for name, model in (("realistic", None), ("thick", "thick")):
        mi.register_sensor(name, sensor_class(model))


def _check_llvm() -> None:
    """Refuses a libLLVM that aborts the process when code computes a minimum of two numbers, as Mitsuba's often
    does."""
    version: tuple[int, ...] = dr.detail.llvm_version()
    if platform.machine().lower() in ("x86_64", "amd64") and version[0] < 17:
        raise ImportError(
            f"Dr.Jit has found libLLVM {'.'.join(map(str, version))}, with which Mitsuba's variant {mi.variant()} ends the process "
            '("Cannot select: fminimum"). Name the file of libLLVM 19 in the variable DRJIT_LIBLLVM_PATH before Python starts, '
            "or use one of the variants scalar_*"
        )


def _follow(old: str | None, new: str | None) -> None:
    """Registers the sensors again; Mitsuba calls it after a variant is set."""
    if new is not None and "double" not in new and not new.startswith(("cuda", "metal")):
        register()


add_variant_callback(_follow)
if mi.variant() is not None:
    register()
