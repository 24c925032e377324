"""A rigid sphere that is pushed along the normal of a rigid plane: the sound that a striking ball makes itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np
import scipy
from numpy.polynomial.legendre import leggauss, legvander

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, freeze, frozen, positive
from acoustics.errors import AcousticsError, Advice
from acoustics.open_air.rayleigh import Baffle, in_front
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.rooms.box_pressure import FADE, NEGLIGIBLE, PADDING, extend_to_rest, fast_length

# ----------------------------------------------------------------------------------------------------------------------
# Multipoles of a rigid sphere that moves along the normal of a rigid plane: what the plane sends back is in them.
# ----------------------------------------------------------------------------------------------------------------------

APART: Final = 10.0  # radii above the plane from which what it sends back to the sphere, at most 10 %, is left out
ORDERS: Final = 10  # of multipoles beside those that ka needs: the far field is then right to about 1e-5
STEP: Final = 0.1  # of ka, over the height in radii, between frequencies at which multipoles are solved for
_BLOCK: Final = 64  # frequencies solved for at once


def strengths(highest: float, height: float) -> Callable[[Floats], Complexes]:
    """Multipoles c_n [orders, nf] by frequency, omega a / c up to `highest`: splines between those at equal steps."""
    if height >= APART:
        return _free
    nodes = np.linspace(0.0, highest, max(8, int(np.ceil(highest * height / STEP))) + 1)
    orders = int(np.ceil(highest)) + ORDERS
    x: Complexes = np.asarray(1j * nodes, dtype=np.complex128)
    solved = np.concatenate([_solved(x[i : i + _BLOCK], height, orders) for i in range(0, len(x), _BLOCK)])
    # Beyond 0 they are the conjugates: without them splines are at their worst at 0, where sphere and image cancel.
    nodes = np.concatenate([-nodes[:0:-1], nodes])
    spline = scipy.interpolate.CubicSpline(nodes, np.concatenate([solved[:0:-1].conj(), solved]))
    return lambda ka: np.asarray(spline(ka).T)


def _free(ka: Floats) -> Complexes:
    """Multipoles of a sphere in free air: the dipole -k_1(x) / (x k_1'(x))."""
    x = 1j * ka
    return np.asarray([0 * x, 1.0 / (2 + x * x / (1 + x))])


def _solved(x: Complexes, height: float, orders: int) -> Complexes:
    """Multipoles [nf, orders] that move the air with the sphere: dp/dr a / (rho s u a) = -cos all over it.

    x [nf] = s a / c.

    Parameters
    ----------
    height : float
        Of the centre over the plane, in radii. By projection on the Legendre polynomials.
    """
    cos, weights = leggauss(max(64, 4 * orders))
    n = np.arange(orders)
    up, out = 2 * height + cos, np.sqrt(1 - cos * cos)  # from the image's centre to the sphere, in radii
    r2 = np.hypot(up, out)
    cos2 = up / r2
    legendre = legvander(cos2, orders).T
    sloped = (n[:, None] * (np.vstack([0 * cos2, legendre[: orders - 1]]) - cos2 * legendre[:orders])) / (out / r2) ** 2
    along = (out * out + cos * up) / r2  # slope of the image's radius along the sphere's normal, and of its cosine
    turned = cos / r2 - up / r2**2 * along
    values, slopes = outward(x[:, None], r2, orders), _outward_slope(x[:, None], r2, orders)
    image = np.where(n % 2, -1.0, 1.0)[:, None, None] * (
        slopes * (along * legendre[:orders])[:, None] + values * (turned * sloped)[:, None]
    )
    project = (n[:, None] + 0.5) * weights * legvander(cos, orders - 1).T
    matrix = np.einsum("mq,nfq->fmn", project, image, optimize=True)
    matrix[:, n, n] += _outward_slope(x[:, None], np.ones(1), orders)[:, :, 0].T
    given = np.zeros((len(x), orders, 1), dtype=np.complex128)
    given[:, 1] = -1.0
    return np.asarray(np.linalg.solve(matrix, given)[:, :, 0])


def outward(x: Complexes, q: Floats, orders: int) -> Complexes:
    """k_n(x q) / k_n(x) for n = 0 .. orders - 1 [orders, nf, nq], x [nf, 1], q [nq]."""
    n = np.arange(orders)[:, None, None]
    return np.asarray(q ** -(n + 1.0) * _polynomials(x * q, orders) / _polynomials(x, orders) * np.exp(x * (1 - q)))


def _outward_slope(x: Complexes, q: Floats, orders: int) -> Complexes:
    """Its derivative along q: k_n' = -k_(n-1) - (n + 1) k_n / x, and k_(-1) = k_0."""
    n = np.arange(orders)[:, None, None]
    below = np.empty((orders, *np.broadcast_shapes(x.shape, q.shape)), dtype=np.complex128)
    below[0] = x / q
    below[1:] = x * x * q ** -n[1:].astype(float) * _polynomials(x * q, orders)[:-1] / _polynomials(x, orders)[1:]
    return np.asarray(-below * np.exp(x * (1 - q)) - (n + 1) / q * outward(x, q, orders))


def _polynomials(z: Complexes, orders: int) -> Complexes:
    """Reverse Bessel polynomials theta_n(z), n = 0 .. orders - 1: k_n(z) = exp(-z) theta_n(z) / z^(n + 1)."""
    made = np.empty((max(2, orders), *z.shape), dtype=np.complex128)
    made[0], made[1] = 1.0, z + 1.0
    for n in range(2, orders):
        made[n] = (2 * n - 1) * made[n - 1] + z * z * made[n - 2]
    return made[:orders]


# ----------------------------------------------------------------------------------------------------------------------
# A rigid sphere that is pushed along the normal of a rigid plane.
# ----------------------------------------------------------------------------------------------------------------------

HIGHEST_KA: Final = 24.0  # circumference over the wavelength up to which a sphere is heard
TOUCHING: Final = 1e-6  # share of the radius by which a sphere may dip into the plane: rounding
UNSAMPLED: Final = 1e-3  # share of an acceleration's energy that may lie above 0.8 of half the sampling
_LINES: Final = 4096  # frequencies heard at once


@dataclass(frozen=True, eq=False)
class Sphere:
    """A rigid sphere in a half space, and what pushes made of its velocity.

    radius [m]. place : [3], its centre, from the origin of the half space [m]; it stays there but for what is small
    beside its radius. velocity : [nt], along the normal of the plane, positive away from it, without the uniform motion
    it had before, which makes no sound, and without free fall [m/s]. dt : sampling interval [s].

    Raises AcousticsError: shapes that do not fit, a radius or an interval that is not positive.

    >>> Sphere(10e-3, place=[0, 0, 10e-3], velocity=[0, 0.5, 1], dt=1e-5).velocity.tolist()
    [0.0, 0.5, 1.0]
    """

    radius: float
    place: Floats
    velocity: Floats
    dt: float

    def __post_init__(self) -> None:
        velocity = frozen("sphere.velocity", self.velocity, (None,))
        if len(velocity) < 2:
            raise AcousticsError("sphere.velocity", got=f"{len(velocity)} samples", expected="at least 2")
        freeze(
            self,
            radius=positive("sphere.radius", self.radius, "m"),
            place=frozen("sphere.place", self.place, (3,)),
            velocity=velocity,
            dt=positive("sphere.dt", self.dt, "s"),
        )


def sphere_pressures(spheres: Sequence[Sphere], space: Baffle, receivers: Sequence[Receiver]) -> RoomResponse:
    """Pressure that pushed spheres make in the half space in front of a rigid plane, the sum of what each makes alone.

    Returns RoomResponse, the sound's way included; its findings tell of spheres too large for the frequencies they are
    pushed with, of pushes shorter than the sampling shows, and of spheres near each other.

    Raises AcousticsError: no sphere, spheres of different sampling, one that dips into the plane, a receiver behind the
    plane or inside a sphere.

    Notes
    -----
    Acceleration noise (Koss and Alfredson, J. Sound Vib. 27, 1973; Akay, J. Acoust. Soc. Am. 64, 1978), with the plane:
    see `sphere_transfer`. Spheres do not affect each other. By the transform of the velocity, as `field_pressures`.

    A sphere far above the plane that speeds up by 1 m/s^2 is followed by rho a^3 cos / (2 r^2), the air it carries:

    >>> t = np.arange(4800) / 48e3
    >>> push = np.where(t < 0.02, t - np.sin(2 * np.pi * t / 0.02) * 0.02 / (2 * np.pi), 0.02 + 0 * t)
    >>> ball = Sphere(0.01, [0, 0, 100], push, 1 / 48e3)
    >>> heard = sphere_pressures([ball], Baffle(Air(343, 1.21)), [Receiver("mic", [0, 0, 100.1])]).p[0]
    >>> print(f"{heard.max() / (2 * 1.21 * 0.01**3 / (2 * 0.1**2)):.2f}")
    1.00
    """
    if not spheres:
        raise AcousticsError("spheres", got="none", expected="at least one")
    dt, nt = spheres[0].dt, len(spheres[0].velocity)
    if any(one.dt != dt or len(one.velocity) != nt for one in spheres):
        raise AcousticsError("spheres", got="spheres of different sampling", expected="motions of one record")
    places = in_front(space, receivers)
    for sphere in spheres:
        refuse_inside(sphere.radius, sphere.place, receivers)
    farthest = max(float(np.linalg.norm(places - _image(space, one.place), axis=1).max()) for one in spheres)
    whole = int(np.ceil(PADDING * nt)) + 1
    length = fast_length(whole + int(np.ceil(farthest / space.air.c / dt)))
    f = np.asarray(np.fft.rfftfreq(length, dt))
    p = np.zeros((len(places), len(f)), dtype=np.complex128)
    found: list[Advice] = []
    for sphere in spheres:
        spectrum = np.fft.rfft(extend_to_rest(sphere.velocity[None], whole)[0], length)
        above = np.cumsum(np.abs(spectrum[::-1]))[::-1]
        loud = int(np.count_nonzero(above > NEGLIGIBLE * above[0])) if above[0] > 0 else 0
        last = min(loud, int(np.count_nonzero(f <= highest_hz(sphere.radius, space.air))))
        p[:, :last] += sphere_transfer(space, sphere.radius, sphere.place, f[:last], receivers) * spectrum[:last]
        found += push_advice(sphere, space.air)
    found += near_advice(spheres)
    history = np.array(np.fft.irfft(p, length, axis=1)[:, :nt])
    history.flags.writeable = False
    return RoomResponse(tuple(receivers), dt * np.arange(nt, dtype=np.float64), history, tuple(found))


def sphere_transfer(
    space: Baffle, radius: float, place: Floats, frequency_hz: Floats, receivers: Sequence[Receiver]
) -> Complexes:
    """Pressure of a sphere in front of a rigid plane per velocity along its normal [n_receivers, nf] [Pa s/m].

    Parameters
    ----------
    place : Floats [3]
        Of its centre, from the origin of the half space [m].
    frequency_hz : Floats [nf]
        Of motion exp(+j omega t), 0 among them, up to omega radius / c = 24.

    Raises
    ------
    AcousticsError
        A sphere that dips into the plane, a receiver behind the plane or inside the sphere, frequencies too high.

    Notes
    -----
    Multipoles at the sphere and their images behind the plane, p = sum c_n (k_n(s r / c) P_n(cos) + its image), k_n the
    modified spherical Bessel functions. The dipole alone is the sphere in free air; what the image's sound does at the
    sphere is in the other c_n, which are found so that the air moves with the sphere everywhere on it. A sphere and an
    image that do not affect each other are 0.7 dB too quiet far from a touching sphere at low frequencies, and wrong by
    1 to 8 dB about ka = 3, where hard balls sound. Limits: rigid, at its place, and nothing else in the air; from 10
    radii above the plane the sound that comes back from the image is taken up by nothing, and does no more.

    Low frequencies, far above the plane: omega^2 rho a^3 cos / (2 r c).

    Examples
    --------
    >>> high, mic = np.array([0.0, 0.0, 1e5]), [Receiver("mic", [0, 0, 1e5 + 50])]
    >>> heard = sphere_transfer(Baffle(Air(343, 1.21)), 0.01, high, np.array([100.0]), mic)
    >>> print(f"{abs(heard[0, 0]) / ((2 * np.pi * 100)**2 * 1.21 * 0.01**3 / (2 * 50 * 343)):.3f}")
    1.000
    """
    places = in_front(space, receivers)
    refuse_inside(radius, place, receivers)
    height = float(place @ space.normal) / radius
    if height < 1 - TOUCHING:
        raise AcousticsError(
            "sphere.place",
            got=f"a centre {radius * height:g} m in front of the plane",
            expected=f"a centre at least its radius, {radius:g} m, in front",
        )
    ka = np.asarray(2 * np.pi * frequency_hz * radius / space.air.c)
    if ka.max(initial=0.0) > HIGHEST_KA * (1 + 1e-9):
        raise AcousticsError("frequency_hz", got=f"ka = {ka.max():g}", expected=f"at most {HIGHEST_KA:g}")
    strength = strengths(float(ka.max(initial=STEP)), height)
    p = np.zeros((len(places), len(ka)), dtype=np.complex128)
    for start in range(0, len(ka), _LINES):
        some = slice(start, min(start + _LINES, len(ka)))
        x, multipoles = np.asarray(1j * ka[some, None], dtype=np.complex128), strength(ka[some])
        orders = min(len(multipoles), int(np.ceil(ka[some].max())) + ORDERS)
        signs = np.where(np.arange(orders) % 2, -1.0, 1.0)
        for centre, image in ((place, False), (_image(space, place), True)):
            away = places - centre
            r = np.linalg.norm(away, axis=1)
            legendre = legvander(away @ space.normal / r, orders - 1) * (signs if image else 1.0)
            for row, q in enumerate(r / radius):
                p[row, some] += legendre[row] @ (multipoles[:orders] * outward(x, np.array([q]), orders)[:, :, 0])
    return np.asarray(2j * np.pi * frequency_hz * space.air.rho * radius * p)


def highest_hz(radius: float, air: Air) -> float:
    """Frequency up to which the sound of a sphere is computed [Hz]."""
    return float(HIGHEST_KA * air.c / (2 * np.pi * radius))


def push_advice(sphere: Sphere, air: Air) -> list[Advice]:
    """Advice on a push that is shorter than the sampling shows, or too short for the size of its sphere."""
    size = np.abs(np.fft.rfft(np.diff(sphere.velocity, prepend=0.0))) ** 2
    f = np.fft.rfftfreq(len(sphere.velocity), sphere.dt)
    total = float(size.sum())
    if not total > 0:
        return []
    found = []
    half = 0.5 / sphere.dt
    missed = float(size[f > FADE * half].sum()) / total
    if missed > UNSAMPLED:
        found.append(
            Advice(
                "push-coarsely-sampled",
                f"{100 * missed:.2g} % of the energy of a sphere's acceleration lies above {FADE * half:.4g} Hz, "
                f"{FADE:g} of half the sampling, and {100 * UNSAMPLED:g} % is allowed: the samples do not resolve "
                "its own sound. Sample faster",
                {"share": missed, "allowed": UNSAMPLED, "from_hz": FADE * half},
            )
        )
    top = highest_hz(sphere.radius, air)
    beyond = float(size[f > top].sum()) / total
    if beyond > UNSAMPLED:
        found.append(
            Advice(
                "sphere-too-large",
                f"{100 * beyond:.2g} % of the energy of a sphere's acceleration lies above {top:.4g} Hz, where its "
                f"circumference of {2e3 * np.pi * sphere.radius:.0f} mm is more than {HIGHEST_KA:g} wavelengths: "
                "its radiation there is not computed",
                {"share": beyond, "allowed": UNSAMPLED, "up_to_hz": top},
            )
        )
    return found


def near_advice(spheres: Sequence[Sphere]) -> list[Advice]:
    """Advice on two spheres so near that each affects the sound of the other: the nearest, in their radii."""
    pairs = [
        (float(np.linalg.norm(one.place - other.place)), one.radius + other.radius)
        for one, other in combinations(spheres, 2)
    ]
    distance, radii = min(pairs, key=lambda pair: pair[0] / pair[1], default=(np.inf, 1.0))
    if distance >= APART * radii:
        return []
    return [
        Advice(
            "spheres-near",
            f"the centres of two spheres are {1e3 * distance:.3g} mm apart, {distance / radii:.2g} times the sum of "
            "their "
            f"radii. Each sphere is computed without the other, which needs {APART:g} times: for spheres in contact "
            "the "
            "error is 1 dB at low frequencies and 8 dB where the wavelength is a third of their "
            "circumference",
            {"distance_m": distance, "radii_m": radii, "needed": APART},
        )
    ]


def _image(space: Baffle, place: Floats) -> Floats:
    """A place on the other side of the plane."""
    return np.asarray(place - 2 * (place @ space.normal) * space.normal)


def refuse_inside(radius: float, place: Floats, receivers: Sequence[Receiver]) -> None:
    """Refuse receivers inside a sphere.

    Raises AcousticsError: one of them is.
    """
    for receiver in receivers:
        distance = float(np.linalg.norm(receiver.position - place))
        if distance < radius * (1 - TOUCHING):
            raise AcousticsError(
                f"receiver {receiver.name}",
                got=f"{receiver.position.tolist()} m, inside a sphere of {radius:g} m",
                expected="a point outside it",
            )
