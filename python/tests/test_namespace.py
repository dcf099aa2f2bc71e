"""The names of the package: what its documents use, and nothing foreign."""

import importlib.metadata
import inspect
import subprocess
import sys
import types

import libration


def test_the_package_shows_its_public_names_only():
    assert dir(libration) == sorted(set(libration.__all__))
    for name in libration.__all__:
        assert hasattr(libration, name), name
        assert not name.startswith("_") or name == "__version__"


def test_nothing_foreign_is_in_the_package():
    for name, value in vars(libration).items():
        if name.startswith("_") or name in libration.__all__:
            continue
        # Modules of the package are attributes of it once they are imported.
        assert inspect.ismodule(value) and value.__name__ == f"libration.{name}", name


def test_public_names_are_of_the_package():
    for name in libration.__all__:
        value = getattr(libration, name)
        if isinstance(value, types.ModuleType):
            assert value.__name__ == f"libration.{name}"
        elif not isinstance(value, (str, types.MappingProxyType)):
            module = getattr(value, "__module__", None) or type(value).__module__
            assert module.startswith("libration."), name


def test_without_gymnasium_the_names_are_those_that_require_numpy_only():
    code = """
import sys
sys.modules["gymnasium"] = None
import libration
assert "VectorEnv" not in dir(libration) and "Environments" in dir(libration) and "hosts" in dir(libration)
assert all(hasattr(libration, name) for name in libration.__all__)
"""
    # An import that is blocked is a ModuleNotFoundError of that name.
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_package_contains_the_licenses_of_what_is_compiled_into_it():
    files = {file.name: file for file in importlib.metadata.files("libration")}
    text = files["THIRD-PARTY-LICENSES.txt"].read_text()
    for name in ("parquet", "pyo3", "zstd-sys"):
        assert f"\n{name} " in text
    assert {"LICENSE-APACHE", "LICENSE-MIT"} <= files.keys()
