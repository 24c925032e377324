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
    from femstruct.assembly.assemble import assemble as assemble
    from femstruct.assembly.given_matrices import given_matrices as given_matrices
    from femstruct.assembly.matrices import Assembly as Assembly
    from femstruct.assembly.matrices import DofMap as DofMap
    from femstruct.campaign.front_search import pareto_front as pareto_front
    from femstruct.campaign.optimise import optimise as optimise
    from femstruct.campaign.sweep import sweep as sweep
    from femstruct.errors import FemstructError as FemstructError
    from femstruct.errors import Finding as Finding
    from femstruct.errors import InputError as InputError
    from femstruct.files.exchange.uff_reading import read_uff as read_uff
    from femstruct.files.exchange.uff_writing import write_uff as write_uff
    from femstruct.files.inputs.matrices_input import read_matrices as read_matrices
    from femstruct.files.inputs.mesh_files.mesh_file import read_mesh_file as read_mesh_file
    from femstruct.files.results_file.found_file import read_found as read_found
    from femstruct.files.results_file.found_file import write_found as write_found
    from femstruct.files.results_file.results import write_results as write_results
    from femstruct.files.results_file.stored import read_results as read_results
    from femstruct.files.results_file.swept_file import read_swept as read_swept
    from femstruct.files.results_file.swept_file import write_swept as write_swept
    from femstruct.impact.batch.batch import simulate_batch as simulate_batch
    from femstruct.impact.batch.metrics import Batch as Batch
    from femstruct.impact.evaluations.perception import PerceptionRequest as PerceptionRequest
    from femstruct.impact.evaluations.shock import ShockRequest as ShockRequest
    from femstruct.impact.laws.cubic import Cubic as Cubic
    from femstruct.impact.laws.flores import Flores as Flores
    from femstruct.impact.laws.hertz import Hertz as Hertz
    from femstruct.impact.laws.hunt_crossley import HuntCrossley as HuntCrossley
    from femstruct.impact.laws.lankarani_nikravesh import LankaraniNikravesh as LankaraniNikravesh
    from femstruct.impact.laws.linear import Linear as Linear
    from femstruct.impact.laws.own import OwnLaw as OwnLaw
    from femstruct.impact.laws.stop import Stop as Stop
    from femstruct.impact.laws.tabulated import Tabulated as Tabulated
    from femstruct.impact.result.fatigue import SNLine as SNLine
    from femstruct.impact.result.response import Response as Response
    from femstruct.impact.scene.bodies import GROUND as GROUND
    from femstruct.impact.scene.bodies import Body as Body
    from femstruct.impact.scene.bodies import Clock as Clock
    from femstruct.impact.scene.bodies import Contact as Contact
    from femstruct.impact.scene.bodies import HalfSine as HalfSine
    from femstruct.impact.scene.bodies import Link as Link
    from femstruct.impact.scene.bodies import Load as Load
    from femstruct.impact.scene.bodies import Scene as Scene
    from femstruct.impact.scene.bodies import Table as Table
    from femstruct.impact.scene.walking import Walk as Walk
    from femstruct.impact.simulate import simulate as simulate
    from femstruct.language import read_model as read_model
    from femstruct.language import read_study as read_study
    from femstruct.language.campaigns import read_campaign as read_campaign
    from femstruct.language.searches import read_search as read_search
    from femstruct.modal.analytic import beam as beam
    from femstruct.modal.analytic import given_modes as given_modes
    from femstruct.modal.analytic import oscillator as oscillator
    from femstruct.modal.analytic import rod as rod
    from femstruct.modal.basis import ModalBasis as ModalBasis
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
    from femstruct.modal.measured.frf_table import FrfTable as FrfTable
    from femstruct.modal.measured.frf_table import frf_table as frf_table
    from femstruct.modal.measured.measurement import MeasuredFrf as MeasuredFrf
    from femstruct.modal.measured.measurement import MeasuredHistory as MeasuredHistory
    from femstruct.modal.measured.measurement import MeasuredModes as MeasuredModes
    from femstruct.modal.measured.measurement import MeasuredPlace as MeasuredPlace
    from femstruct.modal.measured.measurement import Measurement as Measurement
    from femstruct.modal.reduction import modal_basis as modal_basis
    from femstruct.modal.statics import AtRest as AtRest
    from femstruct.modal.statics import statics as statics
    from femstruct.modal.steady.band_spectrum import BandSpectrum as BandSpectrum
    from femstruct.modal.steady.source_mobility import BandMobility as BandMobility
    from femstruct.modal.steady.source_mobility import ForceSource as ForceSource
    from femstruct.modal.steady.source_mobility import MeasuredMobility as MeasuredMobility
    from femstruct.modal.steady.source_mobility import RigidMass as RigidMass
    from femstruct.modal.steady.spectrum import Spectrum as Spectrum
    from femstruct.modal.substructures.craig_bampton import Reduced as Reduced
    from femstruct.modal.substructures.craig_bampton import craig_bampton as craig_bampton
    from femstruct.model.equations.average import Average as Average
    from femstruct.model.equations.equation import Equation as Equation
    from femstruct.model.equations.rigid_link import RigidLink as RigidLink
    from femstruct.model.equations.seam import Seam as Seam
    from femstruct.model.imported.component import Component as Component
    from femstruct.model.imported.imported_mesh import ImportedMesh as ImportedMesh
    from femstruct.model.material import Material as Material
    from femstruct.model.materials.air_between import AirBetween as AirBetween
    from femstruct.model.materials.air_between import Bays as Bays
    from femstruct.model.materials.air_between import Fill as Fill
    from femstruct.model.materials.edge_wall import EdgeWall as EdgeWall
    from femstruct.model.materials.lay_up import Laminate as Laminate
    from femstruct.model.materials.lay_up import Layer as Layer
    from femstruct.model.materials.lay_up import Smeared as Smeared
    from femstruct.model.materials.loss_by_frequency import LossByFrequency as LossByFrequency
    from femstruct.model.materials.loss_by_frequency import laboratory_losses as laboratory_losses
    from femstruct.model.materials.loss_by_frequency import measured_losses as measured_losses
    from femstruct.model.materials.orthotropic import Orthotropic as Orthotropic
    from femstruct.model.materials.plate_section import PlateSection as PlateSection
    from femstruct.model.materials.plate_section import SectionShare as SectionShare
    from femstruct.model.mesher import mesh_structure as mesh_structure
    from femstruct.model.model import Model as Model
    from femstruct.model.probe import Probe as Probe
    from femstruct.model.probe import Surface as Surface
    from femstruct.model.region import Region as Region
    from femstruct.model.section import Section as Section
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
    from femstruct.sound.cavities import with_cavities as with_cavities
    from femstruct.sound.placed import Placed as Placed
    from femstruct.sound.placed import placed as placed
    from femstruct.sound.placed_cavity import PlacedCavity as PlacedCavity
    from femstruct.sound.placed_cavity import placed_cavities as placed_cavities
    from femstruct.sound.room_source import velocity_per_source as velocity_per_source
    from femstruct.sound.surface import surface_velocity as surface_velocity
    from femstruct.study.acting import Covering as Covering
    from femstruct.study.acting import InitialMotion as InitialMotion
    from femstruct.study.acting import PlacedBody as PlacedBody
    from femstruct.study.acting import PlannedContact as PlannedContact
    from femstruct.study.acting import PlannedLink as PlannedLink
    from femstruct.study.acting import PlannedLoad as PlannedLoad
    from femstruct.study.acting import PlannedWalk as PlannedWalk
    from femstruct.study.acting import Repeat as Repeat
    from femstruct.study.acting import RigidMotion as RigidMotion
    from femstruct.study.asked import AccuracyRule as AccuracyRule
    from femstruct.study.asked import Extent as Extent
    from femstruct.study.asked import FrfRequest as FrfRequest
    from femstruct.study.asked import Limit as Limit
    from femstruct.study.asked import PeakRule as PeakRule
    from femstruct.study.asked import Record as Record
    from femstruct.study.asked import RoomPlan as RoomPlan
    from femstruct.study.asked import Spot as Spot
    from femstruct.study.asked import TimePlan as TimePlan
    from femstruct.study.campaign.front import Front as Front
    from femstruct.study.campaign.held_limits import held_limits as held_limits
    from femstruct.study.campaign.sought import Found as Found
    from femstruct.study.campaign.sought import Goal as Goal
    from femstruct.study.campaign.sought import Search as Search
    from femstruct.study.campaign.spread import spread as spread
    from femstruct.study.campaign.swept import Swept as Swept
    from femstruct.study.campaign.varied import Campaign as Campaign
    from femstruct.study.campaign.varied import Listed as Listed
    from femstruct.study.campaign.varied import Sampling as Sampling
    from femstruct.study.campaign.varied import Scattered as Scattered
    from femstruct.study.counting import FatigueRequest as FatigueRequest
    from femstruct.study.measured_source import MeasuredSource as MeasuredSource
    from femstruct.study.result import StudyResult as StudyResult
    from femstruct.study.steady_vibration import Vibration as Vibration
    from femstruct.study.structures import BeamModel as BeamModel
    from femstruct.study.structures import ModesModel as ModesModel
    from femstruct.study.structures import NoStructure as NoStructure
    from femstruct.study.structures import OscillatorModel as OscillatorModel
    from femstruct.study.structures import RodModel as RodModel
    from femstruct.study.study import Case as Case
    from femstruct.study.study import Plan as Plan
    from femstruct.study.study import Study as Study
    from femstruct.workflow.identify.identify import Identification as Identification
    from femstruct.workflow.identify.identify import identify as identify
    from femstruct.workflow.identify.measured_data import MeasuredFiles as MeasuredFiles
    from femstruct.workflow.run.run import run_study as run_study

_NAMES = {
    "campaign.front_search": ("pareto_front",),
    "campaign.optimise": ("optimise",),
    "campaign.sweep": ("sweep",),
    "assembly.assemble": ("assemble",),
    "assembly.given_matrices": ("given_matrices",),
    "assembly.matrices": ("Assembly", "DofMap"),
    "errors": ("FemstructError", "Finding", "InputError"),
    "files.exchange.uff_reading": ("read_uff",),
    "files.exchange.uff_writing": ("write_uff",),
    "files.inputs.matrices_input": ("read_matrices",),
    "files.inputs.mesh_files.mesh_file": ("read_mesh_file",),
    "files.results_file.results": ("write_results",),
    "files.results_file.found_file": ("read_found", "write_found"),
    "files.results_file.stored": ("read_results",),
    "files.results_file.swept_file": ("read_swept", "write_swept"),
    "impact.batch.batch": ("simulate_batch",),
    "impact.scene.bodies": ("GROUND", "Body", "Clock", "Contact", "HalfSine", "Link", "Load", "Scene", "Table"),
    "impact.evaluations.perception": ("PerceptionRequest",),
    "impact.evaluations.shock": ("ShockRequest",),
    "impact.laws.cubic": ("Cubic",),
    "impact.laws.flores": ("Flores",),
    "impact.laws.hertz": ("Hertz",),
    "impact.laws.hunt_crossley": ("HuntCrossley",),
    "impact.laws.lankarani_nikravesh": ("LankaraniNikravesh",),
    "impact.laws.linear": ("Linear",),
    "impact.laws.own": ("OwnLaw",),
    "impact.laws.stop": ("Stop",),
    "impact.laws.tabulated": ("Tabulated",),
    "impact.batch.metrics": ("Batch",),
    "impact.result.fatigue": ("SNLine",),
    "impact.result.response": ("Response",),
    "impact.simulate": ("simulate",),
    "impact.scene.walking": ("Walk",),
    "language": ("read_model", "read_study"),
    "language.campaigns": ("read_campaign",),
    "language.searches": ("read_search",),
    "modal.analytic": ("beam", "given_modes", "oscillator", "rod"),
    "modal.basis": ("ModalBasis",),
    "modal.complex_modes": ("ComplexModes", "complex_modes"),
    "modal.substructures.craig_bampton": ("Reduced", "craig_bampton"),
    "modal.damping": ("Damping", "FromMaterials", "LossFactor", "ModeDamping", "Ratio", "Rayleigh", "with_damping"),
    "modal.frf": ("frf",),
    "modal.measured.frf_table": ("FrfTable", "frf_table"),
    "modal.measured.measurement": ("MeasuredFrf", "MeasuredHistory", "MeasuredModes", "MeasuredPlace", "Measurement"),
    "modal.reduction": ("modal_basis",),
    "modal.steady.band_spectrum": ("BandSpectrum",),
    "modal.steady.source_mobility": ("BandMobility", "ForceSource", "MeasuredMobility", "RigidMass"),
    "modal.steady.spectrum": ("Spectrum",),
    "modal.statics": ("AtRest", "statics"),
    "model.materials.air_between": ("AirBetween", "Bays", "Fill"),
    "model.equations.average": ("Average",),
    "model.equations.equation": ("Equation",),
    "model.equations.rigid_link": ("RigidLink",),
    "model.equations.seam": ("Seam",),
    "model.imported.component": ("Component",),
    "model.imported.imported_mesh": ("ImportedMesh",),
    "model.material": ("Material",),
    "model.materials.lay_up": ("Laminate", "Layer", "Smeared"),
    "model.materials.edge_wall": ("EdgeWall",),
    "model.materials.loss_by_frequency": ("LossByFrequency", "laboratory_losses", "measured_losses"),
    "model.materials.orthotropic": ("Orthotropic",),
    "model.materials.plate_section": ("PlateSection", "SectionShare"),
    "model.mesher": ("mesh_structure",),
    "model.model": ("Model",),
    "model.probe": ("Probe", "Surface"),
    "model.region": ("Region",),
    "model.section": ("Section",),
    "model.structure": ("Joint", "PlaceOn", "Structure", "Support", "SurfaceOn"),
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
    "sound.cavities": ("with_cavities",),
    "sound.placed": ("Placed", "placed"),
    "sound.placed_cavity": ("PlacedCavity", "placed_cavities"),
    "sound.room_source": ("velocity_per_source",),
    "sound.surface": ("surface_velocity",),
    "study.counting": ("FatigueRequest",),
    "study.result": ("StudyResult",),
    "study.structures": ("BeamModel", "ModesModel", "NoStructure", "OscillatorModel", "RodModel"),
    "study.acting": (
        "Covering",
        "InitialMotion",
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
        "FrfRequest",
        "Limit",
        "PeakRule",
        "Record",
        "RoomPlan",
        "Spot",
        "TimePlan",
    ),
    "study.study": (
        "Case",
        "Plan",
        "Study",
    ),
    "study.campaign.front": ("Front",),
    "study.campaign.sought": ("Found", "Goal", "Search"),
    "study.campaign.held_limits": ("held_limits",),
    "study.campaign.spread": ("spread",),
    "study.campaign.swept": ("Swept",),
    "study.campaign.varied": ("Campaign", "Listed", "Sampling", "Scattered"),
    "study.measured_source": ("MeasuredSource",),
    "study.steady_vibration": ("Vibration",),
    "workflow.identify.identify": ("Identification", "identify"),
    "workflow.identify.measured_data": ("MeasuredFiles",),
    "workflow.run.run": ("run_study",),
}
_HOMES = {name: f"femstruct.{module}" for module, names in _NAMES.items() for name in names}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'femstruct' has no attribute '{name}'")


def __dir__() -> list[str]:
    return __all__
