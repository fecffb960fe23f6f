# isocore: `make` lists what there is. PYTHON chooses the interpreter the environment is made from.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin

.PHONY: help develop
help:  ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

develop: $(BIN)/python  ## install editable, with everything tests need
	$(BIN)/python -m pip install -q "scikit-build-core>=0.11" "nanobind>=2.4" ninja cmake
	$(BIN)/python -m pip install -q --no-build-isolation -e ".[test]"
