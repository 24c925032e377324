"""YAML to structures and studies: the language of model and study files.

A name is loaded when it is first asked for: who reads a model needs nothing of studies, rooms and laws.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from femstruct.language.cases import json_schema as json_schema
    from femstruct.language.cases import read_any as read_any
    from femstruct.language.cases import read_study as read_study
    from femstruct.language.models import ModelFile as ModelFile
    from femstruct.language.models import read_model as read_model
    from femstruct.language.models import read_model_file as read_model_file
    from femstruct.language.models import with_position as with_position
    from femstruct.language.yaml.tables import read_measured as read_measured

_MODULES = {
    "cases": ("json_schema", "read_any", "read_study"),
    "models": ("ModelFile", "read_model", "read_model_file", "with_position"),
    "yaml.tables": ("read_measured",),
}
_WHERE = {name: module for module, names in _MODULES.items() for name in names}
__all__ = [
    "ModelFile",
    "json_schema",
    "read_any",
    "read_measured",
    "read_model",
    "read_model_file",
    "read_study",
    "with_position",
]


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_WHERE[name]}"), name)
