"""The asked accuracy of an impact: modes are added until what was recorded no longer changes by more.

A basis is compared with one complete to twice its frequency, residual vectors on both, over the first impact only:
what leaves out modes of a frequency errs there by something that falls with the frequency, at least as its inverse.
Then the larger basis errs by no more than the two differ, and the smaller one by no more than twice that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.resampled import FOLDED, average_motion, last_mode_hz
from femstruct.impact.response import Response
from femstruct.impact.scene import Clock
from femstruct.impact.simulate import simulate
from femstruct.model.model import Model
from femstruct.parts.wave_findings import CELLS_PER_WAVE, mesh_limit_hz
from femstruct.study.asked import AccuracyRule, Extent
from femstruct.study.results import AccuracyCheck, Deviation
from femstruct.study.structures import BeamModel, RodModel
from femstruct.study.study import Case
from femstruct.units import readable_unit
from femstruct.workflow.bases import Solved, damp_basis, key_of, solve
from femstruct.workflow.coupled_air import couple_rooms
from femstruct.workflow.recorded_channels import (
    AT_REST,
    STRESS,
    UNITS,
    before_start,
    closings,
    first_window,
    histories,
    in_band,
    walk_stresses,
)
from femstruct.workflow.staging import build_scene

GROWTH = 2  # in frequency, or in the number of modes of a closed-form structure
MOST_GROWTHS = 6
MOST_MODES = 4000  # the matrices of a basis are full: 128 MB each
FEWEST_SAMPLES = 64
FAINT = 1e-6  # of the largest peak of its unit: a fainter channel is compared with that, not with itself


@dataclass(frozen=True, eq=False)
class Run:
    """What one basis makes of the first impact: filtered channels [nt] at t, peaks [N] of the contacts, its end [s]."""

    channels: Mapping[str, tuple[Floats, str]]
    contacts: Mapping[str, float]
    t: Floats
    window: float


def hold_accuracy(
    cases: Sequence[Case], baseline: Case, solved: Mapping[str, Solved]
) -> tuple[dict[str, Solved], dict[str, AccuracyCheck]]:
    """The bases that every case needs for the accuracy it asks for, and what was compared, both by case name.

    Cases of one structure share the basis that the most demanding of them needs, so that they differ only by what
    happens; cases that ask for nothing keep theirs unless they share it.
    """
    final, checks = dict(solved), dict[str, AccuracyCheck]()
    groups: dict[str, list[Case]] = {}
    for case in sorted(cases, key=lambda case: case.name != baseline.name):  # others take their damping from its basis
        groups.setdefault(solved[case.name].key, []).append(case)
    for members in groups.values():
        own = any(case.name == baseline.name for case in members)
        found, compared = _climb(members, solved[members[0].name], baseline, None if own else final[baseline.name])
        final |= {case.name: found for case in members}
        checks |= compared
    return final, checks


def accuracy_findings(check: AccuracyCheck) -> tuple[Finding, ...]:
    """A severe finding where the asked accuracy does not hold, with both numbers."""
    worst = check.worst
    if check.holds or worst is None:
        return ()
    name, deviation = worst
    low, high = check.band
    factor, unit = readable_unit(deviation.unit, max(deviation.smaller, deviation.larger))
    return (
        Finding(
            "accuracy-not-reached",
            f"The required accuracy of {100 * check.within:g} % between {low:g} and {high:g} Hz is not reached: "
            f"{name} is "
            f"{factor * deviation.smaller:.4g} {unit} with the modes up to {check.smaller_hz:.5g} Hz and "
            f"{factor * deviation.larger:.4g} {unit} with those up to {check.larger_hz:.5g} Hz, "
            f"{100 * deviation.share:.2g} % apart at most. {check.stopped}",
            {
                "asked": check.within,
                "reached": deviation.share,
                "smaller": deviation.smaller,
                "larger": deviation.larger,
                "smaller_hz": check.smaller_hz,
                "larger_hz": check.larger_hz,
            },
            severe=True,
        ),
    )


def _climb(
    members: Sequence[Case], first: Solved, baseline: Case, reference: Solved | None
) -> tuple[Solved, dict[str, AccuracyCheck]]:
    """Grow the basis of one structure until it does for all its cases.

    Parameters
    ----------
    reference : Solved | None
        The baseline's, if it is another.
    """
    asking = [case for case in members if case.study.accuracy is not None]
    if not asking or np.isinf(first.basis.complete_below_hz):
        return first, {case.name: _complete(_rule(case)) for case in asking}
    ladder = _Ladder(members, first)
    needed = first
    checks: dict[str, AccuracyCheck] = {}
    runs: dict[str, tuple[Clock, Run]] = {}
    for lower, higher in ladder.pairs():
        for case in asking:
            run, before = runs.get(case.name) or _first_run(case, lower, baseline, reference)
            clock = _showing(run, higher)
            if clock is not run:
                before = _run(case, lower, baseline, reference, clock)
            after = _run(case, higher, baseline, reference, clock)
            check = _compared(_rule(case), before, after, lower, higher, ladder.stopped)
            runs[case.name], checks[case.name] = (clock, after), check
            if not check.share <= 0.5 * check.within and _complete_to(higher) > _complete_to(needed):
                needed = higher
        asking = [case for case in asking if not checks[case.name].holds]
        if not asking:
            break
    used = needed.basis
    return needed, {
        name: replace(check, used_hz=used.complete_below_hz, used_modes=used.modes.stop)
        for name, check in checks.items()
    }


def _complete_to(solved: Solved) -> float:
    return solved.basis.complete_below_hz


@dataclass(frozen=True, eq=False)
class _Ladder:
    """Larger and larger bases of one structure, as far as its mesh and the study allow."""

    members: Sequence[Case]
    first: Solved

    @property
    def limit_hz(self) -> float:
        limits = [_rule(case).up_to_hz for case in self.members if case.study.accuracy is not None]
        most = np.inf if None in limits else max(hz for hz in limits if hz is not None)
        growths = MOST_GROWTHS
        while growths and self.first.basis.modes.stop * GROWTH**growths > MOST_MODES:
            growths -= 1
        most = min(most, self._reach(self.first, growths) * 1.001)
        return float(min(most, mesh_limit_hz(self.first.model))) if self.first.model is not None else float(most)

    @property
    def stopped(self) -> str:
        """Why there is no larger basis, and what to do."""
        model: Model | None = self.first.model
        limit = self.limit_hz
        if model is not None and limit == mesh_limit_hz(model):
            return (
                f"The mesh is fine enough for bending waves up to {limit:.5g} Hz ({CELLS_PER_WAVE:g} cells a "
                "wavelength): refine it, or "
                "ask for less accuracy"
            )
        return (
            f"The limit of the modes is {limit:.5g} Hz: raise accuracy.up_to or modes.up_to, or ask for less accuracy"
        )

    def pairs(self) -> Iterator[tuple[Solved, Solved]]:
        """Bases to compare, each with the next larger one; where none is larger, the smaller one with the first."""
        lower = self.first
        if not self._reach(lower) <= self.limit_hz:
            yield self._solved(lower, 1.0 / GROWTH), lower
        while not np.isinf(_complete_to(lower)) and self._reach(lower) <= self.limit_hz:
            higher = self._solved(lower, float(GROWTH))
            yield lower, higher
            lower = higher

    def _reach(self, solved: Solved, growths: int = 1) -> float:
        """About where the next bases are complete to [Hz]; a beam's frequencies go as the square of their number."""
        power = 2 if isinstance(self.first.structure, BeamModel) else 1
        return float(GROWTH ** (power * growths)) * _complete_to(solved)

    def _solved(self, solved: Solved, factor: float) -> Solved:
        study = self.members[0].study
        structure, extent = solved.structure, study.extent
        if isinstance(structure, RodModel | BeamModel):
            structure = replace(structure, modes=max(round(factor * structure.modes), 1))
        else:
            extent = Extent(up_to_hz=factor * _complete_to(solved))
        grown = replace(study, structure=structure, extent=extent)
        return solve(structure, extent, [one for case in self.members for one in case.studies], key_of(grown))


def _rule(case: Case) -> AccuracyRule:
    assert case.study.accuracy is not None
    return case.study.accuracy


def _first_run(case: Case, lower: Solved, baseline: Case, reference: Solved | None) -> tuple[Clock, Run]:
    """The first impact on the smallest basis, and a clock that lasts as long: it is often short in a long window."""
    study = case.study
    assert study.time is not None
    time, rule = study.time, _rule(case)
    tail = 2.0 / rule.band[1]  # the filter's own, which is behind the window where the window does not end a contact
    whole = Clock(time.duration, time.sampling, time.quiet)
    guess = 2.0 * study.peaks.first_impact if study.peaks.first_impact is not None else 0.02
    duration = min(max(guess + tail, FEWEST_SAMPLES / time.sampling), time.duration)
    while True:
        clock = replace(whole, duration=duration)
        response = _response(case, lower, baseline, reference, clock)
        end = first_window(study.peaks, response)
        seen = end + tail if study.peaks.first_impact is not None else end
        waits = any(contact.preload == 0.0 for contact in response.scene.contacts) and not closings(response)
        if duration == time.duration or (not waits and end < response.t[-1] and seen <= duration):
            return clock, _digest(case, lower, response)
        duration = min(4.0 * duration, time.duration)


def _showing(clock: Clock, solved: Solved) -> Clock:
    """A clock whose samples show all modes of a basis where they are: with fewer, those above half the sampling would
    be seen in the band."""
    times = ceil(FOLDED * last_mode_hz(solved.basis) / clock.sampling)
    return clock if times <= 1 else replace(clock, sampling=times * clock.sampling)


def _run(case: Case, solved: Solved, baseline: Case, reference: Solved | None, clock: Clock) -> Run:
    return _digest(case, solved, _response(case, solved, baseline, reference, clock))


def _response(case: Case, solved: Solved, baseline: Case, reference: Solved | None, clock: Clock) -> Response:
    basis = damp_basis(case, {baseline.name: reference or solved, case.name: solved}, baseline)
    basis, _ = couple_rooms(basis, case.study.rooms, solved.places)
    return simulate(basis, build_scene(case.study, solved.places, basis), clock)


def _digest(case: Case, solved: Solved, response: Response) -> Run:
    rule, sampling = _rule(case), response.clock.sampling
    stressed = [record for record in case.study.records if record.what == STRESS]
    others = tuple(record for record in case.study.records if record not in stressed)
    plain = histories(replace(case.study, rooms=(), records=others), solved.places, average_motion(response))
    before = before_start(case.study, solved.places, response)
    channels = {
        name: (in_band(values, sampling, rule.band, before.get(name, AT_REST)), unit)
        for name, (values, unit) in plain.items()
    }
    for record in stressed:
        rows = solved.places.stresses(record.target, f"record.{record.target}")
        moved_in_band = in_band(response.q, sampling, rule.band)
        channels[str(record)] = (walk_stresses(rows, response.basis.shapes, moved_in_band).history, UNITS[STRESS])
    window = first_window(case.study.peaks, response)
    within = response.t <= window
    return Run(
        channels,
        {
            name: c.peak_force if c.peak_time <= window else float(c.force[within].max(initial=0.0))
            for name, c in response.contacts.items()
        },
        response.t,
        window,
    )


def _compared(
    rule: AccuracyRule, before: Run, after: Run, lower: Solved, higher: Solved, stopped: str
) -> AccuracyCheck:
    end = float(before.t[-1])
    end -= min(1.0 / rule.band[1], 0.5 * end)  # the filter does not know what comes after
    window = min(before.window, after.window, end)
    within = before.t <= window
    found: dict[str, tuple[str, float, float, float]] = {}
    for name, (values, unit) in before.channels.items():
        a, b = values[within], after.channels[name][0][within]
        found[name] = (unit, _largest(a), _largest(b), _largest(a - b))
    for name, peak in before.contacts.items():
        found[f"{name} peak force"] = ("N", peak, after.contacts[name], abs(peak - after.contacts[name]))
    largest = {unit: max(larger for u, _, larger, _ in found.values() if u == unit) for unit, *_ in found.values()}
    deviations = {}
    for name, (unit, smaller, larger, difference) in found.items():
        scale = max(larger, FAINT * largest[unit])
        deviations[name] = Deviation(unit, smaller, larger, difference, difference / scale if scale > 0.0 else 0.0)
    holds = all(deviation.share <= rule.within for deviation in deviations.values())
    return AccuracyCheck(
        within=rule.within,
        band=rule.band,
        window=window,
        smaller_hz=_complete_to(lower),
        larger_hz=_complete_to(higher),
        used_hz=_complete_to(higher),
        used_modes=higher.basis.modes.stop,
        deviations=deviations,
        holds=holds,
        stopped="" if holds else stopped,
    )


def _largest(values: Floats) -> float:
    return float(np.abs(values).max(initial=0.0))


def _complete(rule: AccuracyRule) -> AccuracyCheck:
    """Of a structure whose basis holds every mode there is: nothing is left out."""
    return AccuracyCheck(
        rule.within,
        rule.band,
        window=0.0,
        smaller_hz=np.inf,
        larger_hz=np.inf,
        used_hz=np.inf,
        used_modes=0,
        deviations={},
        holds=True,
        stopped="",
    )
