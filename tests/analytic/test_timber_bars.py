"""Bars of orthotropic materials against Timoshenko's closed form in both planes, and in torsion."""

from __future__ import annotations

import numpy as np
import pytest

import femstruct as fs
from femstruct.model.sections import rectangle

SPRUCE = fs.Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 50e6, 350e6), nu=0.35, rho=420.0)
LENGTH, WIDTH, HEIGHT = 2.0, 0.08, 0.24
SECTION = rectangle("joist", WIDTH, HEIGHT)


def frequencies(material: fs.Material | fs.Orthotropic, held: tuple[str, ...], count: int) -> np.ndarray:
    """Of a joist along x, y its width, pinned or held against turning at its ends."""
    lines = (((0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0)),)
    joist = fs.Frame("joist", material, SECTION, lines, mesh=LENGTH / 16)
    ends = fs.PlaceOn("ends", "joist", at=((0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0)))
    supports = (fs.Support("walls", held, at="ends"), fs.Support("along", ("x",), at="ends"))
    model = fs.mesh_structure(fs.Structure("joist", (joist,), points=(ends,), supports=supports))
    basis = fs.modal_basis(fs.assemble(model), count=count)
    return np.asarray(basis.frequency_hz[basis.modes])


def pinned(I: float, G: float, n: int) -> float:  # noqa: E741
    """Timoshenko's pinned beam [Hz]: deflection and turning as n half waves."""
    k, kGA = n * np.pi / LENGTH, 5 / 6 * G * SECTION.A
    K = np.array([[kGA * k**2, kGA * k], [kGA * k, 11e9 * I * k**2 + kGA]])
    M = 420.0 * np.array([SECTION.A, I])
    return float(np.sqrt(np.linalg.eigvals(K / M[:, None]).real.min()) / 2 / np.pi)


def test_a_joist_bends_with_the_shear_modulus_of_its_plane() -> None:
    """Upright (along z) it shears with Gzx, flat (along y) with Gxy; with one G the upright modes would be 7 % off."""
    found = frequencies(SPRUCE, ("y", "z", "rx"), 10)
    upright = [pinned(SECTION.Iy, 350e6, n) for n in (1, 2)]
    for expected in (*upright, *(pinned(SECTION.Iz, 690e6, n) for n in (1, 2, 3))):
        assert np.abs(found / expected - 1).min() < 1e-4  # 16 bars, h^4: 2e-5
    assert pinned(SECTION.Iy, 690e6, 1) / upright[0] > 1.07


def test_a_joist_twists_with_both() -> None:
    """sqrt(G J / rho Ip) / 2 L between ends that cannot turn, G the root of both."""
    found = frequencies(SPRUCE, ("y", "z", "rx", "ry", "rz"), 12)
    G = np.sqrt(690e6 * 350e6)
    twist = np.sqrt(G * SECTION.J / 420.0 / (SECTION.Iy + SECTION.Iz)) / 2 / LENGTH
    assert np.abs(found / twist - 1).min() < 1e-5  # 16 bars, h^4


def test_an_isotropic_material_as_an_orthotropic_one_makes_the_same_bar() -> None:
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    same = fs.Orthotropic("steel", E=(210e9, 210e9), G=(steel.G, steel.G), nu=0.3, rho=7850.0)
    held = ("y", "z", "rx")
    assert frequencies(same, held, 6) == pytest.approx(frequencies(steel, held, 6), rel=1e-10)  # rounding
