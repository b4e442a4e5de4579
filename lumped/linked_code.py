"""Compilation of functions that only other compiled functions call, without machine code of their own.

numba optimises each function and writes its machine code, and then repeats both in every function that calls
it: the callee's intermediate code is linked into the caller, where it is inlined. Of a function that Python
never calls the machine code is never used. Half of the time to compile the kernels went there. Here such a
function stays intermediate code. It is optimised, and becomes machine code, as a part of its callers.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm  # type: ignore[import-untyped]
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.typed_passes import AnnotateTypes

#: Start of the names under which compiled code finds Python objects, one for each function.
_ENVIRONMENT = "_ZN08NumbaEnv"
#: Steps of numba that linked code replaces. They are no part of its public interface: with a numba that lacks
#: one of them every function gets its own machine code, which compiles more slowly and computes the same.
_STEPS = ("_optimize_final_module", "_finalize_final_module", "_verify_declare_only_symbols")
LINKING_IS_KNOWN = all(hasattr(JITCodeLibrary, step) for step in (*_STEPS, "_finalize_dynamic_globals"))


class LinkedCode(JITCodeLibrary):  # type: ignore[misc]  # numba ships no types
    """Intermediate code of a function, for its callers."""

    def _optimize_final_module(self) -> None:
        """Leave this to the callers."""

    def _finalize_final_module(self) -> None:
        """Make the code ready for linking. Of all symbols only the environments get an address now."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        environments = [
            one.name for one in self._final_module.global_variables if one.name.startswith(_ENVIRONMENT)
        ]
        lines = [f'@"{name}" = common global i8* null' for name in environments]
        addresses = llvm.parse_assembly("\n".join(lines))
        addresses.triple = self._final_module.triple
        addresses.data_layout = self._codegen._data_layout
        self._codegen._add_module(addresses)
        self._codegen._engine.finalize_object()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Finalize the library; none of its functions has an address."""
        self._ensure_finalized()
        return 0


class OptimisedCode(LinkedCode):
    """Intermediate code of a function that is optimised before its callers get it, and once more in them.

    Compiling takes longer. The callers are faster where much of the work of an inner loop is in a function
    with many functions below it: inlined all at once, the optimiser does not see what it sees in the function
    alone.
    """

    def _optimize_final_module(self) -> None:
        """Optimise as numba does."""
        JITCodeLibrary._optimize_final_module(self)


@register_pass(mutates_CFG=False, analysis_only=False)
class _IntoLinkedCode(LoweringPass):  # type: ignore[misc]
    """Give the function a library that stays intermediate code."""

    _name = "into_linked_code"
    _library: type[LinkedCode] = LinkedCode

    def __init__(self) -> None:
        LoweringPass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        state.library = self._library(state.targetctx.codegen(), state.func_id.func_qualname)
        return True


@register_pass(mutates_CFG=False, analysis_only=False)
class _IntoOptimisedCode(_IntoLinkedCode):
    """Give the function a library that stays intermediate code and is optimised."""

    _name = "into_optimised_code"
    _library = OptimisedCode


class LinkedCompiler(CompilerBase):  # type: ignore[misc]
    """numba's compiler in nopython mode, into linked code."""

    _into_code: type[_IntoLinkedCode] = _IntoLinkedCode

    def define_pipelines(self) -> list[Any]:
        pipeline = DefaultPassBuilder.define_nopython_pipeline(self.state)
        pipeline.add_pass_after(self._into_code, AnnotateTypes)
        pipeline.finalize()
        return [pipeline]


class OptimisingCompiler(LinkedCompiler):
    """numba's compiler in nopython mode, into linked code that is optimised before it is linked."""

    _into_code = _IntoOptimisedCode


def refuse_calls_from_python(dispatcher: Any) -> None:
    """Make a call from Python an error with a reason. Without this a call would jump to address 0."""

    def refuse(*arguments: Any, **keywords: Any) -> None:
        raise TypeError(f"{dispatcher.py_func.__qualname__} is compiled as a part of its callers alone")

    def leave_out(*overload: Any) -> None:
        """Numba would enter the address of the code here, and jump there when Python calls."""

    dispatcher._compile_for_args = refuse
    dispatcher._insert = leave_out
