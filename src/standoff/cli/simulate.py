"""``standoff simulate``: bodies that move and touch, their summary and their files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from standoff.cli.arguments import SimulateCommand
from standoff.cli.errors import ExitCode
from standoff.cli.facts import json_text, simulation_facts
from standoff.cli.output import Writer, check_results, kind_of_picture, write_whole
from standoff.cli.progress import progress_bar
from standoff.cli.summary import line
from standoff.cli.terminal import tell
from standoff.scene.simulation import SimulationScene, load_simulation
from standoff.simulation.coupler_run import CouplerRun
from standoff.simulation.device import Fault
from standoff.simulation.rigid_body import FREE
from standoff.simulation.system_run import SystemRun
from standoff.simulation.units import Units
from standoff.wording import counted


def run_simulate(command: SimulateCommand) -> int:
    """Simulate, write the files asked for, and print the summary.

    Raises SceneError, CommandError if the scene, an option or an output file is not usable, or the
    motion left all bounds. Raises WriteError if the files could not be written after all.
    """
    given = {name: getattr(command, name) for name in ("step", "duration", "method", "tracker")}
    scene = load_simulation(command.scene, given)
    check_results(
        command.output, "standoff.simulation.file", command.plot, "standoff.simulation.plot"
    )
    with progress_bar("simulating") as progress:
        run = scene.run(progress)
    facts = _facts(scene, run)
    files = _files(command, scene, run, facts)
    write_whole(files)
    if command.json:
        tell(json_text(facts | {"files": [str(path) for path in files]}))
    else:
        tell("\n".join(_lines(scene, run, list(files))))
    return ExitCode.DONE if run.uncertified == 0 else ExitCode.NOT_CERTIFIED


def _files(
    command: SimulateCommand, scene: SimulationScene, run: SystemRun, facts: dict[str, Any]
) -> dict[Path, Writer]:
    files: dict[Path, Writer] = {}
    if command.output is not None:
        from standoff.simulation.file import write_run

        files[command.output] = lambda file: write_run(run, scene.names, facts, file)
    if command.plot is not None:
        from standoff.simulation.plot import write_plot

        ending = kind_of_picture(command.plot)
        files[command.plot] = lambda file: write_plot(
            run, scene.names, scene.title, scene.length_unit, (file, ending)
        )
    return files


def _facts(scene: SimulationScene, run: SystemRun) -> dict[str, Any]:
    """The summary as plain data."""
    operator, energy = scene.operator, run.energy
    return simulation_facts(scene) | {
        "method": operator.method,
        "tracker": operator.tracker,
        "step": operator.dt,
        "ticks": scene.ticks,
        "records": len(run.times),
        "start": float(run.times[0]),
        "end": float(run.times[-1]),
        "bodies": {name: _body_facts(run, k) for k, name in enumerate(scene.names)},
        "pairs": {
            scene.pair_name(k): {
                "closest": float(run.distances[:, k].min()),
                "greatest_force": float(np.linalg.norm(run.forces[:, k], axis=1).max()),
                "distance": float(run.distances[-1, k]),
            }
            for k in range(len(run.system.pairs))
        },
        "energy": {
            name: [float(value[0]), float(value[-1])] for name, value in energy._asdict().items()
        },
        "coupler": None if run.coupler is None else _coupler_facts(scene, run.coupler),
        "balance_drift": float(np.abs(energy.balance - energy.balance[0]).max()),
        "deepest": run.deepest,
        "uncertified": run.uncertified,
        "ended_deep": run.jumps,
        "eased": run.eased,
        "crossings": {scene.pair_name(k): [time, n] for k, time, n in run.crossings},
    }


def _coupler_facts(scene: SimulationScene, found: CouplerRun) -> dict[str, Any]:
    tool = scene.system.tool
    return {
        "tool": None if tool is None else scene.names[tool],
        "engaged": bool(found.engaged[-1]),
        "fault": Fault(int(found.fault[-1])).name,
        "greatest_force": float(np.linalg.norm(found.on_device[:, :3], axis=1).max()),
        "greatest_torque": float(np.linalg.norm(found.on_device[:, 3:], axis=1).max()),
        "device_work": float(found.energy.device[-1]),
        "tool_work": float(found.energy.tool[-1]),
        "least_observed": float(found.energy.least[-1]),
        "stored": float(found.stored[-1]),
        "damped": float(found.damped[-1]),
        "counts": found.counts._asdict(),
    }


def _body_facts(run: SystemRun, number: int) -> dict[str, Any]:
    body = run.system.bodies[number]
    mass = body.mass_properties
    return {
        "kind": body.kind,
        "mass": None if mass is None else mass.mass,
        "position": run.positions(number)[-1].tolist(),
        "velocity": run.velocities(number)[-1].tolist(),
        "angular_velocity": run.angular_velocities(number)[-1].tolist(),
    }


def _lines(scene: SimulationScene, run: SystemRun, written: list[Path]) -> list[str]:
    operator, unit = scene.operator, Units.of(scene.length_unit)
    end, records = run.times[-1] + 0.0, counted(len(run.times), "record")
    lines = [
        line("scene", scene.title),
        line("operator", f"{operator.method}, tracker {operator.tracker}, step {operator.dt:g} s"),
        line("ticks", f"{scene.ticks} to {end:g} s, {records}"),
    ]
    for number, name in enumerate(scene.names):
        if run.system.bodies[number].kind == FREE:
            x, v = run.positions(number)[-1], run.velocities(number)[-1]
            speed = f"speed {np.linalg.norm(v):.6g} {unit.length}/s"
            lines.append(line(name, f"at {_vector(x)} {unit.length}, {speed}"))
    for number in range(len(run.system.pairs)):
        force = np.linalg.norm(run.forces[:, number], axis=1).max()
        closest = run.distances[:, number].min() + 0.0
        told = f"closest {closest:.6g} {unit.length}, greatest force {force:.6g} {unit.force}"
        lines.append(line(scene.pair_name(number), told))
    if run.coupler is not None:
        lines += _coupler_lines(_coupler_facts(scene, run.coupler), unit)
    lines += _energy_lines(run, unit)
    lines.append(line("deepest", f"{run.deepest + 0.0:.6g} {unit.length}"))
    lines += _certified_lines(run)
    lines += [
        line("crossed?", f"{scene.pair_name(k)} in {counted(n, 'tick')}, first at {time:g} s")
        for k, time, n in run.crossings
    ]
    return [*lines, *(line("wrote", str(path)) for path in written)]


def _energy_lines(run: SystemRun, unit: Units) -> list[str]:
    energy = run.energy
    names = ["kinetic", "stored", "dissipated", "supplied"]
    names += ["shared"] if energy.shared.any() else []
    told = ", ".join(
        f"{name} {getattr(energy, name)[-1] + 0.0:.6g} {unit.energy}" for name in names
    )
    drift = np.abs(energy.balance - energy.balance[0]).max()
    return [line("energy", told), line("", f"its balance drifted by {drift:.3g} {unit.energy}")]


def _certified_lines(run: SystemRun) -> list[str]:
    """Of pairs of solids no distance is, but whether all places were looked for."""
    solid = sum(run.system.of_solids)
    missed = run.uncertified - sum(each.ticks for each in run.crossings)
    but = "" if missed == 0 else f" but {missed}"
    if not solid:
        return [line("certified", f"all distances{but}")]
    ended = counted(run.jumps, "place")
    lines = [line("solids", f"all places looked for{but}; {ended} ended deep")]
    if solid < len(run.system.pairs):
        lines.insert(0, line("certified", f"all distances of convex pairs{but}"))
    return lines


def _coupler_lines(facts: dict[str, Any], unit: Units) -> list[str]:
    ended = "engaged" if facts["engaged"] else f"let go: {facts['fault']}"
    force = f"greatest force {facts['greatest_force']:.6g} {unit.force}"
    torque = f"torque {facts['greatest_torque']:.6g} {unit.torque}"
    hand, tool, damper = (
        f"{facts[name]:.6g} {unit.energy}" for name in ("device_work", "tool_work", "damped")
    )
    return [
        line("coupler", f"{force}, {torque}, {ended}"),
        line("", f"the hand gave {hand}, the tool {tool}; its damper took {damper}"),
    ]


def _vector(x: Any) -> str:
    return "(" + ", ".join(f"{value + 0.0:.6g}" for value in x) + ")"
