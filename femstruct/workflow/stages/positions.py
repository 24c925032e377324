"""Errors that only show once a structure is built, reported with the line of the file they come from."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from acoustics.errors import AcousticsError
from femstruct.errors import FemstructError, InputErrors, NotConverged
from femstruct.language import ModelFile, with_position
from femstruct.language.yaml import Position
from femstruct.study.study import Plan


@contextmanager
def positioned(source: ModelFile | Plan) -> Iterator[None]:
    """Errors of the input raised inside begin with ``file:line:column:`` where their path is in a file.

    What did not converge is put where the thing that it names is described, else at the beginning of the file.
    """
    try:
        yield
    except NotConverged as error:
        error.position = error.position or _position(source, error)
        raise
    except InputErrors:
        raise
    except FemstructError as error:
        raise InputErrors((with_position(source, error),)) from error
    except AcousticsError as error:
        raise InputErrors((str(error),)) from error


def _position(source: ModelFile | Plan, error: NotConverged) -> str:
    """``file:line:column: `` of the first of the quoted names that a file describes, or of its beginning."""
    quoted = re.findall(r"'([^']+)'", f"{error.got} {error.where}")
    named = [name for one in quoted for name in (one, *one.split(" on "))]
    for name in named:
        for path, (file, line, column) in source.positions.items():
            if path.count(".") == 1 and path.endswith(f".{name}"):
                return f"{Position(file, line, column)}: "
    files = [at[0] for at in source.positions.values()]
    return f"{Position(files[0], 1, 1)}: " if files else ""
