# make report   set up .venv if needed and write the verification report of the default gear pair to report/
# make test     set up .venv if needed and run the tests
# make lint     ruff and mypy --strict
# make reproduce   compute figures, claims and errata of the published model again, in build/reproductions/
# make evidence   compute the evidence about the program again (two minutes) and store it in validation/evidence.json
# make answers  predict 1,000 drawn pairs again: each has a prediction or a stated reason (some minutes)
# make mutants  change 60 drawn lines one by one, the nearest tests judge each (an hour); a second start goes on
# make dist     build sdist and wheel into dist/, check them, try the wheel on every Python 3.11 or later found here
# make lowest   try the oldest releases that pyproject.toml allows with a quick report (four minutes of processor time)
# make docs     set up .venv if needed and build the documentation to build/docs; warnings are errors
# make licences list the licences of spurcheck and of all that it needs to run, as their metadata state them
# make audit    look for published vulnerabilities of all that it needs to run; asks the advisory database of the Python index
# PYTHON=python3.12 chooses the interpreter, VENV=path another environment.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
OUT ?= report
LOWEST ?= build/lowest
# The matrices are small: threads inside BLAS only wait for each other.
export OPENBLAS_NUM_THREADS ?= 1
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check

.PHONY: report reproduce evidence answers mutants test lint docs dist lowest licences audit clean

report: $(VENV)/.ready
	$(BIN)/spurcheck report --output $(OUT) --force
	@echo "Open $(OUT)/index.html"

reproduce: $(VENV)/.ready
	$(BIN)/python -m reproductions.he_cho_singh_2008 build/reproductions/he_cho_singh_2008
	$(BIN)/python -m reproductions.vaishya_singh_2001 build/reproductions/vaishya_singh_2001

evidence: $(VENV)/.ready-test
	$(BIN)/python -m tests.evidence

answers: $(VENV)/.ready-test
	$(BIN)/python -m tests.evidence.drawn_pairs --output docs/verification/answers.json

mutants: $(VENV)/.ready-test
	$(BIN)/python -m tests.evidence.mutants --output docs/verification/mutants.json

test: $(VENV)/.ready-test
	$(BIN)/python -m pytest -n 2

lint: $(VENV)/.ready-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(VENV)/.ready-docs
	MPLBACKEND=Agg $(BIN)/python -m sphinx -W --keep-going -q -b html docs build/docs
	@echo "Open build/docs/index.html"

$(VENV)/.ready: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "spurcheck needs Python 3.11 or later: make PYTHON=python3.12 ...")'
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "Installing spurcheck and its dependencies into $(VENV) ..."
	@$(PIP) --editable .
	@$(BIN)/python -m compileall -q lumped multibody floquet validation spurcheck.py
	@touch $@

$(VENV)/.ready-test: $(VENV)/.ready
	@$(PIP) --editable ".[test]"
	@touch $@

$(VENV)/.ready-dev: $(VENV)/.ready-test
	@$(PIP) --editable ".[dev]"
	@touch $@

$(VENV)/.ready-docs: $(VENV)/.ready
	@$(PIP) --editable ".[docs]"
	@touch $@

dist:
	.ci/dist

licences: $(VENV)/.ready
	@$(BIN)/python .ci/licences.py

audit: $(VENV)/.ready
	@$(PYTHON) -m venv --clear build/audit
	@build/audit/bin/python -m pip install --quiet --disable-pip-version-check pip-audit
	@$(BIN)/python -m pip freeze --exclude-editable --disable-pip-version-check > build/audit/requirements.txt && \
	build/audit/bin/pip-audit --strict --no-deps --disable-pip --requirement build/audit/requirements.txt

lowest:
	@$(PYTHON) -m venv --clear $(LOWEST)
	@$(LOWEST)/bin/python -m pip install --quiet --disable-pip-version-check uv
	@$(LOWEST)/bin/uv pip install --quiet --python $(LOWEST)/bin/python --resolution lowest-direct .
	MPLBACKEND=Agg $(LOWEST)/bin/spurcheck report --quick --output $(LOWEST)/report --force

clean:
	rm -rf .venv build dist docs/_generated docs/gallery *.egg-info .pytest_cache .mypy_cache .ruff_cache
