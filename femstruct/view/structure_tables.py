"""What a person reads of a structure: its modes, also beside measured ones, frequency responses, what `check` found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from rich.console import Console

from femstruct.assembly.matrices import GROUND
from femstruct.errors import Finding, list_some
from femstruct.files.tables import finding_from
from femstruct.study.asked import Beside
from femstruct.view.console import Grid, console, finding_lines, rounded, show_findings

# ----------------------------------------------------------------------------------------------------------------------
# What a person reads of a model at rest under forces and weight.
# ----------------------------------------------------------------------------------------------------------------------

AT_SEVERAL = "what stands at several places as one sum"
ON_THE_GROUND = f"forces on the ground: {AT_SEVERAL}"
BETWEEN = (
    f"forces between parts: {AT_SEVERAL}; on the second part of a joint; of a rigid link on its 'to', of an average on "
    "its 'of'"
)
SUM = " (sum of all)"
NOISE = 1e-6  # of the largest displacement or rotation: less has no meaning beside it


def show_statics(table: Mapping[str, Any], verbose: bool = False) -> None:
    """Displacements of points and parts, forces, largest stresses.

    Parameters
    ----------
    verbose : bool
        Remarks, too.
    """
    screen = console()
    screen.print(table["title"], style="bold")
    x, y, z = (f"{value:.4g}" for value in table["load_n"])
    screen.print(f"all that acts: ({x}, {y}, {z}) N")
    if table["points"]:
        points = Grid("points", ("", "x [mm]", "y [mm]", "z [mm]", "rx [mrad]", "ry [mrad]", "rz [mrad]"))
        rows = table["points"].values()
        noise = [NOISE * max(abs(one) for row in rows for one in row[half]) for half in (slice(3), slice(3, 6))]
        for name, values in table["points"].items():
            least = [noise[0]] * 3 + [noise[1]] * 3
            shown = [1e3 * one if abs(one) > least[i] else 0.0 for i, one in enumerate(values)]
            points.add(name, *(_number(one) for one in shown))
        points.show(screen)
    parts = Grid("parts", ("", "largest displacement [mm]", "largest stress of von Mises [MPa]", "where"))
    for name, moved in table["parts_m"].items():
        stress = table["stresses"].get(name)
        stress_cells = ("-", "") if stress is None else (f"{1e-6 * stress['largest_pa']:.4g}", stress["where"])
        parts.add(name, _number(1e3 * moved), *stress_cells)
    parts.show(screen)
    largest = max((abs(one) for force in table["forces_n"].values() for one in force), default=0.0)
    for words, on_the_ground in ((ON_THE_GROUND, True), (BETWEEN, False)):
        forces = Grid(words, ("", "x [N]", "y [N]", "z [N]"))
        own = [name for name in table["forces_n"] if (name in table["on_the_ground"]) is on_the_ground]
        for name in own:
            force = table["forces_n"][name]
            forces.add(f"{name}{SUM}" if name == GROUND else name, *(_number(rounded(one, largest)) for one in force))
        forces.show(screen)
    if table["held_inside"]:
        x, y, z = (_number(one) for one in table["held_inside"]["force_n"])
        names = list_some(table["held_inside"]["parts"])
        screen.print(f"held inside the matrices of {names}, which reaches no support: ({x}, {y}, {z}) N")
    show_findings(screen, [(finding_from(one), "") for one in table["findings"]], verbose)


def _number(value: float) -> str:
    return f"{value:.4g}" if value else "0"


# ----------------------------------------------------------------------------------------------------------------------
# What a person reads of a structure.
# ----------------------------------------------------------------------------------------------------------------------

Row = Mapping[str, Any]
LIKE = 0.5  # the least likeness at which two shapes count as the same mode, as for damping that follows its mode
NO_DAMPING = 1e-10  # of a ratio: what rounding leaves of none
LEAST_TILT_SHOWN = 1e-6  # rad: a micrometre a metre is rounding, or nobody's concern


def show_modes(table: Row, verbose: bool = False) -> None:
    """Mode numbers, frequencies, damping ratios, kinds and effective masses.

    Parameters
    ----------
    verbose : bool
        Remarks, too.
    """
    screen = console()
    if not table["frequency_hz"]:
        screen.print(f"{table['title']}\nno modes: bodies only" if not table["mass_kg"] else table["title"])
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
    grid.show(screen)
    if table["mass_kg"]:
        screen.print(f"mass {table['mass_kg']:.4g} kg")
    if sentence := _completeness(table["complete_below_hz"], table["rigid_in_plane"]):
        screen.print(sentence)
        screen.print(f"sparse solver: {table['solver']}")
    show_findings(screen, _read(table["findings"]), verbose)


def show_complex_modes(table: Row) -> None:
    """Complex modes: frequencies, damping ratios, phase collinearity, and how many real modes there are beside them."""
    grid = Grid(
        table["title"], ("mode", "frequency [Hz]", "damped [Hz]", "damping ratio", "kind", "phase collinearity")
    )
    columns = (table[key] for key in ("frequency_hz", "damped_hz", "damping_ratio", "kind", "collinearity"))
    for i, (frequency, damped, ratio, kind, collinear) in enumerate(zip(*columns, strict=True)):
        grid.add(
            str(i + 1),
            f"{frequency:.2f}",
            f"{damped:.2f}",
            _damped(ratio),
            kind,
            "" if collinear is None else f"{collinear:.4f}",
        )
    screen = console()
    grid.show(screen)
    screen.print("phase collinearity: 1 where all places move in step, 0 for a travelling wave")
    elastic = table["real_modes"] - table["rigid_body_modes"]
    screen.print(
        f"{_counted(elastic, 'real elastic mode')} up to {table['up_to_hz']:.5g} Hz, proven complete; of complex modes "
        "this is not proved, and overdamped motions are left out"
    )


def _damped(ratio: float | None) -> str:
    if ratio is None:
        return ""
    return f"{100 * ratio:.3g} %" if abs(ratio) > NO_DAMPING else "0 %"


def show_frf(table: Row, verbose: bool = False) -> None:
    """A frequency response as columns, findings before them as comments: what plots columns leaves comments out."""
    for _, line in finding_lines(_read(table["findings"]), verbose):
        print(f"# {line}")
    print(f"# {table['kind']} {table['response']} / {table['drive']}, {table['method']}, {table['unit']}")
    columns, head = [table["real"], table["imag"]], ["real", "imag"]
    if components := table.get("components"):
        print("# largest_anywhere: at each frequency that of the place where it is largest then")
        print(f"# there: all at {table['place']}, where it is largest in the band, components along local axes")
        columns, head = [table["real"], table["equivalent_there"]], ["largest_anywhere", "equivalent_there"]
        for name, one in components.items():
            columns, head = [*columns, one["real"], one["imag"]], [*head, f"{name}_real", f"{name}_imag"]
    print("# frequency_hz", *head)
    for frequency, *values in zip(table["frequency_hz"], *columns, strict=True):
        print(f"{frequency:.6g}", *(f"{value:.8e}" for value in values))


def show_frfs(table: Row, verbose: bool = False) -> None:
    """Frequency responses side by side as columns, what they are before them as comments."""
    for _, line in finding_lines(_read(table["findings"]), verbose):
        print(f"# {line}")
    head = ["frequency_hz"]
    for number, one in enumerate(table["responses"], 1):
        print(f"# {number}: {one['kind']} {one['response']} / {one['drive']}, {one['unit']}")
        head += [f"real_{number}", f"imag_{number}"]
    print("#", *head)
    columns = [part for one in table["responses"] for part in (one["real"], one["imag"])]
    for frequency, *values in zip(table["frequency_hz"], *columns, strict=True):
        print(f"{frequency:.6g}", *(f"{value:.8e}" for value in values))


def show_written(table: Row, verbose: bool = False) -> None:
    """Files that were written, and findings."""
    print(*table["written"], sep="\n")
    show_findings(console(), _read(table["findings"]), verbose)


def show_mac(table: Mapping[str, Any]) -> None:
    """Pairs of modes with their frequencies, damping and MAC, then the MAC of all with all."""
    screen = console()
    columns = ("measured", "[Hz]", "damping", "model", "[Hz]", "damping", "difference", "MAC", "MAC of the group")
    grid = Grid(f"{table['measured']} beside {table['title']}", columns)
    for row in table["modes"]:
        grouped = len(row["group"]) > 1 or row["group_mac"] != row["mac"]
        grid.add(
            str(row["mode"]),
            f"{row['frequency_hz']:.2f}",
            _ratio(row["damping_ratio"]),
            str(row["model_mode"]) if row["group_mac"] >= LIKE else f"({row['model_mode']})",
            f"{row['model_frequency_hz']:.2f}",
            _ratio(row["model_damping_ratio"]),
            "" if row["difference"] is None else f"{100 * row['difference']:+.1f} %",
            f"{row['mac']:.2f}",
            f"{row['group_mac']:.2f} with {_range(row['group'])}" if grouped else "",
        )
    grid.show(screen)
    count = len(table["model_frequency_hz"])
    alike = Grid("MAC, measured modes down, modes of the model across", ("", *(str(j + 1) for j in range(count))))
    for i, values in enumerate(table["mac"]):
        alike.add(str(i + 1), *(f"{value:.2f}" for value in values))
    alike.show(screen)
    screen.print(
        f"{table['places']} places, {table['directions']} displacements, at most {table['farthest_m']:.3g} m from the "
        f"model; partners in brackets are not alike (below {LIKE:g})"
    )
    for note in table["notes"]:
        screen.print(f"note: {note}")


def show_inspection(table: Row, picture: str = "", verbose: bool = False) -> None:
    """What `check` found: masses, box, degrees of freedom, rigid modes, damping, sags, blocks, rooms, findings."""
    screen = console()
    screen.print(table["title"], style="bold")
    if "cases" in table:
        _show_happening(screen, table)
    if table["masses_kg"]:
        _show_masses(screen, table)
    _show_what_holds(screen, table)
    screen.print(_modes_text(table))
    for sentence in table["damping"] if table["first_frequencies_hz"] else ():
        screen.print(sentence)
    for name, position in table["points_m"].items():
        where = "somewhere" if position is None else f"at ({', '.join(f'{x:.4g}' for x in position)}) m"
        screen.print(f"point {name} {where}")
    _show_at_rest(screen, table)
    for mode in table["block_modes"]:
        shares = ", ".join(f"{name} {100 * share:.0f} %" for name, share in mode["shares"].items())
        damped = "" if mode["damping_ratio"] is None else f", damping {100 * mode['damping_ratio']:.3g} %"
        screen.print(f"mode {mode['mode']}, {mode['frequency_hz']:.2f} Hz{damped}: {shares}")
    for name, room in table["rooms"].items():
        _show_room(screen, name, room)
    if table["drops"]:
        screen.print(f"the source strikes {list_some(table['drops'])}: one simulation for each")
    show_findings(screen, _read(table["findings"]), verbose)
    if picture:
        screen.print(f"picture: {picture}")


def _show_masses(screen: Console, table: Row) -> None:
    """Masses of the parts, the box around all, and how many there are of what a model is made of."""
    grid = Grid("masses", ("part", "mass [kg]"))
    for name, mass in table["masses_kg"].items():
        grid.add(name, f"{mass:.5g}")
    grid.add("all", f"{table['mass_kg']:.5g}")
    grid.show(screen)
    low, high = table["box_m"]
    screen.print("box " + " x ".join(f"{b - a:.4g}" for a, b in zip(low, high, strict=True)) + " m")
    screen.print(", ".join(f"{count} {name}" for name, count in table["counts"].items()))


def _show_what_holds(screen: Console, table: Row) -> None:
    """Hangers, joints and simple supports, and the degrees of freedom that they leave."""
    for name, one in table["hangers"].items():
        screen.print(_hanger_text(name, one))
    for name, joint in table["joints"].items():
        screen.print(_joint_text(name, joint))
    if table["simple_supports"]:
        told = (f"{name} {one}" for name, one in table["simple_supports"].items())
        screen.print(f"simple supports of edges: {', '.join(told)}")
    if table["degrees_of_freedom"] is not None:
        screen.print(f"{table['degrees_of_freedom']} degrees of freedom")


def _show_at_rest(screen: Console, table: Row) -> None:
    """How far bodies and blocks sag under their weights."""
    for body, rest in table["rest"].items():
        screen.print(f"{body}: weight {rest['weight_n']:.4g} N sags {1e3 * rest['sag_m']:.3g} mm on its links")
    for part, sag in table["sags"].items():
        seen = sag["tilt_rad"] is not None and sag["tilt_rad"] > LEAST_TILT_SHOWN
        leaning = f" and leans by {1e3 * sag['tilt_rad']:.2g} mm/m" if seen else ""
        screen.print(f"{part} sags {1e3 * sag['sag_m']:.3g} mm under the total weight{leaning}")


def _show_room(screen: Console, name: str, room: Row) -> None:
    """A room or open air, and up to where its cells have modes of their own."""
    if "side" in room:
        screen.print(f"{name}: open air {room['side']} the surface, in an infinite rigid baffle")
        return
    screen.print(f"room {name}: {'; '.join(_room_parts(room))}", soft_wrap=True)
    if "largest_cell_m" in room:
        cells, most = f"{room['largest_cell_m']:.3g} m", f"{room['own_modes_up_to_hz']:.4g} Hz"
        screen.print(f"  cells of {cells} at most; room modes, with rigid walls, up to {most}")


def _joint_text(name: str, joint: Row) -> str:
    """Over how much of what touches a joint holds two parts together."""
    between = " and ".join(joint["between"])
    for key, unit in (("m2", "m^2"), ("m", "m")):
        if (whole := joint.get(f"touching_{key}")) is not None:
            size = joint[f"joined_{key}"]
            of_all = f" of the {whole:.4g} {unit} that touch" if whole - size > 1e-6 * whole else ", all that touches"
            return f"joint {name}: {between} are joined over {size:.4g} {unit}{of_all}"
    return f"joint {name}: {between} are joined at {_counted(joint['nodes'], 'node')}"


def _room_parts(room: Row) -> list[str]:
    """What a person reads of a room first; of a kind that says other things of itself, those by their names."""
    parts = [f"{room['coupling']} coupling"] if "coupling" in room else []
    if "first_modes_hz" in room:
        parts.append(f"first modes {', '.join(f'{f:.1f}' for f in room['first_modes_hz'])} Hz")
    if "damping_ratio" in room:
        ratios = [f"{100 * ratio:.3g} % at {float(f):.4g} Hz" for f, ratio in room["damping_ratio"].items()]
        parts.append(f"damping {', '.join(ratios)}")
    if (t60 := room.get("reverberation_time_of_all_modes_s")) is not None:
        parts.append(f"reverberation time {t60:.4g} s of all modes")
    return parts or [f"{key} {value}" for key, value in room.items()]


def _show_happening(screen: Console, table: Row) -> None:
    """Cases, bodies and window of a study."""
    baseline = f"; the following describes the baseline, {table['baseline']}" if len(table["cases"]) > 1 else ""
    screen.print(f"{_counted(len(table['cases']), 'case')}: {list_some(table['cases'])}{baseline}", soft_wrap=True)
    for name, body in table["bodies"].items():
        speed = f", towards it at {body['speed_m_s']:.4g} m/s" if body["speed_m_s"] else ""
        screen.print(f"{name}: {body['mass_kg']:.4g} kg, {body['side']} {body['target']}{speed}")
    if time := table["time"]:
        screen.print(f"window of {time['duration_s']:.4g} s, sampled at {time['sampling_hz']:.6g} Hz")
    for command, what in table.get("campaigns", {}).items():
        screen.print(f"{command} {what}", soft_wrap=True)


def _modes_text(table: Row) -> str:
    """How many rigid modes there are, and the first others.

    >>> _modes_text({"rigid_body_modes": 1, "first_frequencies_hz": [0.0, 68.012, 220.4]})
    '1 rigid-body mode; first frequencies [Hz]: 68.01, 220.40'
    """
    rigid = table["rigid_body_modes"]
    elastic = ", ".join(f"{f:.2f}" for f in table["first_frequencies_hz"][rigid:][:6])
    if not rigid and not elastic:
        return "no modes: bodies only"
    others = f"first frequencies [Hz]: {elastic}" if elastic else "no others"
    return f"{_counted(rigid, 'rigid-body mode')}; {others}"


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" + ("" if count == 1 else "s")


def _completeness(below_hz: float | None, rigid_in_plane: Sequence[str] = ()) -> str:
    """Which modes are proven to be here: below a frequency, all of them (None), or none (0); and which the model of the
    structure cannot have.

    >>> _completeness(None), _completeness(0.0), _completeness(512.0)
    ('all modes of this model are listed', '', 'no mode of this model is missing below 512 Hz')
    >>> _completeness(512.0, ["floor"])
    'no mode of this model is missing below 512 Hz; its plates (floor) have none in their own planes'
    """
    if below_hz is not None and not below_hz > 0.0:
        return ""
    sentence = "all modes of this model are listed"
    if below_hz is not None:
        sentence = f"no mode of this model is missing below {below_hz:.5g} Hz"
    names = list_some(rigid_in_plane, 3)
    return f"{sentence}; its plates ({names}) have none in their own planes" if names else sentence


def _percentage(part: float, whole: float) -> str:
    return f"{100 * part / whole:.1f}" if whole else "-"


def _read(findings: Sequence[Row]) -> list[tuple[Finding, str]]:
    """Findings of a table of one structure, where there are no cases to name."""
    return [(finding_from(one), "") for one in findings]


def _ratio(ratio: float | None) -> str:
    return f"{100 * ratio:.2f} %" if ratio else ""


def _range(modes: Sequence[int]) -> str:
    """Numbers of modes that follow each other.

    >>> _range([4]), _range([2, 3, 4])
    ('4', '2 to 4')
    """
    return str(modes[0]) if len(modes) == 1 else f"{modes[0]} to {modes[-1]}"


def _hanger_text(name: str, one: dict[str, Any]) -> str:
    """A line on hangers: how many, and the mean load of each beside the largest that is recommended."""
    load, most = one["mean_load_n"], one["largest_load_n"]
    pieces = "1 hanger" if one["count"] == 1 else f"{one['count']} hangers"
    if load is None:
        return f"{name}: {pieces}; other parts or supports carry {one['ceiling']}, too"
    beside = ""
    if most is not None:
        beside = f", {'more than' if load > most else 'of'} the {most:.4g} N that are recommended at most"
    return f"{name}: {pieces}, each with {load:.4g} N of {one['ceiling']} in the mean{beside}"


# ----------------------------------------------------------------------------------------------------------------------
# Parameters found from what was measured, with their intervals, in the terminal.
# ----------------------------------------------------------------------------------------------------------------------

LISTED: Final = ("modes", "levels")  # kinds whose numbers are few enough to be listed


def show_identification(table: Mapping[str, Any], beside: Sequence[Beside] = (), verbose: bool = False) -> None:
    """A row a parameter with its interval, measured beside computed numbers, what the fit leaves over, the values as
    changes of the input files, and findings."""
    screen = console()
    data_text = f"'{table['channel']}'" if "channel" in table else ", ".join(one["name"] for one in table["data"])
    what = "samples" if "channel" in table else "numbers"
    grid = Grid(
        f"found from {table['samples']} {what} of {data_text}",
        ("parameter", "value", f"{100 * table['confidence']:g} % interval", "+-", "unit"),
    )
    for name, one in table["parameters"].items():
        value, low, high = one["value"], one["low"], one["high"]
        half = f"{50 * (high - low) / abs(value):.2g} %" if _known(one) and value else ""
        grid.add(name, f"{value:.5g}", _between(one), half, one["unit"])
    grid.show(screen)
    for one in beside:
        if one.kind in LISTED:
            _show_beside(screen, one)
    if "channel" in table:
        screen.print(
            f"residuals {table['residual_deviation']:.3g} {table['unit']} (standard deviation); the fit explains "
            f"{100 * table['explained']:.2f} % of the measured squares; {table['runs']} simulations",
            soft_wrap=True,
        )
    else:
        for one in table["data"]:
            taken = "stated" if one["scatter_stated"] else "usual"
            screen.print(
                f"{one['name']}: {one['numbers']} numbers, residuals {one['rms_over_scatter']:.2g} times the {taken} "
                "scatter (rms)",
                soft_wrap=True,
            )
        screen.print(f"{table['runs']} trials")
    screen.print(f"to use the values: {table['command']}", soft_wrap=True)
    show_findings(screen, [(finding_from(one), "") for one in table["findings"]], verbose)


def found_lines(table: Mapping[str, Any]) -> list[str]:
    """A line a parameter, below the title of a picture: its value, unit and interval."""
    share = f"{100 * table['confidence']:g} %"
    return [
        f"{name} = {one['value']:.5g} {one['unit']}".rstrip()
        + (f"  ({share} interval {_between(one)})" if _known(one) else f"  ({one['no_interval']})")
        for name, one in table["parameters"].items()
    ]


def _known(one: Mapping[str, Any]) -> bool:
    return one["low"] is not None and one["high"] is not None


def _between(one: Mapping[str, Any]) -> str:
    return f"{one['low']:.5g} .. {one['high']:.5g}" if _known(one) else str(one["no_interval"])


def _show_beside(screen: Any, one: Beside) -> None:
    modes = one.kind == "modes"
    columns = ("mode" if modes else "band [Hz]", f"measured [{one.unit}]", f"computed [{one.unit}]", "difference", "")
    grid = Grid(one.name, columns)
    for i, (along, measured, computed) in enumerate(zip(one.along, one.measured, one.computed, strict=True)):
        off = f"{100 * (computed / measured - 1.0):+.2f} %" if modes else f"{computed - measured:+.1f} dB"
        digits = f"{measured:.5g}", f"{computed:.5g}"
        grid.add(f"{along:g}", *digits, off, one.notes[i] if one.notes else "")
    grid.show(screen)
