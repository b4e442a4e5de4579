"""Published stiffness of spur gear teeth beside plane elasticity of the same gears; nothing is fitted to it.

Sources: ISO 6336-1:2019, eqs (82) to (93); DIN 3990-11, section 3.4.3.1, as a public program quotes it,
https://github.com/hanslhansl/din3990, din3990/din3990_11.py; the finite elements of another program,
https://github.com/git-akai/gearcalc, work/contact-model.md, section 2.4; F. H. A. S. Dias, G. C. Silva and
D. S. Chui, J. Braz. Soc. Mech. Sci. Eng. 46 (2024) 10.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lumped import GearPair, load_gear_pair, plane_compliance
from lumped.stiffness import iso6336
from lumped.stiffness.finite_elements import Plane, Support, elastic_teeth, self_compliance

#: Rim of pinion and gear of 17/43 teeth, module 1 mm, held at the bore [mm] -> c' at the pitch point by
#: plane-strain finite elements of another program [N/(mm um)].
RIMS = {(2.07, 5.79): 17.06, (3.63, 10.13): 14.61, (5.44, 15.19): 10.10, (2.70, 2.70): 17.53}
#: DIN 3990-11: the one c_gamma that it has for all gears [N/(mm um)].
ONE_FOR_ALL = 20.0
#: Largest approach of a pair alone by Dias, Silva and Chui for 27/35 teeth [m].
DIAS = 43.881e-6
_UNIT = 1e9  # N/(mm um) [N/m^2]


@dataclass(frozen=True)
class Beside:
    """A published number and ours."""

    gears: str  # what it is of
    quantity: str
    unit: str
    source: str  # who published it, and how it was found
    published: float  # their number and that of plane elasticity
    elastic: float

    @property
    def ratio(self) -> float:
        """Ours over theirs."""
        return self.elastic / self.published


def plain(**changes: object) -> GearPair:
    """Steel gears of standard form without relief, at 20 N m, with changes."""
    bare = {"pinion.tip_relief": None, "gear.tip_relief": None, "centre_distance": None}
    sizes = {"basic_rack.module": 1.0, "pinion.face_width": 10.0, "gear.face_width": 10.0}
    fields = {key.replace("__", "."): value for key, value in changes.items()}
    return load_gear_pair("nasa_28_28").with_(bare | sizes | {"operating.pinion_torque": 20.0} | fields)


def held_rim(rims: tuple[float, float]) -> float:
    """Stiffness of 17/43 teeth at the pitch point, rims held at their bores, in plane strain [N/(mm um)]."""
    pair = plain(pinion__teeth=17, gear__teeth=43)
    bores = [2.0 * (1e3 * w.tooth.root_radius - rim) for w, rim in zip(pair.wheels, rims, strict=True)]
    pair = pair.with_(pinion__bore=bores[0], gear__bore=bores[1])
    g = pair.geometry
    compliance = self_compliance(pair, elastic_teeth(pair, "strain", "clamped"), np.array([g.L_XP]))
    return float(1.0 / compliance[0] / g.face_width / _UNIT)


def published_stiffness() -> Iterator[Beside]:
    """Yield every published number with the computed number."""
    for rims, theirs in RIMS.items():
        source = "gearcalc, finite elements, plane strain, held at the bore"
        name = f"17/43, rims {rims[0]:g} and {rims[1]:g} mm at 1 mm"
        yield Beside(name, "c′ at the pitch point", "N/(mm µm)", source, theirs, held_rim(rims))
    for name in ("fzg_c", "nasa_art_25_31", "nasa_28_28", "kahraman_blankenship_50_50"):
        pair = load_gear_pair(name)
        free = plane_compliance(pair, phases=1).attrs
        scale = pair.geometry.face_width * _UNIT
        gears = f"{pair.pinion.teeth}/{pair.gear.teeth}"
        single = free["iso_single"] / scale
        mean = free["iso_mean"] / scale
        largest = free["largest_alone"] / scale
        total = free["mean"] / scale
        theory = "ISO 6336-1 before the 0.8 for measurements"
        yield Beside(gears, "c′", "N/(mm µm)", "ISO 6336-1, from measurements", single, largest)
        yield Beside(gears, "c′", "N/(mm µm)", theory, single / iso6336.CORRECTION, largest)
        yield Beside(gears, "c_γ", "N/(mm µm)", "ISO 6336-1, from measurements", mean, total)
        yield Beside(gears, "c_γ", "N/(mm µm)", "DIN 3990-11, one for all gears", ONE_FOR_ALL, total)
    pair = plain(
        basic_rack__module=3.0, pinion__teeth=27, gear__teeth=35, pinion__face_width=25.0,
        gear__face_width=25.0, operating__pinion_torque=80e3 / (2000.0 * np.pi / 30.0),
    )  # fmt: skip
    g = pair.geometry
    force = pair.operating.pinion_torque / g.base_radius_pinion
    single_contact = np.linspace(g.L_XD - g.base_pitch, g.L_XA + g.base_pitch, 101)
    largest = float(
        force
        * self_compliance(pair, elastic_teeth(pair, support="untwisted", bore=5.0), single_contact).max()
    )
    source = "Dias et al. 2024, energy method, tooth on the base circle"
    yield Beside("27/35", "largest approach of one pair", "µm", source, 1e6 * DIAS, 1e6 * largest)


@dataclass(frozen=True)
class Framed:
    """Stiffness of a pair with deflections that count from one place, over ISO 6336-1's."""

    gears: str  # the pair, and from where
    frame: str
    largest: float  # largest of a pair over c' b; mean of the mesh over c_gamma b
    alone: float
    mean: float


#: Frame in words -> state of stress and support.
FRAMES: dict[str, tuple[Plane, Support]] = {
    "free body": ("stress", "free"),
    "rim, bore held, less its twist": ("stress", "untwisted"),
    "shaft, bore held": ("stress", "clamped"),
    "free body, plane strain": ("strain", "free"),
}


def framed_pairs() -> Iterator[GearPair]:
    """Two pairs with bores: 62/62 of module 2 mm, bores of 35 mm, and 19/41 of 3 mm, 20 and 40 mm."""
    for z, module, width, bores in (((62, 62), 2.0, 20.0, (35.0, 35.0)), ((19, 41), 3.0, 20.0, (20.0, 40.0))):
        yield plain(
            basic_rack__module=module,
            pinion__teeth=z[0],
            gear__teeth=z[1],
            pinion__face_width=width,
            gear__face_width=width,
            pinion__bore=bores[0],
            gear__bore=bores[1],
            operating__pinion_torque=100e3 * width * 1e-3 * 0.5e-3 * module * z[0],
        )


def framed(pair: GearPair) -> Iterator[Framed]:
    """Yield a pair in every frame of the elasticity. A solid gear has free frames only."""
    for frame, (plane, support) in FRAMES.items():
        if support != "free" and not min(pair.pinion.bore, pair.gear.bore) > 0.0:
            continue
        by = plane_compliance(pair, plane=plane, support=support, phases=1).attrs
        yield Framed(
            f"{pair.pinion.teeth}/{pair.gear.teeth}",
            frame,
            by["largest_alone"] / by["iso_single"],
            by["mean_alone"] / by["iso_mean"],
            by["mean"] / by["iso_mean"],
        )
