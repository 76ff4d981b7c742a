"""The package's declarations of the C ABI and of the parameters agree with the header and the README."""

import ctypes
import re

import pytest

from realistic import Reason, _abi
from realistic.autofocus import RULES
from realistic.lens import SIDES

TYPES = {
    "uint32_t": ctypes.c_uint32,
    "int32_t": ctypes.c_int32,
    "float": ctypes.c_float,
    "double": ctypes.c_double,
    "size_t": ctypes.c_size_t,
    "const char *": ctypes.c_char_p,
    "void *": ctypes.c_void_p,
    "const struct realistic_camera *": ctypes.c_void_p,
    "realistic_log ": _abi.LOG,
    "realistic_log": _abi.LOG,
    "float *": ctypes.c_void_p,
    "const float *": ctypes.c_void_p,
    "double *": ctypes.c_void_p,
    "realistic_reason *": ctypes.c_void_p,
    "ptrdiff_t": ctypes.c_ssize_t,
    "struct realistic_input": _abi.Input,
    "struct realistic_output": _abi.Output,
    "struct realistic_vectors": _abi.Vectors,
    "uint32_t *": ctypes.c_void_p,
}

STRUCTURES = {
    "realistic_options": _abi.Options,
    "realistic_camera_info": _abi.CameraInfo,
    "realistic_ray": _abi.Ray,
    "realistic_zone": _abi.Zone,
    "realistic_lens_info": _abi.LensInfo,
    "realistic_lens_surface": _abi.LensSurface,
    "realistic_focused_film": _abi.FocusedFilm,
    "realistic_lens_rays": _abi.LensRaysView,
    "realistic_lens_points": _abi.LensPointsView,
    "realistic_input": _abi.Input,
    "realistic_output": _abi.Output,
    "realistic_vectors": _abi.Vectors,
    "realistic_request": _abi.Request,
}


@pytest.fixture(scope="module")
def header(checkout):
    text = (checkout / "include/realistic.h").read_text()
    return re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL)


@pytest.mark.parametrize("name", STRUCTURES)
def test_structures_have_the_headers_fields(header, name):
    body = re.search(rf"typedef struct {name} {{(.*?)}} {name};", header, re.DOTALL).group(1)
    fields = []
    for declaration in body.split(";"):
        if not declaration.strip():
            continue
        kind, field, count = re.fullmatch(r"\s*(.*?[ *])(\w+)(?:\[(\d+)\])?\s*", declaration, re.DOTALL).groups()
        kind = TYPES[kind.strip()]
        fields.append((field, kind * int(count) if count else kind))
    # Later versions may add members at the end; struct_size states how many bytes a caller knows.
    ours = STRUCTURES[name]._fields_
    assert fields[: len(ours)] == ours
    if fields[0][0] != "struct_size":
        assert len(fields) == len(ours)


def test_functions_have_the_headers_arguments(header):
    for name, (_, arguments) in _abi.FUNCTIONS.items():
        found = re.search(rf"\b{name}\((.*?)\);", header, re.DOTALL).group(1)
        count = 0 if found.strip() == "void" else found.count(",") + 1
        assert count == len(arguments), name


def test_numbers_are_the_headers(header):
    reasons = dict(re.findall(r"REALISTIC_REASON_(\w+) = (\d+)", header))
    assert {reason.name: str(int(reason)) for reason in Reason} == reasons
    for name, ours in (("AUTOFOCUS_RULE", RULES), ("SIDE", SIDES)):
        found = re.findall(rf"REALISTIC_{name}_(\w+) = (\d+)", header)
        assert [(word.upper(), str(i)) for i, word in enumerate(ours)] == found
    assert int(re.search(r"define REALISTIC_ABI_VERSION (\d+)", header).group(1)) >= _abi.ABI_VERSION
