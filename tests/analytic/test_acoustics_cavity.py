"""Rooms of any shape by finite elements: against boxes in closed form, a tube with an impedance end, an L."""

from __future__ import annotations

import numpy as np
import pytest

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.rectangular import Room
from acoustics.levels.sound_levels import reverberation_time
from acoustics.losses import Losses, losses_from_beta, losses_from_t60
from acoustics.meshed.cavity_mesh import CavityMesh, box_mesh
from acoustics.meshed.finite_elements import cavity_modes, drive, probe, wall_integrals
from acoustics.meshed.meshed_pressure import cavity_pressure, harmonic_cavity_pressure
from acoustics.meshed.walls import Wall, absorbing, random_incidence_absorption, wall_absorption
from acoustics.receivers import Receiver
from acoustics.rooms.box_pressure import pressure
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration

ROUNDING = 1e-12  # rounding: 2e-15 here at most

FS = 48e3
BOX = (0.58, 0.47, 0.1)
GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3)


def closed_wavenumbers(size, up_to):
    n = np.stack(np.meshgrid(*(np.arange(12),) * 3, indexing="ij"), -1).reshape(-1, 3)
    k = np.sort(np.pi * np.sqrt(((n / np.array(size)) ** 2).sum(axis=1)))
    return k[k < up_to]


def tetrahedra(mesh):
    """Each hexahedron as six tetrahedra around its diagonal."""
    six = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]
    return CavityMesh(mesh.points, mesh.cells[:, six].reshape(-1, 4), {})


def smooth_push(nt, duration=0.004):
    """A velocity of zero net displacement."""
    t = np.arange(nt) / FS
    turn = 2 * np.pi * t / duration
    return np.where(t < duration, np.sin(turn) * (1 - np.cos(turn)), 0)


def ceiling(size, cells, shape, rates):
    """Gauss points of `cells` on the ceiling of a box."""
    x, y = (
        np.concatenate([(i + GAUSS) / n * length for i in range(n)]) for n, length in zip(cells, size, strict=False)
    )
    points = np.array([[a, b, size[2]] for a in x for b in y])
    weights = np.full(len(points), size[0] * size[1] / len(points))
    return SurfaceVelocity(points, weights, shape(points)[:, None], [rates], dt=1 / FS)


def test_modes_of_a_box_and_their_order():
    """Second-order elements: k^2 to fourth order. Hexahedra and tetrahedra."""
    size, up_to = (1.0, 0.8, 0.6), 6.0
    exact = closed_wavenumbers(size, up_to)
    for make in (lambda mesh: mesh, tetrahedra):
        errors = []
        for n in (2, 4, 6):
            found = cavity_modes(make(box_mesh(size, (n, n, n))), up_to).wavenumber
            assert len(found) == len(exact)
            assert found[0] == 0
            errors.append(np.abs(found[1:] / exact[1:] - 1).max())
        order = np.log(errors[1] / errors[2]) / np.log(6 / 4)
        assert order == pytest.approx(4, abs=0.3), errors  # two cells a half wave are not yet few


def test_modes_are_orthonormal_and_the_first_is_uniform():
    modes = cavity_modes(box_mesh(BOX, (4, 4, 1)), 2 * np.pi * 500 / 340)
    points = np.random.default_rng(1).uniform(0, BOX, (40, 3))
    np.testing.assert_allclose(modes.at(points)[:, 0], 1, rtol=1e-7)  # where a residual of Lanczos begins to show
    exact = np.sqrt(2) * np.cos(np.pi * points[:, 0] / BOX[0])
    found = modes.at(points)[:, 1]
    assert min(np.abs(found - exact).max(), np.abs(found + exact).max()) < 1e-2  # four cells a half wave


def test_two_runs_are_bit_equal():
    first, second = (cavity_modes(box_mesh((1, 1, 1), (3, 3, 3)), 7.0) for _ in range(2))  # with degenerate triples
    assert np.array_equal(first.shapes, second.shapes)
    assert len(first.wavenumber) == len(closed_wavenumbers((1, 1, 1), 7.0))


def test_volume_is_conserved_by_surfaces_that_do_not_match():
    """Whatever the two meshes: the uniform mode sees the displaced volume to rounding."""
    modes = cavity_modes(box_mesh(BOX, (3, 2, 1)), 8.0)
    rng = np.random.default_rng(2)
    points = np.column_stack([rng.uniform(0, BOX[:2], (57, 2)), np.full(57, BOX[2])])
    weights, shapes = rng.uniform(0, 1, 57), rng.normal(size=(57, 3))
    loads = drive(modes, SurfaceShapes(points, weights, shapes))
    np.testing.assert_allclose(loads.sum(axis=0), weights @ shapes, rtol=ROUNDING, atol=ROUNDING)


@pytest.mark.parametrize("losses", [losses_from_t60(0.3), losses_from_beta(0.01, 293)])
def test_a_box_of_finite_elements_sounds_as_the_box_of_cosines(losses):
    air = Air(340, 1.29)
    surface = ceiling(
        BOX, (12, 10), lambda x: np.sin(np.pi * x[:, 0] / BOX[0]) * np.sin(np.pi * x[:, 1] / BOX[1]), smooth_push(4800)
    )
    receivers = [Receiver("a", [0.2, 0.3, 0.05]), Receiver("b", [0.29, 0.235, 0])]
    expected = pressure(surface, Room(BOX, air, losses), receivers, orders=12).p
    errors = []
    for cells, up_to in (((6, 5, 1), 15.0), ((10, 8, 4), 40.0)):
        heard = cavity_pressure(surface, cavity_modes(box_mesh(BOX, cells), up_to), air, losses, receivers).p
        errors.append((np.abs(heard - expected).max(axis=1) / np.abs(expected).max(axis=1)).max())
    assert errors[1] < 3e-3  # cells of 58 mm, and modes beyond 2.2 kHz only as their answers at rest
    assert errors[1] < errors[0] / 2


@pytest.mark.parametrize("beta", [0.3, 1 / 14.6])  # the second couples modes by less than walls.COUPLED
def test_a_tube_with_an_impedance_end(beta):
    """Closed form: rho c (cosh jkz + beta sinh jkz) / (sinh jkL + beta cosh jkL), to 0.01 dB."""
    length, air = 1.0, Air(343, 1.21)
    nt = 48000  # the sound is over
    push = smooth_push(nt)
    surface = ceiling((0.1, 0.1, length), (1, 1), lambda x: np.ones(len(x)), push)
    modes = cavity_modes(box_mesh((0.1, 0.1, length), (1, 1, 40)), 30.0)
    places = [0.3, 0.9]
    receivers = [Receiver(str(z), [0.05, 0.05, z]) for z in places]
    heard = cavity_pressure(surface, modes, air, Losses(), receivers, {"z0": Wall({100.0: beta})}).p
    frequency = np.fft.rfftfreq(nt, 1 / FS)
    lines = (frequency > 20) & (frequency < 600)  # where the push has its energy
    jk = 2j * np.pi * frequency[lines] / air.c
    driven = np.fft.rfft(push)[lines]
    for z, p in zip(places, heard, strict=True):
        exact = (
            air.rho
            * air.c
            * (np.cosh(jk * z) + beta * np.sinh(jk * z))
            / (np.sinh(jk * length) + beta * np.cosh(jk * length))
        )
        off = 20 * np.log10(np.abs(np.fft.rfft(p)[lines] / driven / exact))
        assert np.abs(off).max() < 0.01


def test_an_absorbing_wall_damps_each_mode_by_itself_where_it_takes_up_little():
    """c beta 2 / (2 L): the axial mode of a wall's direction decays twice as fast as uniform pressure."""
    air, beta = Air(343, 1.21), 2e-2
    size = (1.0, 0.7, 0.4)
    modes = cavity_modes(box_mesh(size, (6, 4, 2)), 10.0)
    absorbed = np.diag(wall_integrals(modes, "x0")) * beta / modes.mesh.volume
    assert absorbed[:2] == pytest.approx([beta / size[0], 2 * beta / size[0]], rel=1e-3)  # six cells
    surface = ceiling(size, (6, 4), lambda x: np.cos(np.pi * x[:, 0] / size[0]), smooth_push(96000))
    heard = cavity_pressure(
        surface, modes, air, Losses(), [Receiver("a", [0.1, 0.1, 0.1])], {"x0": Wall({100.0: beta})}
    )
    # the wall also shifts the mode: 2e-3 here
    assert reverberation_time(heard.p[0, 400:], 1 / FS) == pytest.approx(
        3 * np.log(10) / (air.c * absorbed[1] / 2), rel=0.01
    )


def test_a_wall_couples_two_modes_by_the_geometric_mean_of_what_it_takes_of_each():
    """Reciprocal, and each mode's own share that of the wall at its frequency."""
    air, size = Air(343, 1.21), (1.0, 0.7, 0.4)
    modes = cavity_modes(box_mesh(size, (6, 4, 2)), 10.0)
    wall = Wall({100.0: 0.01, 400.0: 0.05})
    taken = wall_absorption(modes, {"x0": wall}, air)
    plain = wall_integrals(modes, "x0") / modes.mesh.volume
    beta = wall.at(modes.wavenumber * air.c / (2 * np.pi))
    assert np.ptp(beta) > 0.03
    assert taken == pytest.approx(taken.T, abs=1e-15)  # rounding: 4e-17 here
    assert np.diag(taken) == pytest.approx(beta * np.diag(plain), rel=ROUNDING)
    assert taken[0, 1] == pytest.approx(np.sqrt(beta[0] * beta[1]) * plain[0, 1], rel=ROUNDING)


@pytest.mark.parametrize("by_cosines", [True, False])
def test_reverberation_of_one_second_is_heard_as_one_second(by_cosines):
    size, losses = (1.0, 0.7, 0.4), losses_from_t60(1.0)
    surface = ceiling(size, (6, 4), lambda x: np.cos(np.pi * x[:, 0] / size[0]), smooth_push(72000))
    receivers = [Receiver("a", [0.1, 0.1, 0.1])]
    if by_cosines:
        heard = pressure(surface, Room(size, Air(), losses), receivers).p[0]
    else:
        modes = cavity_modes(box_mesh(size, (6, 4, 2)), 10.0)
        heard = cavity_pressure(surface, modes, Air(), losses, receivers).p[0]
    # a straight decay: 7e-6 here
    assert reverberation_time(heard[400:], 1 / FS) == pytest.approx(1.0, abs=0.002)


def l_room(n):
    """An L of three squares of 1 m, n x n cells each, 0.2 m high."""
    box = box_mesh((2, 2, 0.2), (2 * n, 2 * n, 1))
    middle = box.points[box.cells].mean(axis=1)
    cells = box.cells[~((middle[:, 0] > 1) & (middle[:, 1] > 1))]
    used, number = np.unique(cells, return_inverse=True)
    return CavityMesh(box.points[used], number.reshape(cells.shape), {})


def test_an_l_shaped_room_converges_as_its_corner_allows():
    """The corner of 270 degrees has a gradient of r^(-1/3): frequencies converge with h^(4/3), whatever the element.

    Published: the first Neumann eigenvalue of this L is 1.4756218450 (M. Dauge's benchmark computations for the Maxwell
    equations, https://perso.univ-rennes1.fr/monique.dauge/benchmax.html).
    """
    first = np.array([cavity_modes(l_room(n), 2.5).wavenumber[1] for n in (1, 2, 4, 8)])
    order = np.log2((first[:-2] - first[1:-1]) / (first[1:-1] - first[2:]))
    assert order[-1] == pytest.approx(4 / 3, abs=0.05)  # the next order: 0.012 here
    limit = first[-1] - (first[-2] - first[-1]) / (2 ** (4 / 3) - 1)
    assert limit**2 == pytest.approx(1.4756218450, rel=1e-5)  # h^2 beside the extrapolated h^(4/3): 4e-7 here


@pytest.mark.parametrize("wall", [Wall({50.0: 0.01, 1000.0: 0.03}), Wall({50.0: 0.03, 1000.0: 0.1})])
def test_a_tube_with_an_end_whose_impedance_depends_on_frequency(wall):
    """The same closed form with the admittance at each frequency; the second couples by more than walls.COUPLED."""
    length, air = 2.0, Air(343, 1.2)
    f = np.linspace(40.0, 700.0, 1400)
    modes = cavity_modes(box_mesh((0.1, 0.1, length), (1, 1, 40)), 25.6)
    piston = SurfaceVibration([[0.05, 0.05, length]], [0.01], [[1.0]], np.ones((1, len(f)), complex), f)
    places, jk, beta = (0.3, 1.1), 2j * np.pi * f / air.c, wall.at(f)
    receivers = [Receiver(str(z), [0.05, 0.05, z]) for z in places]
    found, advice = harmonic_cavity_pressure(piston, modes, air, Losses(), receivers, {"z0": wall})
    assert ("coupled-absorption" in {one.code for one in advice}) == (wall.admittance[50.0] == 0.03)
    for z, p in zip(places, found, strict=True):
        exact = air.rho * air.c * (np.cosh(jk * z) + beta * np.sinh(jk * z))
        exact /= np.sinh(jk * length) + beta * np.cosh(jk * length)
        # A dip is what the end lets through: its admittance is that of the two modes beside it, half a mode away,
        # 8 % off at the lowest. Damped one by one, modes miss the same dips by 16 dB.
        assert np.abs(20 * np.log10(np.abs(p / exact))).max() < 20 * np.log10(1.08)
        assert np.abs(p).max() == pytest.approx(np.abs(exact).max(), rel=5e-3)  # lines 0.5 Hz apart


def test_absorption_and_admittance():
    """Paris' integral by quadrature: alpha = int 4 r cos / (r cos + 1)^2 sin 2 theta dtheta."""
    theta = (np.arange(20000) + 0.5) / 20000 * np.pi / 2
    for alpha in (0.02, 0.3, 0.8):
        y = float(absorbing(alpha).at(np.array([50.0]))[0])
        r = 1 / y
        integral = (4 * r * np.cos(theta) / (r * np.cos(theta) + 1) ** 2 * np.sin(2 * theta)).mean() * np.pi / 2
        assert integral == pytest.approx(alpha, rel=1e-7)  # midpoint rule of 20,000: 4e-10 here
    assert random_incidence_absorption(1 / 1.567) == pytest.approx(0.951, abs=1e-3)  # three digits


def test_limits_of_a_room_of_cells_are_reported():
    air = Air()
    surface = ceiling((0.1, 0.1, 1.0), (1, 1), lambda x: np.ones(len(x)), smooth_push(4800))
    modes = cavity_modes(box_mesh((0.1, 0.1, 1.0), (1, 1, 20)), 31.0)
    wall = Wall({100.0: 0.2, 200.0: 0.3})
    heard = cavity_pressure(surface, modes, air, Losses(), [Receiver("a", [0.05, 0.05, 0.5])], {"z0": wall})
    assert "coupled-absorption" in {advice.code for advice in heard.findings}
    coarse = cavity_modes(box_mesh((0.1, 0.1, 1.0), (1, 1, 4)), 12.0)
    told = {
        advice.code for advice in cavity_pressure(surface, coarse, air, Losses(), [Receiver("a", [0, 0, 0])]).findings
    }
    assert "room-mesh-coarse" in told
    few = cavity_modes(box_mesh((0.1, 0.1, 1.0), (1, 1, 20)), 5.0)
    told = {advice.code for advice in cavity_pressure(surface, few, air, Losses(), [Receiver("a", [0, 0, 0])]).findings}
    assert told == {"room-modes-missing"}


def test_a_fast_motion_in_a_pattern_of_modes_left_out_is_told():
    """Slow and uniform, which the kept modes hear, and fast in a pattern that none of them has."""
    size = (1.0, 0.7, 0.4)
    modes = cavity_modes(box_mesh(size, (6, 4, 2)), 6.0)  # 327 Hz
    slow, fast = smooth_push(9600, duration=0.1), smooth_push(9600, duration=0.001)
    even = ceiling(size, (12, 4), lambda x: np.ones(len(x)), slow)
    pattern = np.cos(4 * np.pi * even.points[:, 0])
    receivers = [Receiver("a", [0.1, 0.1, 0.1])]
    both = SurfaceVelocity(even.points, even.weights, np.column_stack([even.shapes, pattern]), [slow, fast], dt=1 / FS)
    told = [
        {advice.code for advice in cavity_pressure(surface, modes, Air(), Losses(), receivers).findings}
        for surface in (even, both)
    ]
    assert ["room-modes-missing" in codes for codes in told] == [False, True]


def test_what_is_no_room_is_refused():
    mesh = box_mesh((1, 1, 1), (1, 1, 1))
    with pytest.raises(AcousticsError, match="a volume of 0 "):
        CavityMesh(mesh.points * [1, 1, 0], mesh.cells, {})
    with pytest.raises(AcousticsError, match="a volume of -1 "):
        CavityMesh(mesh.points, mesh.cells[:, [0, 3, 2, 1, 4, 7, 6, 5]], {})
    with pytest.raises(AcousticsError, match=r"2 separate volumes of air"):
        CavityMesh(
            np.vstack([mesh.points, mesh.points + np.array([2, 0, 0])]), np.vstack([mesh.cells, mesh.cells + 8]), {}
        )
    with pytest.raises(AcousticsError, match=r"expected corners 0 to 7"):
        CavityMesh(mesh.points, mesh.cells + 1, {})
    with pytest.raises(AcousticsError, match="tetrahedra"):
        CavityMesh(mesh.points, mesh.cells[:, :5], {})
    with pytest.raises(AcousticsError, match="facets of the boundary"):
        CavityMesh(mesh.points, mesh.cells, {"odd": [[0, 1, 2, 6]]})
    modes = cavity_modes(box_mesh((1, 1, 1), (2, 2, 2)), 4.0)
    with pytest.raises(AcousticsError, match="a point on the boundary"):
        drive(modes, SurfaceShapes([[0.5, 0.5, 0.9]], [1], [[1]]))
    with pytest.raises(AcousticsError, match="outside the cavity"):
        probe(mesh, np.array([[0.5, 0.5, 1.9]]))
    with pytest.raises(AcousticsError, match="finer mesh"):
        cavity_modes(mesh, 100.0)
    surface = ceiling((1, 1, 1), (1, 1), lambda x: np.ones(len(x)), smooth_push(480))
    with pytest.raises(AcousticsError, match="a causal kind"):
        cavity_pressure(surface, modes, Air(), losses_from_beta(0.01, 100, "source"), [Receiver("a", [0, 0, 0])])
    with pytest.raises(AcousticsError, match="'z9'"):
        cavity_pressure(surface, modes, Air(), Losses(), [Receiver("a", [0, 0, 0])], {"z9": absorbing(0.1)})
    with pytest.raises(AcousticsError, match=r"0 to 0.951"):
        absorbing(0.99)
    with pytest.raises(AcousticsError, match="record longer"):
        reverberation_time(np.ones(100), 1e-3)
    with pytest.raises(AcousticsError, match="got silence, expected a decay"):
        reverberation_time(np.zeros(100), 1e-3)
