"""StudyResult: what every stage of a study computed, and the comparison of its cases."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Final

import numpy as np
from numpy import complex128
from numpy.typing import NDArray

from acoustics.levels.rated import RatedRoom
from acoustics.levels.sound_levels import Levels
from acoustics.room_response import RoomResponse
from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.fatigue import Fatigue
from femstruct.impact.numerical_error import ErrorEstimate
from femstruct.impact.response import Response
from femstruct.impact.shares import ModeEnergies
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady import Highest, Vibrated
from femstruct.model.model import Model
from femstruct.reported import OWN_UNIT, Held, Reported
from femstruct.sound.flanking import SurfaceShares
from femstruct.sound.radiated_power import PowerResponse, Radiated
from femstruct.study.acting import InstalledSource
from femstruct.study.asked import FrfRequest, Machine, Verdict
from femstruct.study.recorded import Channel
from femstruct.study.study import Case, Plan
from femstruct.tags import stored_as

_LEVELS: Final = "Levels at the receivers, ROOM.RECEIVER"
_TOTAL_LEVELS: Final = "Levels of structure and striking bodies together, ROOM.RECEIVER"
_LEVEL: Final = "Levels at one receiver"


@stored_as("frequency response/1")
@dataclass(frozen=True, eq=False)
class Frf:
    """A frequency response: frequency [nf] [Hz], complex values [nf], unit. sound : of a sound power, whose values are
    real. highest : its largest value, also between the lines; None where only they are known."""

    request: FrfRequest
    frequency_hz: Floats
    values: NDArray[complex128]
    unit: str
    sound: PowerResponse | None = None
    highest: Highest | None = None

    @property
    def peak(self) -> float:
        """The largest magnitude [unit], between its lines too; nan without lines.

        Notes
        -----
        Where only the lines are known: near a resonance the inverse square of a magnitude (of a power, the inverse) is
        a parabola along frequency, which three lines give. Where the lines are so far apart that it would rise to more
        than double, the largest of them is taken as it is.
        """
        if self.highest is not None:
            return self.highest.size
        power = 1.0 if self.sound is not None else 2.0
        size = np.abs(self.values)
        at = int(size.argmax()) if len(size) else -1
        if not 0 < at < len(size) - 1:
            return float(size[at]) if len(size) else float("nan")
        before, own, after = size[at - 1 : at + 2] ** -power
        bend = before - 2.0 * own + after
        lowest = own - (before - after) ** 2 / (8.0 * bend) if bend > 0.0 else own
        return float(lowest ** (-1.0 / power)) if lowest > own * 2.0**-power else float(size[at])


@stored_as("deviation by more modes/1")
@dataclass(frozen=True)
class Deviation:
    """A channel in the band, or a contact's peak force, with a smaller and a larger basis: largest |values|, largest
    difference at any time, all in `unit`, and the difference as a share of the larger basis's value [1]."""

    unit: Annotated[str, Reported("1", "Unit of smaller, larger and difference")]
    smaller: Annotated[float, Reported(OWN_UNIT, "Largest |value| with the smaller basis")]
    larger: Annotated[float, Reported(OWN_UNIT, "Largest |value| with the larger basis")]
    difference: Annotated[float, Reported(OWN_UNIT, "Largest difference at any time")]
    share: Annotated[float, Reported("1", "Difference over the value of the larger basis")]


@stored_as("accuracy check/1")
@dataclass(frozen=True)
class AccuracyCheck:
    """What more modes change in the first impact of a case, against what was asked.

    within : the share asked for [1]. band [Hz]. window : end of what was compared [s]. smaller_hz, larger_hz : what the
    two bases compared are complete to. used_hz, used_modes : the basis all cases of the structure use in the end.
    deviations : by channel ("O_f.z acceleration") and contact ("ball on floor peak force"); empty where a basis holds
    every mode there is. stopped : why no modes were added although it does not hold.
    """

    within: Annotated[float, Reported("1", "Share required", "asked")]
    band: Annotated[tuple[float, float], Reported("Hz", "Band that is compared", "band_hz")]
    window: Annotated[float, Reported("s", "End of what is compared", "window_s")]
    smaller_hz: Annotated[float, Reported("Hz", "What the smaller basis is complete to")]
    larger_hz: Annotated[float, Reported("Hz", "What the larger basis is complete to")]
    used_hz: Annotated[float, Reported("Hz", "What the basis is complete to that all cases use")]
    used_modes: Annotated[int, Reported("1", "Modes of that basis")]
    deviations: Annotated[
        Mapping[str, Deviation],
        Held("What more modes change", key="largest", rows=("channel", "1", "Channel, or contact peak force")),
    ]
    holds: Annotated[bool, Reported("1", "Whether it is reached")]
    stopped: str

    @property
    def worst(self) -> tuple[str, Deviation] | None:
        """What differs most."""
        return max(self.deviations.items(), key=lambda item: item[1].share, default=None)

    @property
    def share(self) -> Annotated[float, Reported("1", "Largest share that more modes change", "reached")]:
        """The largest share [1]."""
        return self.worst[1].share if self.worst else 0.0


@stored_as("own sound/1")
@dataclass(frozen=True, eq=False)
class OwnSound:
    """The own sound of striking bodies, in the open air of some rooms.

    own : the pressures they make, by "ROOM"; total : with what the structure radiates, by "ROOM". own_levels,
    total_levels : by "ROOM.RECEIVER".
    """

    own: Mapping[str, RoomResponse]
    total: Mapping[str, RoomResponse]
    own_levels: Mapping[str, Levels]
    total_levels: Mapping[str, Levels]


NO_OWN_SOUND: Final = OwnSound({}, {}, {}, {})


@stored_as("drop/1")
@dataclass(frozen=True, eq=False)
class Drop:
    """What is kept of one blow of a source that strikes several places: how it ended (a sentence), peak forces of the
    contacts [N] by name, levels by "ROOM.RECEIVER", total_levels where the source has own sound, and what came of the
    limits on channels and the time to rest."""

    outcome: Annotated[str, Reported("1", "How it ended")]
    peak_force: Annotated[
        Mapping[str, float], Reported("N", "Peak force", key="peak_force_n", axis=("contact", "1", "Name"))
    ]
    levels: Annotated[Mapping[str, Levels], Held(_LEVELS, _LEVEL)]
    total_levels: Annotated[Mapping[str, Levels], Held(_TOTAL_LEVELS, _LEVEL)] = field(default_factory=dict)
    verdicts: tuple[Verdict, ...] = ()


@stored_as("results of a case/1")
@dataclass(frozen=True, eq=False)
class CaseResult:
    """One case, every stage. `basis_key` names its basis in StudyResult.bases.

    response is None when nothing was simulated. channels by name ("O_s.z velocity", "box.mic pressure").
    rooms and levels by "ROOM" and "ROOM.RECEIVER", of what the structure radiates; heard : of striking bodies
    themselves, and in total. rated : rooms rated by standards, radiated : sound energies of half spaces, by "ROOM".
    accuracy : None where the study asks for none.
    shares : the structure's energy by modes; errors : what the integration leaves wrong in forces and end velocities;
    both None when nothing was simulated. drops : by place ("drops.2"), where a source strikes several: response,
    channels, rooms, levels, shares and errors are those of the first, rated is of all. Empty for one place.
    by_surface : of rooms that several surfaces move, what each gives the air, by "ROOM". evaluations : of recorded
    histories, by kind and name ("shock_spectra", "foot"). vibration : what came of harmonic and random excitations,
    fatigue : rainflow cycles and their damage, sources : what measured sources do in place, by name.
    """

    case: Case
    basis_key: str
    basis: ModalBasis
    response: Response | None
    frf: Mapping[str, Frf]
    channels: Mapping[str, Channel]
    rooms: Mapping[str, RoomResponse]
    levels: Annotated[Mapping[str, Levels], Held(_LEVELS, _LEVEL)]
    findings: tuple[Finding, ...]
    accuracy: Annotated[AccuracyCheck | None, Held("What more modes change, against what was asked")] = None
    shares: ModeEnergies | None = None
    rated: Mapping[str, RatedRoom] = field(default_factory=dict)
    drops: Annotated[
        Mapping[str, Drop], Held("Every place that the source struck; all above is of the first", "One place")
    ] = field(default_factory=dict)
    errors: ErrorEstimate | None = None
    radiated: Mapping[str, Radiated] = field(default_factory=dict)
    heard: OwnSound = NO_OWN_SOUND
    vibration: Annotated[
        Mapping[str, Vibrated], Held("Harmonic and random excitations, each by itself", "One excitation")
    ] = field(default_factory=dict)
    fatigue: Annotated[
        Mapping[str, Fatigue], Held("Rainflow cycles of recorded channels", "Rainflow cycles, ASTM E1049-85")
    ] = field(default_factory=dict)
    sources: Annotated[Mapping[str, InstalledSource], Held("Measured sources in place", "One measured source")] = field(
        default_factory=dict
    )
    by_surface: Mapping[str, SurfaceShares] = field(default_factory=dict)
    evaluations: Annotated[Mapping[str, Mapping[str, Any]], Held("Evaluations of recorded histories", kinds=True)] = (
        field(default_factory=dict)
    )

    @property
    def own_levels(
        self,
    ) -> Annotated[Mapping[str, Levels], Held("Levels of the striking bodies themselves, ROOM.RECEIVER", _LEVEL)]:
        """Levels of the striking bodies themselves, by "ROOM.RECEIVER"."""
        return self.heard.own_levels

    @property
    def total_levels(self) -> Annotated[Mapping[str, Levels], Held(_TOTAL_LEVELS, _LEVEL)]:
        """Levels of structure and striking bodies together, by "ROOM.RECEIVER"."""
        return self.heard.total_levels


@stored_as("peak change/1")
@dataclass(frozen=True)
class PeakChange:
    """Change of a peak against the baseline [%], negative for a reduction; None where the baseline's peak is zero.

    converged : False where the modes alone, without residual vectors, change by another share.
    """

    first_impact_percent: float | None
    whole_percent: float | None
    converged: bool = True


@stored_as("comparison of a case/1")
@dataclass(frozen=True)
class CaseComparison:
    """One case beside the baseline.

    peaks : by channel. bands_db : by receiver ("box.mic"), {band centre [Hz]: attenuation [dB]}, positive = quieter.
    modes_db : by channel, {mode number: attenuation [dB] of the spectrum at the baseline's peak within 2 % of the
    mode's frequency}. frequencies : mode table by MAC, {baseline mode: (own mode, own frequency [Hz], MAC)}.
    notes : sentences on what of the two is not compared, or over which part of them.
    """

    peaks: Mapping[str, PeakChange]
    bands_db: Mapping[str, Mapping[float, float]]
    modes_db: Mapping[str, Mapping[int, float]]
    frequencies: Mapping[int, tuple[int, float, float]]
    notes: tuple[str, ...] = ()


@stored_as("comparison of cases/1")
@dataclass(frozen=True)
class Comparison:
    """All cases against the baseline; `filter` says what every peak went through.

    inputs : of finished runs side by side, what differs in their input files and in their `--set`, a line each.
    """

    baseline: str
    cases: Mapping[str, CaseComparison]
    filter: str
    inputs: tuple[str, ...] = ()


@stored_as("results of a study/1")
@dataclass(frozen=True, eq=False)
class StudyResult:
    """A study, run: bases and meshed models by key, results by case, the comparison, and where they come from.

    models holds None for closed-form structures. findings : of the run as a whole. timings : CPU seconds by stage.
    provenance : versions, platform, date, command line. verdicts : by case, on the limits of the study. machine : by
    case, where the study is about one (see `femstruct.workflow.case_comparison`), else empty.

    A ball falls on the ground. ``cases`` has what was found, by the names of the cases; a history is beside its times:

    >>> import femstruct as fs
    >>> ball = fs.PlacedBody("ball", 0.1, "above", "ground", speed=2.0, law=fs.Linear(1e5))
    >>> window, force = fs.TimePlan(duration=5e-3, sampling=50e3), fs.Record("ball on ground", "force")
    >>> study = fs.Study(
    ...     "a fall", fs.NoStructure(), fs.Damping(), fs.Extent(), bodies=(ball,), records=(force,), time=window
    ... )
    >>> found = fs.run_study(fs.Plan("a fall", (fs.Case("as given", study),), baseline="as given"))
    >>> case = found.cases["as given"]
    >>> channel, t = case.channels["ball on ground force"], case.response.t
    >>> round(channel.whole), channel.unit, round(1e3 * float(t[channel.values.argmax()]), 2)  # v sqrt(k m), at [ms]
    (200, 'N', 1.58)
    >>> [finding.code for finding in (*found.findings, *case.findings)]
    []
    """

    plan: Plan
    bases: Mapping[str, ModalBasis]
    models: Mapping[str, Model | None]
    cases: Mapping[str, CaseResult]
    comparison: Comparison
    findings: tuple[Finding, ...]
    timings: Mapping[str, float]
    provenance: Mapping[str, str]
    verdicts: Mapping[str, tuple[Verdict, ...]] = field(default_factory=dict)
    machine: Mapping[str, Machine] = field(default_factory=dict)
