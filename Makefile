# SPDX-License-Identifier: Apache-2.0
# `make run` and `make test` set up everything they need on a fresh Debian or Ubuntu, and do it again without harm.

PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11; do \
	command -v $$p >/dev/null && $$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' && echo $$p && break; done)
# A failure before a pipe is a failure.
SHELL := /bin/bash
.SHELLFLAGS := -o pipefail -c

VENV := .venv
BIN := $(VENV)/bin
BUILD := build/release
JOBS ?= $(shell nproc)

# make run: what to drive, and how
INPUT ?= simulator
STAGE ?= moving
OUT ?=
SERVE ?=
ARGS ?=

.DEFAULT_GOAL := setup
.PHONY: setup run test test-cpp test-python sanitize lint format clean help

help: ## what there is
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /  \1\t/' | expand -t 16

setup: $(VENV)/engine.stamp ## Debian packages, virtual environment, Python packages, C++ engine

run: setup ## drive INPUT (default: the simulator's street) in STAGE; OUT=folder, SERVE=1 keeps it up, ARGS=more options
	@$(BIN)/kinemap run $(INPUT) --stage $(STAGE) $(if $(OUT),--out $(OUT)) $(if $(filter-out 0,$(SERVE)),--serve) $(ARGS)

test: setup lint test-cpp test-python ## every check and every test

test-cpp: setup
	@echo "test: C++ engine"
	@ctest --test-dir $(BUILD) --output-on-failure -j $(JOBS)

test-python: setup
	@echo "test: Python"
	@$(BIN)/python -m pytest

sanitize: setup ## the C++ tests under ASan and UBSan, then under TSan
	@tests/sanitizers.sh $(JOBS)

lint: setup ## ruff, mypy, clang-format, import-linter
	@echo "lint: ruff, mypy, import-linter, clang-format"
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/mypy
	@$(BIN)/lint-imports --no-cache | tail -n 4
	@git ls-files '*.cc' '*.h' | xargs $(BIN)/clang-format --dry-run --Werror

format: setup ## write the code as lint wants it
	@$(BIN)/ruff check --fix-only --quiet
	@$(BIN)/ruff format
	@git ls-files '*.cc' '*.h' | xargs $(BIN)/clang-format -i

$(VENV)/system.stamp: deploy/setup/debian-packages.txt deploy/setup/system_packages.sh
	@deploy/setup/system_packages.sh
	@test -n "$(PYTHON)" || { echo "set-up: no Python 3.11 or newer found; install one, or give PYTHON=..." >&2; exit 2; }
	@test -x $(BIN)/python || { echo "set-up: making the virtual environment $(VENV)"; $(PYTHON) -m venv $(VENV); }
	@touch $@

$(VENV)/python.stamp: $(VENV)/system.stamp requirements.txt deploy/setup/python_packages.sh
	@deploy/setup/python_packages.sh $(VENV)
	@touch $@

ENGINE_SOURCES := CMakeLists.txt pyproject.toml $(shell find services/slam/engine -type f)

$(VENV)/engine.stamp: $(VENV)/python.stamp $(ENGINE_SOURCES)
	@echo "set-up: building the C++ engine (Release)"
	@cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release -DKINEMAP_BUILD_TESTS=ON \
		-DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python -Dpybind11_DIR=$$($(BIN)/python -m pybind11 --cmakedir) >/dev/null
	@cmake --build $(BUILD) -j $(JOBS) | tail -n 1
	@cmake --install $(BUILD) --component engine --prefix . >/dev/null
	@$(BIN)/pip --disable-pip-version-check install -qq --no-deps --no-build-isolation \
		-C wheel.cmake=false -C editable.mode=inplace --editable .
	@touch $@

clean: ## remove what was built, keep what was recorded
	rm -rf build $(VENV)
