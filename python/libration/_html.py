"""Short tables of results for notebooks: escaped, without scripts and external resources."""

from __future__ import annotations

import html
import json
from typing import Any, Iterable, Mapping, Sequence

LEFT = "text-align:left"

MOST_CHARACTERS = 80
"""Length of a value above which only its size is shown."""


def escaped(value: Any) -> str:
    """Return a value as escaped text, of a number at most six digits."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))


def short(value: Any) -> str:
    """Return a value as text on a line; of a long one its size."""
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, float):
        return f"{value:.12g}"
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    if len(text) <= MOST_CHARACTERS or isinstance(value, str):
        return text
    return f"{len(value)} {'keys' if isinstance(value, Mapping) else 'entries'}"


def pairs(items: Iterable[tuple[str, Any]]) -> str:
    """Return a table of names and values."""
    rows = (
        f"<tr><th style='{LEFT}'>{html.escape(name.replace('_', ' '))}</th><td style='{LEFT}'>{html.escape(short(value))}</td></tr>"
        for name, value in items
    )
    return f"<table>{''.join(rows)}</table>"


def table(head: Sequence[str], rows: Iterable[Sequence[Any]], texts: int = 1) -> str:
    """Return a table whose first ``texts`` columns are texts and whose others are numbers."""
    cells = lambda row: "".join(f"<td{f' style={LEFT!r}' if i < texts else ''}>{escaped(x)}</td>" for i, x in enumerate(row))  # noqa: E731
    body = "".join(f"<tr>{cells(row)}</tr>" for row in rows)
    return f"<table><thead><tr>{''.join(f'<th>{html.escape(x)}</th>' for x in head)}</tr></thead><tbody>{body}</tbody></table>"
