"""What a person reads in the terminal: tables of modes, cases and findings."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from rich.console import Console

from femstruct.errors import Finding
from femstruct.files.tables import findings_by_case
from femstruct.impact.shares import energy_shares
from femstruct.study.result import AccuracyCheck, CaseComparison, CaseResult, StudyResult
from femstruct.view.arrays import arrays
from femstruct.view.blows import blows
from femstruct.view.grid import Grid
from femstruct.view.machine import limits, machine
from femstruct.view.rated import rated

Row = Mapping[str, Any]
DUST = 1e-6  # rad: a micrometre a metre is rounding, or nobody's concern
TOLD = 0.01  # share of the energy from which on a terminal names what has it
SPOKEN_HZ = 500.0  # modes above it are in summary.json; a terminal shows those that floors and presses are judged by


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A line that says what is being computed, on a terminal; silence in a pipe."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda line: None
        return
    with console.status("") as status:
        yield status.update


def show_study(result: StudyResult, written: Mapping[str, float], folder: str = "") -> None:
    """Cases side by side: outcome, machine, limits, peaks, contacts, energy, levels, changes, findings, timings."""
    console = _console()
    console.print(result.plan.title, style="bold")
    for name, case in result.cases.items():
        if case.response is not None:
            console.print(f"  {name}: {case.response.outcome.value}")
    for name, case in result.cases.items():
        if case.accuracy is not None:
            console.print(f"  {name}: {_accuracy(case.accuracy)}", soft_wrap=True)
    for table in (
        machine(result),
        limits(result),
        _peaks(result),
        _contacts(result),
        blows(result),
        _energies(result),
        _whither(result),
        arrays(result),
        _levels(result),
        rated(result),
        _modes_db(result),
    ):
        table.show(console)
    _show_findings(
        console,
        [
            (finding, "" if len(cases) in (0, len(result.cases)) else _in_cases(cases))
            for finding, cases in findings_by_case(result)
        ],
    )
    _show_timings(console, {**result.timings, **written})
    if folder:
        console.print(f"written to {folder}")


def show_modes(table: Row) -> None:
    """Mode numbers, frequencies, damping ratios, kinds and effective masses."""
    console = _console()
    grid = Grid(
        table["title"], ("mode", "frequency [Hz]", "damping ratio", "kind", "x [%]", "y [%]", "z [%] of the mass")
    )
    for i, frequency in enumerate(table["frequency_hz"]):
        ratio = table["damping_ratio"][i]
        shares = [_percentage(table["modal_mass_kg"][axis][i], table["mass_kg"]) for axis in "xyz"]
        grid.add(
            str(i + 1),
            f"{frequency:.2f}",
            "" if ratio is None else f"{100 * ratio:.2f} %",
            table["kind"][i],
            *shares,
        )
    grid.show(console)
    if table["mass_kg"]:
        console.print(f"mass {table['mass_kg']:.4g} kg")
    if told := _completeness(table["complete_below_hz"]):
        console.print(told)
    _show_findings(console, _read(table["findings"]))


def show_frf(table: Row) -> None:
    """A frequency response as columns: frequency, magnitude, phase."""
    print(f"# {table['kind']} {table['response']} / {table['drive']}, {table['method']}, {table['unit']}")
    print("# frequency_hz real imag")
    for line in zip(table["frequency_hz"], table["real"], table["imag"], strict=True):
        print("{:.6g} {:.8e} {:.8e}".format(*line))


def show_inspection(table: Row, picture: str = "") -> None:
    """What `check` found: masses, box, degrees of freedom, rigid modes, damping, sags, blocks, rooms, findings."""
    console = _console()
    console.print(table["title"], style="bold")
    if table["masses_kg"]:
        grid = Grid("masses", ("part", "mass [kg]"))
        for name, mass in table["masses_kg"].items():
            grid.add(name, f"{mass:.5g}")
        grid.add("all", f"{table['mass_kg']:.5g}")
        grid.show(console)
        low, high = table["box_m"]
        console.print("box " + " x ".join(f"{b - a:.4g}" for a, b in zip(low, high, strict=True)) + " m")
        console.print(", ".join(f"{count} {name}" for name, count in table["counts"].items()))
    if table["degrees_of_freedom"] is not None:
        console.print(f"{table['degrees_of_freedom']} degrees of freedom")
    console.print(f"{table['rigid_body_modes']} rigid-body modes; first frequencies [Hz]: " + _first(table))
    for sentence in table["damping"]:
        console.print(sentence)
    for name, position in table["points_m"].items():
        console.print(f"point {name} at ({', '.join(f'{x:.4g}' for x in position)}) m")
    for body, rest in table["rest"].items():
        console.print(f"{body}: weight {rest['weight_n']:.4g} N sags {1e3 * rest['sag_m']:.3g} mm on its links")
    for part, sag in table["sags"].items():
        seen = sag["tilt_rad"] is not None and sag["tilt_rad"] > DUST
        leaning = f" and leans by {1e3 * sag['tilt_rad']:.2g} mm a metre" if seen else ""
        console.print(f"{part} sags {1e3 * sag['sag_m']:.3g} mm under the weight of all{leaning}")
    for mode in table["block_modes"]:
        shares = ", ".join(f"{name} {100 * share:.0f} %" for name, share in mode["shares"].items())
        damped = "" if mode["damping_ratio"] is None else f", damping {100 * mode['damping_ratio']:.3g} %"
        console.print(f"mode {mode['mode']}, {mode['frequency_hz']:.2f} Hz{damped}: {shares}")
    for name, room in table["rooms"].items():
        ratios = ", ".join(f"{100 * ratio:.3g} % at {f} Hz" for f, ratio in room["damping_ratio"].items())
        first = ", ".join(f"{f:.1f}" for f in room["first_modes_hz"])
        console.print(f"room {name}: {room['coupling']} coupling; first modes {first} Hz; damping {ratios}")
    _show_findings(console, _read(table["findings"]))
    if picture:
        console.print(f"picture: {picture}")


def _first(table: Row) -> str:
    elastic = [f"{f:.2f}" for f in table["first_frequencies_hz"][table["rigid_body_modes"] :]]
    return ", ".join(elastic[:6])


def _console() -> Console:
    return Console(width=None if sys.stdout.isatty() else 160, highlight=False, markup=False)


def _completeness(below_hz: float | None) -> str:
    """Which modes are proven to be here: below a frequency, all of them (None), or none (0).

    >>> _completeness(None), _completeness(0.0), _completeness(512.0)
    ('all modes of the structure are here', '', 'no mode is missing below 512 Hz')
    """
    if below_hz is None:
        return "all modes of the structure are here"
    return f"no mode is missing below {below_hz:.5g} Hz" if below_hz > 0.0 else ""


def _percentage(part: float, whole: float) -> str:
    return f"{100 * part / whole:.1f}" if whole else "-"


def _accuracy(check: AccuracyCheck) -> str:
    """What more modes still change, and which are used."""
    if check.worst is None:
        return "accuracy: the basis holds every mode there is"
    name, worst = check.worst
    return (
        f"accuracy: {name} {worst.smaller:.4g} / {worst.larger:.4g} {worst.unit} with the modes up to "
        f"{check.smaller_hz:.5g} / {check.larger_hz:.5g} Hz, at most {100 * worst.share:.2g} % apart in "
        f"{check.band[0]:g} to {check.band[1]:g} Hz until {1e3 * check.window:.4g} ms; {100 * check.within:g} % asked; "
        f"used: {check.used_modes} modes up to {check.used_hz:.5g} Hz"
    )


def _peaks(result: StudyResult) -> Grid:
    grid = Grid(f"peaks: first impact / whole window ({result.comparison.filter})", ("", *result.cases))
    names = list(dict.fromkeys(name for case in result.cases.values() for name in case.channels))
    for name in names:
        unit = next(case.channels[name].unit for case in result.cases.values() if name in case.channels)
        grid.add(f"{name} [{unit}]", *(_peak(result, case, name) for case in result.cases))
    return grid


def _peak(result: StudyResult, case: str, name: str) -> str:
    channel = result.cases[case].channels.get(name)
    if channel is None:
        return "-"
    beside = result.comparison.cases.get(case)
    change = beside.peaks.get(name) if beside else None
    texts = [f"{channel.first_impact:.4g} / {channel.whole:.4g}"]
    if change is not None:
        texts.append(f"{_percent(change.first_impact_percent)} / {_percent(change.whole_percent)}")
    return "\n".join(texts)


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{value:+.1f} %"


def _contacts(result: StudyResult) -> Grid:
    grid = Grid("contacts", ("", "case", "peak force [N]", "closings", "first opens [ms]"), keys=2)
    for case_name, case in result.cases.items():
        if case.response is None:
            continue
        for name, contact in case.response.contacts.items():
            opens = "never" if contact.first_open is None else f"{1e3 * contact.first_open:.3f}"
            grid.add(name, case_name, f"{contact.peak_force:.4g}", str(contact.closings), opens)
    return grid


def _energies(result: StudyResult) -> Grid:
    grid = Grid(
        "energy [mJ]",
        ("case", "when", "t [ms]", "bodies", "structure", "contacts, links", "dissipated", "ledger residual"),
        keys=3,
    )
    for name, case in result.cases.items():
        if case.response is None:
            continue
        ledger = case.response.ledger
        for label, balance in (("start", ledger.start), ("separation", ledger.at_separation), ("end", ledger.end)):
            if balance is None:
                grid.add(name, label, "never", "", "", "", "", "")
                continue
            energies: dict[str, float] = {}
            for body, energy in balance.bodies.items():  # an array of bodies is told as one
                array = body.rpartition(".")[0] or body
                energies[array] = energies.get(array, 0.0) + energy
            bodies = ", ".join(f"{body} {1e3 * energy:.4g}" for body, energy in energies.items())
            stored = sum(balance.contacts.values()) + sum(balance.links.values())
            grid.add(
                name,
                label,
                f"{1e3 * balance.t:.3f}",
                bodies,
                f"{1e3 * balance.structure:.4g}",
                f"{1e3 * stored:.4g}",
                f"{1e3 * balance.dissipated:.4g}",
                f"{ledger.residual:.1e}" if label == "end" else "",
            )
    return grid


def _whither(result: StudyResult) -> Grid:
    """What holds the energy of a case and what took it: bodies, modes, contacts and links, losses."""
    moments: dict[str, list[dict[str, float]]] = {}
    for name, case in result.cases.items():
        if case.response is not None and case.shares is not None:
            ledger, shares = case.response.ledger, case.shares
            pairs = ((ledger.at_separation, shares.at_separation), (ledger.end, shares.end))
            moments[name] = [
                {} if balance is None or groups is None else energy_shares(balance, groups) for balance, groups in pairs
            ]
    grid = Grid("where the energy went [% at the separation / at the end]", ("", *moments))
    told = [share for both in moments.values() for shares_then in both for share in shares_then.items()]
    for holder in dict.fromkeys(what for what, share in told if share >= TOLD):
        texts = [[f"{100 * then[holder]:.3g}" if holder in then else "-" for then in both] for both in moments.values()]
        grid.add(holder, *(" / ".join(both) for both in texts))
    return grid


def _levels(result: StudyResult) -> Grid:
    grid = Grid("levels re 20 uPa", ("receiver", *result.cases))
    names = list(dict.fromkeys(name for case in result.cases.values() for name in case.levels))
    for name in names:
        grid.add(f"{name} L_peak [dB]", *(_level(case, name, "l_peak_db") for case in result.cases.values()))
        grid.add(f"{name} L_AFmax [dB]", *(_level(case, name, "l_afmax_db") for case in result.cases.values()))
    return grid


def _level(case: CaseResult, name: str, what: str) -> str:
    return f"{getattr(case.levels[name], what):.1f}" if name in case.levels else "-"


def _modes_db(result: StudyResult) -> Grid:
    """Attenuation at the baseline's spectral peaks: pressures, velocities and the net force side by side."""
    others = result.comparison.cases
    grid = Grid(
        f"attenuation at the modes of '{result.comparison.baseline}' [dB]",
        ("channel", "mode", "f [Hz]", *others),
        keys=3,
    )
    reference = result.cases[result.comparison.baseline]
    heard = [name for name in reference.channels if name.endswith(("pressure", "velocity"))]
    forces = [name for name in reference.channels if name.startswith("net force")]
    modes = {name: {mode for beside in others.values() for mode in beside.modes_db.get(name, {})} for name in heard}
    spoken = set().union(*modes.values())
    for channel in (*heard, *forces):
        for mode in sorted(modes.get(channel, spoken)):
            frequency = reference.basis.frequency_hz[mode - 1]
            if frequency <= SPOKEN_HZ:
                grid.add(channel, str(mode), f"{frequency:.1f}", *(_mode_db(c, channel, mode) for c in others.values()))
    return grid


def _mode_db(beside: CaseComparison, channel: str, mode: int) -> str:
    value = beside.modes_db.get(channel, {}).get(mode)
    return "-" if value is None else f"{value:.2f}"


def _read(findings: Sequence[Row]) -> list[tuple[Finding, str]]:
    """Findings of a table of one structure, where there are no cases to name."""
    return [(Finding(f["code"], f["message"], f["values"], f["severe"]), "") for f in findings]


def _in_cases(names: Sequence[str]) -> str:
    """The cases a finding holds for.

    >>> _in_cases(["light", "heavy"])
    ' (cases light, heavy)'
    """
    return f" (case{'s' if len(names) > 1 else ''} {', '.join(names)})"


def _show_findings(console: Console, findings: Sequence[tuple[Finding, str]]) -> None:
    """Findings, each with what is said after it."""
    if findings:
        console.print("findings", style="bold")
    for finding, after in findings:
        mark = "NOT TO BE TRUSTED " if finding.severe else ""
        console.print(f"  {mark}{finding.code}: {finding.message}{after}", soft_wrap=True)


def _show_timings(console: Console, seconds: Mapping[str, float]) -> None:
    told = ", ".join(f"{stage} {spent:.2f}" for stage, spent in seconds.items())
    console.print(f"CPU seconds: {told}")
