"""Modules in the current folder are not run, where the search path of this process does not have it."""

import subprocess
import sys
from pathlib import Path

_PROGRAM = """
from libration.hosts._fmu_process import FmuProcess
try:
    FmuProcess("no.fmu", {"folder": "nowhere", "kind": "CoSimulation"}, 20.0).request("load")
except RuntimeError as error:
    print(error)
"""


def test_the_process_of_an_fmu_runs_no_module_of_the_current_folder(tmp_path: Path) -> None:
    folder, scripts = tmp_path / "downloads", tmp_path / "scripts"
    folder.mkdir()
    scripts.mkdir()
    names = ("runpy", "importlib", "pkgutil", "json", "ctypes", "faulthandler", "fmpy", "typing")
    for name in names:
        (folder / f"{name}.py").write_text("import io\nio.open(__file__ + '.ran', 'w').close()\n")
    (scripts / "run.py").write_text(_PROGRAM)
    done = subprocess.run([sys.executable, str(scripts / "run.py")], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "nowhere" in done.stdout, done.stdout
    assert sorted(folder.glob("*.ran")) == []
