"""YAML to structures and studies: the language of model and study files."""

from femstruct.language.cases import json_schema, read_any, read_study
from femstruct.language.models import ModelFile, read_model, read_model_file, with_position
from femstruct.language.tables import read_measured

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
