# isocore: `make` lists what there is. PYTHON chooses the interpreter the environment is made from.
PYTHON  ?= python3
VENV    ?= .venv
BIN     := $(VENV)/bin
READY   := $(VENV)/ready
SOURCES := pyproject.toml $(shell find isocore/kernels -type f)

.PHONY: help develop demo meshes test check lint types kernels bench golden samples dist clean
help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

$(READY): $(SOURCES)
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q "scikit-build-core>=0.11" "nanobind>=2.4" "cmake>=3.20" ninja
	$(BIN)/python -m pip install -q --no-build-isolation -e ".[test]"
	touch $@

develop: $(READY)  ## install editable, with everything tests need

demo: $(READY)  ## convert every sample into out/ and show the table
	$(BIN)/isocore convert sample_volumes/knot.nii.gz -i 200 -d out
	$(BIN)/isocore convert sample_volumes -d out --report out/report.json --report out/report.md

meshes: $(READY)  ## SCANS=dir OUT=dir ISO=300 [BACKEND=] [FORMAT=]: only what changed
	@$(MAKE) --no-print-directory -f examples/meshes.mk ISOCORE=$(BIN)/isocore

test: $(READY)  ## run all tests
	$(BIN)/pytest

check: lint types test  ## what a commit must pass

lint: $(READY)  ## format and style
	$(BIN)/ruff check .

types: $(READY)  ## mypy, strict
	$(BIN)/mypy

kernels: $(READY)  ## the kernels' own tests, under sanitizers
	$(BIN)/cmake -S isocore/kernels -B build/kernels -G Ninja -DCMAKE_MAKE_PROGRAM=$(abspath $(BIN))/ninja \
	  -DCMAKE_BUILD_TYPE=Debug -DISOCORE_KERNEL_TESTS=ON -DISOCORE_WERROR=ON >/dev/null
	$(BIN)/ninja -C build/kernels
	build/kernels/kernel_tests

bench: $(READY)  ## time us against the peers, in one process; and the memory
	$(BIN)/python -m pip install -q ".[bench]" --no-build-isolation --no-deps && $(BIN)/python -m pip install -q vtk scikit-image nilearn
	$(BIN)/python tests/bench/run.py && $(BIN)/python tests/bench/measuring.py && $(BIN)/python tests/bench/memory.py

samples: $(READY)  ## make sample_volumes/ again
	$(BIN)/python sample_volumes/make.py
	cd sample_volumes && sha256sum -b *.nii.gz *.nrrd *.raw *.json *.nhdr *.raw.gz *.vtu >SHA256SUMS

golden: $(READY)  ## rewrite the golden counts; the commit says why
	$(BIN)/python tests/golden/counts.py

dist: $(READY)  ## wheel and sdist, with a look inside
	$(BIN)/python -m pip install -q build && $(BIN)/python -m build -q
	$(BIN)/python tests/check_wheel.py dist

clean:  ## remove what was built
	rm -rf build dist out $(VENV) .pytest_cache .mypy_cache .ruff_cache
