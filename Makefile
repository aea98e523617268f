# Verbs: demo test test-live check explore mutants bench schemas build lock. Each sets up what it needs in .venv, from the
# versions and hashes of release/*.txt.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check
UV := $(BIN)/uv pip install --quiet --python $(BIN)/python
LOCK := $(BIN)/uv pip compile --universal --generate-hashes --upgrade --quiet \
  --custom-compile-command "make lock"
# Tests wait for half of their time: for processes, for real time in live runs.
WORKERS ?= $(shell expr 2 \* $$(getconf _NPROCESSORS_ONLN))
# Without those for robots (naoqi, rosbridge), which tests/parties installs.
EXTRAS := dev experiments cluster export editor bench reachy

# Tests start hundreds of processes; each would compile PRIMA anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test test-live check explore mutants bench attack schemas build lock clean

demo: $(VENV)/.runtime
	@mkdir -p build
	@$(BIN)/prima demo -o build/demo.html
	@echo
	@echo 'To call prima: $(BIN)/prima --help'
	@echo 'or, once in each shell: . $(BIN)/activate; then: prima --help'

test: $(VENV)/.dev
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal

# Drivers against the second parties of tests/parties, and the oldest libraries, each in an environment of its own. More
# workers would be hardly faster, and on a slow machine the parties answer too late.
test-live: $(VENV)/.dev
	$(BIN)/python -m tools.environments
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile tests/parties

check: $(VENV)/.dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m tools.reference --check
	$(BIN)/python -m tools.pictures --check
	$(BIN)/python -m release.licences --check

# Every timing of every scenario that comes with PRIMA; tests do it for the quick ones.
explore: $(VENV)/.dev
	@mkdir -p build
	@for one in $$(find documents/scenarios -name '*.xml' | sort); do \
	  echo "$$one"; $(BIN)/prima explore "$$one" >build/explored.txt || { cat build/explored.txt; exit 1; }; \
	  tail -n 1 build/explored.txt; \
	done

# Each small change to the scheduler, or to FILE=rules.py of it, must make a test fail.
mutants: $(VENV)/.dev
	$(BIN)/python -m tools.mutants $(FILE)

bench: $(VENV)/.dev
	$(BIN)/python -m bench.peers
	$(BIN)/python -m bench.run

attack: $(VENV)/.dev
	$(BIN)/python -m bench.attack

schemas: $(VENV)/.dev
	$(BIN)/python -m tools.reference
	$(BIN)/python -m tools.pictures

build: $(VENV)/.dev
	$(BIN)/python -m build --wheel --no-isolation
	$(BIN)/python -m release.sbom dist

lock: $(VENV)/.dev
	$(LOCK) pyproject.toml -o release/runtime.txt
	$(LOCK) pyproject.toml $(EXTRAS:%=--extra %) -c release/runtime.txt -o release/dev.txt
	echo uv | $(LOCK) - -c release/dev.txt -o release/uv.txt
	$(UV) --require-hashes -r release/dev.txt
	$(BIN)/python -m release.licences

clean:
	rm -rf $(VENV) .environments dist build

$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "PRIMA needs Python 3.11 or newer")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.runtime: pyproject.toml release/runtime.txt | $(BIN)/python
	$(PIP) --require-hashes -r release/runtime.txt
	$(PIP) --no-deps -e .
	touch $@

$(BIN)/uv: release/uv.txt | $(BIN)/python
	$(PIP) --require-hashes -r release/uv.txt
	touch $@

# uv installs in a third of pip's time.
$(VENV)/.dev: pyproject.toml release/dev.txt $(BIN)/uv
	$(UV) --require-hashes -r release/dev.txt
	$(UV) --no-deps --no-build-isolation -e .
	touch $@ $(VENV)/.runtime
