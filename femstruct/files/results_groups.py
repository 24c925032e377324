"""Groups of the results file: bases, blows, energies, sound, and answers to excitations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from acoustics.levels.rated import Interval, RatedRoom
from acoustics.room_response import RoomResponse
from femstruct.conventions import COMPONENTS
from femstruct.files.datasets import axis, group, put
from femstruct.files.described import write_described, write_rows
from femstruct.impact.response import Blow, EnergyBalance, EnergyLedger
from femstruct.impact.shares import ModeEnergies
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady import HarmonicAnswer, RandomAnswer
from femstruct.model.probe import Probe
from femstruct.study.asked import per_hertz
from femstruct.study.recorded import DAMPED_FORCE

if TYPE_CHECKING:
    import h5py


# ----------------------------------------------------------------------------------------------------------------------
# Modal bases in the results file: modes, forces of the structure, damping.
# ----------------------------------------------------------------------------------------------------------------------


def write_basis(target: h5py.Group, basis: ModalBasis) -> None:
    """Modes, shapes and forces of a basis."""
    count = len(basis.omega)
    target.attrs["complete_below_hz"] = basis.complete_below_hz
    mode = axis(target, "mode", np.arange(1, count + 1), "1", "Mode number, rigid-body modes counted")
    node = axis(target, "node", np.arange(len(basis.points)), "1", "Node number")
    component = axis(target, "component", list(COMPONENTS), "1", "Component of a node, global axes; TWIST local")
    direction = axis(target, "direction", ["x", "y", "z"], "1", "Global direction")
    put(target, "frequency_hz", basis.frequency_hz, "Hz", "Natural frequency", (mode,))
    put(target, "kind", list(basis.kind), "1", "rigid, elastic, or residual (completes a static response)", (mode,))
    put(target, "residual_norm", basis.residual_norm, "1", "Convergence of the eigenpair", (mode,))
    put(target, "modal_mass", basis.modal_mass, "kg", "Effective modal mass", (direction, mode))
    put(target, "points", basis.points, "m", "Nodes, global axes", (node, direction))
    put(target, "shapes", basis.shapes, "kg^-0.5", "Mass-normalised shapes", (node, component, mode), whole=0)
    if basis.outputs:
        rows = np.array([[row.stiffness, row.damping, row.inertia] for row in basis.outputs.values()])
        about = f"Force of a spring, foundation, support or joint, {DAMPED_FORCE} where a case has one"
        output = axis(target, "output", list(basis.outputs), "1", about)
        acts_on = axis(target, "acts_on", ["q", "qd", "qdd"], "1", "What the row multiplies, to be summed")
        put(
            target,
            "force_rows",
            rows,
            "N, N s, N s^2 per kg^0.5 m",
            "Forces, of undamped parts; what of a load passes straight on is in direct",
            (output, acts_on, mode),
        )
        passed = [(name, row.direct) for name, row in basis.outputs.items() if len(row.direct.weights)]
        if passed:
            _write_direct(group(target, "direct", "What of a load passes straight on to a force"), passed)
    if basis.part_stiffness:
        omega2 = np.where(basis.omega > 0, basis.omega, np.nan) ** 2
        share = np.array([np.diag(matrix) / omega2 for matrix in basis.part_stiffness.values()])
        part = axis(target, "part", list(basis.part_stiffness), "1", "Part of the structure")
        put(target, "strain_energy_share", share, "1", "Share of the strain energy; nan if rigid", (part, mode))


def _write_direct(target: h5py.Group, passed: Sequence[tuple[str, Probe]]) -> None:
    """Entries of the sparse rows of `ForceRow.direct`: loads on held and joined nodes, times the weight, add to it."""
    names = [name for name, probe in passed for _ in probe.weights]
    nodes, components, weights = (
        np.concatenate([getattr(probe, word) for _, probe in passed]) for word in ("nodes", "components", "weights")
    )
    entry = axis(target, "entry", np.arange(1, len(names) + 1), "1", "Number")
    put(target, "output", names, "1", "Force that it adds to", (entry,))
    put(target, "node", nodes, "1", "Node that the load acts on", (entry,))
    put(target, "component", [COMPONENTS[i] for i in components], "1", "Its component, global axes", (entry,))
    put(target, "weight", weights, "N per unit load", "Share of the load", (entry,))


def write_damping(target: h5py.Group, basis: ModalBasis) -> None:
    """The damping that a basis has in a case."""
    numbers = np.arange(1, len(basis.omega) + 1)
    pair = tuple(axis(target, name, numbers, "1", "Mode number") for name in ("mode", "other_mode"))
    put(target, "damping_ratio", basis.damping_ratio, "1", "Damping ratio; nan for rigid-body modes", pair[:1])
    put(target, "viscous", basis.viscous, "rad/s", "Viscous damping, 2 zeta omega on the diagonal", pair)
    put(target, "hysteretic", basis.hysteretic, "rad^2/s^2", "Structural damping, eta omega^2 on the diagonal", pair)


# ----------------------------------------------------------------------------------------------------------------------
# Blows of bodies that strike several times, in the results file.
# ----------------------------------------------------------------------------------------------------------------------


def write_blows(target: h5py.Group, blows: Sequence[Blow]) -> None:
    """A table of all blows, in the order of time."""
    blow = axis(target, "blow", np.arange(1, len(blows) + 1), "1", "Blow of any body, in the order of time")
    put(target, "body", [one.body for one in blows], "1", "Which body", (blow,))
    write_rows(target, blows, blow)


# ----------------------------------------------------------------------------------------------------------------------
# Where the energy of an impact is and went, as groups of the results file.
# ----------------------------------------------------------------------------------------------------------------------


def write_energy(target: h5py.Group, ledger: EnergyLedger, shares: ModeEnergies | None) -> None:
    """The ledger over time, what was lost and to what, and the structure's energy by modes and by what holds it."""
    energy = group(target, "energy", "The energy ledger, every term by itself")
    time = axis(energy, "time", ledger.t, "s", "Time since the start")
    write_described(energy, ledger)
    if ledger.bodies:
        body = axis(energy, "body", list(ledger.bodies), "1", "Name")
        rows = np.array(list(ledger.bodies.values()))
        put(energy, "bodies", rows, "J", "Kinetic and potential energy of the bodies", (body, time))
    _write_lost(group(energy, "lost", "What was dissipated, by what took it"), ledger, shares)
    if shares is not None and shares.end:
        modes = group(energy, "modes", "The structure's energy by modes: groups that add up to it")
        one = axis(modes, "group", [part.name for part in shares.end], "1", "Mode, modes of an octave, or rigid modes")
        put(modes, "from_hz", [part.from_hz for part in shares.end], "Hz", "Lowest natural frequency", (one,))
        put(modes, "to_hz", [part.to_hz for part in shares.end], "Hz", "Highest natural frequency", (one,))
        put(modes, "end", [part.energy for part in shares.end], "J", "At the end of the window", (one,))
        if shares.at_separation is not None:
            parted = [part.energy for part in shares.at_separation]
            put(modes, "at_separation", parted, "J", "When the collision was over", (one,))
    if shares is not None and shares.held_at_end:
        parts = group(energy, "held_by", "The same by what holds it: structure, air of rooms, walls that yield")
        one = axis(parts, "holder", list(shares.held_at_end), "1", "Name")
        put(parts, "end", list(shares.held_at_end.values()), "J", "At the end of the window", (one,))
        if shares.held_at_separation:
            put(parts, "at_separation", list(shares.held_at_separation.values()), "J", "When it was over", (one,))


def _write_lost(target: h5py.Group, ledger: EnergyLedger, shares: ModeEnergies | None) -> None:
    """Losses in the modes, in the structure's own dashpots, and in those of every contact and link, until the
    separation and until the end; and over time, where modes and dashpots of the structure are one."""

    def lost(balance: EnergyBalance | None, dashpots: float) -> list[float]:
        if balance is None:
            return [np.nan] * len(names)
        own = [balance.lost_modes - dashpots, dashpots]
        return [*own, *balance.lost_contacts.values(), *balance.lost_links.values()]

    end = ledger.end
    then, at_end = (0.0, 0.0) if shares is None else (shares.dashpots_at_separation or 0.0, shares.dashpots_at_end)
    kinds = ["structure", "structure", *["contact"] * len(end.lost_contacts), *["link"] * len(end.lost_links)]
    names = ["modes", "dashpots", *end.lost_contacts, *end.lost_links]
    taker = axis(target, "taker", names, "1", "Modes, dashpots of the structure, a contact or a link")
    put(target, "kind", kinds, "1", "structure, contact or link", (taker,))
    parted = lost(ledger.at_separation, then)
    put(target, "at_separation", parted, "J", "When the collision was over; nan if never", (taker,))
    put(target, "end", lost(end, at_end), "J", "At the end of the window", (taker,))
    histories = [ledger.lost_modes, *ledger.lost_contacts.values(), *ledger.lost_links.values()]
    where = ["structure", *ledger.lost_contacts, *ledger.lost_links]
    place = axis(target, "place", where, "1", "The structure with its dashpots, a contact or a link")
    target["time"] = target.parent["time"]
    put(target, "until_now", np.array(histories), "J", "Lost until now", (place, "time"))


# ----------------------------------------------------------------------------------------------------------------------
# Pressures and levels in the results file.
# ----------------------------------------------------------------------------------------------------------------------


def write_room(target: h5py.Group, response: RoomResponse) -> None:
    """Pressure histories and spectra at the receivers of one room."""
    time = axis(target, "time", response.t, "s", "Time since the start")
    frequency = axis(target, "frequency_hz", response.frequency_hz, "Hz", "Frequency")
    receiver = axis(target, "receiver", [item.name for item in response.receivers], "1", "Receiver")
    direction = axis(target, "direction", ["x", "y", "z"], "1", "Axis of the room, from its lower corner")
    places = np.array([item.position for item in response.receivers])
    put(target, "position", places, "m", "Where the receivers are", (receiver, direction))
    target.attrs["complete_below_hz"] = response.complete_below_hz  # the sound ends there
    put(target, "pressure", response.p, "Pa", "Pressure, positive when compressed", (receiver, time))
    put(target, "spectrum", response.spectrum, "Pa/Hz", "dt rfft(pressure), no window", (receiver, frequency))


def write_own(target: h5py.Group, own: RoomResponse, total: RoomResponse) -> None:
    """Beside the pressure that the structure radiates, that of the striking bodies themselves, and the sum."""
    both = ("receiver", "time")
    put(target, "own_pressure", own.p, "Pa", "Pressure that the striking bodies make themselves", both)
    put(target, "total_pressure", total.p, "Pa", "Sum of pressure and own_pressure", both)


def write_rated(target: h5py.Group, rated: RatedRoom) -> None:
    """A room as the standards state it, with the levels of every drop at every receiver that it is made of."""
    write_described(target, rated.method)
    if rated.numbers:
        symbol = axis(target, "symbol", list(rated.numbers), "1", "Single number, the first the one to state")
        write_rows(target, list(rated.numbers.values()), symbol)
        for name, spreads in (("drops", rated.drops_spread_db), ("receivers", rated.receivers_spread_db)):
            description = f"Standard deviation of the number over {name}; nan for one"
            put(target, f"{name}_spread_db", list(spreads.values()), "dB", description, (symbol,))
        blank = Interval(np.nan, np.nan, np.nan)
        own = np.array([rated.number_intervals.get(one, blank) for one in rated.numbers])
        for column, word in enumerate(("mean", "lower end of the 90 % interval", "upper end of it")):
            name, description = f"number_{('mean', 'low', 'high')[column]}_db", f"Number over rooms and places: {word}"
            put(target, name, own[:, column], "dB", description, (symbol,))
    axis(target, "band_hz", list(rated.bands_hz), "Hz", f"Nominal centre of the {rated.method.bands}")
    axis(target, "drop", np.arange(1, rated.drops + 1), "1", "Place of the source, in the order of the study")
    axis(target, "receiver", np.arange(1, rated.receivers + 1), "1", "Receiver, in the order of the room")
    write_described(target, rated)
    if rated.ensemble is not None:
        beside = group(target, "ensemble", "Low bands over rooms of nearly one size and places")
        axis(beside, "band_hz", list(rated.bands_hz), "Hz", f"Nominal centre of the {rated.method.bands}")
        axis(beside, "member", np.arange(1, len(rated.ensemble.members_db) + 1), "1", "Number of the member")
        write_described(beside, rated.ensemble)
    if rated.statistical is not None:
        beside = group(target, "statistical_bands", "The same bands by statistical energies of plate and room")
        axis(beside, "band_hz", list(rated.bands_hz), "Hz", f"Nominal centre of the {rated.method.bands}")
        write_described(beside, rated.statistical)
        if rated.agreement is not None:
            write_described(beside, rated.agreement)


# ----------------------------------------------------------------------------------------------------------------------
# What answers harmonic and random excitations, in the results file: one table along frequency for all channels.
# ----------------------------------------------------------------------------------------------------------------------

FORCES: Final = f", {DAMPED_FORCE}"


def write_answers(target: h5py.Group, answers: Mapping[str, HarmonicAnswer | RandomAnswer]) -> None:
    """A dataset for every answer to one excitation, along the frequencies of that, which stand in the group around."""
    target["frequency_hz"] = target.parent["frequency_hz"]
    for channel, answer in answers.items():
        where = {"where": answer.where or None}
        if isinstance(answer, HarmonicAnswer):
            most = {"largest": answer.largest, "largest_at_hz": answer.largest_at_hz, **where}
            about = f"Amplitude, exp(+j omega t){FORCES if channel.endswith(' force') else ''}"
            put(target, channel, answer.values, answer.unit, about, ("frequency_hz",), most)
            continue
        numbers = {"rms": answer.rms, "zero_upcrossings_hz": answer.crossings, "expected_peak": answer.peak, **where}
        about = f"Power spectral density, one-sided{FORCES if channel.endswith(' force') else ''}"
        put(target, channel, answer.psd, per_hertz(answer.unit), about, ("frequency_hz",), numbers)
