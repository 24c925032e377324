"""What is asked of a machine on its foundation, by case: forces, travels, rest, energies, and verdicts on limits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from femstruct.reported import Reported
from femstruct.tags import stored_as


@stored_as("verdict/1")
@dataclass(frozen=True)
class Verdict:
    """A limit and what came of it, both in `unit`.

    value : None where there is none: a structure that is not at rest in time; `seen` is then for how long it was looked
    at [s]. met : None where that is too short to tell. at : the place whose drop is the worst, where a source strikes
    several; "" for one. least : whether the value is a lower bound, of a rating some of whose bands are blank.
    converged : False where the verdict rests on a peak that changes with the modes left out or with the mesh.
    statistical : whether bands of a rating are from statistical energies.
    """

    name: str
    value: Annotated[float | None, Reported("see unit", "What came out")]
    limit: Annotated[float, Reported("see unit", "What it should not exceed")]
    unit: Annotated[str, Reported("1", "Unit of value, limit and margin")]
    met: bool | None
    seen: float | None = None
    at: Annotated[str, Reported("1", "Place of the worst drop, where there are several")] = ""
    least: Annotated[bool, Reported("1", "Whether the value is a lower bound", "at_least")] = False
    converged: Annotated[bool, Reported("1", "Whether modes left out and the mesh change little of the value")] = True

    statistical: Annotated[bool, Reported("1", "Whether bands of the rating are statistical")] = False

    @property
    def verdict(self) -> Annotated[str, Reported("1", "met, exceeded, not seen, not known")]:
        """What it says in a word.

        >>> Verdict("ground force", 7.0, 6.0, "N", False).verdict
        'exceeded'
        """
        unknown = "not known" if self.least else "not seen"
        return unknown if self.met is None else "met" if self.met else "exceeded"

    @property
    def margin(self) -> Annotated[float | None, Reported("see unit", "What is left up to the limit, negative beyond")]:
        """What is left up to the limit, negative beyond it; None where that is not known."""
        return None if self.value is None or self.least else self.limit - self.value


@stored_as("sag under weight/1")
@dataclass(frozen=True)
class Sag:
    """How far a part has sunk under the weight of all [m]: its lowest node, of a block the centre of mass.

    tilt : angle a block leans by [rad], None for other parts.
    """

    part: str
    sag: float
    tilt: float | None


@stored_as("block mode/1")
@dataclass(frozen=True)
class BlockMode:
    """A mode in which mainly blocks move. number : from 1; shares : of its kinetic energy, by "BLOCK direction"."""

    number: int
    frequency_hz: float
    ratio: float
    shares: dict[str, float]


@stored_as("ground force/1")
@dataclass(frozen=True)
class GroundForce:
    """Vertical force on the ground [N]: the largest the motion adds, the largest with the weight of all that stands
    there (None without gravity, and of given modes, which do not say their mass), and the first beside the baseline's,
    in percent and as an attenuation [dB] (None for the baseline itself)."""

    dynamic: float
    with_weight: float | None
    percent: float | None
    attenuation_db: float | None


@stored_as("time to rest/1")
@dataclass(frozen=True)
class Rest:
    """Time from a blow to rest: the longest of all blows [s], None where one is not at rest before the next; and the
    shortest interval it was looked for in [s]."""

    after: float | None
    interval: float


@stored_as("companion of a machine/1")
@dataclass(frozen=True)
class Companion:
    """A body that does not strike: an impact damper, a tuned mass.

    travel : largest distance from where it was beside what it was placed at [m]. closings : of its contacts, in all;
    of one that lies or is clamped, how often its force rose above what it has at rest: it need not have left.
    seated : whether one of them carries a force at the end; None without contacts.
    """

    travel: float
    closings: int
    seated: bool | None


@stored_as("energy share/1")
@dataclass(frozen=True)
class EnergyShare:
    """Where the energy put in until t [s] is [J]; the five add up to `put_in` within the ledger's residual.

    forged : lost in the contacts of what strikes, and when they have just ended what their springs still hold.
    strikers : what those bodies keep, the springs of closed contacts included.
    structure : kinetic and elastic. companions : kinetic, stored and lost in the bodies that do not strike and what
    joins them. dissipated : lost in the structure's modes and dashpots.
    """

    t: float
    put_in: float
    forged: float
    strikers: float
    structure: float
    companions: float
    dissipated: float


@stored_as("machine/1")
@dataclass(frozen=True)
class Machine:
    """One case of a machine on its foundation.

    ground : None where the force on the ground is not recorded. travels : largest |displacement| of every recorded
    point [m]. sags, modes : at rest, and of its blocks; as `check` tells them. rest : None without blows.
    companions : by name. at_separation, at_end : where the energy is when the first contact has ended (None if it does
    not) and at the end. growth : by striking body, the structure's largest energy after its last blow over the first's.
    """

    ground: GroundForce | None
    travels: Mapping[str, float]
    sags: tuple[Sag, ...]
    modes: tuple[BlockMode, ...]
    rest: Rest | None
    companions: Mapping[str, Companion]
    at_separation: EnergyShare | None
    at_end: EnergyShare
    growth: Mapping[str, float | None]
