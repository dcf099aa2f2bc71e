"""What the stub says of the native module is true of it."""

import subprocess
import sys


def test_the_stub_agrees_with_the_module():
    checked = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "libration._native"], capture_output=True, text=True
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr
