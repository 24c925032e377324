"""Errors that only show once a structure is built, reported with the line of the file they come from."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from acoustics.errors import AcousticsError
from femstruct.errors import FemstructError, InputErrors, NotConverged
from femstruct.language import ModelFile, with_position
from femstruct.study.study import Plan


@contextmanager
def positioned(source: ModelFile | Plan) -> Iterator[None]:
    """Errors of the input raised inside begin with ``file:line:column:`` where their path is in a file."""
    try:
        yield
    except (NotConverged, InputErrors):
        raise
    except FemstructError as error:
        raise InputErrors((with_position(source, error),)) from error
    except AcousticsError as error:
        raise InputErrors((str(error),)) from error
