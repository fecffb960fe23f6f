# isocore: `make` lists what there is. PYTHON chooses the interpreter that the environment is made from; ISOCORE_ISA=all
# builds the kernels for every processor of this kind, as wheels have them, instead of for this one alone.
PYTHON  ?= python3
VENV    ?= .venv
BIN     := $(VENV)/bin
PIP     := $(BIN)/python -m pip install --no-build-isolation
SOURCES := pyproject.toml $(shell find isocore/kernels -type f)
ISOCORE_ISA ?= native
export ISOCORE_ISA

# Three steps, each done once: what building needs, isocore with what it needs, what its tests need.
TOOLS   := $(VENV)/tools
BUILT   := $(VENV)/built-$(ISOCORE_ISA)
READY   := $(VENV)/ready-$(ISOCORE_ISA)
CMAKE   := $(BIN)/cmake -S isocore/kernels -G Ninja -DCMAKE_MAKE_PROGRAM=$(abspath $(BIN))/ninja
SHELL   := bash
.SHELLFLAGS := -o pipefail -c

.PHONY: help develop demo meshes test check lint types kernels bench fuzz golden samples dist clean
help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

$(TOOLS):
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(PIP) -q "scikit-build-core>=0.11" "nanobind>=2.4" "click>=8.1" "cmake>=3.20" ninja
	touch $@

$(BUILT): $(SOURCES) | $(TOOLS)
	@mkdir -p build && rm -f $(VENV)/built-* $(VENV)/ready-*
	@echo "Building isocore for instruction set $(ISOCORE_ISA); everything that pip says is in build/log"
	@$(PIP) -v -e . 2>&1 | tee build/log | sed -unE "$(NINJA)" || { tail -n 40 build/log; exit 1; }
	touch $@

# Of all that pip passes on: ninja's lines, "[done/all] what", and the compiler's errors.
NINJA := s/^ *(\[[0-9]+\/[0-9]+\]) [A-Z][a-z]+ .* (CMakeFiles\/)?([^ \/]+)(\.dir.*\/([^\/ ]+)\.(o|gch|obj))$$/\1 \3: \5/; s/^ *\[/[/p; /error: /p

# isocore itself is installed already: asking pip for ".[test]" would build it once more.
$(READY): $(BUILT)
	$(BIN)/python -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]["test"], sep="\n")' >build/test-needs
	$(PIP) -q -r build/test-needs
	touch $@

develop: $(READY)  ## install editable, with everything that tests need

demo: $(BUILT)  ## convert every sample into out/ and show the table
	$(BIN)/isocore convert sample_volumes/knot.nii.gz -i 200 -d out
	$(BIN)/isocore convert sample_volumes -d out --report out/report.json --report out/report.md

meshes: $(BUILT)  ## SCANS=dir OUT=dir ISO=300 [BACKEND=] [FORMAT=] [OPTIONS=]: only what changed
	@$(MAKE) --no-print-directory -f examples/meshes.mk ISOCORE=$(BIN)/isocore

test: $(READY)  ## run all tests
	$(BIN)/pytest -n auto --dist worksteal

check: lint types test  ## what a commit must pass

lint: $(READY)  ## format and style, of Python and of C++
	$(BIN)/ruff check .
	find isocore/kernels tests/kernels -name '*.[ch]pp' | xargs $(BIN)/clang-format --dry-run -Werror
	$(CMAKE) -B build/lint -DISOCORE_ISA=base -DPython_EXECUTABLE=$(abspath $(BIN))/python \
	  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
	find isocore/kernels -name '*.cpp' -not -path '*/tables/*' | xargs -P 4 -n 4 $(BIN)/clang-tidy -p build/lint --quiet

types: $(READY)  ## mypy, strict
	$(BIN)/mypy

kernels: $(TOOLS)  ## the kernels' own tests, under sanitizers
	$(CMAKE) -B build/kernels -DCMAKE_BUILD_TYPE=Debug -DISOCORE_KERNEL_TESTS=ON -DISOCORE_WERROR=ON >/dev/null
	$(BIN)/ninja -C build/kernels
	build/kernels/kernel_tests

bench: $(BUILT)  ## time us against the peers, in one process; and the memory
	$(BIN)/python -m pip install -q ".[bench]" --no-build-isolation --no-deps && $(BIN)/python -m pip install -q vtk scikit-image nilearn
	$(BIN)/python tests/bench/run.py && $(BIN)/python tests/bench/measuring.py && $(BIN)/python tests/bench/memory.py && $(BIN)/python tests/bench/simplification_memory.py

fuzz: $(READY)  ## damaged inputs for hours: SECONDS=3600 or RUNS=, JOBS=1, SEED=1, TARGETS=; build/fuzz has what failed
	$(BIN)/python tests/fuzz/run.py $(if $(RUNS),--runs $(RUNS),--seconds $(or $(SECONDS),3600)) --jobs $(or $(JOBS),1) \
	  --seed $(or $(SEED),1) $(if $(TARGETS),--targets $(TARGETS))

samples: $(BUILT)  ## make sample_volumes/ again
	$(BIN)/python sample_volumes/make.py
	cd sample_volumes && sha256sum -b *.nii.gz *.nrrd *.raw *.json *.nhdr *.raw.gz *.vtu >SHA256SUMS

golden: $(BUILT)  ## rewrite the golden counts; the commit says why
	$(BIN)/python tests/golden/counts.py

dist: $(TOOLS)  ## wheel and sdist; the wheel is tried in a new environment, without a compiler
	rm -rf dist && $(PIP) -q build && ISOCORE_ISA=all $(BIN)/python -m build
	$(BIN)/python tests/check_wheel.py dist --try

clean:  ## remove what was built
	rm -rf build dist out $(VENV) .pytest_cache .mypy_cache .ruff_cache
