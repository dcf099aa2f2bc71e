"""What types say of the package is true of it."""

import os
import subprocess
import sys


def checked(*arguments):
    run = [sys.executable, "-m", *arguments]
    done = subprocess.run(run, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_agrees_with_the_module():
    checked("mypy.stubtest", "libration._native")


def test_the_package_agrees_with_its_types():
    checked("mypy", "--python-executable", sys.executable, "--cache-dir", os.devnull, "-p", "libration")
