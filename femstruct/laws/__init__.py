"""Contact laws: a module each, found by `registry`; force from indentation and its rate, compressive and positive."""

from __future__ import annotations
