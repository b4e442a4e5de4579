"""What a propagator is: one step of x' = A(t) x, for many steps at once.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

from abc import ABC, abstractmethod

from lumped.typing import FloatArray


class Propagator(ABC):
    """A one-step method for the matrix equation X' = A(t) X.

    Attributes
    ----------
    name : how results and error messages call it
    order : p; the error of one step is O(h^(p+1)) while A is smooth inside the step
    nodes : (s,) abscissae in [0, 1] at which A is needed
    """

    name: str
    order: int
    nodes: FloatArray

    @abstractmethod
    def step_matrices(self, A: FloatArray, h: FloatArray) -> FloatArray:
        """Return the transition matrices over k steps.

        Parameters
        ----------
        A : (k, s, n, n), A at the nodes of each step
        h : (k,) step lengths [s]

        Returns
        -------
        (k, n, n), approximations of Phi(t_i + h_i, t_i)
        """
