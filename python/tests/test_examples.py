"""Every example that needs no library of learners runs, and says what it should."""

import contextlib
import io
import json
import os
import pathlib
import runpy
import sys

import pytest

os.environ["MPLBACKEND"] = "Agg"
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"


def said_by(name, capsys, monkeypatch, *arguments):
    path = str(EXAMPLES / name)
    monkeypatch.setattr(sys, "argv", [path, *map(str, arguments)])
    runpy.run_path(path, run_name="__main__")
    return capsys.readouterr().out


def test_the_quickstart_loses_nothing_before_what_theory_says_and_much_after_it(capsys, monkeypatch):
    said = said_by("quickstart.py", capsys, monkeypatch)
    critical = float(said.split("commands may be ")[1].split(" s late")[0])
    rows = [line.split() for line in said.splitlines() if line.startswith("  0.")]
    assert len(rows) == 7 and abs(critical - 0.131) < 1e-3
    for late, _, _, lost in rows:
        assert (int(lost) > 500) == (float(late) > critical), late


def test_the_latency_budget_is_kept_and_growth_is_that_of_theory(capsys, monkeypatch, tmp_path):
    said = said_by("latency_budget.py", capsys, monkeypatch, "--figure", tmp_path / "budget.png")
    limit = float(said.split("stable up to ")[-1].split(" s")[0])
    rows = [[float(x) for x in line.split()] for line in said.splitlines() if line.startswith("      0.")]
    assert len(rows) == 5
    for late, predicted, measured in rows:
        assert (predicted > 0) == (measured > 0) == (late > limit)
        # Second moments turn while they grow, which a line through four seconds of them averages but for a part of a turn.
        assert measured == pytest.approx(predicted, abs=0.05)
    assert (tmp_path / "budget.png").stat().st_size > 10_000


def test_training_runs_and_does_not_depend_on_threads(capsys, monkeypatch):
    # Nothing is learnt in a time that a test has, but all of it runs.
    one, three = (
        said_by("train.py", capsys, monkeypatch, "--quick", "--seed", 5, "--threads", threads)
        for threads in (1, 3)
    )
    assert one == three
    rows = [line.split() for line in one.split("|λ|\n")[1].splitlines()[:4]]
    assert [row[-5] for row in rows] == ["0.00", "0.15"] * 2
    for row in rows:
        mean, upright, largest = map(float, row[-3:])
        assert -2000 < mean < -10 and 0 <= upright <= 1 and 0 < largest < 10, row


def test_the_notebook_says_what_it_said_when_it_was_stored():
    cells = json.loads((EXAMPLES / "tour.ipynb").read_text())["cells"]
    cells = [cell for cell in cells if cell["cell_type"] == "code"]
    shared, told = {}, 0
    for cell in cells:
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec("".join(cell["source"]), shared)
        stored = [o for o in cell["outputs"] if o["output_type"] == "stream"]
        assert out.getvalue() == "".join("".join(o["text"]) for o in stored)
        told += len(stored)
    shared["pyplot"].close("all")
    assert told == 2 and all(cell["execution_count"] for cell in cells)
