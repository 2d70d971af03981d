# Two commands for a fresh machine: `make demo` and `make test`; each does its own set-up.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
UV     := .uv/bin/uv
STAMP  := $(VENV)/.installed

# Where Python is told to write no bytecode, every process compiles torch and lightning anew: 28 s in place of 12.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test lint coverage notebooks docs matrix clean
.DELETE_ON_ERROR:

# uv is a fast installer from the ordinary package registry; it lives in a folder of its own.
$(UV):
	$(PYTHON) -c 'import sys; sys.exit("Python 3.11 or newer is needed (set PYTHON=...)" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv .uv
	.uv/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt uv

$(STAMP): $(UV) pyproject.toml constraints.txt
	$(UV) venv --quiet --allow-existing --python $(PYTHON) $(VENV)
	$(UV) pip install --quiet --python $(BIN)/python --constraint constraints.txt --build-constraint constraints.txt --editable '.[train,sim,dev]'
	touch $@

demo: $(STAMP)
	$(BIN)/horizon-dl demo --out demo --overwrite

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test: lint
	$(BIN)/pytest -q $(if $(ALL),-m "")

# Lines of the rooms that a vehicle depends on, and of the figures.
coverage: $(STAMP)
	$(BIN)/pytest -q -m "not slow" --cov=horizon_dl --cov-report=term:skip-covered

# Runs the notebooks and stores what they show.
notebooks: $(STAMP)
	$(BIN)/python benchmarks/store_notebooks.py

docs: $(STAMP)
	$(BIN)/mkdocs build --strict --site-dir build/site

# The quick tests on every Python that uv finds on this machine.
matrix: $(UV)
	for version in 3.11 3.12 3.13; do \
	  $(UV) python find --no-python-downloads $$version >/dev/null 2>&1 || { echo "no Python $$version here"; continue; }; \
	  $(UV) run --no-python-downloads --python $$version --isolated --extra train --extra sim --extra dev pytest -q -m "not slow" || exit 1; \
	done

clean:
	rm -rf $(VENV) .uv demo
