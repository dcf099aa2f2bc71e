"""Every example runs, and says what it should."""

import pathlib
import runpy

import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_an_example_runs(path, capsys):
    runpy.run_path(str(path), run_name="__main__")
    said = capsys.readouterr().out
    if path.stem == "quickstart":
        critical = float(said.split("commands may be ")[1].split(" s late")[0])
        rows = [line.split() for line in said.splitlines() if line.startswith("  0.")]
        # Nothing is lost before what theory says, and much is after it.
        assert len(rows) == 7 and abs(critical - 0.131) < 1e-3
        for late, _, _, lost in rows:
            assert (int(lost) > 500) == (float(late) > critical), late
