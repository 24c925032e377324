"""The study file: what happens to the structure."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, create_model

from femstruct.errors import shown_as
from femstruct.language.evaluations.evaluation import EvaluationSpec
from femstruct.language.evaluations.known_evaluations import KINDS
from femstruct.language.not_computed import BASE_IN_TIME, instead_of
from femstruct.language.rooms.known_rooms import AnyRoom
from femstruct.language.study.body import BodySpec
from femstruct.language.study.campaign.optimise import CampaignSpec
from femstruct.language.study.contact import ContactSpec
from femstruct.language.study.fatigue import FatigueSpec
from femstruct.language.study.limit import Limits
from femstruct.language.study.link import LinkSpec
from femstruct.language.study.load import LoadSpec
from femstruct.language.study.record import Recorded
from femstruct.language.study.request import FrfSpec
from femstruct.language.study.sources.measured_source import MeasuredSourceSpec
from femstruct.language.study.start import InitialSpec
from femstruct.language.study.vibration import VibrationSpec
from femstruct.language.study.window import AccuracySpec, ModesSpec, PeaksSpec, TimeSpec
from femstruct.language.yaml import Instant, Refers, Spec, Text, read_by, refuse


def _changes(value: object) -> object:
    """A case is checked where it is applied; here only its form."""
    if not isinstance(value, dict | None):
        raise refuse(shown_as(value), "a mapping of paths to values", "write it like {bodies.damper.mass: 0.9 kg}")
    return value or {}


Changes = Annotated[dict[str, Any], read_by(_changes, dict[str, Any] | None)]


class CompareSpec(Spec):
    """Which case the others are compared with."""

    baseline: Annotated[Text, Refers()]


class StudyKeys(CampaignSpec):
    """The keys of a study file but those of the evaluations of recorded histories, a key each kind."""

    instead = instead_of(BASE_IN_TIME, "base", "base_motion", "ground", "ground_motion", "earthquake")

    title: Text | None = None
    model: Text = Field(description="the model file, beside this one")
    modes: ModesSpec | None = None
    accuracy: AccuracySpec | None = None
    frf: dict[str, FrfSpec] = Field(default_factory=dict)
    bodies: dict[str, BodySpec] = Field(default_factory=dict)
    contacts: dict[str, ContactSpec] = Field(default_factory=dict)
    links: dict[str, LinkSpec] = Field(default_factory=dict)
    loads: dict[str, LoadSpec] = Field(default_factory=dict)
    initial: InitialSpec = InitialSpec()
    record: dict[str, Recorded] = Field(
        default_factory=dict,
        description="What histories are of. A force of a spring, foundation, support, joint or the ground has, beside "
        "k u and c v, its share of the damping of the modes: of a ratio in proportion to the elastic force.",
    )
    time: TimeSpec | None = None
    peaks: PeaksSpec = PeaksSpec()
    limits: Limits = Field(
        default_factory=dict,
        description="Of a recorded channel, TARGET QUANTITY, of the time to rest, settled, of a rating, ROOM rating. "
        "'ground force' is what the motion adds, 'ground force with weight' has the weight of all that stands there.",
    )
    quiet: Instant = 0.0
    rooms: dict[str, AnyRoom] = Field(default_factory=dict)
    cases: dict[str, Changes] = Field(
        default_factory=dict,
        description="Variants of the study by name: paths of the study or its model with their values there, and "
        "'add: {PATH: ..}', 'remove: [PATH, ..]'. These alone are computed; the first is the baseline: begin with an "
        "empty one, 'as built: {}'.",
    )
    compare: CompareSpec | None = None
    save: Literal["modal"] | None = Field(default=None, description="modal: keep the motion of all modes, too")
    vibration: dict[str, VibrationSpec] = Field(default_factory=dict)
    fatigue: dict[str, FatigueSpec] = Field(default_factory=dict)
    sources: dict[str, MeasuredSourceSpec] = Field(default_factory=dict)

    def evaluations(self) -> Iterator[tuple[str, str, EvaluationSpec]]:
        """What is asked of recorded histories: the key of its kind, its name, and what the file says of it."""
        for key in KINDS:
            yield from ((key, name, one) for name, one in getattr(self, key).items())


if TYPE_CHECKING:
    StudySpec = StudyKeys
else:
    StudySpec = create_model(
        "StudySpec",
        __base__=StudyKeys,
        __doc__="A study file.",
        **{key: (dict[str, kind], Field(default_factory=dict)) for key, kind in KINDS.items()},
    )
