"""One module of machine code an entry: what Numba would emit again for every kernel.

Stock Numba makes each compiled function a library of its own, which links in all that it calls,
optimises it again and emits it again. Here a kernel is kept as bare LLVM code, function passes
only. A *module*, an entry that Python calls or a kernel that several entries share, links the
kernels below it once, is optimised and emitted once, and it alone is cached. A module calls
another by its symbol, which Numba's one execution engine resolves.

This uses inner classes of Numba: `AVAILABLE` says whether they are those of the version that it was
written for; otherwise `compiling` falls back on stock compilation, which gives the same answers.
"""

from __future__ import annotations

import functools
import hashlib
import os
from typing import Any

import numba
from llvmlite import binding as llvm
from numba.core import compiler, typed_passes, types, untyped_passes
from numba.core.caching import NullCache
from numba.core.codegen import CodeLibrary, JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.environment import lookup_environment
from numba.core.registry import CPUDispatcher

WRITTEN_FOR = "0.68."
FORCE_STOCK = "STANDOFF_STOCK_COMPILER"
"""Set to 1 in the environment: stock compilation, whatever Numba's version."""

AVAILABLE = (
    numba.__version__.startswith(WRITTEN_FOR)
    and os.environ.get(FORCE_STOCK, "0") in ("", "0")
    and all(
        hasattr(JITCodeLibrary, name)
        for name in (
            "_get_module_for_linking",
            "_optimize_final_module",
            "_finalize_final_module",
            "_get_compiled_object",
            "_object_compiled_hook",
        )
    )
)


def why_stock() -> str:
    """Why each kernel is compiled by itself though nobody has asked for it; "" if it is not."""
    if AVAILABLE or os.environ.get(FORCE_STOCK, "0") not in ("", "0"):
        return ""
    return f"Numba {numba.__version__} is not the version that one module an entry was written for"


# How Numba names the variables that hold a function's environment.
ENVIRONMENT = "_ZN08NumbaEnv"
OWN_SYMBOL = "_ZN8standoff"


class PartLibrary(JITCodeLibrary):
    """A kernel's own LLVM code, not linked with what it calls, never emitted by itself."""

    def _optimize_functions(self, code: llvm.ModuleRef) -> None:
        """Numba's own, less for functions that are only declared."""
        code.data_layout = self._codegen._data_layout
        for function in code.functions:
            if not function.is_declaration:
                passes, builder = self._codegen._function_pass_manager()
                passes.run(function, builder)

    def finalize(self) -> None:
        self._raise_if_finalized()
        self._finalized = True

    def own_module(self) -> llvm.ModuleRef:
        return self._final_module

    def _get_module_for_linking(self) -> llvm.ModuleRef:
        """With all that it calls, for a stock function that calls this kernel."""
        if self._shared_module is None:
            parts, _ = reached(self._linking_libraries)
            whole = self.own_module().clone()
            for part in parts:
                whole.link_in(code_of(part), preserve=True)
            for function in whole.functions:
                if not function.is_declaration and function.linkage == llvm.Linkage.external:
                    function.linkage = "linkonce_odr"
            self._shared_module = whole
        return self._shared_module


class ModuleLibrary(JITCodeLibrary):
    """A module: linked with all kernels below it, optimised and emitted once."""

    def finalize(self) -> None:
        self._raise_if_finalized()
        exported = {f.name for f in self._final_module.functions if not f.is_declaration}
        parts, modules = reached(self._linking_libraries)
        for part in parts:
            self._reload_init.update(part._reload_init)
            self._final_module.link_in(code_of(part), preserve=True)
        self._hide_all_but(exported)
        self._optimize_final_module()
        self._final_module.verify()
        self._check_resolved(modules)
        self.exported, self.modules = exported, modules
        self._finalize_final_module()
        self._set_environments()

    def _hide_all_but(self, exported: set[str]) -> None:
        """Make the kernels below the module's own, under names that no other module has.

        LLVM may change how an internal function takes its arguments, and its dynamic linker finds
        internal functions by name too: under its own name a stock function would call it wrongly.
        """
        mark = hashlib.sha256("".join(sorted(exported)).encode()).hexdigest()[:16]
        hidden = [
            function
            for function in self._final_module.functions
            if not function.is_declaration and function.name not in exported
        ]
        for number, function in enumerate(hidden):
            function.linkage = "internal"
            function.name = f"standoff.{mark}.{number}"

    def _check_resolved(self, modules: list[ModuleLibrary]) -> None:
        """A symbol that nobody defines would be called all the same, and crash."""
        known = {name for module in modules for name in module.exported}
        for function in self._final_module.functions:
            own = function.is_declaration and function.name.startswith(OWN_SYMBOL)
            if own and function.name not in known:
                raise AssertionError(f"{self.name}: no module defines {function.name}.")

    def _set_environments(self) -> None:
        for variable in self._final_module.global_variables:
            environment = None
            if variable.name.startswith(ENVIRONMENT):
                environment = lookup_environment(variable.name)
            if environment is not None:
                self._codegen.set_env(variable.name, environment)

    def serialize_using_object_code(self) -> tuple[str, str, tuple[bytes, bytes]]:
        """The object code, and in place of the bitcode, which nobody links again, empty functions
        that bear the exported names."""
        self._ensure_finalized()
        named = "\n".join(
            f'define void @"{name}"() {{ ret void }}' for name in sorted(self.exported)
        )
        return (
            self.name,
            "object",
            (self._get_compiled_object(), llvm.parse_assembly(named).as_bitcode()),
        )


def reached(libraries: list[CodeLibrary]) -> tuple[list[CodeLibrary], list[ModuleLibrary]]:
    """(the kernels, the modules) that libraries call, each once; not those below the modules."""
    found: dict[int, CodeLibrary] = {}
    waiting = list(reversed(libraries))
    while waiting:
        library = waiting.pop()
        if id(library) not in found:
            found[id(library)] = library
            if isinstance(library, PartLibrary):
                waiting.extend(reversed(library._linking_libraries))
    modules = [one for one in found.values() if hasattr(one, "exported")]
    return [one for one in found.values() if not hasattr(one, "exported")], modules


def code_of(library: CodeLibrary) -> llvm.ModuleRef:
    if isinstance(library, PartLibrary):
        return library.own_module()
    return library._get_module_for_linking()


class Uncallable:
    """Stands in Numba's tables for a kernel's code, which has no address of its own."""


@register_pass(mutates_CFG=True, analysis_only=False)
class PartLowering(typed_passes.NativeLowering):
    """Lowers a kernel into a `PartLibrary`."""

    _name = "standoff_part_lowering"

    def run_pass(self, state: Any) -> bool:
        state.library = PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        without_references(state)
        super().run_pass(state)
        enter_in_tables(state)
        return True


def enter_in_tables(state: Any) -> None:
    """Let other kernels find what was lowered, though Python cannot call it."""
    state.library.finalize()
    lowered, stand_in = state["cr"], Uncallable()
    state.targetctx.insert_user_function(stand_in, lowered.fndesc, [state.library])
    state.reload_init.extend(state.library._reload_init)
    state["cr"] = lowered._replace(cfunc=stand_in)


def without_references(state: Any) -> None:
    """Leave the counting of references out of a kernel that holds no array."""
    models = state.targetctx.data_model_manager
    kinds = {*state.typemap.values(), state.return_type}
    if not any(models[kind].contains_nrt_meminfo() for kind in kinds):
        state.targetctx = state.targetctx.subtarget(enable_nrt=False)


@register_pass(mutates_CFG=True, analysis_only=False)
class EntryLowering(typed_passes.NativeLowering):
    """Lowers an entry into a `ModuleLibrary`."""

    _name = "standoff_entry_lowering"

    def run_pass(self, state: Any) -> bool:
        begin_module(state)
        return bool(super().run_pass(state))


@register_pass(mutates_CFG=True, analysis_only=False)
class SharedLowering(typed_passes.NativeLowering):
    """Lowers a kernel that several modules call into a `ModuleLibrary`."""

    _name = "standoff_shared_lowering"

    def run_pass(self, state: Any) -> bool:
        begin_module(state)
        super().run_pass(state)
        enter_in_tables(state)
        return True


def begin_module(state: Any) -> None:
    state.library = ModuleLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
    state.library.origin = state.func_id.modname, state.func_id.func_qualname, tuple(state.args)
    state.library.enable_object_caching()


# The passes of Numba's own pipeline without those for what no kernel uses: with blocks, closures,
# list comprehensions, literal types, array expressions, inlining by Numba.
PASSES = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.DeadBranchPrune,
    untyped_passes.GenericRewrites,
    untyped_passes.RewriteDynamicRaises,
    untyped_passes.ReconstructSSA,
    untyped_passes.DeadBranchPrune,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.IRLegalization,
)


class _Compiler(compiler.CompilerBase):  # type: ignore[misc]
    lowering: type
    number = 0

    def define_pipelines(self) -> list[PassManager]:
        # Numba numbers functions in the order of compilation; the cache wants lasting names
        self.state.func_id.unique_id = self.number
        passes = PassManager(type(self).__name__)
        for each in (*PASSES, self.lowering, typed_passes.NoPythonBackend):
            passes.add_pass(each, each.__name__)
        passes.finalize()
        return [passes]


class EntryCompiler(_Compiler):
    """The pipeline of entries."""

    lowering = EntryLowering

    def define_pipelines(self) -> list[PassManager]:
        self.state.flags.no_cfunc_wrapper = True
        return super().define_pipelines()


class LooseCompiler(EntryCompiler):
    """The pipeline of a kernel that Python calls all the same, as tests do: under another name."""

    number = 1


class _Unwrapped(_Compiler):
    """Of what Python does not call."""

    def define_pipelines(self) -> list[PassManager]:
        self.state.flags.no_compile = True
        self.state.flags.no_cpython_wrapper = True
        self.state.flags.no_cfunc_wrapper = True
        return super().define_pipelines()


class PartCompiler(_Unwrapped):
    """The pipeline of kernels."""

    lowering = PartLowering


class SharedCompiler(_Unwrapped):
    """The pipeline of kernels that are modules of their own."""

    lowering = SharedLowering


class Part(CPUDispatcher):  # type: ignore[misc]
    """A kernel: other kernels call it, Python only in tests.

    Numba's own part of it is made when something first asks for that: where entries are found on
    disk few of some 1,300 kernels are asked, and to make all took a sixth of a command's start.
    """

    _begun = False
    _entry = None
    cache: Any = NullCache()
    cache_of_calls: Any = NullCache()

    def __init__(self, function: Any, options: Any, pipeline: type) -> None:
        functools.update_wrapper(self, function)
        self.py_func, self.targetoptions, self._pipeline = function, options, pipeline

    def _begin(self) -> None:
        with global_compiler_lock:
            if not self._begun:
                self._begun = True
                super().__init__(
                    self.py_func, targetoptions=self.targetoptions, pipeline_class=self._pipeline
                )
                self._cache = self.cache

    def __getattr__(self, name: str) -> Any:
        if self._begun:
            raise AttributeError(f"{self.py_func.__name__} has no {name}")
        self._begin()
        return getattr(self, name)

    def compile(self, signature: Any) -> Any:
        self._begin()
        return super().compile(signature)

    def add_overload(self, result: Any) -> None:
        self.overloads[tuple(result.signature.args)] = result

    def get_call_template(self, args: Any, kws: Any) -> Any:
        self._begin()
        # a literal number would compile the kernel once more
        return super().get_call_template([types.unliteral(each) for each in args], kws)

    def __call__(self, *args: Any) -> Any:
        if self._entry is None:
            self._entry = CPUDispatcher(
                self.py_func, targetoptions=self.targetoptions, pipeline_class=LooseCompiler
            )
            self._entry._cache = self.cache_of_calls
        return self._entry(*args)
