"""The forging press of chapter 4: a slider strikes the bed, a damper below it takes energy and hands it to the base."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import minimize_scalar

from femstruct.assembly.matrices import assemble
from femstruct.impact.batch import simulate_batch
from femstruct.impact.response import Response
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Ground, Link, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.models import read_model
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes
from femstruct.modal.reduction import modal_basis
from femstruct.model.probe import Probe

MODELS = Path(__file__).parents[2] / "models"
SLIDER, SPEED, BED, BASE = 1.2, 1.2, 10.0, 41.0  # [kg], [m/s], [kg], [kg], Table 4.1
SPRING, DASHPOT = 1.8e3, 7e2  # of the damper [N/m], [N s/m]
UNIT = 40.0  # omega_6 of the source's simulation, to which its figures refer all frequencies [rad/s]
START = 0.5 * SLIDER * SPEED**2  # E_s- [J]


@dataclass(frozen=True, eq=False)
class Machine:
    """An undamped press: its modes, where it is struck (bed) and where the damper stands (base)."""

    basis: ModalBasis
    bed: Probe
    base: Probe | Ground


@dataclass(frozen=True)
class Share:
    """Energies over the slider's at the start, at the first instant t [s] with slider and damper off the bed."""

    t: float
    machine: float
    damper: float
    slider: float


def two_modes(bed: float = 0.392, base: float = -0.07, heave: float = 0.14) -> Machine:
    """The source's two modes; bed, base : shape of the elastic one there; heave : of the other [1/sqrt(kg)]."""
    frequencies = [UNIT / (2.0 * np.pi), 1777.0 / (2.0 * np.pi)]
    basis, points = given_modes(frequencies, [0.0, 0.0], {"O_b": [heave, bed], "O_f": [heave, base]})
    return Machine(basis, points["O_b"].probe("z"), points["O_f"].probe("z"))


def fitted(up_to: float, *changes: str, model: str = "press") -> Machine:
    """The fitted press of models/ with all its modes up to a frequency [Hz], without residual vectors."""
    meshed = read_model(MODELS / f"{model}.yaml", changes)
    base = meshed.points["O_f"].probe("z") if "O_f" in meshed.points else GROUND
    return Machine(modal_basis(assemble(meshed), up_to=up_to), meshed.points["O_b"].probe("z"), base)


def setting(machine: Machine, ws: float, wd: float, damper: float) -> Scene:
    """ws, wd : contact frequencies [rad/s]; damper : its mass [kg], 0 for none. All touch at t = 0; z is up."""
    bodies = [Body("slider", SLIDER, -SPEED)]
    contacts = [Contact("slider", "slider", machine.bed, Linear(SLIDER * ws**2))]
    links: list[Link] = []
    if damper:
        bodies.append(Body("damper", damper))
        contacts.append(Contact("damper", machine.bed, "damper", Linear(damper * wd**2)))
        links.append(Link("mount", "damper", machine.base, stiffness=SPRING, opening=DASHPOT))
    return Scene(tuple(bodies), tuple(contacts), tuple(links))


def window(ws: float, wd: float) -> float:
    """Long enough for the first separation: two half periods of the slower contact, 20 ms at least [s]."""
    return max(20e-3, 2.0 * np.pi / min(ws, wd))


def blow(
    machine: Machine, ws: float, wd: float, damper: float, duration: float | None = None, samples: int = 10
) -> Response:
    """One blow; arguments as for `setting`."""
    length = duration or window(ws, wd)
    return simulate(machine.basis, setting(machine, ws, wd, damper), Clock(length, samples / length))


def share(machine: Machine, ws: float, wd: float, damper: float) -> Share:
    """Who has the energy after the collision; the damper's is that of its mass and its spring."""
    found = blow(machine, ws, wd, damper).ledger.at_separation
    if found is None:
        raise ValueError(f"slider and damper do not leave the bed at {ws:g} and {wd:g} rad/s")
    taken = found.bodies["damper"] + found.links["mount"] if damper else 0.0
    return Share(found.t, found.structure / START, taken / START, found.bodies["slider"] / START)


def machine_shares(machine: Machine, ws: np.ndarray, wd: np.ndarray, damper: float) -> np.ndarray:
    """The machine's share of `share` for many contact frequencies at once: ws, wd and the result of one shape."""
    slider, below = np.broadcast_arrays(ws, wd)
    vary = {"slider.stiffness": SLIDER * slider.ravel() ** 2}
    if damper:
        vary["damper.stiffness"] = damper * below.ravel() ** 2
    length = window(float(slider.min()), float(below.min()))
    scene = setting(machine, float(slider.flat[0]), float(below.flat[0]), damper)
    found = simulate_batch(machine.basis, scene, Clock(length, 10.0 / length), vary, 1)
    if not found.separated.all():
        i = int(np.argmin(found.separated))
        raise ValueError(f"slider and damper do not leave the bed at {slider.flat[i]:g} and {below.flat[i]:g} rad/s")
    shares: np.ndarray = (found.at_separation.structure / START).reshape(slider.shape)
    return shares


def ballasted(mass: float) -> Machine:
    """The two modes with a mass [kg] fixed to the middle of the bed: still two modes, of I + m phi phi^T."""
    machine = two_modes()
    bed = machine.bed.of(machine.basis.shapes)
    assert isinstance(machine.base, Probe)
    base = machine.base.of(machine.basis.shapes)
    values, vectors = eigh(np.diag(machine.basis.omega**2), np.eye(2) + mass * np.outer(bed, bed))
    points = {"O_b": bed @ vectors, "O_f": base @ vectors}
    basis, named = given_modes(np.sqrt(values) / (2.0 * np.pi), [0.0, 0.0], points)
    return Machine(basis, named["O_b"].probe("z"), named["O_f"].probe("z"))


def best_damper(machine: Machine, ws: float, damper: float) -> tuple[float, float]:
    """omega_d / omega_s that leaves the machine least energy, and that energy over the slider's."""
    grid = np.geomspace(0.4, 2.5, 15)
    values = [share(machine, ws, ratio * ws, damper).machine for ratio in grid]
    i = int(np.clip(np.argmin(values), 1, len(grid) - 2))
    found = minimize_scalar(
        lambda ratio: share(machine, ws, ratio * ws, damper).machine,
        bounds=(grid[i - 1], grid[i + 1]),
        method="bounded",
        options={"xatol": 1e-3},
    )
    return float(found.x), float(found.fun)


def worst_slider(machine: Machine, damper: float, low: float, high: float) -> float:
    """omega_s = omega_d between low and high [rad/s] that leaves the machine most energy."""
    grid = np.geomspace(low, high, 15)
    values = [share(machine, ws, ws, damper).machine for ws in grid]
    i = int(np.clip(np.argmax(values), 1, len(grid) - 2))
    found = minimize_scalar(
        lambda ws: -share(machine, ws, ws, damper).machine,
        bounds=(grid[i - 1], grid[i + 1]),
        method="bounded",
        options={"xatol": 1.0},
    )
    return float(found.x)
