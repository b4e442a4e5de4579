"""Are the verdicts judged fairly: do faults go in, show, get caught, and come out without a trace?"""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

import floquet
import validation
from lumped.errors import LawRangeWarning
from tests.evidence.faults.fault import FAULTS, GROUPS, REPORT_FAULTS, Fault
from tests.evidence.faults.judging import judge
from tests.evidence.faults.quantities import change, quantities
from tests.evidence.faults.report_layer import seen_by
from tests.evidence.faults.rewriting import FaultError, applied, fitted
from tests.evidence.faults.sound import drawn
from tests.evidence.faults.table import laws_that_act, sample, verdict
from tests.evidence.pairs import pairs
from validation.reporting.effort import QUICK
from validation.reporting.relations import broken_relations
from validation.reporting.results import Results

pytestmark = pytest.mark.filterwarnings(f"ignore::{LawRangeWarning.__module__}.LawRangeWarning")


def source_digest() -> str:
    """Digest of the source tree: every commit that changes code draws another sample."""
    root = Path(validation.__file__).parents[1]
    digest = hashlib.sha256()
    for package in ("lumped", "multibody", "floquet", "validation"):
        for path in sorted((root / package).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def stored(name="faults.json"):
    folder = Path(__file__).parents[3] / "docs" / "verification"
    return json.loads((folder / name).read_text(encoding="utf-8"))


def cheap() -> list[Fault]:
    """Faults that do not need the compiler."""
    kernels = ("kinematics:", "kernels:", "kernels_linear:", "friction:")
    return [
        f
        for f in FAULTS.values()
        if not f.target.startswith(tuple(f"multibody.contact.{k}" for k in kernels))
    ]


def drawn_by_the_source(count: int) -> list[Fault]:
    """Some of the faults that a verdict sees, not a named test alone, and that do not need the compiler."""
    named = {row["key"] for row in stored() if str(row["caught"].get("tests", "")).startswith("['tests/")}
    quick = [fault for fault in cheap() if fault.key not in named]
    return [fault for fault in sample(len(FAULTS), source_digest()) if fault in quick][:count]


@pytest.fixture(scope="module")
def sound():
    return [quantities(pair) for pair in pairs()]


def test_every_fault_fits_the_program():
    """A line that a fault changes is there, once; 60 faults and more, each with a name of its own."""
    assert len(FAULTS) == sum(len(faults) for faults in GROUPS.values()) >= 60
    assert len(REPORT_FAULTS) >= 60
    for fault in (*FAULTS.values(), *REPORT_FAULTS.values()):
        if fault.target:
            fitted(fault)


def test_faults_leave_no_trace(sound):
    for fault in sample(8, "trace"):
        if fault in cheap():
            with applied(fault):
                list(pairs(fault))
    for before, pair in zip(sound, pairs(), strict=True):
        after = quantities(pair)
        assert before.keys() == after.keys()
        assert all(np.array_equal(before[name], after[name], equal_nan=True) for name in before)


def test_a_fault_acts_wherever_its_function_is_held(sound):
    """A method, a function imported by name, a function held by a record, a compiled one, a cached one."""
    for key in ("eq2_arm", "radius", "law_iii_radius", "friction_twice", "mesh_period", "block_bearings"):
        with applied(FAULTS[key]):
            both = zip(sound, pairs(), strict=True)
            assert any(change(old, quantities(pair))[0] > 0.01 for old, pair in both), key


def test_a_fault_acts_in_the_public_name_of_a_package():
    """The package holds its functions inside others, which type errors; evidence calls these."""
    pair = next(iter(pairs()))
    public = floquet.gear_pair_system
    period = public(pair, "mesh").period
    with applied(FAULTS["floquet_period"]):
        assert floquet.gear_pair_system(pair, "mesh").period == 2.0 * period
    assert floquet.gear_pair_system is public
    assert public(pair, "mesh").period == period


def test_a_fault_whose_line_is_gone_is_told():
    with (
        pytest.raises(FaultError, match="0 times 'no such text'"),
        applied(Fault("gone", "", "lumped.schema.bodies:solid_disc", "no such text", "")),
    ):
        pass


@pytest.mark.slow
@pytest.mark.parametrize("fault", drawn_by_the_source(1), ids=lambda fault: fault.key)
def test_faults_drawn_by_the_source_are_caught(fault):
    """Another one at every change of the code; ``python -m tests.evidence.faults`` runs all."""
    outcome = judge(fault, thorough=False)
    assert verdict(fault, outcome) in ("caught", "only measurement can tell")


@pytest.mark.parametrize("number", [0, 1])
def test_the_sound_program_keeps_every_relation_of_a_report(number):
    assert broken_relations(Results(list(pairs())[number], QUICK)) == ()


@pytest.mark.slow
@pytest.mark.parametrize("pair", ["calm", "lost"])
def test_a_sound_report_passes_and_faults_in_it_are_seen(pair):
    """Two of the faults that show on both pairs. Every change of the code selects other faults."""
    assert seen_by(None, [pair]) == ()
    both = [key for key in REPORT_FAULTS if key.startswith(("order_", "force_", "axis_", "csv_"))]
    both.remove("force_least")  # where contact is lost, the least of both is zero
    both.remove("force_sentence")  # a calm pair has its largest force on one tooth: both factors are equal
    number = int(source_digest()[:8], 16)
    for key in (both[number % len(both)], both[number // 97 % len(both)]):
        assert seen_by(REPORT_FAULTS[key], [pair]), key


def test_every_fault_of_the_report_is_seen():
    results = stored("report_faults.json")
    assert set(results) == set(REPORT_FAULTS)
    assert [key for key, checks in results.items() if not checks] == []


def test_the_stored_table_is_of_these_faults_and_misses_none():
    rows = stored()
    assert {one["key"] for one in rows} == set(FAULTS)
    assert [one["key"] for one in rows if one["verdict"] in ("missed", "no effect")] == []
    for one in rows:
        assert bool(one["caught"]) == (one["verdict"] == "caught")


def test_every_conservation_law_sees_a_fault_on_every_model_that_it_judges():
    """A limit that no fault ever crosses might as well not be there."""
    seen = laws_that_act(stored())
    every = {"lumped", "linear", "exact"}
    springs = {"lumped", "linear"}
    laws = {"friction takes power": every, "action and reaction": every, "first law": every}
    for law, models in (laws | {"mean bearing load": springs, "efficiency": {"lumped"}}).items():
        assert {model for found, model in seen if found == law} >= models, law
    powers = ("braking", "friction", "bearings", "mesh_damping", "mesh_stiffness")
    found = {item for item in seen if item[0].startswith("power ")}
    assert found == {(f"power {name}", "linear") for name in powers}


def test_sound_pairs_are_drawn_alike_by_one_seed():
    many = list(drawn(8, "7"))
    first, again = ([pair.to_toml() for pair in found] for found in (many[:3], drawn(3, "7")))
    assert first == again
    assert len(set(first)) == 3
    assert np.unique([pair.mesh.stiffness.model for pair in many]).size >= 2
