"""The limits of a study: recorded channels, each in its own dimension, the time to rest, rooms' ratings."""

from __future__ import annotations

from typing import Final

from acoustics.levels.methods import FIELD, RATING
from femstruct.language.schema_study import QUANTITIES, StudySpec
from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Steps, nearest
from femstruct.units import DIMENSIONS

SETTLED: Final = "settled"
RATED: Final = "rating"  # ROOM rating
_LINEAR: Final = {
    "displacement": "length", "travel": "length", "velocity": "speed", "acceleration": "acceleration", "force": "force",
}  # fmt: skip
_TURNING: Final = {"displacement": "angle", "velocity": "angular speed"}


def check_limits(check: Checker, study: StudySpec) -> None:
    """Every limit is of something that is recorded or rated, or of the time to rest, and in its dimension."""
    recorded = [f"{target} {what}" for target, wanted in study.record.items() for what in wanted]
    rated = [f"{name} {RATED}" for name, room in study.rooms.items() if room.receivers and set(room.levels) - {FIELD}]
    for name, limit in study.limits.items():
        here: Steps = ("limits", name)
        room = limited_room(name)
        if room in study.rooms and name not in rated:
            deaf = not study.rooms[room].receivers
            got = f"a limit of the rating of '{room}', which {'has no receivers' if deaf else 'is not rated'}"
            add = "receivers: {..}" if deaf else f"levels: [{FIELD}, {RATING}]"
            check.wrong(here, got, "a rated room", f"add '{add}' under 'rooms.{room}'", of_key=True)
            continue
        if name != SETTLED and name not in recorded and name not in rated:
            expected = f"a recorded channel, TARGET QUANTITY, a rated room, ROOM {RATED}, or {SETTLED}"
            check.wrong(here, f"'{name}'", expected, _what_to_do(name, recorded, rated), of_key=True)
            continue
        wanted = "time" if name == SETTLED else "level" if room else _dimension(name)
        if limit.dimension is not None and limit.dimension != wanted:
            got = DIMENSIONS[limit.dimension].words
            named = DIMENSIONS.get(wanted)
            if named is None:
                check.wrong(here, got, "a plain number, in rad/s^2")
            else:
                check.wrong(here, got, f"{named.words} [{named.unit}]", f"write it like {named.example}")


def limited_room(name: str) -> str:
    """The room whose rating a limit is of, "" for other limits.

    >>> limited_room("bedroom rating"), limited_room("die.z displacement")
    ('bedroom', '')
    """
    target, _, what = name.rpartition(" ")
    return target if what == RATED else ""


def _dimension(name: str) -> str:
    """The dimension of a channel.

    >>> _dimension("die.z displacement"), _dimension("die.rx velocity"), _dimension("ground force")
    ('length', 'angular speed', 'force')
    """
    target, _, what = name.rpartition(" ")
    turning = target.rpartition(".")[2] in ("rx", "ry", "rz")
    return _TURNING.get(what, "angular acceleration") if turning else _LINEAR[what]


def _what_to_do(name: str, recorded: list[str], rated: list[str]) -> str:
    target, _, what = name.rpartition(" ")
    add = f"add '{target}: {what}' under 'record:'" if target and what in QUANTITIES else ""
    near = nearest(name, [*recorded, *rated, SETTLED])
    return f"{near} or {add}" if add and near.startswith("did") else add or near
