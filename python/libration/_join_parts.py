"""Parts of a data set become one data set."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

from .datasets import Written


def join_parts(parts: list[Path], out: Path, remove: Path) -> Written:
    """Move the shards of a data set to its folder, in order, and remove the folder of the parts."""
    counts = [0, 0, 0]
    lines: list[bytes] = []
    for part in parts:
        head, *chunks = (part / "manifest.jsonl").read_bytes().splitlines(keepends=True)
        if not lines:
            first = head
            lines.append(b"")
        lines += chunks
        for chunk in map(json.loads, chunks):
            counts[0] += chunk["holds"]["transitions"]
            counts[2] += 1
            for file in chunk["files"]:
                counts[1] += file["bytes"]
                target = out / file["path"]
                target.parent.mkdir(parents=True, exist_ok=True)
                if not target.exists():
                    os.link(part / file["path"], target)
    last = json.loads(head)["groups"][1]
    begin, end = (json.dumps(json.loads(line)["groups"], separators=(",", ":")) for line in (first, head))
    lines[0] = first.replace(f'"groups":{begin}'.encode(), f'"groups":[0,{last}]'.encode())
    assert end.endswith(f",{last}]")
    unfinished = out / ".manifest.jsonl"
    unfinished.write_bytes(b"".join(lines))
    unfinished.replace(out / "manifest.jsonl")
    shutil.rmtree(remove)
    return Written(out, *counts)
