"""How many modes, how long, how densely, how exactly, and which peaks: what a study asks of its simulation."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, Any, Final, Literal, get_args

from femstruct.errors import quote_value
from femstruct.language.not_computed import BASE_IN_TIME, instead_of
from femstruct.language.parts import STRESSED
from femstruct.quantities import FREQUENCY, Band, Duration, Frequency, Quantity, refuse
from femstruct.study.asked import AccuracyRule, Extent, PeakRule, RecordedQuantity, TimePlan
from femstruct.yaml.reader import Here, nearest
from femstruct.yaml.spec import Count, Flag, Spec, read_by, word_or, words_of

MOST_SAMPLES: Final = 20_000_000
FEWEST_SAMPLES: Final = 5
LONGEST_PLAIN: Final = 300.0  # s: impacts and steps last seconds, and 300 ms and more is written as 300
UNTIL_NEXT: Final = "until next contact"


class ModesSpec(Spec):
    """How many modes: all up to a frequency, or the lowest ones."""

    one_of = (("up_to", "count"),)

    makes = Extent
    short = "up_to"
    called = (("up_to", "up_to_hz"),)
    up_to: Frequency | None = None
    count: Count | None = None

    @classmethod
    def meant_by(cls, value: object) -> str:
        counted = isinstance(value, int) and not isinstance(value, bool)
        return f"{{count: {value}}} or {{up_to: {value} Hz}}" if counted else super().meant_by(value)


class _Window(Quantity):
    """A window: of so many seconds as nobody waits for by hand, the unit is written."""

    def read(self, value: object) -> Any:
        seconds = super().read(value)
        if isinstance(value, int | float) and seconds > LONGEST_PLAIN:
            do = f"a plain number is in seconds: did you mean {seconds:g} ms? Else write {seconds:g} s"
            raise refuse(quote_value(value), f"a unit with a window of more than {LONGEST_PLAIN:g} s", do)
        return seconds


class TimeSpec(Spec):
    """The window, how densely it is sampled, and whether there is gravity."""

    makes = TimePlan
    instead = instead_of(BASE_IN_TIME, "base", "base_motion", "ground_motion", "acceleration")
    duration: Annotated[float, _Window(("time",), above=0.0)]
    sampling: Frequency
    gravity: Flag = False

    def check(self, here: Here) -> None:
        count = self.duration * self.sampling
        most, fewest = f"at most {MOST_SAMPLES:.0e}", f"at least {FEWEST_SAMPLES}"
        got = f"{count:.3g} samples"
        here.need(count <= MOST_SAMPLES, got, most, "shorten the duration or lower the sampling")
        here.need(count >= FEWEST_SAMPLES, got, fewest, "lengthen the duration or raise the sampling")

    def carries(self, here: Here, hertz: float) -> bool:
        """Whether the sampling has a frequency; notes where it has not."""
        half = self.sampling / 2
        expected = f"less than half the sampling, {half:g} Hz"
        return here.need(hertz < half, f"{hertz:g} Hz", expected, "sample faster")


_IMPACT: Final = word_or({UNTIL_NEXT: None}, Quantity(("time",), above=0.0))


class PeaksSpec(Spec):
    """Which peaks are reported, and the low-pass filter before them (not of contact forces, whose peaks are exact)."""

    makes = PeakRule
    called = (("lowpass", "lowpass_hz"),)
    first_impact: Annotated[float | None, read_by(_IMPACT, Literal["until next contact"] | Duration)] = 20e-3
    lowpass: Annotated[float | None, read_by(word_or({"none": None}, FREQUENCY), Literal["none"] | Frequency)] = None


class AccuracySpec(Spec):
    """Add modes until what is recorded in a band changes by no more than a share in the first impact."""

    makes = AccuracyRule
    short = "within"
    called = (("up_to", "up_to_hz"),)
    within: Annotated[float, Quantity(("ratio",), above=0.0, below=1.0)]
    band: Band
    up_to: Frequency | None = None

    def check_in(self, here: Here, time: TimeSpec | None, structure: str | None, first: float | None) -> None:
        """It needs a simulation, a band below half the sampling, and modes to add.

        Parameters
        ----------
        structure : str | None
            The type of a structure in closed form.
        first : float | None
            Up to where the study asks for modes [Hz].
        """
        low, high = self.band
        there = here.at("band")
        there.need(low < high, f"{low:g} to {high:g} Hz", "a rising band [low, high]")
        if (
            here.need(
                time is not None,
                "no time",
                "an impact to be accurate about",
                "add 'time: {duration: 1 s, sampling: 48 kHz}'",
            )
            and time is not None
        ):
            time.carries(there, high)
        here.need(
            structure not in ("none", "modes"),
            "a structure of given modes" if structure == "modes" else "no structure",
            "a structure that has more modes to add",
            "remove 'accuracy'",
        )
        if self.up_to is not None and first is not None and structure is None:
            here.at("up_to").need(self.up_to >= first, f"{self.up_to:g} Hz", f"at least modes.up_to, {first:g} Hz")


# ----------------------------------------------------------------------------------------------------------------------
# Records as they are written: which histories are kept, by what they are of.
# ----------------------------------------------------------------------------------------------------------------------

QUANTITIES: tuple[str, ...] = get_args(RecordedQuantity)
Recorded = Annotated[tuple[RecordedQuantity, ...], words_of(QUANTITIES)]


def check_records(
    here: Here, records: Mapping[str, Collection[str]], bodies: Collection[str], forced: Collection[str]
) -> None:
    """Note what cannot be recorded.

    Parameters
    ----------
    bodies : Collection[str]
        Their names.
    forced : Collection[str]
        Names of all that has a force.
    """
    for target, what in ((target, what) for target, quantities in records.items() for what in quantities):
        there, got = here.at("record", target), f"'{target}'"
        if what == "stress":
            stressed = here.names.known.get(STRESSED, ())
            expected = f"the name of a {STRESSED}"
            there.need(target in stressed, f"'stress' of {got}", expected, nearest(target, stressed), of_key=True)
        elif target in bodies:
            there.need(
                what in ("displacement", "velocity", "acceleration", "travel"),
                f"'{what}' of a body",
                "displacement, velocity, acceleration or travel",
            )
        elif target in forced:
            there.need(what == "force", f"'{what}' of {got}", "force")
        elif what == "travel":
            there.wrong(got, "the name of a body", nearest(target, bodies), of_key=True)
        elif what == "force":
            there.wrong(
                got, "the name of a contact, link, part, joint, support or ground", nearest(target, forced), of_key=True
            )
        elif "." in target:
            there.spot(target, of_key=True)
        else:
            there.wrong(
                got,
                "a direction of a point, or a body",
                nearest(target, [*bodies, *(f"{place}.z" for place in here.names.places)]),
                of_key=True,
            )
