"""Spike: how compiled kernels should dispatch over surface kinds. Run: python dispatch.py

Every candidate runs the same Newton step of a surface pair; only the call of the jet differs.
The kernels are in dispatch_kernels.py, the result in dispatch.md.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import dispatch_kernels as dk
import numpy as np
from numba import cfunc

STEPS = 1_000_000
ROUNDS = int(os.environ.get("SPIKE_ROUNDS", "9"))

# --- the loops: the pair of each step is read from memory, so no branch can leave the loop -------

HEAD = """import numpy as np
from dispatch_kernels import *


@jit
def loop_{name}({extra}slots, pairs, kinds, offsets, data, table, pose, state, n):
    total = 0.0
    jf, jh = np.empty(18), np.empty(18)
    for k in range(0, n, {times}):
"""
BODY = """        i = slots[(k + {j}) & 1023]
        f, h = pairs[i, 0], pairs[i, 1]
        q = (state[i, 0], state[i, 1], state[i, 2], state[i, 3])
        {first}
        {second}
        q, energy = advance({jf}, {jh}, pose, k + {j}, q)
        state[i, 0], state[i, 1], state[i, 2], state[i, 3] = q
        total += energy
"""
PLACES = ("data, offsets[f], q[0], q[1]", "data, offsets[h], q[2], q[3]")
LONG, HYBRID = "jet_long{c}(kinds[{s}], {p})", "jet_hybrid{c}(kinds[{s}], table, {p})"
CALLS = {  # candidate: (call of the jet of A, of B if another; steps written out in the loop)
    "mono sphere-sphere": ("jet_sphere({p})", None, 1),
    "mono sphere-cylinder": ("jet_sphere({p})", "jet_cylinder({p})", 1),
    "mono sphere-user": ("jet_sphere({p})", "jet_user({p})", 1),
    "a if-chain": ("jet_chain(kinds[{s}], {p})", None, 1),
    "a if-chain, array jets": ("jet_chain_into(kinds[{s}], {p}, {j})", None, 1),
    "b function tuple": ("functions[kinds[{s}]]({p})", None, 1),
    "c addresses, stack": ("jet_at(table[kinds[{s}]], {p})", None, 1),
    "c addresses, array jets": ("jet_at_into(table[kinds[{s}]], {p}, {j})", None, 1),
    "d chain + addresses": (HYBRID.replace("{c}", ""), None, 1),
    "d called, not inlined": (HYBRID.replace("{c}", "_called"), None, 1),
    "d, 10 sites": (HYBRID.replace("{c}", ""), None, 5),
    "d called, 10 sites": (HYBRID.replace("{c}", "_called"), None, 5),
    "a 11 kinds": (LONG.replace("{c}", ""), None, 1),
    "a 11 kinds called": (LONG.replace("{c}", "_called"), None, 1),
    "a 11 kinds called, no owner": (LONG.replace("{c}", "_called"), None, 1),
    "a 11 kinds, 10 sites": (LONG.replace("{c}", ""), None, 5),
    "a 11 kinds called, 10 sites": (LONG.replace("{c}", "_called"), None, 5),
}


def identifier(candidate):
    return "".join(c if c.isalnum() else "_" for c in candidate)


def write_loops(folder):
    """One module per candidate: Numba's disk cache needs a source file."""
    for candidate, (call_a, call_b, times) in CALLS.items():
        lines, arrays = [], "array jets" in candidate
        for call, p, s, j in zip(
            (call_a, call_b or call_a), PLACES, "fh", ("jf", "jh"), strict=True
        ):
            text = call.format(p=p, s=s, j=j)
            lines.append(text if arrays else f"{j} = {text}")
        read = "from_array({})" if arrays else "{}"
        extra = "functions, " if candidate[0] == "b" else ""
        source = HEAD.format(name=identifier(candidate), extra=extra, times=times)
        if not arrays:
            source = source.replace("    jf, jh = np.empty(18), np.empty(18)\n", "")
        if "no owner" in candidate:  # a view of the same memory that has no reference count
            view = "    data = carray(doubles_at(types.int64(data.ctypes.data)), data.size)\n"
            source = source.replace("data, table", "owned, table").replace(
                "    total = 0.0\n", "    total = 0.0\n" + view.replace("data.", "owned.")
            )
        for j in range(times):
            source += BODY.format(
                j=j, first=lines[0], second=lines[1], jf=read.format("jf"), jh=read.format("jh")
            )
        path = folder / f"loop_{identifier(candidate)}.py"
        path.write_text(source + "    return total\n", encoding="utf-8")


def load_loop(candidate):
    name = f"loop_{identifier(candidate)}"
    return getattr(__import__(name), name)


def tables(candidate):
    """(extra arguments, address table, the objects that keep the code alive)."""
    table, keep, extra = np.zeros(4, dtype=np.int64), [], ()
    if candidate[0] == "b":
        extra = (
            tuple(
                cfunc(dk.FIRST_CLASS, cache=True)(f)
                for f in (dk.f_plane, dk.f_sphere, dk.f_cylinder, dk.f_user)
            ),
        )
    wanted = {
        "c": (dk.c_plane, dk.c_sphere, dk.c_cylinder, dk.c_user),
        "d": (None, None, None, dk.c_user),
    }
    for kind, function in enumerate(wanted.get(candidate[0], ())):
        if function is not None:
            keep.append(cfunc(dk.C_JET, cache=True)(function))
            table[kind] = keep[-1].address
    return extra, table, keep


# --- workloads ---

WORKLOADS = {
    "sphere-sphere": [(1, 5)], "sphere-cylinder": [(1, 6)], "sphere-user": [(1, 7)],
    "mixed built-in": [(1, 5), (1, 6), (2, 5), (0, 5), (1, 4), (2, 6)],
}  # fmt: skip


def arguments(candidate, workload, n):
    extra, table, keep = tables(candidate)
    s, pairs = dk.scene(), np.array(WORKLOADS[workload])
    slots = np.random.default_rng(0).integers(0, len(pairs), 1024)
    state = np.zeros((len(pairs), 4))
    call = (slots, pairs, s["kinds"], s["offsets"], s["data"], table, s["pose"], state, n)
    return (*extra, *call), keep


def runs(candidate, workload):
    return not candidate.startswith("mono") or candidate.endswith(workload)


# --- what the child processes measure ------------------------------------------------------------


def child_compile(candidate, workload="sphere-sphere"):
    workload = candidate[5:] if candidate.startswith("mono") else workload
    dk.nothing(1)  # start Numba itself, not counted
    start = time.perf_counter()
    call, _keep = arguments(candidate, workload, 1)
    middle = time.perf_counter()
    loop = load_loop(candidate)
    loop(*call)
    end = time.perf_counter()
    hits = sum(loop.stats.cache_hits.values())
    return {"table": middle - start, "first": end - middle, "hits": hits}


def child_step(*candidates):
    """Interleaved medians of ns a step; the totals must agree among candidates."""
    ready, times, totals = [], {}, {}
    for candidate in candidates or CALLS:
        loop = load_loop(candidate)
        for workload in WORKLOADS:
            if runs(candidate, workload):
                call, keep = arguments(candidate, workload, STEPS)
                loop(*call[:-1], 2048)
                ready.append((candidate, workload, loop, call, keep))
    for _ in range(ROUNDS):
        for candidate, workload, loop, call, _keep in ready:
            call[-2][:] = 0.0
            start = time.perf_counter()
            total = loop(*call)
            times.setdefault(f"{candidate}|{workload}", []).append(time.perf_counter() - start)
            first = totals.setdefault(workload, total)
            assert abs(total - first) <= 1e-9 * abs(first), (candidate, workload, total, first)
    return {k: (statistics.median(v) / STEPS * 1e9, min(v) / STEPS * 1e9) for k, v in times.items()}


USER_SOURCE = """
from numba import cfunc, types
POINTER = types.CPointer(types.float64)
@cfunc(types.void(types.float64, types.float64, POINTER, POINTER), cache=True)
def late(u, v, p, out):
    a, b = p[12], p[13]
    jet = (u, v, -0.5*(a*u*u + b*v*v) - {c}*u*u*v*v, 1.0, 0.0, -a*u - 2*{c}*u*v*v,
           0.0, 1.0, -b*v - 2*{c}*u*u*v, 0.0, 0.0, -a - 2*{c}*v*v, 0.0, 0.0, -4*{c}*u*v,
           0.0, 0.0, -b - 2*{c}*u*u)
    for r in range(6):
        x, y, z = jet[3*r], jet[3*r + 1], jet[3*r + 2]
        for i in range(3):
            out[3*r + i] = p[3*i]*x + p[3*i + 1]*y + p[3*i + 2]*z
    for i in range(3):
        out[i] += p[9 + i]
"""


def child_later(name, coefficient):
    """A function that did not exist when the kernel was cached, in a fresh process."""
    path = Path(os.environ["SPIKE_FOLDER"]) / f"{name}.py"
    if not path.exists():
        path.write_text(USER_SOURCE.format(c=coefficient), encoding="utf-8")
    candidate = "d chain + addresses"
    call, _keep = arguments(candidate, "sphere-user", 2048)
    loop = load_loop(candidate)
    start = time.perf_counter()
    late = __import__(name).late
    middle = time.perf_counter()
    call[5][dk.USER] = late.address
    total = loop(*call)
    end = time.perf_counter()
    hits = sum(loop.stats.cache_hits.values())
    misses = sum(loop.stats.cache_misses.values())
    return {
        "user function, s": middle - start,
        "from cache": late.cache_hits,
        "kernel, s": end - middle,
        "hits": hits,
        "misses": misses,
        "total": total,
    }


def child_call():
    s = dk.scene()
    q, table = np.zeros(5), np.zeros(4, dtype=np.int64)
    floats, ints = np.zeros(4), np.zeros(4, dtype=np.int64)
    model = dk.Model(s["kinds"], s["offsets"], s["data"], table, ints, ints, ints, floats)
    packed = np.concatenate([s["pose"], np.zeros(5), s["data"]])
    four, eight = (s["data"], s["data"].copy(), s["pose"], q), (*model[:6], s["pose"], q)
    calls = {
        "an int, nothing done": (dk.nothing, (1,)),
        "4 arrays, tuple back": (dk.four_return, four), "4 arrays, written": (dk.four_write, four),
        "1 packed array, tuple back": (dk.packed_return, (packed,)),
        "1 packed array, written": (dk.packed_write, (packed,)),
        "8 arrays, written": (dk.eight_write, eight),
        "namedtuple of 8 + 2 arrays, tuple back": (dk.model_return, (model, s["pose"], q)),
        "namedtuple of 8 + 2 arrays, written": (dk.model_write, (model, s["pose"], q)),
        "int address of the packed array, written": (dk.address_write, (packed.ctypes.data,)),
    }  # fmt: skip
    times, number = {}, 100_000
    for function, given in calls.values():
        function(*given)
    for _ in range(ROUNDS):
        for name, (function, given) in calls.items():
            start = time.perf_counter()
            for _ in range(number):
                function(*given)
            times.setdefault(name, []).append(time.perf_counter() - start)
    return {k: statistics.median(v) / number * 1e9 for k, v in times.items()}


# --- the parent ----------------------------------------------------------------------------------


def print_head(first, *columns):
    print(f"\n| {first} |", " | ".join(columns), "|\n|---|" + "---|" * len(columns))


def print_row(first, *cells):
    print(f"| {first} |", " | ".join(cells), "|", flush=True)


def child(folder, cache, what, *given, options=None, **environment):
    """Run child_<what> in a fresh process; its answer and the process's wall time."""
    here = Path(__file__).resolve().parent
    code = (
        "import json, sys, dispatch\n"
        "print(json.dumps(getattr(dispatch, 'child_' + sys.argv[1])(*sys.argv[2:])))"
    )
    env = os.environ | {
        "NUMBA_CACHE_DIR": str(folder / cache), "SPIKE_FOLDER": str(folder),
        "SPIKE_OPTIONS": json.dumps(options or {}), "PYTHONPATH": f"{here}{os.pathsep}{folder}",
    } | environment  # fmt: skip
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", code, what, *given], env=env, text=True, capture_output=True
    )
    wall = time.perf_counter() - start
    if done.returncode:
        raise SystemExit(f"{what} {given} failed:\n{done.stderr}")
    return json.loads(done.stdout.splitlines()[-1]), wall


def report_compile(folder):
    print_head("candidate", "cold: table + kernel, s", "2nd process: table + kernel, s", "hits")
    for candidate in CALLS:
        cache = identifier(candidate)
        cold, _ = child(folder, cache, "compile", candidate)
        warm, _ = child(folder, cache, "compile", candidate)
        first = f"{cold['table']:.2f} + {cold['first']:.2f}"
        second = f"{warm['table']:.3f} + {warm['first']:.3f}"
        print_row(candidate, first, second, f"{cold['hits']}, {warm['hits']}")


def report_step(folder):
    answer, _ = child(folder, "all", "step")
    print_head("ns a step, median (least)", *WORKLOADS)
    for candidate in CALLS:
        cells = (answer.get(f"{candidate}|{w}") for w in WORKLOADS)
        print_row(candidate, *(f"{c[0]:.1f} ({c[1]:.1f})" if c else "" for c in cells))


def report_later(folder):
    print()
    for name, coefficient in (("late_one", "0.05"), ("late_two", "0.07"), ("late_two", "0.07")):
        answer, wall = child(folder, "all", "later", name, coefficient)
        print(f"user function {name}: {answer}, process {wall:.2f} s", flush=True)


def report_call(folder):
    print_head("call from Python", "ns")
    for name, value in child(folder, "all", "call")[0].items():
        print_row(name, f"{value:.0f}")


def report_options(folder):
    choices = {
        "forced inlining": {},
        "no forced inlining": {"forceinline": False},
        "error_model numpy": {"error_model": "numpy"},
        "fastmath": {"fastmath": True},
        "fastmath + numpy": {"fastmath": True, "error_model": "numpy"},
        "boundscheck": {"boundscheck": True},
    }
    candidate, times = "d chain + addresses", {}
    for turn in range(8):  # the first compiles; the processes are interleaved
        for name, options in choices.items():
            rounds = {"SPIKE_ROUNDS": "1"}
            cache = "options " + name
            answer, _ = child(folder, cache, "step", candidate, options=options, **rounds)
            if turn:
                for load in WORKLOADS:
                    times.setdefault((name, load), []).append(answer[f"{candidate}|{load}"][0])
    print_head("(d), ns a step", *WORKLOADS)
    for name in choices:
        print_row(name, *(f"{statistics.median(times[name, w]):.1f}" for w in WORKLOADS))


STALE_LOW = "from numba import njit\n@njit(cache=True)\ndef low(x): return x + {}\n"
STALE_HIGH = """import os
from numba import njit
from stale_low import low
@njit(cache=True, boundscheck=bool(os.environ.get("SPIKE_CHECKED")))
def high(a, i): return low(a[i])
"""


def child_stale():
    from stale_high import high

    answer = {"value": high(np.zeros(2), 0), "index 5 of 2": "read"}
    try:
        high(np.zeros(2), 5)
    except IndexError:
        answer["index 5 of 2"] = "refused"
    return answer | {"hits": sum(high.stats.cache_hits.values())}


def report_stale(folder):
    """Does the disk cache see a change in a callee's file, or in the options of njit?"""
    low = folder / "stale_low.py"
    low.write_text(STALE_LOW.format("1.0"), encoding="utf-8")
    (folder / "stale_high.py").write_text(STALE_HIGH, encoding="utf-8")
    print("\ncallee adds 1:", child(folder, "stale", "stale")[0])
    low.write_text(STALE_LOW.format("100.0"), encoding="utf-8")
    print("callee's file now adds 100:", child(folder, "stale", "stale")[0])
    print("boundscheck on:", child(folder, "stale", "stale", SPIKE_CHECKED="1")[0])
    print("both, empty cache:", child(folder, "fresh", "stale", SPIKE_CHECKED="1")[0])


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_loops(folder)
        for report in (
            report_compile,
            report_step,
            report_later,
            report_call,
            report_options,
            report_stale,
        ):
            report(folder)


if __name__ == "__main__":
    main()
