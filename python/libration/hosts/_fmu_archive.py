"""The archive of an FMU, checked before anything of it is unpacked."""

from __future__ import annotations

import os
import stat
import zipfile
from pathlib import Path, PureWindowsPath

# Limits of an archive: the largest public FMUs have some thousand files and some hundred MB.
MOST_ENTRIES = 100_000
MOST_BYTES = 4 << 30
MOST_OF_DESCRIPTION = 256 << 20
DESCRIPTION = "modelDescription.xml"


def check_archive(path: Path) -> None:
    """Check the number, the sizes and the names of the files in an archive, or the description in a folder.

    Raises
    ------
    ValueError
        If the archive is none, is too large, or has a file outside its folder.
    """
    if path.is_dir():
        description = path / DESCRIPTION
        if description.is_file() and description.stat().st_size > MOST_OF_DESCRIPTION:
            raise ValueError(f"{path.name}: {DESCRIPTION} has {description.stat().st_size} bytes; expected at most {MOST_OF_DESCRIPTION}")
        if not description.is_file():
            raise ValueError(f"{path.name} is no valid FMU: it has no file {DESCRIPTION}")
        return
    if not path.is_file():
        raise ValueError(f"{path.name} is no regular file; expected an FMU")
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
    except (OSError, zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        raise ValueError(f"{path.name} is no valid FMU: {error}") from None
    if len(entries) > MOST_ENTRIES:
        raise ValueError(f"{path.name} has {len(entries)} files; expected at most {MOST_ENTRIES}")
    total = sum(entry.file_size for entry in entries)
    if total > MOST_BYTES:
        raise ValueError(f"{path.name} unpacks to {total} bytes; expected at most {MOST_BYTES}")
    for entry in entries:
        if not _is_inside(entry.filename):
            raise ValueError(f"{path.name} has the file {entry.filename!r}, which is not in its folder")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise ValueError(f"{path.name} has the link {entry.filename!r}; expected files and folders")
        if entry.filename == DESCRIPTION and entry.file_size > MOST_OF_DESCRIPTION:
            raise ValueError(f"{path.name}: {DESCRIPTION} has {entry.file_size} bytes; expected at most {MOST_OF_DESCRIPTION}")


def _is_inside(name: str) -> bool:
    """Whether a name stays in its folder, on any system."""
    path = PureWindowsPath(name)
    return bool(name) and not path.anchor and ".." not in path.parts and not os.path.isabs(name) and name.isprintable()
