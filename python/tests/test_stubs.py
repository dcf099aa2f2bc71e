"""What types say of the package is true of it."""

import subprocess
import sys
from pathlib import Path

CONFIG = Path(__file__).parents[2] / "pyproject.toml"


def test_the_package_agrees_with_its_types_and_its_stub_with_the_module(tmp_path):
    """By one program: each of two would check the types of NumPy as well, for longer than those of the package."""
    # stubtest fails where mypy has an error in any module. The modules without a stub have no other signatures than their own.
    allowed = tmp_path / "allowed.txt"
    allowed.write_text(r"libration(?!\._native\b).*")
    options = ["--mypy-config-file", CONFIG, "--allowlist", allowed, "--ignore-unused-allowlist"]
    run = [sys.executable, "-m", "mypy.stubtest", "libration", *options]
    done = subprocess.run(run, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
