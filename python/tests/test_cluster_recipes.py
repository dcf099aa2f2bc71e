"""The recipes of docs/cluster.md give the bits of one process, in twenty lines each."""

import filecmp
import os
import re
import subprocess
import sys
from pathlib import Path

import libration

PAGE = Path(__file__).resolve().parents[2] / "docs" / "cluster.md"
SETTINGS = {"num_envs": 64, "steps": 200, "chunk": {"num_envs": 16, "steps": 100}}
SLURM = re.findall(r"^```bash\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def run(script, folder, **variables):
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    done = subprocess.run(["bash", "-e", "-c", script], cwd=folder, env={**os.environ, "PATH": path, **variables}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_an_array_of_slurm_gives_the_bytes_and_the_digest_of_one_process(tmp_path):
    array, join = SLURM
    for index in ("3", "1", "4", "2", "2"):
        # The last task was started again.
        run(array, tmp_path, SLURM_ARRAY_TASK_ID=index, SLURM_ARRAY_TASK_COUNT="4", SLURM_CPUS_PER_TASK="2")
    over = {"dt": [0.01, 0.02, 0.05, 0.1]}
    alone = libration.sweep(libration.analyze, {"system": "oscillator", "integrator": "rk4", "steps": 10}, over=over)
    assert run(join, tmp_path) == alone.digest()
    libration.datasets.write(tmp_path / "alone", SETTINGS)
    files = [str(path.relative_to(tmp_path / "alone")) for path in (tmp_path / "alone").rglob("*") if path.is_file()]
    assert len(files) > 8 and filecmp.cmpfiles(tmp_path / "alone", tmp_path / "data", files, shallow=False)[0] == files


def test_each_recipe_has_at_most_twenty_lines():
    joblib = PAGE.read_text(encoding="utf-8").split("<!-- requires: joblib -->\n```python\n")[1].split("```")[0]
    for recipe in (joblib, "".join(SLURM)):
        assert sum(bool(line.strip()) for line in recipe.splitlines()) <= 20
