"""Progress of long work, in a terminal or a notebook."""

from __future__ import annotations

import html
import sys
from typing import Any, Callable, Union

Progress = Union[bool, None, Callable[[float, str], Any]]
"""``True`` shows progress, ``False`` does not, ``None`` does in a terminal or notebook. A function receives the fraction done, from 0 to 1,
and a description."""


class ProgressDisplay:
    """Display of progress, removed at the end."""

    def __init__(self, progress: Progress) -> None:
        if not (progress is None or isinstance(progress, bool) or callable(progress)):
            raise TypeError(
                f"progress must be True, False, None or a function, not {type(progress).__name__}"
            )
        self._show: Callable[[float, str], Any] | None = None
        self._line = 0
        self._display: Any = None
        if callable(progress):
            self._show = progress
        elif progress is not False:
            if _in_notebook():
                self._show = self._in_notebook
            elif progress or sys.stderr.isatty():
                self._show = self._in_terminal

    def __enter__(self) -> ProgressDisplay:
        return self

    def __exit__(self, *_: Any) -> None:
        if self._line:
            sys.stderr.write("\r" + " " * self._line + "\r")
            sys.stderr.flush()
        if self._display is not None:
            from IPython.display import HTML  # type: ignore[import-not-found,unused-ignore]

            self._display.update(HTML(""))

    def update(self, part: float, what: str) -> None:
        if self._show is not None:
            self._show(min(max(part, 0.0), 1.0), what)

    @property
    def enabled(self) -> bool:
        return self._show is not None

    def _in_terminal(self, part: float, what: str) -> None:
        full = round(20 * part)
        line = f"{'━' * full}{'─' * (20 - full)} {100 * part:3.0f} %  {what}"[:100]
        sys.stderr.write("\r" + line.ljust(self._line))
        sys.stderr.flush()
        self._line = len(line)

    def _in_notebook(self, part: float, what: str) -> None:
        from IPython.display import HTML, display  # type: ignore[import-not-found,unused-ignore]

        bar = HTML(f"<progress value='{part:.4f}' max='1'></progress> {html.escape(what)}")
        if self._display is None:
            self._display = display(bar, display_id=True)
        else:
            self._display.update(bar)


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return shell is not None and getattr(shell, "kernel", None) is not None
