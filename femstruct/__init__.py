"""Impact vibration of structures and the sound it makes.

    text -> Spec -> Structure -> Model -> Assembly -> ModalBasis -> Response
         -> SurfaceVelocity -> RoomResponse -> Levels -> files, pictures

Each arrow is a pure function, each noun a frozen value; nothing points back::

    read_model, read_study      a YAML file           -> Model, Plan
    read_mesh_file              a mesh file           -> ImportedMesh, for parts whose shape is a mesh
    mesh_structure              Structure             -> Model, for structures written in Python
    assemble                    Model                 -> Assembly
    given_matrices              someone's M, C, K     -> Assembly
    read_matrices               exported M, C, K      -> Assembly
    read_uff, write_uff         a universal file      -> Measurement, and back
    modal_basis, with_damping   Assembly              -> ModalBasis
    craig_bampton               someone's M, C, K     -> Reduced: a substructure on its interface
    complex_modes               Assembly, Damping     -> ComplexModes, where damping is not proportional
    statics                     Model, Assembly       -> AtRest, under weight and constant forces
    frf, simulate               ModalBasis, Scene     -> frequency response, Response
    placed                      a room, Surface       -> Placed, in the room's coordinates
    surface_velocity            Response, Placed      -> acoustics.SurfaceVelocity of each surface
    velocity_per_source         ModalBasis, Placed    -> what a loudspeaker in a room moves
    run_study                   Plan                  -> StudyResult
    read_campaign, sweep        what varies in it     -> Swept: a row of numbers for every sample
    read_search, optimise       what may be chosen    -> Found: the best design
    pareto_front                likewise, two goals   -> Front: designs of which none is better in all
    identify                    a model, measurements -> its numbers, with intervals
    write_results, read_results StudyResult           -> results.h5 and back

Names are fetched when first asked for (PEP 562): a script that only meshes never loads HDF5.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from femstruct.assembly.given_matrices import given_matrices as given_matrices
    from femstruct.assembly.matrices import Assembly as Assembly
    from femstruct.assembly.matrices import DofMap as DofMap
    from femstruct.assembly.matrices import assemble as assemble
    from femstruct.campaign.front_search import pareto_front as pareto_front
    from femstruct.campaign.optimise import optimise as optimise
    from femstruct.campaign.sweep import sweep as sweep
    from femstruct.decks.mesh_file import read_mesh_file as read_mesh_file
    from femstruct.errors import FemstructError as FemstructError
    from femstruct.errors import Finding as Finding
    from femstruct.errors import InputError as InputError
    from femstruct.evaluations.perception import PerceptionRequest as PerceptionRequest
    from femstruct.evaluations.shock import ShockRequest as ShockRequest
    from femstruct.files.campaign_files import read_found as read_found
    from femstruct.files.campaign_files import read_swept as read_swept
    from femstruct.files.campaign_files import write_found as write_found
    from femstruct.files.campaign_files import write_swept as write_swept
    from femstruct.files.matrices_input import read_matrices as read_matrices
    from femstruct.files.results_file import read_results as read_results
    from femstruct.files.results_file import write_results as write_results
    from femstruct.files.uff import read_uff as read_uff
    from femstruct.files.uff import write_uff as write_uff
    from femstruct.impact.batch import Batch as Batch
    from femstruct.impact.batch import simulate_batch as simulate_batch
    from femstruct.impact.fatigue import SNLine as SNLine
    from femstruct.impact.response import Response as Response
    from femstruct.impact.scene import GROUND as GROUND
    from femstruct.impact.scene import Body as Body
    from femstruct.impact.scene import Clock as Clock
    from femstruct.impact.scene import Contact as Contact
    from femstruct.impact.scene import HalfSine as HalfSine
    from femstruct.impact.scene import Link as Link
    from femstruct.impact.scene import Load as Load
    from femstruct.impact.scene import Scene as Scene
    from femstruct.impact.scene import Table as Table
    from femstruct.impact.scene import Walk as Walk
    from femstruct.impact.simulate import simulate as simulate
    from femstruct.language.campaigns import read_campaign as read_campaign
    from femstruct.language.campaigns import read_search as read_search
    from femstruct.language.cases import read_study as read_study
    from femstruct.language.models import read_model as read_model
    from femstruct.laws.cubic import Cubic as Cubic
    from femstruct.laws.flores import Flores as Flores
    from femstruct.laws.hertz import Hertz as Hertz
    from femstruct.laws.hunt_crossley import HuntCrossley as HuntCrossley
    from femstruct.laws.lankarani_nikravesh import LankaraniNikravesh as LankaraniNikravesh
    from femstruct.laws.linear import Linear as Linear
    from femstruct.laws.own import OwnLaw as OwnLaw
    from femstruct.laws.stop import Stop as Stop
    from femstruct.laws.tabulated import Tabulated as Tabulated
    from femstruct.modal.basis import ModalBasis as ModalBasis
    from femstruct.modal.closed_form import beam as beam
    from femstruct.modal.closed_form import given_modes as given_modes
    from femstruct.modal.closed_form import oscillator as oscillator
    from femstruct.modal.closed_form import rod as rod
    from femstruct.modal.complex_modes import ComplexModes as ComplexModes
    from femstruct.modal.complex_modes import complex_modes as complex_modes
    from femstruct.modal.damping import Damping as Damping
    from femstruct.modal.damping import FromMaterials as FromMaterials
    from femstruct.modal.damping import LossFactor as LossFactor
    from femstruct.modal.damping import ModeDamping as ModeDamping
    from femstruct.modal.damping import Ratio as Ratio
    from femstruct.modal.damping import Rayleigh as Rayleigh
    from femstruct.modal.damping import with_damping as with_damping
    from femstruct.modal.frf import frf as frf
    from femstruct.modal.installed_sources import BandMobility as BandMobility
    from femstruct.modal.installed_sources import ForceSource as ForceSource
    from femstruct.modal.installed_sources import MeasuredMobility as MeasuredMobility
    from femstruct.modal.installed_sources import RigidMass as RigidMass
    from femstruct.modal.measured import FrfTable as FrfTable
    from femstruct.modal.measured import MeasuredFrf as MeasuredFrf
    from femstruct.modal.measured import MeasuredHistory as MeasuredHistory
    from femstruct.modal.measured import MeasuredModes as MeasuredModes
    from femstruct.modal.measured import MeasuredPlace as MeasuredPlace
    from femstruct.modal.measured import Measurement as Measurement
    from femstruct.modal.measured import frf_table as frf_table
    from femstruct.modal.reduction import modal_basis as modal_basis
    from femstruct.modal.statics import AtRest as AtRest
    from femstruct.modal.statics import statics as statics
    from femstruct.modal.steady import BandSpectrum as BandSpectrum
    from femstruct.modal.steady import Spectrum as Spectrum
    from femstruct.modal.substructures import Reduced as Reduced
    from femstruct.modal.substructures import craig_bampton as craig_bampton
    from femstruct.model.component import Component as Component
    from femstruct.model.constraints import Average as Average
    from femstruct.model.constraints import Equation as Equation
    from femstruct.model.constraints import RigidLink as RigidLink
    from femstruct.model.imported_mesh import ImportedMesh as ImportedMesh
    from femstruct.model.lay_ups import Laminate as Laminate
    from femstruct.model.lay_ups import Layer as Layer
    from femstruct.model.lay_ups import PlateSection as PlateSection
    from femstruct.model.lay_ups import SectionShare as SectionShare
    from femstruct.model.lay_ups import Smeared as Smeared
    from femstruct.model.materials import EdgeWall as EdgeWall
    from femstruct.model.materials import LossByFrequency as LossByFrequency
    from femstruct.model.materials import Material as Material
    from femstruct.model.materials import Orthotropic as Orthotropic
    from femstruct.model.materials import laboratory_losses as laboratory_losses
    from femstruct.model.materials import measured_losses as measured_losses
    from femstruct.model.mesher import mesh_structure as mesh_structure
    from femstruct.model.model import Model as Model
    from femstruct.model.probe import Probe as Probe
    from femstruct.model.probe import Surface as Surface
    from femstruct.model.regions import Region as Region
    from femstruct.model.seams import Seam as Seam
    from femstruct.model.sections import Section as Section
    from femstruct.model.structure import AirBetween as AirBetween
    from femstruct.model.structure import Bays as Bays
    from femstruct.model.structure import Fill as Fill
    from femstruct.model.structure import Joint as Joint
    from femstruct.model.structure import PlaceOn as PlaceOn
    from femstruct.model.structure import Structure as Structure
    from femstruct.model.structure import Support as Support
    from femstruct.model.structure import SurfaceOn as SurfaceOn
    from femstruct.parts.attachments import Attachments as Attachments
    from femstruct.parts.block import Block as Block
    from femstruct.parts.foundation import Foundation as Foundation
    from femstruct.parts.frame import Frame as Frame
    from femstruct.parts.hangers import Hangers as Hangers
    from femstruct.parts.inertia import Inertia as Inertia
    from femstruct.parts.mass import Mass as Mass
    from femstruct.parts.plate import Plate as Plate
    from femstruct.parts.shell import Shell as Shell
    from femstruct.parts.slab import Slab as Slab
    from femstruct.parts.solid import Solid as Solid
    from femstruct.parts.spring import Spring as Spring
    from femstruct.parts.substructure import Substructure as Substructure
    from femstruct.sound.cavity_coupling import PlacedCavity as PlacedCavity
    from femstruct.sound.cavity_coupling import placed_cavities as placed_cavities
    from femstruct.sound.cavity_coupling import with_cavities as with_cavities
    from femstruct.sound.placed import Placed as Placed
    from femstruct.sound.placed import placed as placed
    from femstruct.sound.surfaces import surface_velocity as surface_velocity
    from femstruct.sound.surfaces import velocity_per_source as velocity_per_source
    from femstruct.study.acting import Covering as Covering
    from femstruct.study.acting import InitialMotion as InitialMotion
    from femstruct.study.acting import MeasuredSource as MeasuredSource
    from femstruct.study.acting import PlacedBody as PlacedBody
    from femstruct.study.acting import PlannedContact as PlannedContact
    from femstruct.study.acting import PlannedLink as PlannedLink
    from femstruct.study.acting import PlannedLoad as PlannedLoad
    from femstruct.study.acting import PlannedWalk as PlannedWalk
    from femstruct.study.acting import Repeat as Repeat
    from femstruct.study.acting import RigidMotion as RigidMotion
    from femstruct.study.asked import AccuracyRule as AccuracyRule
    from femstruct.study.asked import Extent as Extent
    from femstruct.study.asked import FatigueRequest as FatigueRequest
    from femstruct.study.asked import FrfRequest as FrfRequest
    from femstruct.study.asked import Limit as Limit
    from femstruct.study.asked import PeakRule as PeakRule
    from femstruct.study.asked import Record as Record
    from femstruct.study.asked import RoomPlan as RoomPlan
    from femstruct.study.asked import Spot as Spot
    from femstruct.study.asked import TimePlan as TimePlan
    from femstruct.study.asked import Vibration as Vibration
    from femstruct.study.campaigns import Campaign as Campaign
    from femstruct.study.campaigns import Listed as Listed
    from femstruct.study.campaigns import Sampling as Sampling
    from femstruct.study.campaigns import Scattered as Scattered
    from femstruct.study.campaigns import Swept as Swept
    from femstruct.study.campaigns import held_limits as held_limits
    from femstruct.study.campaigns import spread as spread
    from femstruct.study.optima import Found as Found
    from femstruct.study.optima import Front as Front
    from femstruct.study.optima import Goal as Goal
    from femstruct.study.optima import Search as Search
    from femstruct.study.results import StudyResult as StudyResult
    from femstruct.study.structures import BeamModel as BeamModel
    from femstruct.study.structures import ModesModel as ModesModel
    from femstruct.study.structures import NoStructure as NoStructure
    from femstruct.study.structures import OscillatorModel as OscillatorModel
    from femstruct.study.structures import RodModel as RodModel
    from femstruct.study.study import Case as Case
    from femstruct.study.study import Plan as Plan
    from femstruct.study.study import Study as Study
    from femstruct.workflow.identify import Identification as Identification
    from femstruct.workflow.identify import identify as identify
    from femstruct.workflow.measured_data import MeasuredFiles as MeasuredFiles
    from femstruct.workflow.run import run_study as run_study

_NAMES = {
    "assembly.given_matrices": ("given_matrices",),
    "assembly.matrices": (
        "Assembly",
        "DofMap",
        "assemble",
    ),
    "campaign.front_search": ("pareto_front",),
    "campaign.optimise": ("optimise",),
    "campaign.sweep": ("sweep",),
    "decks.mesh_file": ("read_mesh_file",),
    "errors": (
        "FemstructError",
        "Finding",
        "InputError",
    ),
    "evaluations.perception": ("PerceptionRequest",),
    "evaluations.shock": ("ShockRequest",),
    "files.campaign_files": (
        "read_found",
        "read_swept",
        "write_found",
        "write_swept",
    ),
    "files.matrices_input": ("read_matrices",),
    "files.results_file": (
        "read_results",
        "write_results",
    ),
    "files.uff": (
        "read_uff",
        "write_uff",
    ),
    "impact.batch": (
        "Batch",
        "simulate_batch",
    ),
    "impact.fatigue": ("SNLine",),
    "impact.response": ("Response",),
    "impact.scene": (
        "Body",
        "Clock",
        "Contact",
        "GROUND",
        "HalfSine",
        "Link",
        "Load",
        "Scene",
        "Table",
        "Walk",
    ),
    "impact.simulate": ("simulate",),
    "language.campaigns": (
        "read_campaign",
        "read_search",
    ),
    "language.cases": ("read_study",),
    "language.models": ("read_model",),
    "laws.cubic": ("Cubic",),
    "laws.flores": ("Flores",),
    "laws.hertz": ("Hertz",),
    "laws.hunt_crossley": ("HuntCrossley",),
    "laws.lankarani_nikravesh": ("LankaraniNikravesh",),
    "laws.linear": ("Linear",),
    "laws.own": ("OwnLaw",),
    "laws.stop": ("Stop",),
    "laws.tabulated": ("Tabulated",),
    "modal.basis": ("ModalBasis",),
    "modal.closed_form": (
        "beam",
        "given_modes",
        "oscillator",
        "rod",
    ),
    "modal.complex_modes": (
        "ComplexModes",
        "complex_modes",
    ),
    "modal.damping": (
        "Damping",
        "FromMaterials",
        "LossFactor",
        "ModeDamping",
        "Ratio",
        "Rayleigh",
        "with_damping",
    ),
    "modal.frf": ("frf",),
    "modal.installed_sources": (
        "BandMobility",
        "ForceSource",
        "MeasuredMobility",
        "RigidMass",
    ),
    "modal.measured": (
        "FrfTable",
        "MeasuredFrf",
        "MeasuredHistory",
        "MeasuredModes",
        "MeasuredPlace",
        "Measurement",
        "frf_table",
    ),
    "modal.reduction": ("modal_basis",),
    "modal.statics": (
        "AtRest",
        "statics",
    ),
    "modal.steady": (
        "BandSpectrum",
        "Spectrum",
    ),
    "modal.substructures": (
        "Reduced",
        "craig_bampton",
    ),
    "model.component": ("Component",),
    "model.constraints": (
        "Average",
        "Equation",
        "RigidLink",
    ),
    "model.imported_mesh": ("ImportedMesh",),
    "model.lay_ups": (
        "Laminate",
        "Layer",
        "PlateSection",
        "SectionShare",
        "Smeared",
    ),
    "model.materials": (
        "EdgeWall",
        "LossByFrequency",
        "Material",
        "Orthotropic",
        "laboratory_losses",
        "measured_losses",
    ),
    "model.mesher": ("mesh_structure",),
    "model.model": ("Model",),
    "model.probe": (
        "Probe",
        "Surface",
    ),
    "model.regions": ("Region",),
    "model.seams": ("Seam",),
    "model.sections": ("Section",),
    "model.structure": (
        "AirBetween",
        "Bays",
        "Fill",
        "Joint",
        "PlaceOn",
        "Structure",
        "Support",
        "SurfaceOn",
    ),
    "parts.attachments": ("Attachments",),
    "parts.block": ("Block",),
    "parts.foundation": ("Foundation",),
    "parts.frame": ("Frame",),
    "parts.hangers": ("Hangers",),
    "parts.inertia": ("Inertia",),
    "parts.mass": ("Mass",),
    "parts.plate": ("Plate",),
    "parts.shell": ("Shell",),
    "parts.slab": ("Slab",),
    "parts.solid": ("Solid",),
    "parts.spring": ("Spring",),
    "parts.substructure": ("Substructure",),
    "sound.cavity_coupling": (
        "PlacedCavity",
        "placed_cavities",
        "with_cavities",
    ),
    "sound.placed": (
        "Placed",
        "placed",
    ),
    "sound.surfaces": (
        "surface_velocity",
        "velocity_per_source",
    ),
    "study.acting": (
        "Covering",
        "InitialMotion",
        "MeasuredSource",
        "PlacedBody",
        "PlannedContact",
        "PlannedLink",
        "PlannedLoad",
        "PlannedWalk",
        "Repeat",
        "RigidMotion",
    ),
    "study.asked": (
        "AccuracyRule",
        "Extent",
        "FatigueRequest",
        "FrfRequest",
        "Limit",
        "PeakRule",
        "Record",
        "RoomPlan",
        "Spot",
        "TimePlan",
        "Vibration",
    ),
    "study.campaigns": (
        "Campaign",
        "Listed",
        "Sampling",
        "Scattered",
        "Swept",
        "held_limits",
        "spread",
    ),
    "study.optima": (
        "Found",
        "Front",
        "Goal",
        "Search",
    ),
    "study.results": ("StudyResult",),
    "study.structures": (
        "BeamModel",
        "ModesModel",
        "NoStructure",
        "OscillatorModel",
        "RodModel",
    ),
    "study.study": (
        "Case",
        "Plan",
        "Study",
    ),
    "workflow.identify": (
        "Identification",
        "identify",
    ),
    "workflow.measured_data": ("MeasuredFiles",),
    "workflow.run": ("run_study",),
}
_HOMES = {name: f"femstruct.{module}" for module, names in _NAMES.items() for name in names}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'femstruct' has no attribute '{name}'")


def __dir__() -> list[str]:
    return __all__
