# Needs only Python 3.11 or newer (with pip and venv), make and git.
PYTHON ?= python3
BIN := .venv/bin
# A stamp names what was installed; it is renewed when what a package declares changes.
ALL := .venv/.installed-all
CLI := .venv/.installed-cli
PIP := $(BIN)/python -m pip --disable-pip-version-check
DECLARED := pyproject.toml studies/pyproject.toml constraints.txt
# The tests start many interpreters: each would compile every module anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: venv torch gpu demo paper bench wheel numba-range check test soak lint types layers docs clean

venv: $(ALL)

$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit(None if (3, 11) <= sys.version_info < (3, 15) else "Standoff needs Python 3.11 to 3.14; this is " + sys.version.split()[0] + ". Name another: make PYTHON=python3.12 ...")'
	@echo "Making a virtual environment in .venv ..."
	$(PYTHON) -m venv .venv

$(ALL): $(DECLARED) | $(BIN)/python
	@echo "Installing Standoff, all its extras and the tools into .venv: once, some minutes ..."
	$(PIP) install -q -c constraints.txt \
		-e ".[cli,test,dev,docs,pandas,jax,casadi,devices,view,rerun,video,mujoco,pinocchio]" -e "./studies[peers]"
	@touch $(ALL) $(CLI)

$(CLI): $(DECLARED) | $(BIN)/python
	@echo "Installing Standoff, its studies and what they need into .venv: once, about a minute ..."
	$(PIP) install -q -c constraints.txt -e ".[cli]" -e ./studies
	@touch $(CLI)

# Not in `venv`: from PyPI it comes with gigabytes of CUDA. Without it its tests are skipped.
torch: $(ALL)
	$(PIP) install -q -c constraints.txt -e ".[torch]"

# Not in `venv` either: half a gigabyte of compilers for GPUs. Without it its tests are skipped.
gpu: $(ALL)
	$(PIP) install -q -c constraints.txt -e ".[gpu]"

demo: $(CLI)
	@mkdir -p build
	$(BIN)/standoff track examples/demo.toml -o build/demo.parquet --plot build/demo.png

paper: $(CLI)
	$(BIN)/standoff paper all -o build/paper

# Times and errors beside other packages: up to ten minutes on a quiet machine (docs/benchmarks.md).
bench: $(ALL)
	$(BIN)/python -m benchmarks.bench -o build/bench

# Two wheels: the library's, with compiled kernels for this Python, platform and Numba
# (docs/wheels.md), and that of the studies.
wheel: $(CLI)
	rm -rf build/compiled
	$(BIN)/python -m standoff.kernels.entries.shipping build/compiled
	STANDOFF_COMPILED="$(CURDIR)/build/compiled" $(PIP) wheel -q --no-deps -w dist .
	$(PIP) wheel -q --no-deps -w dist ./studies

# The ends of the range of Numba versions, in new environments: some half an hour each.
numba-range: $(BIN)/python
	$(BIN)/python -m benchmarks.numba_range

# What an edit is tried with: a minute or two once the kernels are compiled (tests/tiers.py).
check: lint types layers
	$(BIN)/standoff warmup
	$(BIN)/python -m pytest -n auto --dist loadfile -m "not slow"

test: $(ALL)
	$(BIN)/standoff warmup
	$(BIN)/python -m pytest -n auto --dist loadfile

# More of the same than `make test` tries (CONTRIBUTING.md).
soak: $(ALL)
	$(BIN)/standoff warmup
	$(BIN)/python -m pytest -n auto --dist loadfile -m soak

lint: $(ALL)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(ALL)
	$(BIN)/mypy

layers: $(ALL)
	$(BIN)/lint-imports --no-logo

docs: $(ALL)
	$(BIN)/sphinx-build -q -j auto -W --keep-going -b html docs build/docs

clean:
	rm -rf build dist .pytest_cache .hypothesis .mypy_cache .ruff_cache .import_linter_cache
	find src studies tests -name __pycache__ -type d -prune -exec rm -rf {} +
