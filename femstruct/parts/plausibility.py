"""Numbers that are physically possible, or nearly, and surely not meant: units that were forgotten or mistaken.

All of it is judged by what parts say of themselves (`Part.implausible`); nothing needs a mesh. What cannot mean
anything at all is refused where it is written (`Material`, `Plate`, the schemas of the language).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from femstruct.conventions import GRAVITY
from femstruct.errors import Finding, InputError
from femstruct.model.lay_ups import Laminate, LayUp, PlateSection
from femstruct.model.materials import DENSEST, AnyMaterial, Loss, LossByFrequency, Material, Orthotropic
from femstruct.model.part import Part
from femstruct.model.regions import Vector
from femstruct.model.sections import Section

# sqrt(E / rho) [m/s]. M. F. Ashby, Materials Selection in Mechanical Design, chart of modulus and density: foams and
# rubbers from 30 m/s on, gelatine (10 kPa) 3; beryllium 12.5 km/s, diamond 18 km/s.
SLOWEST, FASTEST = 2.0, 20e3
# What is denser than DENSE and no rubber (nu from RUBBER on): polyethylene and PTFE 430 m/s, asphalt 650, lead 1100,
# concrete 3500. Below SLOWEST_HARD lie loose soils, and 30 MPa for concrete (112 m/s), 210 MPa for steel (164 m/s).
DENSE, RUBBER, SLOWEST_HARD = 1100.0, 0.4, 300.0
LIGHTEST = 1.0  # kg/m^3: less than the air in its pores; aerogels have 3 kg/m^3
LIGHTEST_BLOCK = 5.0  # kg/m^3: a rigid body of less is a balloon
THINNEST = 1e-4  # of the shorter side: sheet metal of 0.5 mm that spans 5 m; foils are held by their tension
SAGGING = 0.05  # of its shorter side that a plate sags under its own weight; floors sag by 1/1000, sheets by 1/50
STOUT = 200.0  # shorter side over thickness: beyond it sheets do sag by more
STOUTEST, SLENDEREST = 5.0, 300.0  # shorter side over thickness of what a plate is likely meant to be
LONGEST_SPAN = 50.0  # m: a plate of more was likely written in millimetres
LONGEST_BAR = 3e4  # length over radius of gyration: a wire of 4 mm over 30 m
# Side of a section over the length of its line: stubs between two parts reach 5; of walls and piers, which are larger
# than LARGE [m], 1.
THICKEST_BAR, THICKEST_LARGE, LARGE = 10.0, 2.0, 1.0
PROPORTIONS = (1e-5, 1e2)  # second moment over area squared: a strip of 1:8000, a tube of a wall of 1:1000
LOSSY, STIFF = 0.5, 1e9  # loss factor of what is stiffer than STIFF [Pa]: asphalt, the most of these, has 0.4
SLIPS = (1e3, 1e-3, 1.0 / GRAVITY, 1e6, 1e-6, 1e9, 1e-9)  # 1 / g: a weight given for a mass


def plausibility_findings(parts: Sequence[Part]) -> tuple[Finding, ...]:
    """Materials no solid has, plates and bars too thin, too thick or too soft, and blocks too light or too heavy."""
    materials = {material.name: material for part in parts for material in part.materials()}
    lying = {name for part in parts for name in part.bears()}
    found = [finding for material in materials.values() for finding in material_findings(material)]
    return (*found, *(finding for part in parts for finding in part.implausible(lies=part.name in lying)))


def material_findings(material: AnyMaterial) -> tuple[Finding, ...]:
    """A density or a modulus that no solid has, with the one that was probably meant; none without mass.

    Of an orthotropic material the stiffest direction is judged, then the softest as what only rubbers are.
    """
    if isinstance(material, Material):
        judged = _solid_findings(material.name, material.E, material.nu, material.rho)
        return (*judged, *_lossy(material.name, material.E, material.loss_factor))
    stiff = _solid_findings(material.name, max(material.E), 0.0, material.rho)
    judged = stiff or _solid_findings(material.name, min(material.E), RUBBER, material.rho)
    return (*judged, *_lossy(material.name, max(material.E), material.loss_factor), *_completed(material))


def _lossy(name: str, E: float, loss: Loss) -> tuple[Finding, ...]:
    """A loss factor that nothing so stiff has, as 1 for 1 %."""
    most = max(value for _, value in loss.points) if isinstance(loss, LossByFrequency) else loss
    if most < LOSSY or E < STIFF:
        return ()
    return (
        Finding(
            "implausible-damping",
            f"{name}: a loss factor of {100 * most:.4g} %, with E {_pressure(E)}; metals have 0.01 to 0.1 %, concrete "
            f"and timber 1 %, asphalt up to 40 %. Did you mean {most:.4g} %?",
            {"loss_factor": most, "E_pa": E},
        ),
    )


def _completed(material: Orthotropic) -> tuple[Finding, ...]:
    """The constants of an orthotropic material that were not given, with what they are."""
    if not material.completed:
        return ()
    (Ex, Ey, Ez), (xy, yz, zx), nu = material.E, material.G, material.ratios
    sentence = f"{material.name}: {', '.join(material.completed)} complete what was given"
    return (
        Finding(
            "material-completed",
            f"{sentence}. Ex, Ey, Ez: {', '.join(map(_pressure, (Ex, Ey, Ez)))}; Gxy, Gyz, Gzx: "
            f"{', '.join(map(_pressure, (xy, yz, zx)))}; nuxy, nuyz, nuzx: {', '.join(f'{one:.3g}' for one in nu)}",
            {"Ez_pa": Ez, "Gzx_pa": zx, "nu_yz": nu[1], "nu_zx": nu[2]},
        ),
    )


def _solid_findings(name: str, E: float, nu: float, rho: float) -> tuple[Finding, ...]:
    if rho == 0.0:
        return ()
    speed = float(np.sqrt(E / rho))
    if rho > DENSEST:
        message = f"{name}: rho {rho:.4g} kg/m^3, the densest solid has {DENSEST:.0f}"
    elif rho < LIGHTEST:
        message = f"{name}: rho {rho:.4g} kg/m^3, lighter than any solid (rho: 0 is a part without mass)"
    elif SLOWEST <= speed <= FASTEST and (speed >= SLOWEST_HARD or rho <= DENSE or nu >= RUBBER):
        return ()
    else:
        known = "gelatine has 3 m/s, diamond 18000 m/s"
        if SLOWEST <= speed < SLOWEST_HARD:
            known = (
                f"above {DENSE:.0f} kg/m^3 only rubbers (nu {RUBBER:g} or more) have less than {SLOWEST_HARD:.0f} m/s"
            )
        message = (
            f"{name}: with E {_pressure(E)} and rho {rho:.4g} kg/m^3 the speed of sound in a bar is {speed:.3g} m/s; "
            f"{known}"
        )
    stiffer = _meant(E, lambda other: _is_ordinary(other, rho, nu))
    denser = _meant(rho, lambda other: _is_ordinary(E, other, nu))
    if DENSEST >= rho >= LIGHTEST and stiffer is not None:
        message += f". Did you mean E {_pressure(stiffer)}?"
    elif denser is not None:
        message += f". Did you mean rho {denser:.4g} kg/m^3?"
    values = {"wave_speed_m_s": speed, "E_pa": E, "rho_kg_m3": rho}
    return (Finding("implausible-material", message, values, severe=True),)


def _is_ordinary(E: float, rho: float, nu: float) -> bool:
    """Whether most solids people build with are like this: the middle of Ashby's chart."""
    speed = np.sqrt(E / rho)
    slowest = SLOWEST_HARD if rho > DENSE and nu < RUBBER else 30.0
    return bool(10.0 <= rho <= DENSEST and slowest <= speed <= 13e3)


def _meant(value: float, good: Callable[[float], bool]) -> float | None:
    """What a number would be without the slip of a unit; None where no usual slip explains it."""
    return next((value * factor for factor in SLIPS if good(value * factor)), None)


def _pressure(value: float) -> str:
    for unit, size in (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)):
        if value >= size:
            return f"{value / size:.4g} {unit}"
    return f"{value:.4g} Pa"


def _length(value: float) -> str:
    return f"{value:.4g} m" if value >= 1.0 else f"{1e3 * value:.4g} mm"


def refuse_thicker(name: str, kind: str, material: AnyMaterial | LayUp, thickness: float, side: float) -> None:
    """Raise InputError for what is thicker than its shorter side is long [m], at its layers where it has some."""
    if not thickness > side > 0:
        return
    key, got, largest = "thickness", f"{thickness:g} m", thickness
    if isinstance(material, Laminate):
        key, got, largest = "layers", f"{thickness:g} m in all", max(layer.thickness for layer in material.layers)
    meant = f"plain numbers are metres: {largest:g} mm?"
    raise InputError(
        f"parts.{name}.{key}",
        got=got,
        expected=f"at most the {kind}'s shorter side, {side:g} m",
        do=meant if largest > 1.0 else "what is thicker than wide is a frame or a block",
    )


def thickness_findings(
    name: str, section: PlateSection, materials: Sequence[AnyMaterial], side: float, hangs: bool
) -> tuple[Finding, ...]:
    """A foil in place of a plate, or a plate that would sag far.

    Parameters
    ----------
    side : float
        The shorter one [m].
    hangs : bool
        Whether it is flat and not supported over its area.
    """
    h = section.thickness
    if h < THINNEST * side:
        meant = _meant(h, lambda other: side / SLENDEREST <= other <= side / STOUTEST)
        question = "" if meant is None else f". Did you mean {_length(meant)}?"
        if side >= LONGEST_SPAN and STOUTEST * h <= 1e-3 * side <= SLENDEREST * h:
            question = f". Plain numbers are metres: did you mean a side of {_length(1e-3 * side)}?"
        return (
            Finding(
                "implausible-thickness",
                f"{name} is {_length(h)} thick, 1/{side / h:.0f} of its shorter side of {_length(side)}: a foil, "
                f"which has no bending stiffness in practice{question}",
                {"thickness_m": h, "side_m": side},
                severe=True,
            ),
        )
    sag = sag_of(section, side)
    rubber = any(isinstance(one, Material) and one.nu >= RUBBER for one in materials)
    if not hangs or rubber or side / h > STOUT or sag <= SAGGING * side:
        return ()
    data = ", ".join(_moduli(one) for one in materials) or "the rigidities, the mass"
    return (
        Finding(
            "implausible-stiffness",
            f"{name}: {_length(h)} thick and simply supported over its shorter side of {_length(side)}, it would "
            f"sag by {_length(sag)} under its own weight, {100 * sag / side:.0f} %; floors sag by 0.1 %. Check {data}, "
            "the thickness and the size",
            {"sag_m": sag, "side_m": side},
            severe=True,
        ),
    )


def _moduli(material: AnyMaterial) -> str:
    if isinstance(material, Material):
        return f"E {_pressure(material.E)}, rho {material.rho:.4g} kg/m^3"
    return f"E {', '.join(map(_pressure, material.E[:2]))}, rho {material.rho:.4g} kg/m^3"


def sag_of(section: PlateSection, a: float) -> float:
    """Sag of a plate under its own weight over a length a, simply supported at both ends [m].

    5 q a^4 / (384 D) with q = g m0 and D its bending rigidity, the larger of those along x and y.
    """
    return 5.0 * section.m0 * GRAVITY * a**4 / (384.0 * float(section.bending.diagonal()[:2].max()))


def section_findings(name: str, section: Section, lines: Iterable[Sequence[Vector]]) -> tuple[Finding, ...]:
    """A section that does not fit the lines it runs along [m], or itself."""
    pieces = [np.linalg.norm(np.diff(np.asarray(line), axis=0), axis=1) for line in lines if len(line) > 1]
    if not pieces:
        return ()
    longest_piece = max(float(lengths.max()) for lengths in pieces)
    longest_line = max(float(lengths.sum()) for lengths in pieces)
    side, gyration = np.sqrt(section.A), np.sqrt(min(section.Iy, section.Iz) / section.A)
    message = ""
    if side > (THICKEST_LARGE if side > LARGE else THICKEST_BAR) * longest_line:
        message = f"an area of {section.A:.4g} m^2, {_length(side)} square, on a line of {_length(longest_line)}"
    elif gyration < longest_piece / LONGEST_BAR:
        message = f"a radius of gyration of {gyration:.3g} m on a straight piece of {_length(longest_piece)}"
    else:
        for axis, moment in (("Iy", section.Iy), ("Iz", section.Iz)):
            low, high = PROPORTIONS
            if not low <= moment / section.A**2 <= high:
                message = (
                    f"A {section.A:.4g} m^2 and {axis} {moment:.4g} m^4, {moment / section.A**2:.3g} of A^2; a square "
                    f"has 0.083, others {low:g} to {high:g}"
                )
    if not message:
        return ()
    return (
        Finding(
            "implausible-section",
            f"{name}: its section {section.name} has {message}. Plain numbers are m, m^2 and m^4",
            {"area_m2": section.A, "radius_of_gyration_m": float(gyration), "length_m": longest_piece},
            severe=True,
        ),
    )


def density_findings(name: str, mass: float, size: Vector) -> tuple[Finding, ...]:
    """A rigid body [kg] in a box [m] denser than any solid, or lighter than what has a shape."""
    density = mass / float(np.prod(size))
    if LIGHTEST_BLOCK <= density <= DENSEST:
        return ()
    sides = " x ".join(f"{side:.4g}" for side in size)
    return (
        Finding(
            "implausible-mass",
            f"{name}: {mass:.4g} kg in {sides} m is {density:.3g} kg/m^3; solids and machines have "
            f"{LIGHTEST_BLOCK:g} to {DENSEST:.0f}",
            {"density_kg_m3": density, "mass_kg": mass},
            severe=True,
        ),
    )
