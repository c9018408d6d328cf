"""Rigid bodies that touch: their equations of motion and one step of them, compiled."""
