"""Do the site's own extensions write what they should? The build itself treats warnings as errors."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("sphinx", reason="the docs extra is not installed")
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs"))

from computed.faults import faults
from computed.markdown import CheckFailed, must_pass, table
from computed.mutants import mutants
from computed.schema import parameters
from extensions import gallery
from extensions.docstrings import rewritten
from extensions.mathml import mathml
from extensions.plain_mathematics import parts
from sphinx.errors import ExtensionError

from tests.evidence.faults.fault import FAULTS
from tests.evidence.faults.outcome import Outcome
from tests.evidence.faults.table import row


def test_a_failing_check_stops_the_build():
    must_pass("order", True)
    with pytest.raises(CheckFailed, match="order"):
        must_pass("order", False)


def test_the_pages_are_computed_without_the_test_extra(root):
    """`make docs` of a fresh clone installs the docs extra alone."""
    code = """
import sys
for name in ("pytest", "hypothesis", "xdist", "selenium", "flint", "fmpy"):
    sys.modules[name] = None  # an import raises ModuleNotFoundError
import computed
computed.writers()
"""
    paths = os.pathsep.join((str(root), str(root / "docs")))
    environment = os.environ | {"PYTHONPATH": paths}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_table_cells_are_not_markup():
    assert table(("a", "b"), [("x|y*z", None)]).splitlines()[2] == r"| x\|y\*z | – |"


def test_the_table_of_faults_says_which_check_saw_one():
    outcome = Outcome(0.9, "speed", {"cross-check": (), "tests": ("frequencies",)})
    shown = faults([row(FAULTS["speed_unit"], outcome)])
    # The cross-check does not use it.
    assert "| 90 % | speed |  |  | tests: frequencies |" in shown


def test_the_table_of_mutants_gives_the_share_and_survivors_first():
    row = {"file": "lumped/a.py", "line": 3, "before": "y = a | b", "after": "y = a", "seconds": 4.6}
    rows = [row | {"verdict": word, "by": by} for word, by in (("killed", "test_a"), ("survived", ""))]
    shown = mutants({"seed": 1, "mutants": rows})
    assert "Seed 1: 50 % of the decided mutants are killed." in shown
    assert "| lumped | 1 | 1 | 0 | 0 | 50 % |" in shown
    assert "| `` lumped/a.py:3 `` | `` y = a \\| b `` | `` y = a `` | test_a | 5 |" in shown
    assert shown.index("## Survived") < shown.index("## Killed")


def test_fields_of_a_docstring():
    text = ["Do it.", "", "Parameters", "----------", "a, b : length |x| [m],", "    positive", "", "Raises"]
    text += ["------", "ValueError : never", "", "Returns", "-------", "the ``x_`` of `y`"]
    assert rewritten(text) == [
        "Do it.",
        "",
        "",
        r":param a: length \|x\| [m], positive",
        r":param b: length \|x\| [m], positive",
        ":raises ValueError: never",
        ":returns: the ``x_`` of ``y``",
        "",
    ]


def marked(text, **options):
    """The text with its formulas in ⟦ ⟧."""
    return "".join(f"⟦{part.text}⟧" if part.latex else part.text for part in parts(text, **options))


@pytest.mark.parametrize(("text", "latex"), [
    ("Ω_p r_bp", r"\Omega_{p}\,r_{bp}"),
    ("4 M^k x", r"M^{k}\,x"),
    ("V_s^b6", "V_{s}^{b6}"),
    ("r_bg/r_bp", "r_{bg}/r_{bp}"),
    ("r_{k+1}", "r_{k+1}"),
    ("θ̇_p", r"\dot{\theta}_{p}"),
    ("2w_i/k", "2w_{i}/k"),
    ("e^{−ct} y", r"e^{-ct}\,y"),
    ("r_b²(r_i⁻² − r_f⁻²)", "r_{b}^{2}(r_{i}^{-2} - r_{f}^{-2})"),
    ("√(r_a² − r_b²)", r"\sqrt{r_{a}^{2} - r_{b}^{2}}"),
    ("ΣF_iv_s,i", r"\sum F_{i}v_{s,i}"),
    ("x″ᵀMy = x′ᵀGy", r"x^{\prime\prime T}My = x^{\prime T}Gy"),
    ("(I − M)⁻¹ p = |E|_F", r"(I - M)^{-1}\,p = |E|_{F}"),
    ("d_ij ≠ 2 cos θ", r"d_{ij} \ne 2 \cos \theta"),
])  # fmt: skip
def test_latex_of_formulas_in_text(text, latex):
    (formula,) = (part.latex for part in parts(text, letters=True) if part.latex)
    expected, typeset = (re.sub(r"\s", "", mathml(one, block=False)) for one in (latex, formula))
    assert typeset == expected


@pytest.mark.parametrize("text", [
    "⟦L_XA⟧ is the start. A contact at ⟦ξ = 21⟧ mm carries 5 N, or ⟦N_i = 3⟧ kN m.",
    "from ⟦A⟧ to ⟦D⟧ with a gear of law V, at the centre distance ⟦a⟧ (ISO 21771)",
    "the friction ⟦F_i⟧, in J. Sound Vib. 309, is ⟦μ_i N_i⟧ of eq. (3)",
    "mesh_efficiency of 98 % at 4875 rpm, e.g. 1e-7 of it, and 2·10⁻⁵ N/m",
    "pair ⟦i⟧ gets ⟦k_i = k(τ) κ_i/Σκ_j⟧, where ⟦κ_i⟧ is its stiffness",
    "law II for ⟦1 ≤ Λ < 4⟧; roots with ⟦|tr M| < 2⟧ and ⟦c' = 0.8 c'_th⟧",
    "a motion doubles; ⟦J = [[0, I], [−I, 0]]⟧, the gear's tip, 20 µm/N and 3 mm²",
])  # fmt: skip
def test_words_and_units_are_no_formulas(text):
    plain = re.sub("[⟦⟧]", "", text)
    assert marked(plain, letters=True) == text


def test_a_letter_alone_is_a_symbol_on_pages_of_theory_only():
    assert marked("the gear k turns by θ", letters=False) == "the gear k turns by ⟦θ⟧"
    assert marked("the gear k turns by θ", letters=True) == "the gear ⟦k⟧ turns by ⟦θ⟧"


def test_equations_keep_the_index_beside_a_dotted_symbol():
    found = mathml(r"\dot x_p", block=True)
    assert "<msub><mover>" in found
    assert "munderover" not in found
    with pytest.raises(ExtensionError, match="nosuchcommand"):
        mathml(r"\nosuchcommand", block=True)


def test_fractions_of_single_tokens():
    """docutils by itself reads the 12 of \\frac12 as one number."""
    for latex in (r"\tfrac12 x", r"\tfrac{1}{2} x", r"\frac 1 2x", r"\frac1{2} x"):
        found = re.sub(r"\s", "", mathml(latex, block=True))
        assert "<mn>1</mn><mn>2</mn></mfrac>" in found, latex
    assert "<mfrac><mi>α</mi><mi>S</mi></mfrac>" in re.sub(r"\s", "", mathml(r"\frac\alpha S", block=True))


def test_every_equation_has_mathml(page):
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    for latex in re.findall(r"\$\$(.+?)\$\$", text, re.S):
        mathml(re.sub(r"\\tag\{[^}]*\}", "", latex).strip(), block=True)


def test_the_parameter_reference_states_unit_range_and_default():
    rows = [line for line in parameters().splitlines() if line.startswith("| `pinion_speed`")]
    assert rows == ["| `pinion_speed` | nominal speed of the pinion | rpm | > 0, ≤ 200000 | required |"]


def test_a_folder_inside_examples_is_no_section_of_the_gallery(root, monkeypatch):
    from sphinx_gallery import gen_gallery

    monkeypatch.setattr(gen_gallery, "get_subsections", gen_gallery.get_subsections)
    settings = {"subsection_order": None, "copyfile_regex": "", "source_suffix": {".rst": "", ".md": ""}}
    arguments = (root / "docs", root / "examples", settings)
    assert gen_gallery.get_subsections(*arguments) == ["check_in_ci"]  # it has a README.md
    gallery.setup(None)
    assert gen_gallery.get_subsections(*arguments) == []
