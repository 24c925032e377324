"""What a plate can be made of beside one material: layers, or a deck known by its rigidities."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, freeze, frozen
from femstruct.declared import checked
from femstruct.elements import laminate
from femstruct.elements.plate import rigidity
from femstruct.errors import InputError
from femstruct.model.materials import (
    AnyMaterial,
    Given,
    Loss,
    Material,
    Orthotropic,
    check_loss,
    of_loss,
    of_plate,
    weighted,
)
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# What a plate or a shell is per area: rigidities, mass and loss factor, whatever it is made of.
# ----------------------------------------------------------------------------------------------------------------------

COUPLED = 1e-9  # of what B could be: beyond the rounding of a lay-up that is the same from above and below


@dataclass(frozen=True, eq=False)
class SectionShare:
    """What layers of one loss factor have of the energy of a plate: their part of its A, B, D and As.

    name : of their materials. loss_factor [1]. The parts of all layers sum to the rigidities of the plate.

    >>> from femstruct.model.materials import Material
    >>> from femstruct.model.lay_ups import Laminate, Layer
    >>> skin, core = Material("skin", 30e9, 0.2, 2400.0, 0.01), Material("core", 5e9, 0.2, 800.0, 0.1)
    >>> shares = Laminate((Layer(skin, 0.01), Layer(core, 0.1), Layer(skin, 0.01))).section.shares
    >>> [(one.name, one.loss_factor, round(float(one.A[2, 2]) / 1e6)) for one in shares]
    [('skin', 0.01, 250), ('core', 0.1, 208)]
    """

    name: str
    loss_factor: Loss
    A: Floats
    B: Floats
    D: Floats
    As: Floats

    def __post_init__(self) -> None:
        matrices = {name: frozen(f"SectionShare {name}", getattr(self, name), (3, 3)) for name in ("A", "B", "D")}
        freeze(self, **matrices, As=frozen("SectionShare As", self.As, (2, 2)))

    def turned(self, angle: float) -> SectionShare:
        """As `PlateSection.turned`."""
        return replace(self, **_turned(self, angle))


@dataclass(frozen=True, eq=False)
class PlateSection:
    """Rigidities and masses of a plate per area, about its reference surface, along its own axes x and y.

    A [3, 3] [N/m], B [3, 3] [N], D [3, 3] [N m] : (N, M) of membrane strains (eps_x, eps_y, gamma_xy) and curvatures.
    As [2, 2] : transverse shear stiffness of (gamma_xz, gamma_yz) [N/m], from the lay-up: no correction is to be added.
    m0 [kg/m^2], m1 [kg/m], m2 [kg] : mass per area and its moments. low, high : heights of its faces above the
    reference surface [m], which is in the middle unless it was moved (`about`). loss_factor, shear_loss_factor : of
    bending and of transverse shear, the layers weighted by their share of its energy [1], for what asks for one
    number. shares : of layers by their loss factor, of layers that lose differently: in its modes each loses by its
    part of the energy of any motion.

    >>> from femstruct.model.materials import Material
    >>> from femstruct.model.lay_ups import section_of
    >>> slab = section_of(Material("concrete", E=30e9, nu=0.2, rho=2400.0), 0.18)
    >>> round(float(slab.D[0, 0]) / 1e6, 4), round(slab.m0, 1), round(float(slab.As[0, 0]) / 1e9, 4)
    (15.1875, 432.0, 1.875)
    """

    A: Floats
    B: Floats
    D: Floats
    As: Floats
    m0: float
    m1: float
    m2: float
    low: float
    high: float
    loss_factor: Loss
    shear_loss_factor: Loss
    shares: tuple[SectionShare, ...] = ()

    def __post_init__(self) -> None:
        matrices = {name: frozen(f"PlateSection {name}", getattr(self, name), (3, 3)) for name in ("A", "B", "D")}
        losses = {name: of_plate(getattr(self, name), self.m0) for name in ("loss_factor", "shear_loss_factor")}
        freeze(self, **matrices, **losses, As=frozen("PlateSection As", self.As, (2, 2)))

    @property
    def thickness(self) -> float:
        """From face to face [m]."""
        return self.high - self.low

    @property
    def coupled(self) -> bool:
        """Whether it bends when it is stretched: its reference surface is not its neutral surface."""
        return float(np.abs(self.B).max()) > COUPLED * float(np.abs(self.A).max()) * self.thickness

    @property
    def bending(self) -> Floats:
        """Bending rigidity [3, 3] of a plate that nothing holds in its plane [N m]: D - B A^-1 B, about its neutral
        surface."""
        return laminate.free_to_stretch(self.A, self.B, self.D) if self.coupled else self.D

    def bending_of(self, share: SectionShare) -> Floats:
        """Part [3, 3] of layers in the energy of `bending` [N m]."""
        if not self.coupled:
            return share.D
        stretch = -np.linalg.solve(self.A, self.B)
        part: Floats = stretch.T @ share.A @ stretch + stretch.T @ share.B + share.B @ stretch + share.D
        return (part + part.T) / 2.0

    def stretching(self, angle: float = 0.0) -> float:
        """Membrane stiffness along a direction at an angle from x [rad], its sides free to draw in [N/m]: E h."""
        return float(1.0 / np.linalg.inv(laminate.rotate_stiffness(self.A, -angle))[0, 0])

    def turned(self, angle: float) -> PlateSection:
        """The same along axes from which its own x is turned by an angle about z [rad]."""
        return replace(self, **_turned(self, angle), shares=tuple(one.turned(angle) for one in self.shares))


def _turned(of: PlateSection | SectionShare, angle: float) -> dict[str, Any]:
    in_plane = {name: laminate.rotate_stiffness(getattr(of, name), angle) for name in ("A", "B", "D")}
    return {**in_plane, "As": laminate.rotate_shear(of.As, angle)}


# ----------------------------------------------------------------------------------------------------------------------
# What a plate can be made of beside one material.
# ----------------------------------------------------------------------------------------------------------------------

SHEAR_FACTOR = 5.0 / 6.0  # of a homogeneous plate: a parabola of shear stress


@stored_as("layer/1")
@dataclass(frozen=True)
@checked("layers")
class Layer:
    """A layer of a plate: material, thickness [m], and the angle from the plate's x to the material's x about z [rad].

    >>> Layer(Material("gypsum", E=2.5e9, nu=0.3, rho=800.0), 12.5e-3).angle
    0.0
    """

    material: AnyMaterial
    thickness: float
    angle: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.thickness < np.inf:
            raise InputError("layers.thickness", got=f"{self.thickness:g} m", expected="a positive length")


@stored_as("laminate/1")
@dataclass(frozen=True)
@checked("laminate")
class Laminate:
    """Layers from the lower face up, bonded without slip; stands where a plate takes a material.

    like : the entry of the library that they were taken from, with its source.
    bond : 1 for glued layers, 0 for boards that slip on each other: each bends about its own middle, so that two equal
    boards have 2 D, where glued ones have 8 D of one. Screwed boards lie between: rigidities are that share of the way.

    A sandwich is skins and a soft core: the core shears.

    >>> spruce = Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 50e6), nu=0.35, rho=420.0)
    >>> clt = Laminate(tuple(Layer(spruce, 0.04, angle) for angle in (0.0, np.pi / 2, 0.0, np.pi / 2, 0.0)))
    >>> section = clt.section
    >>> (section.D[0, 0] / 1e6).round(3), (section.As[0, 0] / 1e6).round(2), round(section.m0)
    (np.float64(5.884), np.float64(15.92), 84)
    """

    layers: tuple[Layer, ...]
    like: str = ""
    bond: float = 1.0

    def __post_init__(self) -> None:
        if not self.layers:
            raise InputError("laminate.layers", got="no layer", expected="one or more")
        if not 0.0 <= self.bond <= 1.0:
            raise InputError("laminate.bond", got=f"{self.bond:g}", expected="from 0 (slipping) to 1 (glued)")

    @property
    def thickness(self) -> float:
        """Of all layers [m]."""
        return float(sum(layer.thickness for layer in self.layers))

    def described(self) -> tuple[Given, ...]:
        """Its layers in words, for tables of inputs."""
        layers = (
            f"{one.material.name} {1e3 * one.thickness:.6g} mm"
            + (f" at {np.degrees(one.angle):.6g}°" if one.angle else "")
            for one in self.layers
        )
        more = (Given("like", self.like),) if self.like else ()
        return (Given("layers", tuple(layers)), *more, *((Given("bond", self.bond),) if self.bond < 1.0 else ()))

    @property
    def materials(self) -> tuple[AnyMaterial, ...]:
        """Of its layers, each once."""
        return tuple(dict.fromkeys(layer.material for layer in self.layers))

    @property
    def section(self) -> PlateSection:
        """Rigidities and masses about the middle of the thickness."""
        stiff, soft, z = self._stiffnesses()
        axis = next((layer.angle for layer in self.layers if isinstance(layer.material, Orthotropic)), 0.0)
        losses = [layer.material.loss_factor for layer in self.layers]
        (A, B, D), shear = laminate.stiffness(stiff, z), laminate.shear_stiffness(stiff, soft, z, axis)
        bends, shears = laminate.bending_shares(stiff, z), laminate.shear_shares(stiff, soft, z, axis)
        if self.bond < 1.0:
            B, D, bends = laminate.with_slip(stiff, z, self.bond)
            alone = SHEAR_FACTOR * soft * np.diff(z)[:, None, None]
            shear = self.bond * shear + (1.0 - self.bond) * alone.sum(axis=0)
            slips = np.trace(alone, axis1=1, axis2=2) / np.trace(alone.sum(axis=0))
            shears = self.bond * shears + (1.0 - self.bond) * slips
        return PlateSection(
            A,
            B,
            D,
            shear,
            *laminate.inertia([layer.material.rho for layer in self.layers], z),
            low=float(z[0]),
            high=float(z[-1]),
            loss_factor=weighted(losses, bends),
            shear_loss_factor=weighted(losses, shears),
            shares=self._shares(stiff, soft, z, axis),
        )

    def _shares(self, stiff: Floats, soft: Floats, z: Floats, axis: float) -> tuple[SectionShare, ...]:
        """What layers of each loss factor have of the rigidities; none where all lose alike."""
        losses = list(dict.fromkeys(layer.material.loss_factor for layer in self.layers))
        if len(losses) == 1:
            return ()
        of = np.array([losses.index(layer.material.loss_factor) for layer in self.layers])
        shear = laminate.layer_shear_stiffness(stiff, soft, z, axis, of)
        A, B, D = laminate.layer_stiffness(stiff, z)
        alone = SHEAR_FACTOR * soft * np.diff(z)[:, None, None]
        B, D = self.bond * B, self.bond * D + (1.0 - self.bond) * laminate.bending_alone(stiff, z)
        found = []
        for number, loss in enumerate(losses):
            own = of == number
            names = dict.fromkeys(layer.material.name for layer in self.layers if layer.material.loss_factor == loss)
            across = self.bond * shear[number] + (1.0 - self.bond) * alone[own].sum(axis=0)
            membrane, coupling, bends = (matrix[own].sum(axis=0) for matrix in (A, B, D))
            found.append(SectionShare(", ".join(names), loss, membrane, coupling, bends, across))
        return tuple(found)

    def stresses(self, N: ArrayLike, M: ArrayLike) -> Floats:
        """Stresses (sigma_x, sigma_y, tau_xy) [m, n, 2, 3] in Pa along the plate's axes at the lower and upper face of
        its n layers, from membrane forces N [m, 3] [N/m] and moments M [m, 3] [N] per length."""
        stiff, _, z = self._stiffnesses()
        self._refuse_slipping()
        return laminate.layer_stresses(stiff, z, N, M)

    def shear_stresses(self, V: ArrayLike, share: ArrayLike = (0.0, 0.5, 1.0)) -> Floats:
        """Transverse shear stresses (tau_xz, tau_yz) [m, n, k, 2] in Pa in its n layers at shares [k] of their height,
        from shear forces V [m, 2] per length [N/m]."""
        stiff, _, z = self._stiffnesses()
        self._refuse_slipping()
        return laminate.shear_stresses(stiff, z, V, share)

    def _refuse_slipping(self) -> None:
        if self.bond < 1.0:
            raise InputError("stresses", got=f"boards with a bond of {self.bond:g}", expected="layers without slip")

    def _stiffnesses(self) -> tuple[Floats, Floats, Floats]:
        """In plane [n, 3, 3] and across [n, 2, 2] along the plate's axes [Pa], and the heights of the faces [m]."""
        angles = np.array([layer.angle for layer in self.layers])
        constants = np.array([_constants(layer.material) for layer in self.layers])
        stiff = laminate.plane_stress(*constants[:, :4].T)
        soft = constants[:, 4:, None] * np.eye(2)
        z = laminate.bounds([layer.thickness for layer in self.layers])
        return laminate.rotate_stiffness(stiff, angles), laminate.rotate_shear(soft, angles), z


@stored_as("smeared layers/1")
@dataclass(frozen=True)
@checked("smeared")
class Smeared:
    """A deck known by its rigidities: ribs, corrugations or hollows smeared over its area, along the plate's x and y.

    D : bending rigidities (Dx, Dy, D12, D66) [N m]; the torsional stiffness usually called 2 H is 2 D12 + 4 D66.
    S : transverse shear stiffnesses (Sx, Sy) [N/m]. mass : per area [kg/m^2]. thickness : from face to face [m].
    A : membrane rigidities (Ax, Ay, A12, A66) [N/m]; without them 12 D / thickness^2, those of a homogeneous plate.
    Its rotary inertia is that of a homogeneous plate, mass thickness^2 / 12. loss_factor [1].

    Raises InputError for values that are not positive, and where D12^2 >= Dx Dy.

    >>> Smeared(D=(5.9e6, 1.7e6, 0.09e6, 0.46e6), S=(16e6, 10e6), mass=84.0, thickness=0.2).section.D[1, 1]
    np.float64(1700000.0)
    """

    D: tuple[float, float, float, float]
    S: tuple[float, float]
    mass: float
    thickness: float
    A: tuple[float, float, float, float] | None = None
    loss_factor: Loss = 0.0

    def __post_init__(self) -> None:
        checked: list[tuple[str, tuple[float, ...], int]] = [("D", self.D, 4), ("S", self.S, 2)]
        for key, values, count in checked if self.A is None else [*checked, ("A", self.A, 4)]:
            if len(values) != count or not all(value > 0 for value in (values[0], values[1], values[-1])):
                got = ", ".join(f"{value:g}" for value in values)
                raise InputError(f"smeared.{key}", got=got, expected=f"{count} rigidities above 0")
            if count == 4 and not values[2] ** 2 < values[0] * values[1]:
                least = np.sqrt(values[0] * values[1])
                raise InputError(
                    f"smeared.{key}",
                    got=f"{key}12 = {values[2]:g}",
                    expected=f"less than sqrt({key}x {key}y) = {least:.4g}",
                    do=f"the order is {key}x, {key}y, {key}12, {key}66",
                )
        for key, value in (("mass", self.mass), ("thickness", self.thickness)):
            if not value > 0:
                raise InputError(f"smeared.{key}", got=f"{value:g}", expected="a positive value")
        check_loss("smeared.loss_factor", self.loss_factor)

    def described(self) -> tuple[Given, ...]:
        """Its rigidities, for tables of inputs; the thickness is the plate's."""
        membrane = () if self.A is None else (Given("A", self.A, "N/m"),)
        values = (
            Given("D", self.D, "N m"),
            Given("S", self.S, "N/m"),
            *membrane,
            Given("mass per area", self.mass, "kg/m^2"),
        )
        return (*values, of_loss(self.loss_factor))

    @property
    def materials(self) -> tuple[AnyMaterial, ...]:
        """None that is known."""
        return ()

    @property
    def section(self) -> PlateSection:
        """Rigidities and masses about the middle of the thickness."""
        D, h = _orthotropic(self.D), self.thickness
        return PlateSection(
            A=12.0 / h**2 * D if self.A is None else _orthotropic(self.A),
            B=np.zeros((3, 3)),
            D=D,
            As=np.diag(self.S),
            m0=self.mass,
            m1=0.0,
            m2=self.mass * h**2 / 12.0,
            low=-h / 2.0,
            high=h / 2.0,
            loss_factor=self.loss_factor,
            shear_loss_factor=self.loss_factor,
        )


LayUp = Laminate | Smeared


def materials_of(made_of: AnyMaterial | LayUp) -> tuple[AnyMaterial, ...]:
    """What a part is made of that takes a material or a lay-up."""
    return made_of.materials if isinstance(made_of, LayUp) else (made_of,)


def section_of(made_of: AnyMaterial | LayUp, thickness: float) -> PlateSection:
    """Rigidities and masses of a plate of one material, of layers, or smeared, about the middle of its thickness.

    Parameters
    ----------
    thickness : float [m]
        Of one material; that of a lay-up is its own.

    Examples
    --------
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> one = Laminate((Layer(steel, 5e-3),)).section
    >>> bool(np.allclose(section_of(steel, 5e-3).As, one.As, rtol=1e-12))
    True
    """
    if isinstance(made_of, LayUp):
        return made_of.section
    if isinstance(made_of, Orthotropic):
        return Laminate((Layer(made_of, thickness),)).section
    mass, bends = made_of.rho * thickness, rigidity(made_of.E, made_of.nu, thickness)
    return PlateSection(
        A=12.0 / thickness**2 * bends,
        B=np.zeros((3, 3)),
        D=bends,
        As=SHEAR_FACTOR * made_of.G * thickness * np.eye(2),
        m0=mass,
        m1=0.0,
        m2=mass * thickness**2 / 12.0,
        low=-thickness / 2.0,
        high=thickness / 2.0,
        loss_factor=made_of.loss_factor,
        shear_loss_factor=made_of.loss_factor,
    )


def stresses_of_resultants(made_of: AnyMaterial | LayUp, thickness: float) -> tuple[Floats, Floats]:
    """Heights [s] of faces [m] and the stresses (xx, yy, xy) there of membrane forces [1/m] and moments per length
    [1/m^2], [s, 3, 6]: of one material the face of the normal and the other, of layers the lower and the upper face of
    each, from below.

    Raises InputError for smeared ribs, whose stresses are not known.

    >>> heights, stresses = stresses_of_resultants(Material("steel", E=210e9, nu=0.3, rho=7850.0), 2.0)
    >>> heights.tolist(), stresses[:, 0, 0].tolist(), stresses[:, 0, 3].tolist()  # N / t, 6 M / t^2
    ([1.0, -1.0], [0.5, 0.5], [1.5, -1.5])
    """
    if isinstance(made_of, Smeared):
        raise InputError("stresses", got="smeared ribs", expected="a material or layers", do="model the ribs as parts")
    if isinstance(made_of, Laminate):
        moved = made_of.stresses(np.eye(6, 3), np.eye(6, 3, -3))
        z = laminate.bounds([layer.thickness for layer in made_of.layers])
        heights = np.stack([z[:-1], z[1:]], axis=1).ravel()
        return heights, np.asarray(np.moveaxis(moved, 0, -1).reshape(len(heights), 3, 6))
    signs = np.array([1.0, -1.0])
    of_moments = signs[:, None, None] * (6.0 / thickness**2 * np.eye(3))
    of_forces = np.broadcast_to(np.eye(3) / thickness, of_moments.shape)
    return signs * thickness / 2.0, np.concatenate([of_forces, of_moments], axis=2)


def _constants(material: AnyMaterial) -> tuple[float, float, float, float, float, float]:
    """E1, E2, nu12, G12, G13, G23."""
    if isinstance(material, Material):
        return material.E, material.E, material.nu, material.G, material.G, material.G
    (Ex, Ey, _), (Gxy, Gyz, Gzx) = material.E, material.G
    return Ex, Ey, material.ratios[0], Gxy, Gzx, Gyz


def _orthotropic(values: tuple[float, float, float, float]) -> Floats:
    x, y, both, twist = values
    return np.array([[x, both, 0.0], [both, y, 0.0], [0.0, 0.0, twist]])
