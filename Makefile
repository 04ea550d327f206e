# Needs git, python3 >= 3.11, pip and make; everything else goes into .venv.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
PYTEST := $(BIN)/python -m pytest -n auto --maxprocesses 8 --dist loadgroup --max-worker-restart 0

# Each process would compile the sources anew: tests start many.
unexport PYTHONDONTWRITEBYTECODE

# The first use of a loop compiles it; done once here, for every process after.
COMPILE = $(BIN)/python -W ignore -c "from asperity.app.runs.loops import compile_loops as c; c(lambda text: print(text, '...'))"

.PHONY: help run test test-all check format docs packages lock release bench clean

help:  ## List the targets
	@grep -E '^[a-z-]+:.*##' Makefile | sed -E 's/:[^#]*## /\t/' | expand -t 12

run: $(VENV)/.run  ## Age a rough contact over nine decades and draw it
	$(BIN)/asperity run --out results/demo --overwrite
	@echo "Look at results/demo/aging.png. Next: source $(BIN)/activate, then asperity predict as in README.md, or docs/start.md"

test: $(VENV)/.dev  ## Run the test suite
	$(PYTEST)

test-all: $(VENV)/.dev  ## Run what `make test` leaves out: long physics, browser, gallery, research, more random draws
	HYPOTHESIS_PROFILE=$${HYPOTHESIS_PROFILE:-more} $(PYTEST) tests research/tests -m "slow or random" -o timeout=1800 -o faulthandler_timeout=2400

check: $(VENV)/.dev  ## Lint, format and types
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

format: $(VENV)/.dev  ## Format the source
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

docs: $(VENV)/.dev  ## Build the documentation: docs/_build/html/index.html
	$(BIN)/python -m sphinx -W --keep-going -b html docs docs/_build/html

packages: $(VENV)/.dev  ## Build wheel and source distribution, try them in empty environments: STEPS="3.13 oldest"
	$(BIN)/python .ci/packages.py $(STEPS)

lock: $(VENV)/.dev  ## Renew the lock file of the development environment
	$(BIN)/python -m uv pip compile --quiet --universal --upgrade --generate-hashes --no-annotate --no-header \
	  --python-version 3.11 --extra dev --output-file requirements-dev.lock pyproject.toml

release: $(VENV)/.dev  ## Check everything, build, and print the commands that publish
	$(BIN)/python .ci/release.py ready
	CURVES=500 $(MAKE) check test test-all docs packages
	$(BIN)/python .ci/release.py upload

bench: $(VENV)/.run  ## Time Asperity beside its peers: BENCH="--all" for every case
	$(BIN)/python benchmarks/bench.py $(BENCH)

clean:  ## Remove the environment and what was computed
	rm -rf $(VENV) .boot results dist docs/_build docs/auto_gallery docs/reference .coverage .pytest_cache .mypy_cache .ruff_cache .hypothesis

# Some systems ship Python without venv; virtualenv then makes the environment.
$(BIN)/python:
	@command -v $(PYTHON) >/dev/null || { echo "$(PYTHON): not found; try: make PYTHON=python3.12 ..."; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Asperity needs Python 3.11 or newer; try: make PYTHON=python3.12 ..."; exit 1; }
	@echo "Making $(VENV) ..."
	@$(PYTHON) -m venv $(VENV) >/dev/null 2>&1 || { \
	  rm -rf $(VENV); \
	  $(PYTHON) -m pip install --quiet --target .boot virtualenv && \
	  PYTHONPATH=.boot $(PYTHON) -m virtualenv --quiet $(VENV); }

$(VENV)/.run: pyproject.toml research/pyproject.toml | $(BIN)/python
	@echo "Installing Asperity ..."
	@$(PIP) install --editable '.[campaign,explore,inference]' --editable ./research
	@$(COMPILE)
	@touch $@

$(VENV)/.dev: pyproject.toml research/pyproject.toml | $(BIN)/python
	@echo "Installing Asperity and its tools ..."
	@$(if $(LOCKED),$(PIP) install --require-hashes --requirement requirements-dev.lock)
	@$(PIP) install $(if $(LOCKED),--no-deps) --editable '.[dev]' --editable ./research
	@$(COMPILE)
	@touch $@ $(VENV)/.run
