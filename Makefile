# Two commands do everything, set-up included: `make demo` and `make test`.
# They need python3 (3.11 or newer, with venv), make and bash; no compiler, no graphics library.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
LOCK := requirements/dev.lock
STAMP := $(VENV)/.installed
ROBOCASA_VENV ?= .venv-robocasa
ROBOCASA_LOCK := requirements/robocasa.lock
ROBOCASA_STAMP := $(ROBOCASA_VENV)/.installed

# One thread for small linear algebra (more is slower), and no search for a display.
export OMP_NUM_THREADS := 1
export MUJOCO_GL := disabled

.PHONY: help install ray-packages ray-test robocasa robocasa-packages robocasa-test demo test check format lint types contracts examples demonstrations clean

help:
	@echo "make demo       install everything into $(VENV) and run the quickstart (writes symskill-out/)"
	@echo "make test       install everything, then format check, lint, types, import contracts and all tests"
	@echo "make install    only the installation"
	@echo "make lint       format check and lint;   make format   rewrite;   make types;   make contracts"
	@echo "make robocasa   RoboCasa in $(ROBOCASA_VENV) beside it, and small assets for it;   make robocasa-test   its tests"
	@echo "make ray-test   Ray into $(VENV), and its tests"
	@echo "make examples   make domains/ and problems/ again from the shipped demonstrations"
	@echo "make demonstrations   record the shipped demonstrations again"
	@echo "make clean      remove caches and outputs;   rm -r $(VENV) removes the installation"

install: $(STAMP)

$(STAMP): $(LOCK) pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	    || { echo "symskill needs Python 3.11 or newer; say which with: make PYTHON=python3.12 ..." >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null \
	    || { echo "Python's venv is missing; on Debian and Ubuntu: apt-get install python3-venv" >&2; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -r $(LOCK)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

# RoboCasa needs another robosuite than ours, under the same import name: an environment of its own, and beside it
# assets of primitive shapes (somebody who has RoboCasa's own says where with ROBOCASA_ASSETS_PATH).
robocasa: .robocasa-assets/symskill-assets.txt

robocasa-packages: $(ROBOCASA_STAMP)

.robocasa-assets/symskill-assets.txt: $(ROBOCASA_STAMP) symskill_pddl/robocasa/assets.py symskill_pddl/robocasa/asset_models.py
	$(ROBOCASA_VENV)/bin/python scripts/robocasa_assets.py .robocasa-assets

$(ROBOCASA_STAMP): $(ROBOCASA_LOCK) pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	    || { echo "symskill needs Python 3.11 or newer; say which with: make PYTHON=python3.12 ..." >&2; exit 1; }
	test -x $(ROBOCASA_VENV)/bin/python || $(PYTHON) -m venv $(ROBOCASA_VENV)
	$(ROBOCASA_VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps -r $(ROBOCASA_LOCK)
	$(ROBOCASA_VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

robocasa-test: robocasa
	$(ROBOCASA_VENV)/bin/python -m pytest tests/robocasa tests/demos/test_lerobot.py

ray-packages: install
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -r requirements/ray.lock

ray-test: ray-packages
	$(BIN)/python -m pytest tests/evaluation/test_spread.py

demo: install
	$(BIN)/symskill quickstart

test: lint types contracts
	$(BIN)/python -m pytest -n 2 --dist worksteal

lint: install
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

types: install
	$(BIN)/mypy

contracts: install
	$(BIN)/lint-imports

format: install
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

examples: install
	scripts/make_examples.sh

# The shipped demonstrations: ten of each atomic task, and one of play; the same files again.
TASKS := OpenSingleDoor CloseSingleDoor PnPCabToCounter PnPCounterToCab PnPStoveToCounter PnPCounterToStove OpenDrawer CloseDrawer \
    TurnOnStove TurnOffStove TurnOnSinkFaucet TurnOffSinkFaucet
demonstrations: install
	mkdir -p symskill_pddl/data/kitchen
	for task in $(TASKS); do $(BIN)/symskill record $$task -n 10 --seed 0 --force -o symskill_pddl/data/kitchen/$$task.hdf5; done
	mkdir -p symskill_pddl/data/play
	$(BIN)/symskill record Play -n 1 --seed 0 --force -o symskill_pddl/data/play/Play.hdf5

clean:
	rm -rf symskill-out .mypy_cache .ruff_cache .pytest_cache .import_linter_cache build ./*.egg-info
	find symskill_pddl tests -name __pycache__ -type d -prune -exec rm -rf {} +
