"""The wheel and its build hook."""

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile

import pytest

import realistic
from realistic import _abi


def pip_wheel(package, directory, **environment):
    command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-w", str(directory)]
    environment = {**os.environ, "PIP_DISABLE_PIP_VERSION_CHECK": "1", **environment}
    return subprocess.run([*command, str(package)], env=environment, capture_output=True, text=True)


@pytest.fixture(scope="module")
def wheel(checkout, tmp_path_factory):
    pytest.importorskip("hatchling")
    directory, room = tmp_path_factory.mktemp("wheel"), tmp_path_factory.mktemp("program")
    # A stand-in for the program prints its arguments and exits with 7.
    fake_program = room / "built"
    fake_program.write_text('#!/bin/sh\necho "$0 $@"\nexit 7\n')
    fake_program.chmod(0o755)
    done = pip_wheel(
        checkout / "python", directory, REALISTIC_LIBRARY=str(_abi.library_file()), REALISTIC_PROGRAM=str(fake_program)
    )
    assert done.returncode == 0, done.stdout + done.stderr
    (file,) = directory.iterdir()
    return file


def test_one_wheel_serves_every_python_of_a_platform(wheel):
    assert re.fullmatch(rf"realistic-{re.escape(realistic.__version__)}-py3-none-\w+\.whl", wheel.name)
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {"realistic/py.typed", "realistic/licenses/LICENSE-MIT"} <= names
    assert [name for name in names if name.endswith((".so", ".dylib", ".dll"))] == ["realistic/librealistic.so"]
    metadata = zipfile.ZipFile(wheel).read(f"realistic-{realistic.__version__}.dist-info/METADATA").decode()
    needed = [line for line in metadata.splitlines() if line.startswith("Requires-Dist") and "extra ==" not in line]
    assert [line.split()[1].partition(">")[0] for line in needed] == ["numpy"]


def test_the_wheel_carries_the_program_and_starts_it(wheel, tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(tmp_path), str(wheel)],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    program = tmp_path / "realistic/realistic"
    environment = {name: value for name, value in os.environ.items() if name != "REALISTIC_PROGRAM"}
    environment["PYTHONPATH"] = str(tmp_path)
    for command in ([sys.executable, "-m", "realistic"], [str(tmp_path / "bin/realistic")]):
        done = subprocess.run([*command, "render", "a b"], env=environment, capture_output=True, text=True)
        assert (done.returncode, done.stdout) == (7, f"{program} render a b\n"), done.stderr
    code = "from realistic import blender; print(blender.program())"
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert done.stdout == f"{program}\n", done.stderr
    program.unlink()
    done = subprocess.run([sys.executable, "-m", "realistic"], env=environment, capture_output=True, text=True)
    assert done.returncode == 1 and "has no program: name a built one in the variable REALISTIC_PROGRAM" in done.stderr


def test_the_wheel_works_without_the_checkout(wheel, tmp_path):
    """Unpacks the wheel into an empty folder; of the installed packages, only NumPy is visible."""
    import numpy

    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    only = tmp_path / "only"
    only.mkdir()
    packages = os.path.dirname(os.path.dirname(numpy.__file__))
    for name in os.listdir(packages):
        if name.startswith("numpy"):
            (only / name).symlink_to(os.path.join(packages, name))
    code = (
        f"import sys; sys.path[:0] = [{str(tmp_path / 'site')!r}, {str(only)!r}]\n"
        "import realistic\n"
        "camera = realistic.Camera('wide.22mm', resolution=(300, 200))\n"
        "assert camera.rays([[150, 100]], [[0.5, 0.5]]).weight[0] > 0\n"
        "print(realistic.__file__)\n"
    )
    environment = {name: value for name, value in os.environ.items() if name != "REALISTIC_PLUGIN"}
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(str(tmp_path / "site"))


def test_what_is_missing_for_a_build_is_reported(checkout, tmp_path):
    pytest.importorskip("hatchling")
    no_cargo = pip_wheel(checkout / "python", tmp_path, PATH=str(tmp_path), CARGO="", REALISTIC_LIBRARY="")
    assert no_cargo.returncode != 0
    assert "there is no cargo in PATH: install Rust" in no_cargo.stdout + no_cargo.stderr
    no_library = pip_wheel(checkout / "python", tmp_path, REALISTIC_LIBRARY=str(tmp_path / "none.so"))
    assert no_library.returncode != 0
    assert "none.so, where there is no file" in no_library.stdout + no_library.stderr


def test_the_source_distribution_carries_what_cargo_reads(checkout, tmp_path):
    """`.ci/run` builds from the source distribution; here cargo finds each package's sources, and prebuilt files become
    the same wheel."""
    pytest.importorskip("hatchling")
    done = subprocess.run(
        [sys.executable, "-c", f"import hatchling.build as b; b.build_sdist({str(tmp_path)!r})"],
        cwd=checkout / "python",
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    archive = tmp_path / f"realistic-{realistic.__version__}.tar.gz"
    with tarfile.open(archive) as packed:
        packed.extractall(tmp_path, filter="data")
    package = tmp_path / f"realistic-{realistic.__version__}"
    for tracked in (
        "src/lib.rs",
        "crates/optics/lenses/dgauss.50mm.dat",
        "crates/optics/lenses/glasses.txt",
        "cli/assets/letters.ttf",
        "lab/src/lib.rs",
    ):
        assert (package / "workspace" / tracked).read_bytes() == (checkout / tracked).read_bytes()
    if cargo := shutil.which("cargo"):
        command = [cargo, "metadata", "--no-deps", "--locked", "--offline", "--format-version", "1"]
        completed = subprocess.run(command, cwd=package / "workspace", capture_output=True, text=True)
        assert completed.returncode == 0, completed.stderr
        targets = [target for each in json.loads(completed.stdout)["packages"] for target in each["targets"]]
        built = [
            target["src_path"] for target in targets if {"lib", "bin", "cdylib", "custom-build"} & set(target["kind"])
        ]
        assert len(built) >= 5 and all(os.path.isfile(file) for file in built), built
    library = str(_abi.library_file())
    done = pip_wheel(package, tmp_path / "wheel", REALISTIC_LIBRARY=library, REALISTIC_PROGRAM=__file__)
    assert done.returncode == 0, done.stdout + done.stderr
    (file,) = (tmp_path / "wheel").iterdir()
    assert zipfile.ZipFile(file).read("realistic/librealistic.so") == _abi.library_file().read_bytes()


def test_the_package_is_typed(checkout, tmp_path):
    pytest.importorskip("mypy")
    user = tmp_path / "user.py"
    user.write_text(
        "import realistic\n"
        "camera = realistic.Camera('dgauss.50mm', resolution=(3, 2), fnumber=4.0)\n"
        "reveal_type(camera.rays([[1, 1]], [[0.5, 0.5]]).weight)\n"
        "realistic.Camera(resolution=(3, 2), fnumber='four')\n"
        "realistic.Camera(resolution=(3, 2), fnunber=4.0)\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path / "cache"), str(user)],
        cwd=checkout / "python",
        env={**os.environ, "MYPYPATH": str(checkout / "python/src")},
        capture_output=True,
        text=True,
    )
    assert "float" in done.stdout and "ndarray" in done.stdout
    assert 'Argument "fnumber" to "Camera" has incompatible type "str"' in done.stdout, done.stdout
    assert 'Unexpected keyword argument "fnunber"' in done.stdout
    assert "Found 2 errors in 1 file" in done.stdout, done.stdout
    strict = subprocess.run(
        [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path / "cache")],
        cwd=checkout / "python",
        capture_output=True,
        text=True,
    )
    assert strict.returncode == 0, strict.stdout
