"""Impact vibration of structures and the sound it makes.

    text -> Spec -> Structure -> Model -> Assembly -> ModalBasis -> Response -> SurfaceVelocity -> RoomResponse -> Levels

Each arrow is a pure function, each noun a frozen value; nothing points back::

    read_model, read_study     a YAML file           -> Structure and damping, Plan
    mesh_structure             Structure             -> Model
    assemble                   Model                 -> Assembly
    modal_basis, with_damping  Assembly              -> ModalBasis
    frf, simulate              ModalBasis, Scene     -> frequency response, Response
    surface_velocity           Response, Surface     -> acoustics.SurfaceVelocity
    run_study                  Plan                  -> StudyResult
    write_results              StudyResult           -> results.h5
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from femstruct.assembly.assemble import assemble
    from femstruct.errors import FemstructError, Finding, InputError
    from femstruct.files.results import write_results
    from femstruct.impact.bodies import GROUND, Body, Clock, Contact, Link, Load, Scene
    from femstruct.impact.laws import Hertz, Linear, Stop
    from femstruct.impact.response import Response
    from femstruct.impact.simulate import simulate
    from femstruct.language import read_model, read_study
    from femstruct.modal.basis import ModalBasis
    from femstruct.modal.damping import Damping, with_damping
    from femstruct.modal.frf import frf
    from femstruct.modal.reduction import modal_basis
    from femstruct.model.mesher import mesh_structure
    from femstruct.model.model import Model
    from femstruct.model.parts import Structure
    from femstruct.radiation import surface_velocity
    from femstruct.study.result import StudyResult
    from femstruct.study.study import Plan, Study
    from femstruct.workflow.run import run_study

_HOMES = {
    "assemble": "femstruct.assembly.assemble",
    "FemstructError": "femstruct.errors",
    "Finding": "femstruct.errors",
    "InputError": "femstruct.errors",
    "write_results": "femstruct.files.results",
    "GROUND": "femstruct.impact.bodies",
    "Body": "femstruct.impact.bodies",
    "Clock": "femstruct.impact.bodies",
    "Contact": "femstruct.impact.bodies",
    "Link": "femstruct.impact.bodies",
    "Load": "femstruct.impact.bodies",
    "Scene": "femstruct.impact.bodies",
    "Hertz": "femstruct.impact.laws",
    "Linear": "femstruct.impact.laws",
    "Stop": "femstruct.impact.laws",
    "Response": "femstruct.impact.response",
    "simulate": "femstruct.impact.simulate",
    "read_model": "femstruct.language",
    "read_study": "femstruct.language",
    "ModalBasis": "femstruct.modal.basis",
    "Damping": "femstruct.modal.damping",
    "with_damping": "femstruct.modal.damping",
    "frf": "femstruct.modal.frf",
    "modal_basis": "femstruct.modal.reduction",
    "mesh_structure": "femstruct.model.mesher",
    "Model": "femstruct.model.model",
    "Structure": "femstruct.model.parts",
    "surface_velocity": "femstruct.radiation",
    "StudyResult": "femstruct.study.result",
    "Plan": "femstruct.study.study",
    "Study": "femstruct.study.study",
    "run_study": "femstruct.workflow.run",
}

__all__ = [  # noqa: RUF022 (in the order of _HOMES: the way through the house)
    "assemble",
    "FemstructError",
    "Finding",
    "InputError",
    "write_results",
    "GROUND",
    "Body",
    "Clock",
    "Contact",
    "Link",
    "Load",
    "Scene",
    "Hertz",
    "Linear",
    "Stop",
    "Response",
    "simulate",
    "read_model",
    "read_study",
    "ModalBasis",
    "Damping",
    "with_damping",
    "frf",
    "modal_basis",
    "mesh_structure",
    "Model",
    "Structure",
    "surface_velocity",
    "StudyResult",
    "Plan",
    "Study",
    "run_study",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'femstruct' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(_HOMES)
