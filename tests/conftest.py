"""Shared by all tests."""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(name, "1")

from hypothesis import settings  # noqa: E402

settings.register_profile("pearlbvp", deadline=None, max_examples=60, derandomize=True)
settings.load_profile("pearlbvp")
