"""PTX on the processor: a kernel's PTX written in C, instruction by instruction, and compiled.

So what a GPU would be given can be run without one: it judges all that numba-cuda and NVVM do, and
counts the operations that a thread makes. What ptxas and the GPU make of the PTX it can't judge;
``contract`` fuses a product and a sum wherever ptxas may. Needs a C compiler.
"""

from __future__ import annotations

import ctypes
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

KINDS = ("add", "sub", "mul", "fma", "div", "rcp", "sqrt")
"""Operations that are counted, in double precision."""

REGISTERS = {
    "%p": "uint8_t",
    "%rs": "uint16_t",
    "%r": "uint32_t",
    "%fd": "double",
    "%rd": "uint64_t",
}
TYPES = {
    "f64": "double", "u64": "uint64_t", "s64": "int64_t", "b64": "uint64_t", "u32": "uint32_t",
    "s32": "int32_t", "b32": "uint32_t", "u16": "uint16_t", "s16": "int16_t", "pred": "uint8_t",
}  # fmt: skip
HEAD = """
#include <math.h>
#include <stdint.h>
#include <string.h>
#define COUNT(k) (++counts[k])
static double real_of(uint64_t x) { double y; memcpy(&y, &x, 8); return y; }
static uint64_t bits_of(double x) { uint64_t y; memcpy(&y, &x, 8); return y; }
static uint64_t whole_of(double x) {
  if (isnan(x)) return (uint64_t)INT64_MIN;
  if (x >= 9223372036854775808.0) return (uint64_t)INT64_MAX;
  return x < -9223372036854775808.0 ? (uint64_t)INT64_MIN : (uint64_t)(int64_t)x;
}
void run(const uint64_t *params, uint64_t first, uint64_t end, uint64_t *counts) {
for (uint64_t thread = first; thread < end; ++thread) {
"""
COMPARED = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}


class NotKnown(ValueError):
    """An instruction that no kernel had when this was written."""


def written_in_c(ptx: str) -> str:
    """The C of the one kernel in a PTX file, which must call nothing."""
    body = ptx[ptx.index(".visible .entry") :]
    body = body[body.index("{") + 1 : body.index("\n}")]
    lines, declared = [], []
    for name, kind in REGISTERS.items():
        for count in re.findall(rf"\.reg \.\w+\s+{name}<(\d+)>", body):
            every = ", ".join(_name(f"{name}{k}") for k in range(int(count)))
            declared += [f"{kind} {every};"]
    # braces on lines of their own hold a register for a while
    body = re.sub(r"^\s*[{}]\s*$", "", body, flags=re.MULTILINE)
    declared.append("uint32_t r_temp;")
    for statement in body.replace("\n", " ").split(";"):
        said = statement.strip()
        while label := re.match(r"\$(\w+):\s*", said):
            lines.append(f"{label[1]}: ;")
            said = said[label.end() :]
        if said and not said.startswith((".reg", ".loc")):
            lines.append(_guarded(said))
    return HEAD + "\n".join(declared + lines) + "\n}}\n"


def _name(register: str) -> str:
    return register.replace("%", "r_")


def _guarded(said: str) -> str:
    guard = re.match(r"@(!?)(%p\d+)\s+", said)
    if guard is None:
        return _instruction(said)
    return f"if ({guard[1]}{_name(guard[2])}) {{ {_instruction(said[guard.end() :])} }}"


def _value(operand: str, kind: str) -> str:
    """An operand as C, of a type."""
    operand = operand.strip()
    if special := {"%tid.x": "0", "%ntid.x": "1", "%ctaid.x": "thread"}.get(operand):
        return f"(({TYPES[kind]}){special})"
    if operand.startswith("0d"):
        return f"real_of(0x{operand[2:]}u)"
    if operand.startswith("%fd"):
        return _name(operand) if kind == "f64" else f"bits_of({_name(operand)})"
    if operand.startswith("%rd") and kind == "f64":
        return f"real_of({_name(operand)})"
    if operand.startswith("%"):
        return f"(({TYPES[kind]}){_name(operand)})"
    return f"(({TYPES[kind]}){operand}ll)"


def _address(operand: str) -> str:
    found = re.fullmatch(r"\[(%rd\d+)(?:\+(-?\d+))?\]", operand.strip())
    if found is None:
        raise NotKnown(operand)
    return f"({_name(found[1])} + ({found[2] or 0}))"


def _instruction(said: str) -> str:
    """A statement of C for an instruction without its guard."""
    name, _, rest = said.partition(" ")
    parts = name.split(".")
    kind = parts[-1]
    if said == "ret":
        return "continue;"
    if parts[0] == "bra":
        return f"goto {rest.strip().lstrip('$')};"
    given = [each.strip() for each in re.split(r",(?![^{\[]*[}\]])", rest)]
    if parts[0] in ("ld", "st"):
        return _memory(parts, given)
    if said.startswith("mov.b64") and "{" in said:
        return _halves(given)
    if parts[0] == "cvta":
        return f"{_name(given[0])} = {_name(given[1])};"
    if parts[0] == "cvt":
        value = _value(given[1], kind)
        whole = parts[1] == "rzi" and kind == "f64"
        made = f"whole_of({value})" if whole else f"({TYPES[parts[-2]]}){value}"
        return f"{_name(given[0])} = {made};"
    if parts[0] == "setp":
        return f"{_name(given[0])} = {_compared(parts[1], *(_value(x, kind) for x in given[1:]))};"
    if parts[0] == "selp":
        a, b = (_value(x, kind) for x in given[1:3])
        return f"{_name(given[0])} = {_name(given[3])} ? {a} : {b};"
    return f"{_name(given[0])} = {_computed(parts, kind, given[1:])};"


def _halves(given: list[str]) -> str:
    """Two registers of 32 bits, low and high, from one of 64; or that from them."""
    to, whole = given
    if to.startswith("{"):
        low, high = (_name(each) for each in re.findall(r"%\w+", to))
        value = _value(whole, "b64")
        return f"{low} = (uint32_t){value}; {high} = (uint32_t)({value} >> 32);"
    low, high = (_name(each) for each in re.findall(r"%\w+", whole))
    value = f"(uint64_t){low} | (uint64_t){high} << 32"
    return f"{_name(to)} = {f'real_of({value})' if to.startswith('%fd') else value};"


def _memory(parts: list[str], given: list[str]) -> str:
    kind = TYPES[parts[-1]]
    if parts[1] == "param":
        number = re.search(r"_param_(\d+)\]$", given[1])
        assert number is not None, given
        return f"{_name(given[0])} = params[{number[1]}];"
    at, value = (given[1], given[0]) if parts[0] == "ld" else (given[0], given[1])
    names, place = re.findall(r"-?[%\w]+", value), _address(at)
    told = []
    for k, each in enumerate(names):
        memory = f"(({kind} *)({place}))[{k}]"
        if parts[0] == "ld":
            told.append(f"{_name(each)} = {memory};")
        else:
            told.append(f"{memory} = {_value(each, parts[-1])};")
    return " ".join(told)


def _compared(how: str, a: str, b: str) -> str:
    if how in COMPARED:
        # C's != is true of a NaN, PTX's ne is not
        return f"({a} {COMPARED[how]} {b})" if how != "ne" else f"({a} < {b} || {a} > {b})"
    if how.endswith("u") and how[:-1] in COMPARED:
        return f"({a} {COMPARED[how[:-1]]} {b} || {a} != {a} || {b} != {b})"
    raise NotKnown(how)


def _computed(parts: list[str], kind: str, given: list[str]) -> str:
    """What an instruction makes of its operands."""
    x = [_value(each, kind) for each in given]
    name = parts[0]
    signs = {"add": "+", "sub": "-", "mul": "*", "div": "/", "and": "&", "or": "|", "xor": "^"}
    if kind == "f64" and name in KINDS:
        made = {"fma": "fma({})".format(", ".join(x)), "rcp": f"1.0 / {x[0]}"}
        made |= {"sqrt": f"sqrt({x[0]})"}
        told = made[name] if name in made else f"{x[0]} {signs[name]} {x[1]}"
        return f"(COUNT({KINDS.index(name)}), {told})"
    if name == "mov":
        return x[0]
    if name == "mul" and parts[1] == "wide":
        return f"(uint64_t)((int64_t){x[0]} * (int64_t){x[1]})"
    if name in signs:
        return f"{x[0]} {signs[name]} {x[1]}"
    if name in ("shl", "shr"):
        return f"{x[0]} {'<<' if name == 'shl' else '>>'} {_value(given[1], 'u32')}"
    if name == "not":
        return f"!{x[0]}" if kind == "pred" else f"~{x[0]}"
    if name in ("neg", "abs") and kind == "f64":
        return f"-{x[0]}" if name == "neg" else f"fabs({x[0]})"
    if name in ("min", "max"):
        if kind == "f64":
            return f"f{name}({x[0]}, {x[1]})"
        return f"{x[0]} {'<' if name == 'min' else '>'} {x[1]} ? {x[0]} : {x[1]}"
    raise NotKnown(".".join(parts))


class Run(NamedTuple):
    """A kernel's PTX, as a function of the processor."""

    library: Any

    def __call__(self, arguments: tuple[Any, ...], threads: int) -> dict[str, int]:
        """Let each thread do it; how often all of them made each operation."""
        params = np.array(flat(arguments), dtype=np.int64)
        counts = np.zeros(len(KINDS), dtype=np.uint64)
        self.library.run(
            ctypes.c_void_p(params.ctypes.data), ctypes.c_uint64(0), ctypes.c_uint64(threads),
            ctypes.c_void_p(counts.ctypes.data),
        )  # fmt: skip
        return {name: int(count) for name, count in zip(KINDS, counts, strict=True)}


def flat(arguments: Any) -> list[int]:
    """Arguments as numba-cuda hands them to a kernel: of an array 5 numbers, its shape, strides."""
    if isinstance(arguments, tuple):
        return [number for each in arguments for number in flat(each)]
    array: NDArray[Any] = arguments
    data = array.ctypes.data
    return [0, 0, array.size, array.itemsize, data, *array.shape, *array.strides]


def compiled_in_c(ptx: str, folder: Path | None = None, *, contract: bool = False) -> Run:
    """Compile a kernel's PTX for this processor."""
    with tempfile.TemporaryDirectory() as own:
        place = folder or Path(own)
        source, library = place / "kernel.c", place / "kernel.so"
        source.write_text(written_in_c(ptx), encoding="utf-8")
        how = [
            "-O2" if contract else "-O1",
            "-march=native",
            f"-ffp-contract={'fast' if contract else 'off'}",
        ]
        command = ["cc", *how, "-w", "-shared", "-fPIC", str(source), "-o", str(library), "-lm"]
        subprocess.run(command, check=True)
        return Run(ctypes.CDLL(str(library)))
