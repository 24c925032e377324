"""Which numbers of a scene follow what a campaign varies: read from a few of its samples, foreseen for all others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.campaign.samples import Samples
from femstruct.impact.batch.vary import numbers_of_scene, variation
from femstruct.impact.scene.bodies import Scene
from femstruct.study.study import Study
from femstruct.workflow.stages.fingerprint import fingerprint

ROUNDING: Final = 1e-13  # of the largest value: some multiplications, and texts of 17 digits
TABLED: Final = 12  # values of a path, all of which are read if there are no more
LOOKS: Final = 5  # values of a path that are read where there are more; whole samples that are compared
READ: Final = 50  # samples after which it is told how many were read
IN_SCENE: Final = frozenset({"bodies", "contacts", "links", "loads"})  # of a study: what its scene is made of

Staged = Callable[[Sequence[str]], Mapping[str, tuple[Study, Scene]]]
Numbers = Mapping[str, Mapping[str, float]]  # of scenes, by case
Columns = Mapping[str, Mapping[str, Floats]]  # of scenes, by case: the numbers of all samples


@dataclass(frozen=True, eq=False)
class SceneColumns:
    """The scene of the first sample by case, and the numbers of it that differ between n samples, by name [n]."""

    scenes: Mapping[str, Scene]
    columns: Columns


def scene_columns(
    samples: Samples, staged: Staged, told: Callable[[str], None] = lambda line: None
) -> SceneColumns | None:
    """What all samples change, where that is nothing but numbers of scenes; None where it is more.

    staged : study and scene of every case for texts ``PATH=VALUE``. told : is given a line while all are read.

    Raises InputErrors for a sample that cannot be read, FemstructError for numbers that a body, contact or link
    refuses, TypeError for a law with functions of its own.

    Notes
    -----
    The effect of a path on a number of a scene is read at each of its values up to 12 of them; else it is a straight
    line through those at its least and largest value, on which three others have to lie. A number is that of the first
    sample and the sum of all effects; five whole samples are read and compared. All to rounding. Where that cannot be,
    as of the speed after a height of fall, or of a spring that follows a mass and a frequency, each sample is read.
    """
    first = staged(samples.changes(0))
    start = {case: numbers_of_scene(scene) for case, (_, scene) in first.items()}
    columns = _foreseen_columns(samples, staged, first, start)
    if columns is None:
        columns = _read_columns(samples, staged, first, told)
    if columns is None:
        return None
    for case, (_, scene) in first.items():
        if columns[case]:
            variation(scene, columns[case])
    return SceneColumns({case: scene for case, (_, scene) in first.items()}, columns)


def _foreseen_columns(
    samples: Samples, staged: Staged, first: Mapping[str, tuple[Study, Scene]], start: Numbers
) -> Columns | None:
    """The numbers of scenes that differ, from a few samples; None where they cannot be foreseen."""
    n = len(samples.texts)
    columns: dict[str, dict[str, Floats]] = {case: {} for case in first}
    for j in range(len(samples.paths)):
        looked, spread = _looks([one[j] for one in samples.texts], samples.numbers[:, j])
        changed = [[*samples.changes(0)[:j], samples.changes(i)[j], *samples.changes(0)[j + 1 :]] for i in looked]
        effects = [one for texts in changed if (one := _alike(first, staged(texts))) is not None]
        if len(effects) < len(looked):
            return None
        for case, name, value in [(case, name, value) for case, own in start.items() for name, value in own.items()]:
            values = np.array([one[case][name] for one in effects])
            if (values == value).all():
                continue
            followed = spread(values)
            if followed is None:
                return None
            before = columns[case].get(name)
            columns[case][name] = followed if before is None else before + (followed - value)
    for i in np.unique(np.linspace(0, n - 1, LOOKS + 1).astype(int))[1:].tolist():
        whole = _alike(first, staged(samples.changes(i)))
        if whole is None or not _foreseen(whole, start, columns, i):
            return None
    return columns


def _read_columns(
    samples: Samples, staged: Staged, first: Mapping[str, tuple[Study, Scene]], told: Callable[[str], None]
) -> Columns | None:
    """The numbers of scenes that differ, from every sample; None where more than numbers differs."""
    n, read = len(samples.texts), []
    for i in range(n):
        if i % READ == 0:
            told(f"reading sample {i + 1} of {n}")
        one = _alike(first, staged(samples.changes(i)))
        if one is None:
            return None
        read.append(one)
    columns = {}
    for case, own in read[0].items():
        values = {name: np.array([one[case][name] for one in read]) for name in own}
        columns[case] = {name: one for name, one in values.items() if (one != one[0]).any()}
    return columns


def _looks(texts: Sequence[str], numbers: Floats) -> tuple[list[int], Callable[[Floats], Floats | None]]:
    """Samples at which the effect of a path is read, and what all samples have by what was read there; that is None
    where it is no straight line."""
    known, at = np.unique(np.array(texts, dtype=object).astype(str), return_inverse=True)
    if len(known) <= TABLED:
        return [texts.index(one) for one in known.tolist()], lambda values: values[at]
    order = np.argsort(numbers, kind="stable")
    looked = order[np.linspace(0, len(order) - 1, LOOKS).astype(int)]
    x = (numbers - numbers[looked[0]]) / (numbers[looked[-1]] - numbers[looked[0]])

    def line(values: Floats) -> Floats | None:
        found: Floats = values[0] + (values[-1] - values[0]) * x
        straight = np.abs(found[looked] - values).max() <= ROUNDING * np.abs(values).max()
        return found if straight else None

    return looked.tolist(), line


def _alike(
    first: Mapping[str, tuple[Study, Scene]], other: Mapping[str, tuple[Study, Scene]]
) -> dict[str, dict[str, float]] | None:
    """The numbers of other scenes by case and name; None where more than numbers differs."""
    if first.keys() != other.keys():
        return None
    found = {}
    for case, (study, scene) in other.items():
        told = numbers_of_scene(scene)
        base_study, base = first[case]
        if told.keys() != numbers_of_scene(base).keys() or _beside(study) != _beside(base_study):
            return None
        moved = variation(base, {name: [value] for name, value in told.items()})(0) if told else base
        if fingerprint(moved) != fingerprint(scene):
            return None
        found[case] = told
    return found


def _beside(study: Study) -> str:
    """A name for all of a study that is not in its scene."""
    return fingerprint([getattr(study, one.name) for one in fields(study) if one.name not in IN_SCENE])


def _foreseen(whole: Numbers, start: Numbers, columns: Columns, i: int) -> bool:
    """Whether the columns have the numbers of sample i."""
    for case, own in whole.items():
        for name, value in own.items():
            column = columns[case].get(name)
            told, size = (start[case][name], 0.0) if column is None else (column[i], np.abs(column).max())
            if abs(told - value) > ROUNDING * size:
                return False
    return True
