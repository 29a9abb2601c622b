"""What a session shows of an object that holds arrays: its fields, long ones by their size, in a few lines."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

FEW = 12
"""Entries up to which numbers are shown one by one."""

PLAIN = (str, bool, int, float, complex, np.generic, type(None))


def brief(self: Any) -> str:
    """``__repr__`` of a dataclass: ``Name(field=value, ...)``; arrays, lists and further objects by what they are."""
    shown = (f"{field.name}={_shown(getattr(self, field.name))}" for field in fields(self) if field.repr)
    return f"{type(self).__name__}({', '.join(shown)})"


def _shown(value: Any) -> str:
    """One value in a few words."""
    if isinstance(value, (float, np.floating)):
        return f"{value:.10g}"
    if isinstance(value, PLAIN):
        text = str(value.item()) if isinstance(value, np.generic) else repr(value)
        return text if len(text) <= 100 else f"{text[:97]}..."
    if isinstance(value, np.ndarray):
        if value.ndim == 1 and value.size <= FEW // 2 and value.dtype.kind in "fiub":
            return f"[{', '.join(f'{number:.10g}' for number in value)}]"
        return f"array {value.shape}"
    if isinstance(value, Mapping):
        if len(value) <= FEW and all(isinstance(part, PLAIN) for part in value.values()):
            return f"{{{', '.join(f'{name}: {_shown(part)}' for name, part in value.items())}}}"
        return f"{len(value)} entries"
    if isinstance(value, (Sequence, set, frozenset)):
        if len(value) <= FEW and all(isinstance(part, PLAIN) for part in value):
            return f"({', '.join(map(_shown, value))})"
        kinds = {type(part).__name__ for part in value}
        return f"{len(value)} {kinds.pop() if len(kinds) == 1 else 'entries'}"
    if is_dataclass(value):
        return f"{type(value).__name__}(...)"
    return str(getattr(value, "__name__", f"<{type(value).__name__}>"))


def span(values: Sequence[float]) -> str:
    """``0.48``, or ``1 to 1.02`` where values differ."""
    low, high = min(values), max(values)
    return f"{low:.8g}" if math.isclose(low, high, rel_tol=1e-9, abs_tol=1e-12) else f"{low:.8g} to {high:.8g}"
