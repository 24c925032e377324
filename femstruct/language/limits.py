"""Limits as they are written: of recorded channels, each in its own dimension, of the time to rest, of ratings."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, Any, Final, NamedTuple

from acoustics.levels.standards import FIELD, RATING
from femstruct.declared import Refers
from femstruct.impact.fatigue import SNLine
from femstruct.language.rooms import RoomSpec
from femstruct.language.window import QUANTITIES, TimeSpec
from femstruct.quantities import Factor, Measured, Quantity, refuse
from femstruct.study.asked import SETTLED, FatigueRequest
from femstruct.study.recorded import GROUND_WITH_WEIGHT, WITH_WEIGHT
from femstruct.units import DIMENSIONS, QuantityError
from femstruct.yaml.reader import Here, nearest
from femstruct.yaml.spec import Spec, Text, read_by

RATED: Final = "rating"  # ROOM rating
_LINEAR: Final = {
    "displacement": "length", "travel": "length", "velocity": "speed", "acceleration": "acceleration", "force": "force",
    "stress": "pressure",
}  # fmt: skip
_TURNING: Final = {"displacement": "angle", "velocity": "angular speed"}
LIMITED: Final = ("length", "speed", "acceleration", "force", "time", "angle", "angular speed", "level", "pressure")


class _Named(NamedTuple):
    """A limit as it is written, and what it is of."""

    name: str
    value: object


class _LimitQuantity(Quantity):
    """What is no quantity that can be limited is answered with the one that its name has."""

    def read(self, value: object) -> Any:
        name, given = value if isinstance(value, _Named) else ("", value)
        try:
            return super().read(given)
        except QuantityError:
            dimension = _dimension(name)
            if dimension not in LIMITED:
                raise
            return Quantity((dimension,), above=0.0, which=True).read(given)


def _with_names(value: object) -> object:
    return {name: _Named(name, one) for name, one in value.items()} if isinstance(value, dict) else value


LimitValue = Annotated[Measured, _LimitQuantity(LIMITED, above=0.0, which=True)]
Limits = Annotated[dict[str, LimitValue], read_by(_with_names, dict[str, LimitValue])]


def check_limits(
    here: Here,
    limits: Mapping[str, Measured],
    records: Mapping[str, Collection[str]],
    rooms: Mapping[str, RoomSpec],
    gravity: bool,
) -> None:
    """Every limit is of something that is recorded or rated, or of the time to rest, and in its dimension."""
    recorded = [f"{target} {what}" for target, wanted in records.items() for what in wanted]
    weighed = [GROUND_WITH_WEIGHT] if "ground force" in recorded else []
    rated = [f"{name} {RATED}" for name, room in rooms.items() if room.receivers and set(room.standards) - {FIELD}]
    for name, limit in limits.items():
        there, room = here.at("limits", name), limited_room(name)
        if room in rooms and name not in rated:
            deaf = not rooms[room].receivers
            got = f"a limit of the rating of '{room}', which {'has no receivers' if deaf else 'is not rated'}"
            add = "receivers: {..}" if deaf else f"levels: [{FIELD}, {RATING}]"
            there.wrong(got, "a rated room", f"add '{add}' under 'rooms.{room}'", of_key=True)
        elif name.endswith(WITH_WEIGHT) and not (gravity and name == GROUND_WITH_WEIGHT in weighed):
            got, expected = f"'{name}'", "'ground force with weight' of a study that records it under gravity"
            there.wrong(got, expected, _weighing(name, gravity), of_key=True)
        elif name not in (SETTLED, *weighed, *recorded, *rated):
            expected = f"a recorded channel, TARGET QUANTITY, a rated room, ROOM {RATED}, or {SETTLED}"
            there.wrong(f"'{name}'", expected, _what_to_do(name, recorded, rated), of_key=True)
        elif limit.dimension is not None:
            wanted = _dimension(name)
            named, do = DIMENSIONS.get(wanted), ""
            expected = "a plain number, in rad/s^2"
            if named is not None:
                expected, do = f"{named.words} [{named.unit}]", f"write it like {named.example}"
            there.need(limit.dimension == wanted, DIMENSIONS[limit.dimension].words, expected, do)


def _weighing(name: str, gravity: bool) -> str:
    """What to do for a limit of a force with weight."""
    if name != GROUND_WITH_WEIGHT:
        return "of supports and springs alone 'femstruct statics' has it, without a blow"
    return "add 'ground: force' under 'record:'" if gravity else "add 'gravity: true' under 'time:'"


def limited_room(name: str) -> str:
    """The room whose rating a limit is of, "" for other limits.

    >>> limited_room("bedroom rating"), limited_room("die.z displacement")
    ('bedroom', '')
    """
    target, _, what = name.rpartition(" ")
    return target if what == RATED else ""


def _dimension(name: str) -> str:
    """The dimension of a limit by what it is of, "" where that is nothing that can be limited."""
    if name == SETTLED:
        return "time"
    return "level" if limited_room(name) else dimension_of(name) if _what(name) in _LINEAR else ""


def _what(name: str) -> str:
    return name.removesuffix(WITH_WEIGHT).rpartition(" ")[2]


def dimension_of(name: str) -> str:
    """The dimension of a channel.

    >>> dimension_of("die.z displacement"), dimension_of("die.rx velocity"), dimension_of("ground force")
    ('length', 'angular speed', 'force')
    """
    target, _, what = name.removesuffix(WITH_WEIGHT).rpartition(" ")
    turning = target.rpartition(".")[2] in ("rx", "ry", "rz")
    return _TURNING.get(what, "angular acceleration") if turning else _LINEAR[what]


def _what_to_do(name: str, recorded: list[str], rated: list[str]) -> str:
    target, _, what = name.rpartition(" ")
    add = f"add '{target}: {what}' under 'record:'" if target and what in QUANTITIES else ""
    near = nearest(name, [*recorded, *rated, SETTLED])
    return f"{near} or {add}" if add and near.startswith("did") else add or near


# ----------------------------------------------------------------------------------------------------------------------
# fatigue: cycles of recorded histories, and the damage they do.
# ----------------------------------------------------------------------------------------------------------------------

OF_CATEGORIES: Final = 3.0  # slope m of EN 1993-1-9 up to five million cycles


_RANGE: Final = Quantity(("pressure", "force", "length", "speed", "acceleration"), above=0.0, which=True)
_CATEGORY: Final = Quantity(("pressure",), above=0.0, least=1e6, too_small="a plain number is in Pa")


class SNSpec(Spec):
    """An S-N line: a range that is endured 'at' so many cycles, and its slope m, positive; or a detail category of EN
    1993-1-9 for direct stress, such as 71 MPa, with its slopes of 3 and 5 and its cut-off. Without partial factors."""

    makes = SNLine
    one_of = (("range", "category"),)
    range: Annotated[Measured, _RANGE] | None = None
    category: Annotated[float, _CATEGORY] | None = None
    at: Factor = 2e6
    slope: Factor | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        if "category" in given and given.keys() & {"at", "slope"}:
            raise refuse(
                "a slope or cycles beside a category", "a category alone", "write 'range' for a line of your own"
            )
        if "range" in given and "category" not in given and given.get("slope") is None:
            do = "add 'slope: 3', as of welds, or 'slope: 5' and more, as of machined parts"
            raise refuse("a range without its slope", "'slope' beside 'range'", do)

    def given(self) -> dict[str, Any]:
        value = self.category if self.range is None else self.range.value
        category = self.category is not None
        return {"range": value, "at": self.at, "slope": self.slope or OF_CATEGORIES, "category": category}


class FatigueSpec(Spec):
    """Rainflow cycles of a recorded channel, of: TARGET QUANTITY, and the damage they do. Of a stress it is the normal
    stress on the worst plane at the place with the most damage. Of the history in time or, under: NAME, on the average
    in the duration of a random excitation of 'vibration', at the place with the most damage, too."""

    makes = FatigueRequest
    of: Annotated[Text, Refers()]
    sn: SNSpec | None = None
    under: Annotated[Text, Refers()] | None = None

    def given(self) -> dict[str, Any]:
        return {**super().given(), "under": self.under or ""}

    def check_in(
        self,
        here: Here,
        records: Mapping[str, Collection[str]],
        time: TimeSpec | None,
        random: Collection[str],
    ) -> None:
        """Note what is wrong with its channel and its S-N line.

        Parameters
        ----------
        random : Collection[str]
            Excitations that have a psd and a duration.
        """
        known = [f"{target} {what}" for target, quantities in records.items() for what in quantities]
        expected = "a recorded channel, such as 'brace force' of 'record: {brace: force}'"
        do = "add 'time: {duration: 1 s, sampling: 48 kHz}'"
        if self.under is None:
            here.need(time is not None, "no time", "a history to count", f"{do} or 'under: EXCITATION'")
        else:
            expected_of = "an excitation of 'vibration' with 'psd' and 'duration'"
            here.at("under").need(self.under in random, f"'{self.under}'", expected_of, nearest(self.under, random))
        if not here.at("of").need(self.of in known, f"'{self.of}'", expected, nearest(self.of, known)):
            return
        if self.sn is None:
            return
        got = "pressure" if self.sn.range is None else self.sn.range.dimension
        quantities = dimension_of(self.of)
        words = DIMENSIONS[quantities].words if quantities in DIMENSIONS else "a plain number"
        there = here.at("sn")
        there.need(got in (None, quantities), DIMENSIONS[got or "ratio"].words, f"{words}, as '{self.of}' is")
