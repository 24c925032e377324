"""results.h5: the results of a study written whole, and read back."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.declared import expect
from femstruct.errors import FemstructError, Finding, InputError
from femstruct.files.campaign_files import OPTIMUM, SWEEP
from femstruct.files.datasets import (
    axis,
    group,
    put,
    put_text,
    refuse_broken_seal,
    remember_arrays,
    write_sealed,
    write_vtkhdf,
)
from femstruct.files.described import write_described, write_held, write_rows
from femstruct.files.results_groups import (
    write_answers,
    write_basis,
    write_blows,
    write_damping,
    write_energy,
    write_own,
    write_rated,
    write_room,
)
from femstruct.files.stored_values import read_whole, with_derived, without_unread, write_whole
from femstruct.files.study_tables import (
    summary,
    write_errors,
    write_power,
    write_radiated,
    write_shares,
    write_verdicts,
)
from femstruct.files.tables import finding_table, study_findings_table
from femstruct.impact.response import Response
from femstruct.study.asked import Verdict
from femstruct.study.recorded import DAMPED_FORCE, damped_forces
from femstruct.study.results import CaseComparison, CaseResult, StudyResult

if TYPE_CHECKING:
    import h5py


# ----------------------------------------------------------------------------------------------------------------------
# The results file of a campaign where that of a run is asked for.
# ----------------------------------------------------------------------------------------------------------------------

KINDS = {SWEEP: "a sweep", OPTIMUM: "an optimisation"}


def campaign_file(given: str | Path) -> Path | None:
    """The sweep.h5 or optimise.h5 that is meant by its name or by that of its folder; None where there is none, and for
    a folder with the results file of a run.

    >>> campaign_file("results/no_such_study.sweep")
    """
    path = Path(given)
    if path.is_dir():
        files = [] if (path / "results.h5").exists() else [path / name for name in KINDS]
    else:
        files = [path] if path.name in KINDS else []
    return next((file for file in files if file.is_file()), None)


def refuse_campaign(given: str | Path) -> None:
    """Raise InputError, with where its table and its page are, for a campaign in place of a run."""
    file = campaign_file(given)
    if file is not None:
        there = [file.with_suffix(ending) for ending in (".csv", ".html")]
        listed = " and ".join(str(one) for one in there if one.is_file())
        open_it = f"open {listed}, or " if listed else ""
        do = f"{open_it}write its table with 'femstruct export {file.parent} --to xlsx'"
        raise InputError(str(given), got=f"{KINDS[file.name]}", expected="one run, with its results.h5", do=do)


# ----------------------------------------------------------------------------------------------------------------------
# The results of a study as one HDF5 file.
#
#     /                   complete (written last), format, title, baseline, findings and their cases (JSON)
#     /input              the files of the study verbatim: YAML, and CSV of loads
#     /provenance         versions, platform, date, command line (attributes)
#     /summary            the numbers of all cases and their comparison (JSON)
#     /bases/KEY          modes, damping, shapes, force rows
#     /cases/NAME         @basis; damping, channels, contacts, bodies, links, events, stresses, energy, error_estimate,
#                         accuracy, limits, frf, shock_spectra, fatigue, vibration, rooms, levels, own_levels,
#                         total_levels, sound_energy, rated, drops, modal
#     /comparison/CASE    modes by MAC, beside the baseline's
#     /VTKHDF             mode shapes of the baseline, opened by ParaView as they are
#     /nouns              all of the above and its problem as one value (JSON), whose arrays are above or in /arrays;
#                         nouns go by tags ("contact history/1"), never by modules
#
# Behind the last byte of HDF5 stands a checksum of all of them (files.seal), compared before HDF5 opens the file again.
# Every dataset has a unit, a description and a checksum of its own; histories, spectra and modes have named axes, so
# that ``xarray.open_dataset("results.h5", group="cases/NAME/channels")`` is a labelled table.
# ----------------------------------------------------------------------------------------------------------------------

FORMAT: Final = "femstruct results"
FORMAT_VERSION: Final = 5


def write_results(path: str | Path, result: StudyResult) -> None:
    """Write a study's results to one HDF5 file that is, at every instant, complete or not there.

    Raises FemstructError when the disk is full or refuses; the file that was there before is then untouched.

    Notes
    -----
    Made in memory, `complete = True` last, then written to a temporary name in the same folder, synced and
    renamed. A disk that fills up while HDF5 itself writes leaves its library in a state that crashes the process; the
    price is the size of the file in memory. Modal coordinates are kept only where the study says `save: modal`: they
    are most of the bytes. `without_unread` leaves out what else no reader uses.

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct import read_results, read_study, run_study
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(folder, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     write_results(Path(folder, "results.h5"), run_study(read_study(Path(folder, "hit.study.yaml"))))
    ...     stored = read_results(Path(folder, "results.h5"))
    >>> case = stored.cases["as given"]
    >>> case.response.outcome.value, case.channels["m.z velocity"].unit, case.channels["m.z velocity"].values.shape
    ('All contacts opened and stayed open to the end.', 'm/s', (100,))
    """
    expect("write_results", result, StudyResult, "run_study makes one")
    write_sealed(path, lambda file: _write(file, result))


def _write(file: h5py.File, result: StudyResult) -> None:
    with remember_arrays() as written:
        _write_tables(file, result)
        write_whole(file, without_unread(result), written)


def _write_tables(file: h5py.File, result: StudyResult) -> None:
    file.attrs.update(
        Conventions="CF-1.11",  # units and long_name of datasets, axes as coordinates
        format=FORMAT,
        format_version=FORMAT_VERSION,
        title=result.plan.title,
        baseline=result.plan.baseline,
        findings=json.dumps(study_findings_table(result)),
        timings_s=json.dumps(dict(result.timings)),
    )
    inputs = group(file, "input", "The files of the study, verbatim")
    for name, text in result.plan.sources.items():
        put_text(inputs, name, text, "A file of the study, verbatim", path=name)
    group(file, "provenance", "Where the numbers come from", **result.provenance)
    put_text(file, "summary", json.dumps(summary(result), allow_nan=False), "Numbers of all cases, as --json (JSON)")
    bases = group(file, "bases", "Modal bases by key")
    for name, basis in result.bases.items():
        findings = _findings(basis.findings)
        write_basis(group(bases, name, "A modal basis", total_mass_kg=basis.total_mass, findings=findings), basis)
    cases = group(file, "cases", "Cases by name")
    for name, case in result.cases.items():
        _write_case(cases, name, case, result.verdicts.get(name, ()))
    comparison = group(
        file, "comparison", "Against the baseline", baseline=result.comparison.baseline, filter=result.comparison.filter
    )
    for name, beside in result.comparison.cases.items():
        _write_comparison(group(comparison, name, "Modes of the baseline found again in this case"), beside)
    baseline = result.cases[result.plan.baseline]
    write_vtkhdf(file, baseline.basis, result.models.get(baseline.basis_key))


def _findings(findings: tuple[Finding, ...]) -> str:
    return json.dumps([finding_table(finding) for finding in findings], allow_nan=False)


def _write_case(cases: h5py.Group, name: str, case: CaseResult, verdicts: Sequence[Verdict]) -> None:
    target = group(
        cases,
        name,
        "One case of the study",
        case=name,
        basis=case.basis_key,
        changes=json.dumps(dict(case.case.changes)),
        findings=_findings(case.findings),
    )
    write_damping(group(target, "damping", "Damping of the basis in this case"), case.basis)
    if case.errors is not None:
        about = "Numbers of the impact, and their estimated numerical error"
        write_errors(group(target, "error_estimate", about), case.errors)
    if verdicts:
        write_verdicts(group(target, "limits", "Verdicts on the limits of the study"), verdicts)
    if case.frf:
        responses = group(target, "frf", "Frequency responses")
        for label, frf in case.frf.items():
            request = frf.request
            place = group(
                responses,
                label,
                request.kind,
                drive=str(request.drive),
                response_at=str(request.response),
                kind=request.kind,
            )
            frequency = axis(place, "frequency_hz", frf.frequency_hz, "Hz", "Frequency")
            if frf.sound is not None:
                about = "Sound power over the mean square of the force"
                put(place, "response", frf.sound.power, frf.unit, about, (frequency,))
                write_power(place, frf.sound, frequency, frf.unit)
                continue
            put(place, "response", frf.values, frf.unit, f"{request.kind}, exp(+j omega t)", (frequency,))
    if case.response is not None:
        _write_response(target, case, case.response)
    write_held(target, case, {"answers": write_answers})
    if case.rooms:
        rooms = group(target, "rooms", "Sound in the rooms")
        for label, room in case.rooms.items():
            place = group(rooms, label, "Pressure at the receivers")
            write_room(place, room)
            if label in case.heard.own:
                write_own(place, case.heard.own[label], case.heard.total[label])
    _write_sound_energies(target, case)
    if case.rated:
        rated = group(target, "rated", "Rooms as the standards state them, over their receivers")
        for label, room_rated in case.rated.items():
            write_rated(group(rated, label, "One room"), room_rated)


def _write_sound_energies(target: h5py.Group, case: CaseResult) -> None:
    if case.radiated:
        sound = group(target, "sound_energy", "Sound energy into the open, ROOM")
        for label, radiated in case.radiated.items():
            write_radiated(group(sound, label, "One half space"), radiated)
    if case.by_surface:
        sound = group(target, "by_surface", "What each surface gives the air of a room, ROOM")
        for label, shares in case.by_surface.items():
            write_shares(group(sound, label, "One room"), shares)


def _write_response(target: h5py.Group, case: CaseResult, response: Response) -> None:
    target.attrs["outcome"] = response.outcome.value
    channels = group(target, "channels", "Recorded histories")
    time = axis(channels, "time", response.t, "s", "Time since the start")
    damped = damped_forces(case.channels, case.basis.outputs)
    for channel in case.channels.values():
        peaks = {"peak_first_impact": channel.first_impact, "peak_whole": channel.whole}
        description = f"{channel.name}, recorded{f', {DAMPED_FORCE}' if channel.name in damped else ''}"
        put(channels, channel.name, channel.values, channel.unit, description, (time,), peaks)
    if response.contacts:
        contacts, histories = _table(target, "contacts", "Contacts", response.contacts), response.contacts.values()
        write_rows(contacts, list(histories), "contact")
    if response.bodies:
        bodies = _table(target, "bodies", "Bodies", response.bodies)
        mass = {body.name: body.mass for body in response.scene.bodies}
        put(bodies, "mass", [mass[name] for name in response.bodies], "kg", "Mass", ("body",))
        write_rows(bodies, list(response.bodies.values()), "body")
    if response.links:
        links = _table(target, "links", "Links", response.links)
        put(links, "force", np.array(list(response.links.values())), "N", "Positive in compression", ("link", time))
    if response.events:
        events = group(target, "events", "Contacts closing and opening")
        number = axis(events, "event", np.arange(1, len(response.events) + 1), "1", "Event number")
        write_rows(events, response.events, number)
    if response.blows:
        write_blows(group(target, "blows", "Blows of bodies that strike several times"), response.blows)
    stressed = {name: one.stressed for name, one in case.channels.items() if one.stressed is not None}
    if stressed:
        parts = group(target, "stresses", "Largest stresses of parts, by channel")
        for name, found in stressed.items():
            places = group(parts, name, "Largest equivalent stress of von Mises, place by place")
            axis(places, "place", np.arange(1, len(found.largest) + 1), "1", "Number; positions may have several sides")
            axis(places, "direction", ["x", "y", "z"], "1", "Global direction")
            write_described(places, found)
    write_energy(target, response.ledger, case.shares)
    if case.case.study.save_modal:
        modal = group(target, "modal", "Motion of the modes (save: modal)")
        modal["time"] = channels["time"]
        mode = axis(modal, "mode", np.arange(1, len(response.q) + 1), "1", "Mode number")
        put(modal, "q", response.q, "kg^0.5 m", "Modal coordinates", (mode, "time"))
        put(modal, "qd", response.qd, "kg^0.5 m/s", "Modal velocities", (mode, "time"))


def _table(target: h5py.Group, name: str, description: str, rows: Mapping[str, object]) -> h5py.Group:
    """A group of histories of several named things at the times of the channels."""
    made = group(target, name, description)
    made["time"] = target["channels/time"]
    axis(made, name.removesuffix("ies") + "y" if name == "bodies" else name[:-1], list(rows), "1", "Name")
    return made


def _write_comparison(target: h5py.Group, beside: CaseComparison) -> None:
    if not beside.frequencies:
        return
    own, frequency, mac = (list(column) for column in zip(*beside.frequencies.values(), strict=True))
    mode = axis(target, "mode", list(beside.frequencies), "1", "Mode number of the baseline")
    put(target, "own_mode", own, "1", "Number of the mode most like it in this case", (mode,))
    put(target, "own_frequency_hz", frequency, "Hz", "Its frequency", (mode,))
    put(target, "mac", mac, "1", "Modal assurance criterion of the two shapes", (mode,))


# ----------------------------------------------------------------------------------------------------------------------
# Reading a results file back.
# ----------------------------------------------------------------------------------------------------------------------

_UNREADABLE: Final = (
    OSError,
    KeyError,
    RuntimeError,
    ValueError,
    TypeError,
    ImportError,
    AttributeError,
    FemstructError,
)


OLDEST: Final = 4  # format that is still read
RESULTS: Final = "results.h5"  # of a run, in its folder


def results_file(given: str | Path) -> Path:
    """The results file that is meant by its name or by that of its folder.

    >>> results_file("results/no_such_study/results.h5").name
    'results.h5'
    """
    path = Path(given)
    return path / RESULTS if path.is_dir() else path


def read_results(path: str | Path) -> StudyResult:
    """What a study found, as `run_study` returned it.

    All nouns are there: responses, levels, findings, modes, the meshed model and the plan with its files verbatim. Of a
    contact law in Python only the name is kept, and the motion of the modes where the study says ``save: modal``: who
    asks for it elsewhere is told so. ``docs/results_file.md`` says what else is left out.

    Parameters
    ----------
    path : str | Path
        A results.h5, or the folder of a run that it is in.

    Raises
    ------
    InputError
        For a file that is not there, not of this format, incomplete, or damaged: the whole file is compared with the
        checksum at its end before anything else reads it.

    Examples
    --------
    A ball strikes a mass on a spring. After ``femstruct run`` the folder would be ``results/hit``:

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct import read_study, run_study, write_results
    >>> folder = tempfile.TemporaryDirectory()
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> _ = Path(folder.name, "model.yaml").write_text(model, encoding="utf-8")
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... '''
    >>> _ = Path(folder.name, "hit.study.yaml").write_text(study, encoding="utf-8")
    >>> write_results(Path(folder.name, "results.h5"), run_study(read_study(Path(folder.name, "hit.study.yaml"))))

    Its histories are channels of its cases, at the times of the response:

    >>> case = read_results(folder.name).cases["as given"]
    >>> list(case.channels)
    ['m.z velocity', 'net force on m']
    >>> velocity, times = case.channels["m.z velocity"], case.response.t
    >>> round(float(times[-1]), 6), round(float(velocity.values[-1]), 3), velocity.unit
    (0.0099, -0.996, 'm/s')
    >>> folder.cleanup()
    """
    path = results_file(path)
    refuse_campaign(path.parent if path.name == RESULTS else path)
    if not path.is_file():
        expected = f"a results file, or the folder of a run with its {RESULTS}"
        raise InputError(str(path), got="no such file", expected=expected, do="run the study first")
    try:
        refuse_broken_seal(path)
        import h5py

        with h5py.File(path, "r") as file:
            _check(path, file)
            found: StudyResult = read_whole(file)
            return with_derived(found)
    except InputError:
        raise
    except _UNREADABLE as error:
        raise InputError(
            str(path),
            got=f"a file that cannot be read ({error})",
            expected="a complete results file of this version",
            do="run the study again",
        ) from error


def _check(path: Path, file: h5py.File) -> None:
    if file.attrs.get("format") != FORMAT:
        raise InputError(str(path), got="an HDF5 file of another kind", expected=f"'{FORMAT}'")
    if file.attrs.get("complete") is not np.True_:
        raise InputError(
            str(path), got="an incomplete file", expected="complete = True, written last", do="run the study again"
        )
    if not OLDEST <= (version := file.attrs["format_version"]) <= FORMAT_VERSION:
        raise InputError(
            str(path),
            got=f"format version {version}",
            expected=f"{OLDEST} to {FORMAT_VERSION}",
            do="run the study again" if version < FORMAT_VERSION else "use the version of femstruct that wrote it",
        )
