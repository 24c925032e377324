"""YAML to structures and studies: the language of model and study files.

A name is loaded when it is first asked for: who reads a model needs nothing of studies, rooms and laws.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from femstruct.language.cases import json_schema, read_any, read_study
    from femstruct.language.models import ModelFile, read_model, read_model_file, with_position

__all__ = ["ModelFile", "json_schema", "read_any", "read_model", "read_model_file", "read_study", "with_position"]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    of_studies = name in ("json_schema", "read_any", "read_study")
    return getattr(import_module(f"{__name__}.{'cases' if of_studies else 'models'}"), name)
