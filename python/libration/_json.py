"""Results as JSON."""

from __future__ import annotations

import json
import math
from typing import Any


def json_text(results: Any) -> str:
    """Return results as JSON. A number that is not finite is null, as in the output of ``--json``."""
    return json.dumps(_with_nulls(results), indent=2, allow_nan=False)


def _with_nulls(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _with_nulls(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_with_nulls(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
