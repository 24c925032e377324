"""What all samples of a batch share, and which numbers of theirs it makes: by the batch engine and from histories."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Final

import numpy as np

from acoustics.errors import Advice
from femstruct.arrays import Floats
from femstruct.campaign.batch.heard_rows import HeardRooms, heard_rooms, level_names, main_names
from femstruct.campaign.numbers import MODES
from femstruct.campaign.tasks import Task, read_sample
from femstruct.errors import Finding
from femstruct.impact.batch.batch import simulate_batch
from femstruct.impact.batch.metrics import Batch, Energies
from femstruct.impact.batch.vary import numbers_of_scene
from femstruct.impact.scene.bodies import Scene
from femstruct.modal.basis import ModalBasis
from femstruct.study.result import CaseResult
from femstruct.study.study import Case, Plan
from femstruct.workflow.run.case import known_before
from femstruct.workflow.run.impact_alone import impact_alone
from femstruct.workflow.run.struck import clock_of
from femstruct.workflow.stages.fingerprint import fingerprint
from femstruct.workflow.stages.modal_bases import Solved, damped, solve_all
from femstruct.workflow.stages.staging import scene as staged


@dataclass(frozen=True, eq=False)
class Stage:
    """What all samples share, by case: solved structures, damped bases, scenes of the first sample, who listens, codes
    of what is known before an impact and of what of it forbids trust."""

    plan: Plan
    solved: Mapping[str, Solved]
    bases: Mapping[str, ModalBasis]
    scenes: Mapping[str, Scene]
    rooms: Mapping[str, HeardRooms]
    codes: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]]

    def batch(self, case: Case, columns: Mapping[str, Floats], runs: int, threads: int) -> Batch:
        """So many runs of a case, which differ in columns; all the same where there are none."""
        scene, time = self.scenes[case.name], case.study.time
        assert time is not None
        if not columns:
            name, value = next(iter(numbers_of_scene(scene).items()))
            columns = {name: np.full(runs, value)}
        listener = self.rooms[case.name].listener if case.name in self.rooms else None
        return simulate_batch(self.bases[case.name], scene, clock_of(time), columns, threads, listener=listener)

    def history(self, case: Case, scene: Scene) -> CaseResult:
        """A run of a case whose scene this is, with its history."""
        own = self.solved[case.name]
        return impact_alone(case, own.key, own.places, self.bases[case.name], scene)

    def offered(self, case: Case, batch: Batch) -> dict[str, tuple[Floats, str]]:
        """All numbers of the runs of a case, with their units, named as in a full row."""
        found = offered(batch, self.bases[case.name])
        for record in case.study.records:  # a full row has these in place of the peak forces
            if record.what == "force" and record.target in batch.peak_force:
                found[str(record)] = found.pop(f"{record.target} peak force")
        if case.name in self.rooms:
            levels = dict(zip(self.rooms[case.name].names, batch.heard.T, strict=True))
            found |= {name: (one, "dB") for name, one in levels.items()}
            found |= {name: (levels[of], "dB") for name, of in main_names(case.study).items()}
        return found


def offered(batch: Batch, basis: ModalBasis) -> dict[str, tuple[Floats, str]]:
    """All numbers of impacts that the batch engine has, [runs] with their units, named as in a full row."""
    runs = len(batch.status)
    parted = np.isfinite(batch.at_separation.t)
    found = {"structure energy": (np.where(parted, batch.at_separation.structure, batch.end.structure), "J")}
    for name, peak in batch.peak_force.items():
        table = f"contacts / {name} /"
        found |= {
            f"{name} peak force": (peak, "N"),
            f"{table} peak_force_n": (peak, "N"),
            f"{table} peak_time_s": (batch.peak_time[name], "s"),
            f"{table} closings": (batch.closings[name], ""),
            f"{table} first_open_s": (batch.first_open[name], "s"),
        }
    found |= {f"bodies / {name} / end_velocity": (one, "") for name, one in batch.end_velocity.items()}
    for when, energies in (("at_separation", batch.at_separation), ("end", batch.end)):
        found |= {f"energy / {when} / {name}": one for name, one in _balance(energies).items()}
    found["energy / ledger_residual"] = batch.residual, ""
    for number, omega in enumerate(basis.omega[basis.modes][:MODES], 1):
        found[f"mode {number} frequency"] = np.full(runs, float(omega) / (2.0 * pi)), "Hz"
    found["total mass"] = np.full(runs, basis.total_mass), "kg"
    return found


def _balance(one: Energies) -> dict[str, tuple[Floats, str]]:
    """Energies at one instant; those lost in dashpots of the structure are not told from those lost in modes."""
    stored = sum((*one.contacts.values(), *one.links.values()), np.zeros_like(one.t))
    lost = {f"lost / contacts / {name}": energy for name, energy in one.lost_contacts.items()}
    lost |= {f"lost / links / {name}": energy for name, energy in one.lost_links.items()}
    energies = {
        **one.bodies,
        "structure": one.structure,
        "stored": stored,
        "dissipated": sum(lost.values(), one.lost_modes),
        **lost,
        "work": one.work,
        "blows": one.blows,
    }
    return {"t_s": (one.t, "s"), **{name: (energy, "J") for name, energy in energies.items()}}


def stage_of(first: Task, only: tuple[str, ...]) -> Stage:
    """The stage of a sample, for numbers to be made of it; that of the last task where it is the same.

    Raises what reading, solving and staging raise.
    """
    plan = read_sample(first, first.samples[0][1])
    key = fingerprint((dict(plan.sources), first.overrides, first.case, first.samples, only))
    if key not in _STAGES:
        stage = _made(plan, only)
        _STAGES.clear()
        _STAGES[key] = stage
    return _STAGES[key]


def _made(plan: Plan, only: Sequence[str]) -> Stage:
    solved = solve_all(plan.cases)
    baseline = next(case for case in plan.cases if case.name == plan.baseline)
    bases = {case.name: damped(case, solved, baseline) for case in plan.cases}
    scenes = {case.name: staged(case.study, solved[case.name].places, bases[case.name]) for case in plan.cases}
    codes, rooms = {}, {}
    for case in plan.cases:
        study, own, basis = case.study, solved[case.name], bases[case.name]
        found: list[Finding | Advice] = [*known_before(case, own, basis, None)]
        if study.time is not None and not {*level_names(study), *main_names(study)}.isdisjoint(only):
            rooms[case.name] = heard_rooms(study, own.places, basis, scenes[case.name], clock_of(study.time))
            found += rooms[case.name].told
        severe = dict.fromkeys(one.code for one in found if isinstance(one, Finding) and one.severe)
        codes[case.name] = tuple(dict.fromkeys(one.code for one in found)), tuple(severe)
    return Stage(plan, solved, bases, scenes, rooms, codes)


_STAGES: Final[dict[str, Stage]] = {}  # of this process, the latest
