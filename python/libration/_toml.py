"""Conversion of settings to TOML."""

from __future__ import annotations

import json
import math
import numbers
import os
from typing import Any, Mapping

from . import _native


def text_of(name: str, settings: Any) -> str:
    """Return settings as TOML: those of a dictionary or of a file; an empty string for None."""
    if settings is None:
        return ""
    if isinstance(settings, (str, os.PathLike)):
        return _text_of_file(name, settings)
    if isinstance(settings, Mapping):
        return "\n".join(_table((), settings)) + "\n"
    raise TypeError(f"{name} must be a dictionary or the path of a file, not {type(settings).__name__}")


def _text_of_file(name: str, path: str | os.PathLike[str]) -> str:
    with open(path, "rb") as file:
        # A device or a pipe may have no end.
        text = file.read(_native._SETTINGS_BYTES + 1)
    if len(text) > _native._SETTINGS_BYTES:
        raise ValueError(f"{name}: {os.fspath(path)!r} is too long; expected at most {_native._SETTINGS_BYTES} bytes")
    return text.decode("utf-8")


def _table(path: tuple[str, ...], table: Mapping[str, Any]) -> list[str]:
    lines = [f"[{'.'.join(map(_string, path))}]"] if path else []
    inner = {key: value for key, value in table.items() if isinstance(value, Mapping)}
    for key, value in table.items():
        if key not in inner and value is not None:
            lines.append(f"{_string(str(key))} = {_value(str(key), value)}")
    for key, value in inner.items():
        lines += _table((*path, str(key)), value)
    return lines


def _value(key: str, value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        number = float(value)
        return repr(number) if math.isfinite(number) else str(number)
    if isinstance(value, os.PathLike):
        return _string(os.fspath(value))
    if hasattr(value, "tolist"):
        value = value.tolist()
        if not isinstance(value, list):
            return _value(key, value)
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{_string(str(name))} = {_value(str(name), entry)}' for name, entry in value.items())}}}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_value(key, entry) for entry in value)}]"
    raise TypeError(f"{key} must be a number, a string, a list or a dictionary, not {type(value).__name__}")


def _string(text: str) -> str:
    # TOML strings equal JSON strings, except for characters that JSON writes as surrogate pairs.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
