"""What numba and LLVM do with a compiled function: less work than by default where the work is of no use.

**Linked code** is of functions that only other compiled functions call, without machine code of their own.

numba optimises each function and writes its machine code, and then repeats both in every function that calls
it: the callee's intermediate code is linked into the caller, where it is inlined. Of a function that Python
never calls the machine code is never used. Half of the time to compile the kernels went there. Here such a
function stays intermediate code. It is optimised, and becomes machine code, as a part of its callers.

**Short loops.** LLVM writes most loops several times: unrolled, in vector instructions, and the rest one by
one. A loop over six coordinates or three tooth pairs never comes to the copies, but half of the time in LLVM
goes there. The code of a function with short loops has each loop once. The results are the same bits: without
fast arithmetic LLVM does not change the order of operations.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm  # type: ignore[import-untyped]
from numba.core import errors, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import AnnotateTypes

#: Start of the names under which compiled code finds Python objects, one for each function.
_ENVIRONMENT = "_ZN08NumbaEnv"
#: Steps of numba that linked code replaces. They are no part of its public interface: with a numba that lacks
#: one of them every function gets its own machine code, which compiles more slowly and computes the same.
_STEPS = ("_optimize_final_module", "_finalize_final_module", "_verify_declare_only_symbols")
LINKING_IS_KNOWN = all(hasattr(JITCodeLibrary, step) for step in (*_STEPS, "_finalize_dynamic_globals"))
#: Without these of llvmlite the copies of loops cannot be left out.
_TUNING_IS_KNOWN = all(
    hasattr(llvm, name) for name in ("create_pipeline_tuning_options", "create_pass_builder")
)
#: Highest level of optimisation.
_MOST = 3


def optimise_short_loops(library: Any) -> None:
    """Optimise the module of a library at the highest level, without copies of loops."""
    if not _TUNING_IS_KNOWN:
        JITCodeLibrary._optimize_final_module(library)
        return
    tuning = llvm.create_pipeline_tuning_options(speed_level=_MOST)
    tuning.loop_unrolling = False
    tuning.loop_interleaving = False
    tuning.loop_vectorization = False
    tuning.slp_vectorization = False
    builder = llvm.create_pass_builder(library._codegen._tm, tuning)
    passes = builder.getModulePassManager()
    passes.add_refprune_pass()  # of numba: counts of references that cancel
    passes.run(library._final_module, builder)


class ShortLoopCode(JITCodeLibrary):  # type: ignore[misc]  # numba ships no types
    """Machine code of a function in which LLVM copies no loop."""

    def _optimize_final_module(self) -> None:
        optimise_short_loops(self)


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
        optimise_short_loops(self)


class _IntoCode(LoweringPass):  # type: ignore[misc]
    """Give the function a library of a kind."""

    _library: type[JITCodeLibrary]
    _stored = False

    def __init__(self) -> None:
        LoweringPass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        state.library = self._library(state.targetctx.codegen(), state.func_id.func_qualname)
        if self._stored:
            state.library.enable_object_caching()
        return True


@register_pass(mutates_CFG=False, analysis_only=False)
class _IntoLinkedCode(_IntoCode):
    _name = "into_linked_code"
    _library = LinkedCode


@register_pass(mutates_CFG=False, analysis_only=False)
class _IntoOptimisedCode(_IntoCode):
    _name = "into_optimised_code"
    _library = OptimisedCode


@register_pass(mutates_CFG=False, analysis_only=False)
class _IntoShortLoopCode(_IntoCode):
    _name = "into_short_loop_code"
    _library = ShortLoopCode
    _stored = True


class _Compiler(CompilerBase):  # type: ignore[misc]
    """numba's compiler in nopython mode, into code of a kind."""

    _into_code: type[_IntoCode]

    def define_pipelines(self) -> list[Any]:
        pipeline = DefaultPassBuilder.define_nopython_pipeline(self.state)
        pipeline.add_pass_after(self._into_code, AnnotateTypes)
        pipeline.finalize()
        return [pipeline]


class LinkedCompiler(_Compiler):
    """Into linked code."""

    _into_code = _IntoLinkedCode


class OptimisingCompiler(_Compiler):
    """Into linked code that is optimised before it is linked."""

    _into_code = _IntoOptimisedCode


class ShortLoopCompiler(_Compiler):
    """Into machine code in which LLVM copies no loop."""

    _into_code = _IntoShortLoopCode


def refuse_calls_from_python(dispatcher: Any) -> None:
    """Make a call from Python an error with a reason. Without this a call would jump to address 0."""

    def refuse(*arguments: Any, **keywords: Any) -> None:
        raise TypeError(f"{dispatcher.py_func.__qualname__} is compiled as a part of its callers alone")

    def leave_out(*overload: Any) -> None:
        """Numba would enter the address of the code here, and jump there when Python calls."""

    dispatcher._compile_for_args = refuse
    dispatcher._insert = leave_out


class TwoForms(CPUDispatcher):  # type: ignore[misc]
    """A function that Python calls, and that compiled functions call as another form of it."""

    part: Any

    @property
    def _numba_type_(self) -> Any:
        """What the name of the function stands for in compiled code.

        Raises
        ------
        TypingError : the function calls itself: linked code has no address to which such a call could go
        """
        if self.part.is_compiling:
            name = self.py_func.__qualname__
            raise errors.TypingError(f"{name} calls itself, directly or through others. Write a loop.")
        return types.Dispatcher(self.part)


def link_into_callers(dispatcher: Any, part: Any) -> None:
    """Let compiled callers take the code of ``part``, the same function as linked code.

    The machine code for callers in Python is then compiled only where Python calls the function.
    """
    dispatcher.__class__ = TwoForms
    dispatcher.part = part


def forms_of(dispatcher: Any) -> tuple[Any, ...]:
    """Return a compiled function, and its form for compiled callers where that is another one."""
    part = getattr(dispatcher, "part", None)
    return (dispatcher,) if part is None else (dispatcher, part)
