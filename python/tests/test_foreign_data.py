"""Data sets and FMUs of others: what is wrong with them is a ValueError, before anything is unpacked or made."""

import json
import os
import stat
import zipfile
from pathlib import Path
from typing import Any

import pytest

from libration import datasets
from libration.hosts import _fmu_archive
from libration.hosts._fmu_archive import check_archive

SETTINGS: dict[str, Any] = {"num_envs": 2, "steps": 4, "chunk": {"num_envs": 2, "steps": 4}}


def changed(folder: Path, change: Any) -> Path:
    """Return the folder of a data set, of whose settings `change` makes others."""
    datasets.write(folder, SETTINGS)
    manifest = folder / "manifest.jsonl"
    head, *rest = manifest.read_text().splitlines(keepends=True)
    value = json.loads(head)
    value["data"] = change(value["data"])
    manifest.write_text(json.dumps(value) + "\n" + "".join(rest))
    return folder


@pytest.mark.parametrize(
    "change",
    [
        lambda data: [],
        lambda data: "text",
        lambda data: {},
        lambda data: {**data, "system": "oscillator"},
        lambda data: {**data, "system": {}},
        lambda data: {**data, "dt": "fast"},
        lambda data: {**data, "dt": None},
        lambda data: {**data, "substeps": 0},
        lambda data: {**data, "delays": 3},
        lambda data: {**data, "dtype": ["f64"]},
        lambda data: {**data, "integrator": 7},
        lambda data: {**data, "noise": {"jitter": {}}},
        lambda data: {**data, "start": {"q": "here", "v": []}},
    ],
)
def test_settings_of_another_form_are_a_value_error(tmp_path: Path, change: Any) -> None:
    with pytest.raises(ValueError):
        datasets.recover_environment(changed(tmp_path / "set", change))


def test_a_manifest_that_has_no_end_or_is_no_file_is_a_value_error(tmp_path: Path) -> None:
    for text in [b"[" * 200_000, b"{" + b" " * (1 << 24) + b"}", b"\xff\xfe", b""]:
        (tmp_path / "manifest.jsonl").write_bytes(text)
        with pytest.raises(ValueError, match="has no data set"):
            datasets.recover_environment(tmp_path)
    os.remove(tmp_path / "manifest.jsonl")
    os.mkfifo(tmp_path / "manifest.jsonl")
    with pytest.raises(ValueError, match="is no file"):
        datasets.recover_environment(tmp_path)


def archive(path: Path, *names: str, link: bool = False) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name in names:
            entry = zipfile.ZipInfo(name)
            if link:
                entry.external_attr = (stat.S_IFLNK | 0o777) << 16
            file.writestr(entry, b"0" * 1000)
    return path


def test_an_archive_with_files_outside_its_folder_is_refused(tmp_path: Path) -> None:
    for name in ["../a", "/etc/a", "a/../../b", "..\\a", "C:\\a", "a\nb"]:
        with pytest.raises(ValueError, match="not in its folder"):
            check_archive(archive(tmp_path / "a.fmu", "modelDescription.xml", name))
    with pytest.raises(ValueError, match="has the link"):
        check_archive(archive(tmp_path / "a.fmu", "resources/x", link=True))
    check_archive(archive(tmp_path / "a.fmu", "modelDescription.xml", "binaries/linux64/a.so"))


def test_an_archive_that_is_too_large_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = archive(tmp_path / "a.fmu", "modelDescription.xml", "a", "b")
    for limit, most, message in [
        ("MOST_ENTRIES", 2, "has 3 files; expected at most 2"),
        ("MOST_BYTES", 2999, "unpacks to 3000 bytes; expected at most 2999"),
        ("MOST_OF_DESCRIPTION", 999, "modelDescription.xml has 1000 bytes"),
    ]:
        with monkeypatch.context() as patch:
            patch.setattr(_fmu_archive, limit, most)
            with pytest.raises(ValueError, match=message):
                check_archive(path)
    check_archive(path)


def test_what_is_no_archive_is_refused(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.fmu"
    os.mkfifo(pipe)
    text = tmp_path / "text.fmu"
    text.write_text("text")
    for path in [pipe, text, tmp_path]:
        with pytest.raises(ValueError, match="no regular file|no valid FMU"):
            check_archive(path)
