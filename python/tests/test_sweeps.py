"""Sweeps in one process: the grid, the table, its page."""

import math
import pickle
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import libration
from libration.sweeps import Sweep, sweep

FIXED = {"system": "oscillator", "integrator": "rk4", "steps": 10}
DTS = [0.01, 0.02, 0.5]


def sum_of(a, b=0.0, inner=None):
    return a + b + sum((inner or {}).values())


def with_failure(a, b):
    if a == b:
        raise ArithmeticError(f"{a} equals {b}")
    return {"sum": a + b, "is_less": a < b, "inner": {"name": "x" * a}, "list": [1, 2]}


@pytest.fixture(scope="module")
def table():
    return sweep(with_failure, over={"a": [1, 2, 3], "b": [1, 3, 9, 10]}, units={"a": "m"})


def test_rows_are_in_the_order_of_the_grid_with_the_results_of_single_calls():
    found = sweep(libration.analyze, FIXED, over={"dt": DTS, "q": [1.0, 2.0]})
    assert len(found) == 6 and found["dt"] == [0.01, 0.01, 0.02, 0.02, 0.5, 0.5] and found["q"] == [1.0, 2.0] * 3
    single = libration.analyze(**FIXED, dt=0.02, q=1.0)
    assert found["spectral_radius"][2] == single.spectral_radius
    assert found["largest_dt.bounded"][2] == single.largest_dt["bounded"]
    assert list(found.columns)[:2] == ["dt", "q"] and list(found.columns)[-1] == "error"


def test_a_dotted_key_changes_a_copy_of_its_dictionary_only():
    inner = {"x": 1.0, "y": 2.0}
    grid = Sweep(sum_of, {"a": 10.0, "inner": inner}, over={"inner.x": [5.0, 6.0], "b": [0.0, 0.5]})
    assert grid.run()["value"] == [17.0, 17.5, 18.0, 18.5]
    assert inner == {"x": 1.0, "y": 2.0} and grid.config["inner"] is inner
    assert Sweep(sum_of, over={"a": [1.0], "inner.x": [2.0]}).run()["value"] == [3.0]


def test_any_division_into_parts_gives_the_same_digest(table):
    grid = Sweep(with_failure, over={"a": [1, 2, 3], "b": [1, 3, 9, 10]})
    for number in (1, 2, 5, 12, 99):
        parts = grid.parts(number)
        assert [i for part in parts for i in part] == list(range(12)) and len(parts) == min(number, 12)
        # In reverse, by copies of another process.
        rows = {part: pickle.loads(pickle.dumps(grid)).rows(part) for part in reversed(parts)}
        assert grid.table([row for part in parts for row in rows[part]]).digest() == table.digest()


def test_the_digest_has_every_bit_of_every_column():
    def digest(values, name="a"):
        return sweep(lambda **k: list(k.values())[0], over={name: values}).digest()

    assert digest([0.0]) == digest([0.0])
    different = [[0.0], [-0.0], [5e-324], [0], [False], ["0"], [None, 1.0], [1.0, None], [math.nan], [1.0], [np.nextafter(1.0, 2.0)]]
    assert len({digest(values) for values in different} | {digest([0.0], "b")}) == len(different) + 1


def test_a_failed_point_is_an_error_in_its_row_and_no_lost_sweep(table):
    assert table.errors == ["ArithmeticError: 1 equals 1", "ArithmeticError: 3 equals 3"]
    assert table["error"].index(table.errors[1]) == 9 and table["sum"][9] is None and table["sum"][10] == 12
    assert "2 failed" in repr(table)


def test_ctrl_c_in_a_call_ends_the_sweep():
    calls = []

    def interrupted(a):
        calls.append(a)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(interrupted, over={"a": [1, 2]})
    assert calls == [1]


@pytest.mark.parametrize(
    ("keywords", "error", "message"),
    [
        ({"over": {}}, ValueError, "over is empty; expected at least one keyword"),
        ({"over": {"dt": []}}, ValueError, r"over\['dt'\] is empty; expected at least one value"),
        ({"over": {"dt": 0.1}}, TypeError, r"over\['dt'\] is 0.1; expected a list"),
        ({"over": {"dt": "0.1"}}, TypeError, r"over\['dt'\] is '0.1'; expected a list"),
        ({"over": {"dtt": [0.1]}}, TypeError, "unknown keyword 'dtt' of the function: did you mean 'dt'"),
        ({"over": {"dt": [0.1]}, "config": {"latencyy": 1}}, TypeError, "'latencyy'.*did you mean 'latency'"),
        ({"over": {"dt": [0.1]}, "config": {"integrator": "rk4"}}, TypeError, "system is missing; expected it in config or in over"),
        ({"over": {"dt": [0.1]}, "config": {**FIXED, "dt": 1}}, ValueError, "over and config both have 'dt'"),
        ({"over": {"system.k": [0.1]}, "config": FIXED}, ValueError, r"over has 'system.k', but config\['system'\] is 'oscillator'; expected a dict"),
        ({"over": {"q": [1.0], "q.x": [1.0]}, "config": FIXED}, ValueError, "over has 'q' and 'q.x'; expected one of them"),
        ({"over": {"a..b": [1]}}, ValueError, "over has the key 'a..b'"),
        ({"over": [("dt", [1])]}, TypeError, "over must be a mapping, not list"),
    ],
)
def test_wrong_arguments_are_refused_before_any_call(keywords, error, message):
    with pytest.raises(error, match=message):
        sweep(libration.analyze, **keywords)
    with pytest.raises(TypeError, match="did you mean 'over'"):
        sweep(libration.analyze, overr=keywords)


def test_a_row_too_few_is_refused():
    grid = Sweep(sum_of, over={"a": [1.0, 2.0]})
    with pytest.raises(ValueError, match="there are 1 rows; expected 2"):
        grid.table(grid.rows([0]))


def test_values_without_a_notation_have_their_number_and_others_their_notation():
    values = [libration.PD(1.0, 2.0), object(), sum_of, 3, None]
    labels = sweep(lambda of: 1.0, over={"of": values})["of"]
    assert labels[0].startswith("PD(") and labels[1:] == ["object 2", "sum_of", 3, None]


def test_advice_probes_and_studies_are_tables_too():
    advice = sweep(libration.advise, {"system": "oscillator", "controller": (10.0, 2.0), "horizon": 1.0}, over={"latency": [0.01, 0.3]})
    assert advice["holds"] == [True, False] and advice["loop.budgets.latency.stated"] == [0.01, 0.3]
    # The speed of the machine is no result.
    assert not any(name.startswith("throughput") for name in advice.columns)
    probed = sweep(libration.probe, {"step": lambda x, u, dt: x * (1 - dt), "state": [1.0]}, over={"dt": [0.1, 0.2]})
    assert probed["spectral_radius"] == pytest.approx([0.9, 0.8]) and probed.errors == []
    studies = sweep(libration.run_lab, {"studies": ["spectrum"], "effort": "quick"}, over={"config.system.oscillator.omega2": [10.0, 20.0]})
    assert studies.errors == [] and any(name.endswith(".measured") for name in studies.columns)


def test_pandas_and_parquet_have_the_values_of_the_table(table, tmp_path):
    pandas, parquet = pytest.importorskip("pandas"), pytest.importorskip("pyarrow.parquet")
    frame = table.to_pandas()
    assert list(frame.columns) == list(table.columns) and len(frame) == 12
    assert pandas.isna(frame["sum"][0]) and frame["sum"][1] == 4 and frame["error"][9] == "ArithmeticError: 3 equals 3"
    table.to_parquet(tmp_path / "t.parquet")
    read = parquet.read_table(tmp_path / "t.parquet")
    assert {name: read[name].to_pylist() for name in read.column_names} == table.columns
    assert table.digest().encode() in read.schema.metadata[b"libration.sweep"]


@pytest.mark.parametrize(("package", "extra"), [("pandas", "pandas"), ("pyarrow", "parquet")])
def test_without_a_package_the_error_names_the_extra(table, tmp_path, monkeypatch, package, extra):
    monkeypatch.setitem(sys.modules, package, None)
    write = table.to_pandas if package == "pandas" else lambda: table.to_parquet(tmp_path / "t.parquet")
    with pytest.raises(ModuleNotFoundError, match=rf"{package} is not installed; help: pip install 'libration\[{extra}\]'"):
        write()


def svgs(text):
    return [ElementTree.fromstring(found) for found in re.findall(r"<svg.*?</svg>", text, re.DOTALL)]


def test_the_page_has_a_named_map_of_each_result_and_needs_no_network(table, tmp_path):
    table.page(tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "http:" not in text and "https:" not in text and "<script" not in text and "src=" not in text
    assert [svg.get("aria-label") for svg in svgs(text)] == ["Map of sum over a and b", "Map of is_less over a and b"]
    assert "From 3 at a = 2 m, b = 1 to 13 at a = 3 m, b = 10. 2 points have no number, drawn in grey." in text
    assert "a (m)" in text and "a = 2 m, b = 9: 11" in text and "2 points failed" in text and "light-dark" in text


def test_the_page_has_a_line_over_one_key_and_a_map_for_each_value_of_a_third(tmp_path):
    sweep(sum_of, over={"a": [1.0, 2.0, 4.0]}).page(tmp_path / "line.html", title="<1>")
    text = (tmp_path / "line.html").read_text(encoding="utf-8")
    assert [svg.get("aria-label") for svg in svgs(text)] == ["value over a"] and "<h1>&lt;1&gt;</h1>" in text
    sweep(sum_of, over={"a": [1.0, 2.0], "b": [1.0, 2.0], "inner.x": [10.0, 20.0, 30.0]}).page(tmp_path / "maps.html")
    text = (tmp_path / "maps.html").read_text(encoding="utf-8")
    assert len(svgs(text)) == 3 and "inner.x = 20" in text
    second = text[text.index("inner.x = 20") :]
    assert "a = 2, b = 1: 23" in second[: second.index("inner.x = 30")]


def test_a_page_of_ten_thousand_points_stays_below_a_megabyte_for_each_map(tmp_path):
    sweep(sum_of, over={"a": np.linspace(0, 1, 100), "b": np.linspace(0, 1, 100)}).page(tmp_path / "page.html")
    assert (tmp_path / "page.html").stat().st_size < 1_000_000


def test_a_result_that_cannot_be_drawn_is_refused_with_its_name(table, tmp_path):
    with pytest.raises(ValueError, match="results has 'summ': did you mean 'sum'"):
        table.page(tmp_path / "page.html", results=["summ"])
    with pytest.raises(ValueError, match="results has 'inner.name', which has no numbers"):
        table.page(tmp_path / "page.html", results=["inner.name"])


def test_progress_reaches_its_end_and_calls_show_none_of_their_own(capsys):
    seen = []
    sweep(sum_of, over={"a": [1.0, 2.0]}, progress=lambda part, text: seen.append((part, text)))
    assert seen == [(0.5, "1 of 2 points"), (1.0, "2 of 2 points")]
    given = []
    sweep(lambda a, progress=None: given.append(progress), over={"a": [1]})
    assert given == [False]


def test_the_package_imports_no_ray():
    code = "import sys, libration; assert not any(name.split('.')[0] == 'ray' for name in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_without_ray_the_error_names_the_extra():
    code = "import sys; sys.modules['ray'] = None; import libration.cluster"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "ModuleNotFoundError: libration.cluster requires Ray" in done.stderr
    assert done.stderr.endswith("help: pip install 'libration[ray]'\n")


def changes_its_argument(table):
    table["list"].append(1)
    return len(table["list"])


def test_a_call_that_changes_its_arguments_changes_those_of_no_other_call():
    found = libration.sweep(changes_its_argument, {"table": {"list": []}}, over={"table.x": [1, 2, 3]})
    assert found["value"] == [1, 1, 1]
    found = libration.sweep(changes_its_argument, over={"table": [{"list": []}] * 2})
    assert found["value"] == [1, 1]


def test_results_with_names_of_other_columns_are_kept_and_repeated_keys_are_not():
    found = libration.sweep(lambda a: {"a": a, "error": 0.5, "y": 1}, over={"a": [1, 2]})
    assert list(found.columns) == ["a", "result.error", "y", "error"] and found["result.error"] == [0.5, 0.5]
    found = libration.sweep(lambda a: {"a": 10 * a}, over={"a": [1, 2]})
    assert (found["a"], found["result.a"]) == ([1, 2], [10, 20])
    with pytest.raises(ValueError, match="over has the key 'error'"):
        libration.sweep(lambda error: error, over={"error": [1]})


@pytest.mark.parametrize(
    ("result", "message"),
    [
        (lambda a: {"x.y": 1, "x": {"y": 2}}, "two results with the name 'x.y'"),
        (lambda a: None, "returned NoneType; expected a number"),
        (lambda a: {"": 1}, "a result without a name"),
        (lambda a: exit(3), "SystemExit: 3"),
    ],
)
def test_what_cannot_be_a_row_is_an_error_in_its_row(result, message):
    found = libration.sweep(result, over={"a": [1]})
    assert message in found["error"][0]
