"""What is proven, and where: every bound that is a theorem, with the function that computes the bound.

"Proven" means: the bound holds for the numbers as given; truncation, polynomials in place of formulas and the
rounding of every operation are in the bound. Each function below has the word PROVEN in its docstring. The
sections are those of docs/theory/proven_bounds.md. tests/floquet/engine/test_proven.py keeps this table complete.

| statement | file: function | section |
|---|---|---|
| the polynomials of a friction law differ from the formula of the law by at most this | lumped/friction/misfit.py: fit_misfit | The gains |
| the gain of a mesh, computed from these polynomials, is wrong by at most this | floquet/gear/gains.py: MeshGains | The gains |
| the pieces of degree 8 that the kernel takes differ from the gain by at most this | floquet/rank_one/piecewise.py: fit_pieces | The gains |
| the change to modal coordinates makes A wrong by at most this | floquet/rank_one/kernel_input.py: _rounding | The matrix of a step |
| after so many Taylor terms the rest is below the tolerance | floquet/rank_one/kernels/gains.py: enough_terms | The matrix of a step |
| the flow over a step of a chart is wrong by at most this | floquet/rank_one/kernels/taylor.py: _error_of_step | The matrix of a step |
| the monodromy matrix of a chart is wrong by at most this | floquet/rank_one/kernels/taylor.py: propagate_points | The product |
| the product of steps of a chart is wrong by at most this | floquet/rank_one/kernels/product.py: carry | The product |
| a formula for A(t) is its Taylor polynomial but for this | floquet/engine/coefficients.py: PeriodicMatrix | Coefficients given as formulas |
| M, C and K as formulas give A(t) but for this | floquet/engine/second_order.py: _Solution | Coefficients given as formulas |
| the flow over a step with A(t) as a formula is wrong by at most this | floquet/engine/formula_steps.py: _steps | The matrix of a step |
| the product of any steps is wrong by at most this | floquet/engine/kernels/steps.py: product_bounds | The product |
| each disk holds an eigenvalue: quick bound, by eigenvectors | floquet/engine/kernels/eigenvalue_bounds.py: spectra | Multipliers |
| each disk holds an eigenvalue: careful bound, by the Schur form | floquet/engine/multipliers.py: multipliers_with_bounds | Multipliers |
| the exact invariant subspace of a cluster is as near as this | floquet/engine/multipliers.py: clusters_of | Multipliers |
| without damping all multipliers are simple and on the unit circle | floquet/engine/neutral.py: on_unit_circle | On the unit circle |
| without damping all multipliers are on the unit circle, and motions are bounded though multipliers coincide | floquet/engine/neutral.py: definite_signatures | On the unit circle |
| without friction and damping motions that tip corners drive are bounded | floquet/gear/multipliers.py: stays_bounded | On the unit circle |
| motions off the line of action have these multipliers | floquet/gear/multipliers.py: OffLineOfAction | Multipliers |
| with teeth that differ the rate is wrong by at most this | floquet/gear/multipliers.py: _of_cycles | Teeth that differ |
| all slower speeds are stable | floquet/rank_one/boxes.py: slow_period | Between the nodes of a chart |
| the monodromy matrix over a patch of a chart is this polynomial but for this | floquet/rank_one/boxes.py: FlowPolynomial | Between the nodes of a chart |
| a cell of a chart is stable, or unstable, everywhere in it | floquet/rank_one/boxes.py: decided | Between the nodes of a chart |
| everywhere in a patch flows within a cycle are at most this | floquet/rank_one/boxes.py: _flow_in_patch | Between the nodes of a chart |
| entries with these ranges have no multiplier on the unit circle | floquet/rank_one/boxes.py: verdicts_by_disks | Between the nodes of a chart |
| an interval of periods is stable, or unstable, everywhere in it | floquet/rank_one/boxes.py: decided_intervals | The nearest unstable speed |
| all periods between the first and the nearest unstable one are stable, but for intervals that are listed | floquet/rank_one/period_search.py: proven_periods | The nearest unstable speed |
| between two speeds mu deviates from a sum with factors by at most this | floquet/gear/friction_between_speeds.py: FrictionBetweenSpeeds | The nearest unstable speed |

A result says which kind of error it has: ``certificate`` is "proven" or "estimate", of charts also "mixed".

NOT proven:

- A callable A(t), of which only samples are known: `floquet.monodromy` of a callable, and every
  ``method`` but "auto" and "taylor". A narrow feature may be missed without a warning; see "What remains an
  estimate".
- Interpolated nodes of a chart, and everything between the nodes, unless ``prove=True`` and the cell says so.
- Boundaries, tongues, margins and jumps: searches that decide by multipliers at the speeds that they try. Only
  `nearest_unstable_speed` proves what is between.
- Motions: orbits, their multipliers, settled runs and attractors (floquet/orbits, and the unilateral motions of
  floquet/gear).
- With teeth that differ: the distance of the polynomials of the gains from the static state.
- The model: k, c, the errors of the teeth and a table of mu are taken as exact.
"""  # noqa: E501
