# Verbs: demo test check bench schemas. Each sets up what it needs in .venv.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: demo test check bench attack schemas build clean

demo: $(VENV)/.runtime
	@mkdir -p build
	@$(BIN)/prima demo -o build/demo.html
	@echo
	@echo 'To call prima: $(BIN)/prima --help'
	@echo 'or, once in each shell: . $(BIN)/activate; then: prima --help'

test: $(VENV)/.dev
	$(BIN)/python -m pytest -n auto

check: $(VENV)/.dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m prima.reference --check
	$(BIN)/python -m prima.pictures --check

bench: $(VENV)/.bench
	$(BIN)/python -m bench.peers
	$(BIN)/python -m bench.run

attack: $(VENV)/.dev
	$(BIN)/python -m bench.attack

schemas: $(VENV)/.dev
	$(BIN)/python -m prima.reference
	$(BIN)/python -m prima.pictures

build: $(VENV)/.dev
	$(BIN)/python -m build --wheel

clean:
	rm -rf $(VENV) dist build

$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "PRIMA needs Python 3.11 or newer")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.runtime: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	touch $@

$(VENV)/.dev: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev]'
	touch $@ $(VENV)/.runtime

$(VENV)/.bench: $(VENV)/.dev
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev,bench]'
	touch $@
