"""Frames of a device's service, broken in every way that a cable, a service or a bug may."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np

Frames = list[str | bytes | float]


def _with(text: str, change: Callable[[dict[str, Any]], None]) -> str:
    told = json.loads(text)
    change(told["inverse3"][0])
    return json.dumps(told)


def _position(value: Any) -> Callable[[dict[str, Any]], None]:
    return lambda one: one["state"].__setitem__("cursor_position", value)


def kinds(late: float) -> dict[str, Callable[[str, np.random.Generator], Frames]]:
    """By name, from a good frame to bad ones; `late` is a time beyond the greatest age [s]."""
    vector = {"x": 0.0, "y": 0.0, "z": 0.15}
    return {
        "truncated": lambda text, rng: [text[: int(rng.integers(0, len(text) - 1))]],
        "flipped": lambda text, rng: [_flipped(text, rng)],
        "doubled": lambda text, rng: [text, text],
        "late": lambda text, rng: [late, text],
        "empty": lambda text, rng: [""],
        "binary": lambda text, rng: [bytes(rng.integers(0, 256, 40, dtype=np.uint8))],
        "deep": lambda text, rng: ["[" * 30_000],
        "other device": lambda text, rng: [_with(text, lambda one: one.update(device_id="0BAD"))],
        "no device": lambda text, rng: ['{"inverse3": []}'],
        "no state": lambda text, rng: [_with(text, lambda one: one.pop("state"))],
        "not ready": lambda text, rng: [_with(text, lambda one: one["status"].update(ready=False))],
        "text": lambda text, rng: [_with(text, _position(vector | {"x": "0.1"}))],
        "truth": lambda text, rng: [_with(text, _position(vector | {"y": True}))],
        "list": lambda text, rng: [_with(text, _position([0.0, 0.0, 0.15]))],
        "nan": lambda text, rng: [_with(text, _position(vector | {"z": float("nan")}))],
        "infinite": lambda text, rng: [text.replace('"z": 0.15', '"z": 1e999')],
        "huge": lambda text, rng: [text.replace('"z": 0.15', '"z": 1' + 400 * "0")],
        "far": lambda text, rng: [_with(text, _position(vector | {"x": 3.0}))],
        "leap": lambda text, rng: [_with(text, _position(vector | {"x": 0.9}))],
        "fast": lambda text, rng: [
            _with(text, lambda one: one["state"].update(cursor_velocity=vector | {"x": 500.0}))
        ],
    }


def _flipped(text: str, rng: np.random.Generator) -> bytes:
    """A byte that is no text any more."""
    raw = bytearray(text.encode())
    raw[int(rng.integers(0, len(raw)))] = 0xFF
    return bytes(raw)
