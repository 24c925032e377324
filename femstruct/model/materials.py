"""Materials: isotropic, orthotropic, timber by class; loss factors by frequency; walls at the edges of plates."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, fields, replace
from itertools import pairwise
from typing import Any, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, freeze
from femstruct.declared import checked
from femstruct.elements import solid
from femstruct.errors import InputError
from femstruct.model.sections import Section
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Loss factors that depend on frequency.
# ----------------------------------------------------------------------------------------------------------------------

LABORATORY: Final = "laboratory"
MEASURED: Final = "measured"
INTERNAL = 0.01  # ISO 12354-1: common homogeneous building materials
LABORATORY_BAND = (50.0, 5000.0)  # Hz
STEPS = 12  # an octave of points: 1e-4 of m' / (485 sqrt f) between them
DECAY = 2.2  # 6 ln 10 / 2 pi = 2.199, as the standards have it
MOST_LOSSES = 1.5  # of rubbers at their glass transition; a few reach 2 in a narrow band, which one number is not


@stored_as("loss factor by frequency/1")
@dataclass(frozen=True)
@checked("loss_factor")
class LossByFrequency:
    """A loss factor given at some frequencies; between them straight over log f, beyond them that of the nearest.

    points : (frequency [Hz], loss factor [1]), ascending. total : of what such a number holds beside the losses in the
    material itself, those at the edges and by radiation: "" for nothing of them, "measured" for one from structural
    reverberation times (`measured_losses`), "laboratory" for one of ISO 12354-1 (`laboratory_losses`), whose points are
    the internal losses until the mass per area of the plate is known (`of_plate`): mass [kg/m^2], 0 before.

    Raises InputError for no point, for frequencies that are not positive or do not ascend, and for loss factors below 0
    or above 1.5.

    >>> loss = LossByFrequency(((63.0, 0.06), (252.0, 0.02)))
    >>> loss.at([20.0, 63.0, 126.0, 1000.0]).round(6).tolist()
    [0.06, 0.06, 0.04, 0.02]
    """

    points: tuple[tuple[float, float], ...]
    total: Literal["", "measured", "laboratory"] = ""
    mass: float = 0.0

    def __post_init__(self) -> None:
        frequencies = [frequency for frequency, _ in self.points]
        if not frequencies or not frequencies[0] > 0 or any(not low < high for low, high in pairwise(frequencies)):
            listed = ", ".join(f"{frequency:g}" for frequency in frequencies)
            raise InputError("loss_factor", got=f"[{listed}] Hz", expected="positive frequencies that ascend")
        for frequency, value in self.points:
            check_loss(f"loss_factor.{frequency:g} Hz", value)

    def __str__(self) -> str:
        if self.total == LABORATORY:
            plate = f", {self.mass:.4g} kg/m^2" if self.mass else ""
            internal = self.points[0][1] - (edge_losses(self.mass, self.points[0][0]) if self.mass else 0.0)
            return f"ISO 12354-1 laboratory, internal {100 * internal:.4g} %{plate}"
        return ", ".join(f"{100 * value:.5g} % at {frequency:g} Hz" for frequency, value in self.points)

    @property
    def band(self) -> tuple[float, float]:
        """The lowest and the highest frequency that it is given at [Hz]."""
        return self.points[0][0], self.points[-1][0]

    def at(self, frequency_hz: ArrayLike) -> Floats:
        """Loss factors [...] at frequencies [...] [Hz]; at 0 Hz that of the lowest."""
        frequencies, values = np.array(self.points).T
        clipped = np.clip(np.asarray(frequency_hz, dtype=np.float64), *self.band)
        return np.asarray(np.interp(np.log(clipped), np.log(frequencies), values))


Loss = float | LossByFrequency


def laboratory_losses(internal: float = INTERNAL) -> LossByFrequency:
    """The total loss factor of heavy plates in a laboratory, internal + m' / (485 sqrt f), m' their mass per area.

    Parameters
    ----------
    internal : float
        Loss factor of the material itself [1]; ISO 12354-1 has 1 % for common homogeneous materials.

    Notes
    -----
    ISO 12354-1, annex C: for m' below 800 kg/m^2, at 50 Hz to 5 kHz; beyond, the value of the nearest of these. The
    second term is of the edges of the laboratory, so that edges with losses of their own count them twice.

    Examples
    --------
    >>> from femstruct.model.materials import of_plate
    >>> of_plate(laboratory_losses(0.006), 322.0).at([50.0, 200.0, 1000.0]).round(4).tolist()
    [0.0999, 0.0529, 0.027]
    """
    return LossByFrequency(((LABORATORY_BAND[0], internal), (LABORATORY_BAND[1], internal)), LABORATORY)


def measured_losses(times: Mapping[float, float]) -> LossByFrequency:
    """The total loss factors 2.2 / (f T) of structural reverberation times T [s] by frequency f [Hz].

    Raises InputError for times with which a loss factor is beyond 1.5.

    >>> measured_losses({100.0: 0.304, 50.0: 0.44}).at([50.0, 100.0]).round(4).tolist()
    [0.1, 0.0724]
    """
    found = [(frequency, DECAY / (frequency * time)) for frequency, time in sorted(times.items())]
    return LossByFrequency(tuple(found), MEASURED)


def of_plate(loss: Loss, mass: float) -> Loss:
    """The loss factor of a plate of a mass per area [kg/m^2]: one of a laboratory with its second term.

    >>> of_plate(0.02, 345.0)
    0.02
    """
    if not isinstance(loss, LossByFrequency) or loss.total != LABORATORY or loss.mass or not mass > 0.0:
        return loss
    low, high = LABORATORY_BAND
    frequencies = np.geomspace(low, high, round(STEPS * np.log2(high / low)) + 1)
    values = loss.at(frequencies) + edge_losses(mass, frequencies)
    points = tuple(zip(frequencies.tolist(), np.minimum(values, MOST_LOSSES).tolist(), strict=True))
    return LossByFrequency(points, LABORATORY, mass)


def edge_losses(mass: float, frequency_hz: ArrayLike) -> Floats:
    """m' / (485 sqrt f): what the edges of a laboratory take of a plate of a mass per area [kg/m^2] [1]."""
    return np.asarray(mass / (485.0 * np.sqrt(np.asarray(frequency_hz, dtype=np.float64))))


def refuse_laboratory(where: str, loss: Loss) -> Loss:
    """The loss factor of what is no plate; InputError for one of ISO 12354-1, which takes a mass per area."""
    if isinstance(loss, LossByFrequency) and loss.total == LABORATORY:
        got, expected = "a loss factor of ISO 12354-1 in a part without mass per area", "a plate, slab or shell"
        raise InputError(where, got=got, expected=expected, do="give it a material with a loss factor as a number")
    return loss


def loss_at(loss: Loss, frequency_hz: ArrayLike) -> Floats:
    """Loss factors [...] at frequencies [...] [Hz] of one number or a table.

    >>> loss_at(0.02, [10.0, 20.0]).tolist()
    [0.02, 0.02]
    """
    if isinstance(loss, LossByFrequency):
        return loss.at(frequency_hz)
    return np.full(np.shape(frequency_hz), loss, dtype=np.float64)


def weighted(losses: Sequence[Loss], shares: ArrayLike) -> Loss:
    """The loss factor of what shares its energy between parts of these; one of them where all are alike.

    >>> weighted([0.01, LossByFrequency(((100.0, 0.03), (200.0, 0.05)))], [0.5, 0.5]).at([100.0, 200.0]).round(9)
    array([0.02, 0.03])
    """
    parts = np.asarray(shares, dtype=np.float64)
    if len(set(losses)) == 1:
        return losses[0]
    for one in losses:
        refuse_laboratory("layers", one)
    tables = [one for one in losses if isinstance(one, LossByFrequency)]
    if not tables:
        return float(parts @ np.array(losses, dtype=np.float64))
    grid = sorted({frequency for one in tables for frequency, _ in one.points})
    mean = parts @ np.array([loss_at(one, grid) for one in losses])
    return LossByFrequency(tuple(zip(grid, mean.tolist(), strict=True)))


def check_loss(where: str, loss: Loss) -> None:
    """Raise InputError for a loss factor that no material has; a table has compared its own."""
    if isinstance(loss, LossByFrequency) or 0 <= loss <= MOST_LOSSES:
        return
    raise InputError(
        where,
        got=f"{loss:g}",
        expected=f"a loss factor from 0 to {MOST_LOSSES:g}",
        do=f"2 % is 0.02: did you mean {loss:g} %?" if loss > 0 else "remove the sign",
    )


# ----------------------------------------------------------------------------------------------------------------------
# Linear elastic, isotropic materials.
# ----------------------------------------------------------------------------------------------------------------------

DENSEST = 23_000.0
"""Density [kg/m^3] that no solid exceeds: osmium has 22 600."""
IMPOSSIBLE = 1e5  # kg/m^3: beyond it a density is none, not even that of a sheet that stands for what it carries


@stored_as("material/1")
@dataclass(frozen=True)
@checked("materials")
class Material:
    """Linear elastic isotropic material.

    E : Young's modulus [Pa]. nu : Poisson's ratio [1]. rho : density [kg/m^3]. loss_factor : eta in K (1 + j eta) [1],
    one number or a table by frequency. completed : what was taken from the library, with the works that print it.

    Raises InputError for values that cannot be: E not above zero, nu not between -1 and 0.5, a density below zero
    or beyond 1e5 kg/m^3, a loss factor below zero or beyond 1.5.

    >>> round(Material("steel", E=210e9, nu=0.3, rho=7850.0).G / 1e9, 2)
    80.77
    """

    name: str
    E: float
    nu: float
    rho: float
    loss_factor: Loss = 0.0
    completed: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"materials.{self.name}"
        if not self.E > 0:
            raise InputError(f"{where}.E", got=f"{self.E:g} Pa", expected="a positive modulus")
        if not -1 < self.nu < 0.5:
            raise InputError(f"{where}.nu", got=f"{self.nu:g}", expected="a Poisson's ratio between -1 and 0.5")
        if not self.rho >= 0:
            raise InputError(f"{where}.rho", got=f"{self.rho:g} kg/m^3", expected="a density >= 0")
        if not self.rho <= IMPOSSIBLE:
            raise InputError(
                f"{where}.rho",
                got=f"{self.rho:g} kg/m^3",
                expected=f"a density; the densest solid has {DENSEST:.0f} kg/m^3",
                do="plain numbers are kg/m^3" + (f": {self.rho / 1e3:g}?" if self.rho <= 1e3 * DENSEST else ""),
            )
        check_loss(f"{where}.loss_factor", self.loss_factor)

    @property
    def G(self) -> float:
        """Shear modulus E / 2(1 + nu) [Pa]."""
        return self.E / (2.0 * (1.0 + self.nu))


# ----------------------------------------------------------------------------------------------------------------------
# Linear elastic, orthotropic materials: timber, fibre composites, corrugated and cored boards.
# ----------------------------------------------------------------------------------------------------------------------


@stored_as("orthotropic material/1")
@dataclass(frozen=True)
@checked("materials")
class Orthotropic:
    """Linear elastic orthotropic material by nine constants along its own axes x, y, z, z being across a plate.

    E : Young's moduli (Ex, Ey, Ez) [Pa]; (Ex, Ey) has Ez = Ey. G : shear moduli (Gxy, Gyz, Gzx) [Pa]; (Gxy, Gyz) has
    Gzx = Gxy. Gyz is the rolling shear of timber, which decides how crosswise layers shear, and is never guessed.
    nu : (nuxy, nuyz, nuzx) [1], nuij being the contraction along j under stress along i, so nuxy / Ex = nuyx / Ey; a
    number alone is nuxy, with nuyz = nuxy and nuzx = nuxy Ez / Ex (nuxz = nuxy). rho : density [kg/m^3]. loss_factor :
    eta in K (1 + j eta) [1], one number or a table by frequency. completed : the constants that were not given, with
    what they follow from. A plate uses Ex, Ey, nuxy and the shear moduli; a solid uses all.

    Raises InputError for moduli that are not positive, and for ratios with which the elastic energy could be
    negative, with both numbers.

    >>> spruce = Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 69e6), nu=0.35, rho=420.0)
    >>> spruce.E[2] / 1e6, spruce.completed
    (370.0, ('Ez = Ey', 'Gzx = Gxy', 'nuyz = nuxy', 'nuzx = nuxy Ez / Ex'))
    """

    name: str
    E: tuple[float, ...]
    G: tuple[float, ...]
    nu: float | tuple[float, ...]
    rho: float
    loss_factor: Loss = 0.0
    completed: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"materials.{self.name}"
        for key, values in (("E", self.E), ("G", self.G)):
            if len(values) not in (2, 3) or not all(value > 0 for value in values):
                got = f"({', '.join(f'{one:g}' for one in values)}) Pa"
                raise InputError(f"{where}.{key}", got=got, expected="two or three positive moduli")
        E, G, completed = self.E, self.G, list(self.completed)
        if len(E) == 2:
            E, completed = (*E, E[1]), [*completed, "Ez = Ey"]
        if len(G) == 2:
            G, completed = (*G, G[0]), [*completed, "Gzx = Gxy"]
        nu = self.nu if isinstance(self.nu, tuple) else (self.nu,)
        if len(nu) == 1:
            nu = (nu[0], nu[0], nu[0] * E[2] / E[0])
            completed += ["nuyz = nuxy", "nuzx = nuxy Ez / Ex"]
        if len(nu) != 3:
            raise InputError(f"{where}.nu", got=f"{len(nu)} ratios", expected="nuxy, or nuxy, nuyz and nuzx")
        freeze(self, E=E, G=G, nu=nu, completed=tuple(completed))
        Material(
            self.name, E=min(E), nu=0.0, rho=self.rho, loss_factor=self.loss_factor
        )  # refuses what no material has
        try:
            solid.hooke(self.E, self.G, self.ratios)  # refuses ratios that would give energy away
        except InputError as error:
            raise InputError(f"{where}.nu", got=error.got, expected=error.expected, do=error.do) from None

    @property
    def ratios(self) -> tuple[float, float, float]:
        """nuxy, nuyz, nuzx [1]."""
        xy, yz, zx = self.nu if isinstance(self.nu, tuple) else (self.nu,) * 3
        return xy, yz, zx

    @property
    def elasticity(self) -> Floats:
        """Stresses xx yy zz xy yz zx [6, 6] in Pa of unit strains along its axes, for solids."""
        return solid.hooke(self.E, self.G, self.ratios)


AnyMaterial = Material | Orthotropic


# ----------------------------------------------------------------------------------------------------------------------
# What is given of a noun: its numbers by name with their units, as they were put in.
# ----------------------------------------------------------------------------------------------------------------------


class Given(NamedTuple):
    """One input: what it is called, its value in SI units (a number, several, a text, a material), its unit."""

    what: str
    value: Any
    unit: str = ""


def given_fields(noun: Any, units: Mapping[str, str]) -> tuple[Given, ...]:
    """The fields of a frozen dataclass by name, its own name and what is as by default left out.

    Parameters
    ----------
    units : Mapping[str, str]
        Of the fields that have one.

    Examples
    --------
    >>> from femstruct.model.materials import Material
    >>> given_fields(Material("steel", E=210e9, nu=0.3, rho=7850.0), {"E": "Pa", "rho": "kg/m^3"})[0]
    Given(what='E', value=210000000000.0, unit='Pa')
    """
    return tuple(
        Given(field.name.removesuffix("_hz").replace("_", " "), comparable(value), units.get(field.name, ""))
        for field in fields(noun)
        if field.name != "name" and not _as_by_default(field, value := getattr(noun, field.name))
    )


def comparable(value: Any) -> Any:
    """A value that can be compared and kept: rows of numbers as tuples.

    >>> comparable(np.zeros((2, 1)))
    ((0.0,), (0.0,))
    """
    rows = value.tolist() if isinstance(value, np.ndarray) else value
    return tuple(map(comparable, rows)) if isinstance(rows, tuple | list) else rows


def _as_by_default(field: Field[Any], value: object) -> bool:
    default = field.default_factory() if field.default_factory is not MISSING else field.default
    return type(value) is type(default) and bool(value == default)


def of_material(material: AnyMaterial) -> tuple[Given, ...]:
    """All of a material; a loss factor of zero, too, and what was completed of an orthotropic one.

    >>> from femstruct.model.materials import Material
    >>> of_material(Material("steel", E=210e9, nu=0.3, rho=7850.0))[-1]
    Given(what='loss factor', value=0.0, unit='')
    """
    first = (
        Given("E", material.E, "Pa"),
        Given("rho", material.rho, "kg/m^3"),
        Given("nu", material.nu),
        of_loss(material.loss_factor),
    )
    completed = (Given("completed", material.completed),) if material.completed else ()
    if not isinstance(material, Orthotropic):
        return (*first, *completed)
    return (*first, Given("G", material.G, "Pa"), *completed)


def of_loss(loss: Loss) -> Given:
    """A loss factor, by frequency in words.

    >>> of_loss(LossByFrequency(((63.0, 0.06), (125.0, 0.05)))).value
    ('6 % at 63 Hz', '5 % at 125 Hz')
    """
    return Given("loss factor", tuple(str(loss).split(", ")) if isinstance(loss, LossByFrequency) else loss)


def of_section(section: Section) -> tuple[Given, ...]:
    """All of a cross-section, but its shear coefficients.

    >>> of_section(Section("bar", A=1e-4, Iy=1e-9, Iz=1e-9, J=2e-9))[0]
    Given(what='A', value=0.0001, unit='m^2')
    """
    moments = (Given(name, getattr(section, name), "m^4") for name in ("Iy", "Iz", "J"))
    return (Given("A", section.A, "m^2"), *moments)


# ----------------------------------------------------------------------------------------------------------------------
# A material as a bar has it: one modulus along the axis, shear in two planes.
# ----------------------------------------------------------------------------------------------------------------------


def of_bar(material: AnyMaterial, section: Section) -> tuple[float, float, Section]:
    """E along a bar [Pa], G of its torsion [Pa], and the section with shear coefficients that go with this G.

    The x of an orthotropic material is along the axis, its y and z along those of the section. Bending along y shears
    with Gxy, along z with Gzx; torsion with the root of both, which is exact where they are alike, as nearly in timber.

    >>> from femstruct.model.materials import Orthotropic
    >>> spruce = Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 50e6, 690e6), nu=0.35, rho=420.0)
    >>> of_bar(spruce, Section("joist", A=0.02, Iy=1e-4, Iz=2e-5, J=5e-5))[:2]
    (11000000000.0, 690000000.0)
    """
    if isinstance(material, Material):
        return material.E, material.G, section
    xy, _, zx = material.G
    G = float(np.sqrt(xy * zx))
    return material.E[0], G, replace(section, ky=section.ky * xy / G, kz=section.kz * zx / G)


# ----------------------------------------------------------------------------------------------------------------------
# Structural timber by strength class.
# ----------------------------------------------------------------------------------------------------------------------

SOURCE: Final = "EN 338"
ROLLING: Final = 0.1
"""Rolling shear over shear modulus, the usual assumption. Measured on boards: 65 to 101 MPa (cedar and cypress,
doi:10.1186/s10086-021-01954-y, table 5); it is the least known number of cross-laminated timber."""
NU: Final = 0.35
"""Poisson's ratio, for which the standard has none; plates hardly depend on it."""
_MEANS: Final = {  # E along and across the grain, shear modulus [MPa], density [kg/m^3], all means
    "C18": (9000.0, 300.0, 560.0, 380.0),
    "C24": (11000.0, 370.0, 690.0, 420.0),
    "C30": (12000.0, 400.0, 750.0, 460.0),
}
CLASSES: Final = tuple(_MEANS)


def timber(
    name: str,
    strength_class: str,
    G: tuple[float, ...] | None = None,
    rho: float | None = None,
    loss_factor: Loss = 0.0,
) -> Orthotropic:
    """Softwood of a strength class, x along the grain, with the means of EN 338 as makers print them (KVH structural
    timber, kvh.eu, "Strength, rigidity and density characteristics"); what the standard does not say is `completed`.

    Parameters
    ----------
    G, rho : tuple[float, ...] | None, float | None
        In place of those of the class, where they are known better.

    Examples
    --------
    >>> spruce = timber("boards", "C24")
    >>> spruce.E[:2], spruce.G[1], spruce.rho
    ((11000000000.0, 370000000.0), 69000000.0, 420.0)
    >>> spruce.completed
    ('C24 of EN 338', 'Ez = Ey', 'Gyz = 0.1 Gxy', 'Gzx = Gxy', 'nuxy = nuyz = nuxz = 0.35')
    """
    along, across, shear, density = _MEANS[strength_class]
    completed = [f"{strength_class} of {SOURCE}", "Ez = Ey", f"nuxy = nuyz = nuxz = {NU:g}"]
    if G is None:
        G, completed[2:2] = (1e6 * shear, 1e6 * ROLLING * shear, 1e6 * shear), [f"Gyz = {ROLLING:g} Gxy", "Gzx = Gxy"]
    E = (1e6 * along, 1e6 * across, 1e6 * across)
    nu = (NU, NU, NU * across / along)
    return Orthotropic(name, E, G, nu, density if rho is None else rho, loss_factor, tuple(completed))


# ----------------------------------------------------------------------------------------------------------------------
# Walls that stand at the edge of a plate and are not modelled: what they resist to its rotation, and take of it.
# ----------------------------------------------------------------------------------------------------------------------

WALLS_AT: Final = 100.0  # Hz: frequency at which a model holds their stiffness; it grows with the square root


@stored_as("wall at an edge/1")
@dataclass(frozen=True)
@checked("supports")
class EdgeWall:
    """A wall at the edge of a plate, as a semi-infinite plate: the bending waves that it takes do not return.

    material : isotropic. thickness [m].

    Raises InputError for a thickness or a density that is not positive.

    Notes
    -----
    Per length and radian its edge resists with B k (1 + j) where the edge is pinned, k = (m omega^2 / B)^(1/4) being
    the wave number of bending in the wall: a spring with a loss factor of 1 that grows with the root of frequency.
    With B (1 + j eta) of the material it is (1 + j eta)^(3/4) times that. The wave in the wall runs straight away from
    the edge; that of a mode with a wave number k_e along the edge does not, and resists with
    B [sqrt(k^2 + k_e^2) + j sqrt(k^2 - k_e^2)] (no losses where k_e > k). Walls of a real building return part of what
    they take; in the mean over frequency the semi-infinite wall holds (L. Cremer, M. Heckl, B. Petersson,
    Structure-Borne Sound, 3rd edition, chapter 6).

    A wall of masonry, 175 mm:

    >>> wall = EdgeWall(Material("masonry", E=5e9, nu=0.2, rho=1400.0), 0.175)
    >>> round(wall.stiffness(100.0) / 1e6, 3), round(wall.loss_factor, 3)
    (5.907, 1.0)
    """

    material: Material
    thickness: float

    def __post_init__(self) -> None:
        if not self.thickness > 0.0:
            got = f"{self.thickness:g} m"
            raise InputError("supports.wall.thickness", got=got, expected="a positive length")
        if not self.material.rho > 0.0:
            got = f"a wall of {self.material.name}, whose density is 0"
            raise InputError("supports.wall.material", got=got, expected="a material with mass")

    @property
    def _lossy(self) -> complex:
        """(1 + j) (1 + j eta)^(3/4) of its material."""
        loss = float(loss_at(self.material.loss_factor, WALLS_AT))
        return (1.0 + 1.0j) * (1.0 + 1.0j * loss) ** 0.75

    @property
    def bending(self) -> float:
        """Bending stiffness per width [N m]."""
        return self.material.E * self.thickness**3 / (12.0 * (1.0 - self.material.nu**2))

    def stiffness(self, frequency_hz: float) -> float:
        """Real part of its rotational stiffness per length at a frequency [N m/rad/m]."""
        mass = self.material.rho * self.thickness
        wave_number: float = (mass * (2.0 * math.pi * frequency_hz) ** 2 / self.bending) ** 0.25
        return self.bending * wave_number * self._lossy.real

    @property
    def loss_factor(self) -> float:
        """Of that stiffness [1]: imaginary over real part, at any frequency."""
        return self._lossy.imag / self._lossy.real
