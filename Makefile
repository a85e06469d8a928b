# Each target sets up what it needs, from nothing but python3 ≥ 3.11.
PYTHON ?= python3
export PIP_DISABLE_PIP_VERSION_CHECK := 1
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
export PATH := $(CURDIR)/$(BIN):$(PATH)

.PHONY: setup demo test lint docs bench evidence lock clean

setup: $(READY)

$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "railgate needs Python 3.11 or later, not $$($(PYTHON) --version 2>&1)"; exit 2; }
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || \
		{ echo "railgate needs Python's venv (Debian: apt-get install python3-venv)"; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --require-hashes --requirement requirements.lock
	$(BIN)/pip install --quiet --no-deps --no-build-isolation --editable .
	@test -n "$$CXX" || command -v c++ >/dev/null || \
		{ echo "no c++ here: installing one from PyPI"; $(BIN)/pip install --quiet ziglang==0.17.1; }
	$(BIN)/railgate doctor
	@touch $@

demo: setup
	@sh tools/demo.sh

test: setup
	@sh tools/judges.sh
	$(BIN)/pytest --numprocesses 2 -m "not slow"

lint: setup
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

# The documentation; a warning is an error. Its figures come from the code as it is, so always anew.
docs: setup
	$(BIN)/sphinx-build -qnWE --keep-going -j auto -d build/doctrees docs build/docs

bench: setup
	$(BIN)/python -m bench

# All evidence: the tests, long random comparisons that `test` leaves out, and all proofs; it fails
# where a requirement is not shown by them.
evidence: test
	$(BIN)/railgate fpga report
	$(BIN)/pytest --numprocesses 2 -m slow
	$(BIN)/railgate prove --mutants
	$(BIN)/railgate evidence --strict

lock: setup
	$(BIN)/pip install --quiet uv==0.13.9
	$(BIN)/uv pip compile --quiet --universal --generate-hashes --no-annotate --no-header \
		--extra cxxrtl --extra prove --extra registers --extra fpga --group dev --group bench pyproject.toml --output-file requirements.lock

clean:
	rm -rf $(VENV) build
