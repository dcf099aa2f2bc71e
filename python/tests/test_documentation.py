"""Each block of Python in the documents runs, in the order of its page."""

import importlib.util
import os
import re
from pathlib import Path

import pytest

os.environ["MPLBACKEND"] = "Agg"
ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]

# A block that needs a library beyond NumPy and Gymnasium has a line ``<!-- requires: NAME -->`` above it, and is left out without the library.
BLOCK = re.compile(r"(?:<!-- requires: (?P<modules>[a-z0-9_, ]+) -->\n+)?^```python\n(?P<text>.*?)^```$(?:\n```text\n(?P<printed>.*?)^```$)?", re.MULTILINE | re.DOTALL)
# The files that blocks of the shell write before: a test of the program runs these blocks.
FILE = re.compile(r"^cat > (?P<name>[\w.-]+) <<'END'\n(?P<text>.*?)^END$", re.MULTILINE | re.DOTALL)
LIBRARIES = {"stable_baselines3", "matplotlib", "mujoco", "scipy", "ray", "joblib"}


def blocks_of(page: Path) -> list[tuple[int, str, str, list[str]]]:
    """The line and the text of each block, the text that the page says it prints, and its required libraries."""
    text = page.read_text(encoding="utf-8")
    return [
        (
            text.count("\n", 0, block.start("text")),
            block["text"],
            block["printed"] or "",
            [name.strip() for name in (block["modules"] or "").split(",") if name.strip()],
        )
        for block in BLOCK.finditer(text)
    ]


WITH_BLOCKS = [page for page in PAGES if blocks_of(page)]


@pytest.mark.parametrize("page", WITH_BLOCKS, ids=lambda page: page.name)
def test_blocks_of_a_page_run_as_a_reader_copies_them_and_print_what_it_says(page, tmp_path, monkeypatch, capsys):
    # A reader is in a clone of the repository. Nothing else exists before the first block but the files of blocks of the shell.
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    for file in FILE.finditer(page.read_text(encoding="utf-8")):
        Path(file["name"]).write_text(file["text"], encoding="utf-8")
    shared: dict = {"__name__": "__main__"}
    for line, text, printed, libraries in blocks_of(page):
        if any(importlib.util.find_spec(name) is None for name in libraries):
            continue
        code = compile("\n" * line + text, str(page), "exec")
        exec(code, shared)
        output = capsys.readouterr().out
        for promised in printed.splitlines():
            assert promised in output, f"{page.name}:{line} promises {promised!r}:\n{output}"


def test_blocks_are_found_and_left_out_only_for_a_library_that_they_import():
    texts = {page.name: page.read_text(encoding="utf-8") for page in PAGES}
    assert len(WITH_BLOCKS) >= 6
    for page in PAGES:
        assert len(blocks_of(page)) == texts[page.name].count("```python"), page.name
        assert sum(bool(libraries) for *_, libraries in blocks_of(page)) == texts[page.name].count("<!-- requires:"), page.name
        for line, text, _, libraries in blocks_of(page):
            assert set(libraries) <= LIBRARIES
            for name in libraries:
                other = {"matplotlib": ".plot()", "ray": "libration.cluster"}.get(name, name)
                assert name in text or other in text, f"{page.name}:{line} does not use {name}"
