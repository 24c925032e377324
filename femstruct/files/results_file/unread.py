"""What no reader of a results file uses and most of its bytes would be: left out, unless a study says `save: modal`."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, NoReturn, TypeVar

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import FemstructError

if TYPE_CHECKING:
    from femstruct.impact.engine.motion import Motion
    from femstruct.modal.basis import ModalBasis
    from femstruct.study.result import CaseResult, StudyResult

T = TypeVar("T")
MOTION: Final = "the motion of the modes"
PUSHES: Final = "the forces that push the modes"


class NotKept:
    """What stands in a noun for something that its file does not have: whoever uses it is told so.

    >>> NotKept("the motion of the modes").turn
    Traceback (most recent call last):
    ...
    femstruct.errors.FemstructError: the motion of the modes: got a results file without it, expected the whole; run \
the study again with 'save: modal'
    """

    def __init__(self, what: str) -> None:
        self.what = what

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") and not name.startswith("__array"):
            raise AttributeError(name)  # what Python asks of any value
        self._refuse()

    def __getitem__(self, place: object) -> Any:
        self._refuse()

    def __len__(self) -> int:
        self._refuse()

    def _refuse(self) -> NoReturn:
        do = "run the study again with 'save: modal'"
        raise FemstructError(self.what, got="a results file without it", expected="the whole", do=do)


def without_unread(result: StudyResult) -> StudyResult:
    """The results as a file has them: without what only further simulations and evaluations would use.

    Notes
    -----
    Pages, tables, pictures, sounds, comparisons and exports are made of histories, shapes and levels. Left out are, of
    a case that does not say `save: modal`: the forces that push the modes (their channels are kept) and the motion of
    the modes, unless pictures of closed rooms are drawn of it, those of the baseline; of its basis, what couples the
    modes in the stiffness of parts and in what holds energy, which is nan then, beside the diagonals, the shares of
    each mode.
    """
    bases: dict[int, ModalBasis] = {}
    whole = {case.basis_key for case in result.cases.values() if case.case.study.save_modal}

    def basis_of(one: ModalBasis) -> ModalBasis:
        return bases.setdefault(id(one), _by_itself(one))

    def case_of(name: str, one: CaseResult) -> CaseResult:
        if one.case.study.save_modal:
            return one
        if one.response is None:
            return _with(one, basis=basis_of(one.basis))
        rooms = [plan for plan in one.case.study.rooms if plan.room.bounded and plan.name in one.rooms]
        drawn = name == result.plan.baseline and rooms and result.models.get(one.basis_key) is not None
        motion = _halved(one.response.motion) if drawn else NotKept(MOTION)
        left: dict[str, Any] = {"pushes": NotKept(PUSHES), "motion": motion}
        response = _with(one.response, basis=basis_of(one.response.basis), **left)
        return _with(one, basis=basis_of(one.basis), response=response)

    return replace(
        result,
        bases={key: one if key in whole else basis_of(one) for key, one in result.bases.items()},
        cases={name: case_of(name, one) for name, one in result.cases.items()},
    )


def with_derived(result: StudyResult) -> StudyResult:
    """The results that a file has, with what was left out because the rest of a noun says it, to the last bit."""

    def case_of(one: CaseResult) -> CaseResult:
        if one.response is None or isinstance(one.response.motion, NotKept) or len(one.response.motion.turn) == 4:
            return one
        motion = one.response.motion
        return _with(one, response=_with(one.response, motion=motion._replace(turn=_whole_turn(motion))))

    return _with(result, cases={name: case_of(one) for name, one in result.cases.items()})


def _halved(motion: Any) -> Any:
    """A motion of oscillators without what makes rates of their states: displacements say it."""
    if not isinstance(motion, NotKept) and len(motion.turn) == 4 and motion.turn.size:
        half = motion._replace(turn=motion.turn[:2])
        if np.array_equal(_whole_turn(half), motion.turn):
            return half
    return motion


def _whole_turn(motion: Motion) -> Floats:
    places, tilts = motion.turn
    k = motion.turn.shape[2]
    w, c = motion.omega[:k], motion.damping[:k]
    whole = np.array([places, tilts, -tilts * w**2, places - tilts * c])
    whole.flags.writeable = False
    return whole


def _by_itself(basis: ModalBasis) -> ModalBasis:
    holders = {
        name: _with(one, inertia=_diagonal(one.inertia), stiffness=_diagonal(one.stiffness))
        for name, one in basis.holders.items()
    }
    return _with(basis, part_stiffness=_diagonals(basis.part_stiffness), holders=holders)


def _diagonals(matrices: Mapping[str, Floats]) -> dict[str, Floats]:
    return {name: _diagonal(one) for name, one in matrices.items()}


def _diagonal(matrix: Floats) -> Floats:
    found = np.full_like(matrix, np.nan)
    np.fill_diagonal(found, np.diag(matrix))
    return found


def _with(noun: T, **fields: Any) -> T:
    """The noun with other fields, whatever it is that stands in them."""
    made = copy(noun)
    for name, value in fields.items():
        object.__setattr__(made, name, value)
    return made
