# Play, test and check Logical Robots. `make help` lists the targets.
# Needs only Python 3.11 or newer with its venv module; everything else goes into $(VENV).

PYTHON ?= python3
VENV ?= .venv
# As many as there are processors, hardly a test of a quick run waits for anything else; one more
# for all tests, of which a fifth of the time is waiting for terminals, servers and killed processes.
WORKERS ?= $(shell echo $$(($$(getconf _NPROCESSORS_ONLN) + $(if $(ALL),1,0))))
BIN := $(VENV)/bin
# A quick run leaves out slow tests and nine tenths of what there are many of; ALL=1 runs everything.
ALL ?=
# CHANGED=1 runs the tests nearest to what differs from main, CHANGED=BRANCH from another branch or commit.
CHANGED ?=
# Whatever the environment says, modules and tests are compiled once and not in each process.
PYTEST = PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal $(if $(ALL),--all)
PIP := $(BIN)/python -m pip --disable-pip-version-check --require-virtualenv

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.SUFFIXES:

.PHONY: help play test lowest lint check format proof prove mutants bench lock screenshot reference learn debugging measures dist clean

help: ## Show this list
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## (.*)/  make \1\t\2/' | expand -t 20

play: $(VENV)/.play ## Play; ARGS="play LEVEL" passes arguments on
	@$(BIN)/python -m logical_robots_tui $(ARGS)

test: $(VENV)/.dev ## Run the tests, a quick choice of them, CHANGED=1 or ALL=1; ARGS="-k wall" passes arguments on
ifdef CHANGED
	files=$$($(BIN)/python -m tests.changed $(patsubst 1,main,$(CHANGED))) && $(PYTEST) --quick $$files $(ARGS)
else
	$(PYTEST) $(ARGS)
endif

# What touches Textual's private parts, and what a terminal shows.
LOWEST = tests/tui/terminal tests/tui/app/test_key_queue.py tests/snapshots

lowest: $(VENV)/.dev ## Run the tests that depend on Textual's version with the lowest one, in VENV; it stays there
	@$(PIP) install --quiet --no-deps \
		textual==$$(sed -n 's/.*"textual>=\([0-9.]*\),.*/\1/p' pyproject.toml)
	$(PYTEST) $(LOWEST) $(ARGS)

lint: $(VENV)/.dev ## Check layout, style, types and which part may use which
	$(BIN)/python -m ruff format --check .
	$(BIN)/python -m ruff check .
	$(BIN)/python -m mypy
	$(BIN)/lint-imports
	@$(BIN)/python -m tests.house.figures

check: lint test ## Everything that must be true before a commit

format: $(VENV)/.dev ## Lay out the code and mend what can be mended
	$(BIN)/python -m ruff format .
	$(BIN)/python -m ruff check --fix .

proof: $(VENV)/.dev ## The long proofs: many starts, load, fuzzing
	$(PYTEST) --all -m "proof or hypothesis" --hypothesis-profile=proof \
		-o faulthandler_timeout=7200 $(ARGS)

prove: $(VENV)/.dev ## Prove the levels from 20 starts each; ARGS="-k 05-lighthouse" only that one
	$(PYTEST) --all -m "proof or not proof" -o faulthandler_timeout=7200 tests/levels/test_proof.py $(ARGS)

mutants: $(VENV)/.dev ## Undo corrections of the past and see which tests notice; ARGS="--all" runs all tests
	$(BIN)/python -m tests.mutants.corrections --workers $(WORKERS) $(ARGS)

bench: $(VENV)/.dev ## Measure; ARGS="--json numbers.json" keeps the numbers
	@$(BIN)/python -m compileall -q logical_robots_tui
	$(BIN)/python -m benchmarks $(ARGS)

screenshot: $(VENV)/.dev ## Draw the README's pictures anew
	$(BIN)/python -m docs.screenshot

reference: $(VENV)/.dev ## Regenerate the tables of functions, fields and settings in docs
	$(BIN)/python -m docs.reference

learn: $(VENV)/.dev ## Regenerate docs/learn.md, docs/solutions.md and their pictures
	$(BIN)/python -m docs.learn

debugging: $(VENV)/.dev ## Regenerate docs/debugging.md and its pictures
	$(BIN)/python -m docs.debugging

measures: $(VENV)/.dev ## Measure the reference programs again; ARGS="LEVEL" for one level
	$(BIN)/python -m benchmarks.reference $(ARGS)

dist: $(VENV)/.dev ## Build wheel and sdist into dist/, and check them on every Python that is found
	rm -rf dist
	$(BIN)/python -m build --no-isolation
	$(BIN)/python -m twine check --strict dist/*
	$(PYTEST) -m "proof or not proof" tests/house/test_wheel.py --built dist $(ARGS)

# uv is needed by authors only: it writes one lock for all systems and Python versions.
LOCK = $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	--no-annotate --no-header --no-emit-index-url --no-emit-find-links \
	--upgrade pyproject.toml requirements/build.in

lock: $(VENV)/.dev ## Choose newer versions of the dependencies
	@test -x $(BIN)/uv || $(PIP) install --quiet uv
	$(LOCK) --output-file requirements/play.lock
	$(LOCK) --group dev --constraint requirements/play.lock --output-file requirements/dev.lock

clean: ## Remove what was built; the next start installs again
	rm -rf $(VENV) .venv-* build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache

# A stamp is newer than everything it was installed from, so the next start begins at once.
$(VENV)/.%: requirements/%.lock pyproject.toml | $(VENV)/.python
	@echo "Installing what '$*' needs into $(VENV) ..."
	@$(PIP) install --quiet --require-hashes --requirement $<
	@$(PIP) install --quiet --no-build-isolation --no-deps --no-index --editable .
	@$(BIN)/python -m compileall -q logical_robots_tui
	@touch $@

$(VENV)/.python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "Logical Robots needs Python 3.11 or newer; '$(PYTHON)' is missing or older." >&2; \
	  echo "Name another one like this: make play PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo "'$(PYTHON)' can't make virtual environments." >&2; \
	  echo "On Debian and Ubuntu: sudo apt install python3-venv" >&2; exit 1; }
	@$(PIP) --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV)
	@touch $@
