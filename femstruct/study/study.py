"""Study: everything one simulation needs, resolved and in SI units, before anything is computed.

Names still stand for places here ("O_f", "ball"); the workflow turns them into probes once the model is meshed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.modal.damping import Damping
from femstruct.study.acting import (
    InitialMotion,
    MeasuredSource,
    PlacedBody,
    PlannedContact,
    PlannedLink,
    PlannedLoad,
    PlannedWalk,
)
from femstruct.study.asked import (
    AccuracyRule,
    Extent,
    FatigueRequest,
    FrfRequest,
    Limit,
    PeakRule,
    Record,
    RoomPlan,
    TimePlan,
    Vibration,
)
from femstruct.study.structures import StructureModel
from femstruct.tags import stored_as

if TYPE_CHECKING:  # a model's modes need nothing of impacts
    from femstruct.evaluations.evaluation import Evaluation


@stored_as("study/1")
@dataclass(frozen=True)
@checked("study")
class Study:
    """All inputs of one simulation, in SI units.

    structure, damping : the model. extent : how many modes its basis has. frf, evaluations (of recorded
    histories: shock spectra, perception), vibration, fatigue : what is asked for.
    bodies, contacts, links, loads, walks, initial : what takes part, its initial state. records : histories to keep.
    time : the window, None when nothing is simulated. peaks : which peaks are reported. rooms : with their receivers.
    limits : what the verdicts of a case are about. save_modal : whether the modal coordinates go into the results
    file. accuracy : None to use the modes asked for. sources : machines that were measured by themselves.

    A ball of 50 g strikes the middle of a steel plate with 1 m/s. What the run found is in `cases` of its result: the
    modes, the histories and, of every contact, the largest force [N] and when it first opens [ms here]. A rigid plate
    would give 300 N:

    >>> import femstruct as fs
    >>> steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> plate = fs.Plate("plate", steel, 0.005, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=0.1)
    >>> structure = fs.Structure(
    ...     "a plate",
    ...     (plate,),
    ...     points=(fs.PlaceOn("middle", "plate", at=((0.25, 0.2),)),),
    ...     supports=(fs.Support("edges", "simple", on="plate", edge="all"),),
    ... )
    >>> study = Study(
    ...     "a ball on a plate",
    ...     structure,
    ...     fs.Damping(fs.Ratio(0.01)),
    ...     Extent(up_to_hz=2000.0),
    ...     bodies=(PlacedBody("ball", 0.05, "above", "middle", speed=1.0, law=fs.Hertz(1e8)),),
    ...     records=(Record("middle.z", "velocity"),),
    ...     time=TimePlan(duration=0.02, sampling=20e3),
    ... )
    >>> found = fs.run_study(Plan("a ball on a plate", (Case("as given", study),), baseline="as given"))
    >>> contact = found.cases["as given"].response.contacts["ball on middle"]
    >>> round(contact.peak_force), round(1e3 * contact.first_open, 2)
    (276, 0.62)
    """

    title: str
    structure: StructureModel
    damping: Damping
    extent: Extent
    frf: tuple[FrfRequest, ...] = ()
    bodies: tuple[PlacedBody, ...] = ()
    contacts: tuple[PlannedContact, ...] = ()
    links: tuple[PlannedLink, ...] = ()
    loads: tuple[PlannedLoad, ...] = ()
    walks: tuple[PlannedWalk, ...] = ()
    initial: InitialMotion = field(default_factory=InitialMotion)
    records: tuple[Record, ...] = ()
    time: TimePlan | None = None
    peaks: PeakRule = field(default_factory=PeakRule)
    rooms: tuple[RoomPlan, ...] = ()
    limits: tuple[Limit, ...] = ()
    save_modal: bool = False
    accuracy: AccuracyRule | None = None
    evaluations: tuple[Evaluation, ...] = ()
    vibration: tuple[Vibration, ...] = ()
    fatigue: tuple[FatigueRequest, ...] = ()
    sources: tuple[MeasuredSource, ...] = ()

    def __post_init__(self) -> None:
        lowpass = self.peaks.lowpass_hz
        if self.time is not None and lowpass is not None and not lowpass < 0.5 * self.time.sampling:
            expected = f"less than half the sampling, {0.5 * self.time.sampling:g} Hz"
            raise InputError("study.peaks.lowpass_hz", got=f"{lowpass:g} Hz", expected=expected)


@stored_as("case/1")
@dataclass(frozen=True)
@checked("cases")
class Case:
    """One column of the comparison: a study, and what makes it differ from the file (path -> text of the value).

    drops : the same study for every place that its standard source strikes, by the place ("drops.2"); the first is
    `study`. Empty where there is one place or no source.

    >>> import femstruct as fs
    >>> ball = PlacedBody("ball", 0.1, "above", "ground")
    >>> study = Study("a fall", fs.NoStructure(), fs.Damping(), Extent(), bodies=(ball,))
    >>> Case("as given", study).studies == (study,)
    True
    """

    name: str
    study: Study
    changes: Mapping[str, str] = field(default_factory=dict)
    drops: Mapping[str, Study] = field(default_factory=dict)

    @property
    def studies(self) -> tuple[Study, ...]:
        """The studies to simulate, one for every drop."""
        return tuple(self.drops.values()) or (self.study,)


@stored_as("plan of a study/1")
@dataclass(frozen=True)
@checked("plan")
class Plan:
    """A study file, read: its cases in order, which one is the baseline, and its files verbatim by
    name: YAML, and CSV of loads; none of a plan made in Python.

    positions : (file, line, column) of every path of the files, for messages.

    Two cases of a fall on the ground, with a ball of twice the mass in the second; `Study` has a whole one:

    >>> from dataclasses import replace
    >>> import femstruct as fs
    >>> ball = PlacedBody("ball", 0.1, "above", "ground", speed=2.0, law=fs.Linear(1e5))
    >>> light = Study("a fall", fs.NoStructure(), fs.Damping(), Extent(), bodies=(ball,), time=TimePlan(0.02, 50e3))
    >>> heavy = replace(light, bodies=(replace(ball, mass=0.2),))
    >>> plan = Plan("two falls", (Case("light", light), Case("heavy", heavy)), baseline="light")
    >>> contacts = [case.response.contacts["ball on ground"] for case in fs.run_study(plan).cases.values()]
    >>> [round(1e3 * contact.first_open, 4) for contact in contacts]  # pi sqrt(m / k) [ms]
    [3.1416, 4.4429]
    """

    title: str
    cases: tuple[Case, ...]
    baseline: str
    sources: Mapping[str, str] = field(default_factory=dict)
    positions: Mapping[str, tuple[str, int, int]] = field(default_factory=dict)
