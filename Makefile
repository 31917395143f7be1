# make study: set up and write the main report.   make manual: set up and build the manual, reports/manual/index.html.
# make test: set up, lint, type-check and test.
# make test-all: install what make test may have to skip for (Debian, Ubuntu), and run every test; a skip is a failure.
PYTHON ?= python3
BIN = .venv/bin

# CalculiX, GetFEM, the libraries that Gmsh loads, and a browser
PACKAGES = calculix-ccx chromium chromium-driver python3-getfem++ libgl1 libglu1-mesa libgomp1 libxcursor1 libxft2 libxinerama1
AS_ROOT = $(shell [ "$$(id -u)" = 0 ] || echo sudo)
TESTS = -n 2 --dist loadscope --no-skips  # or --skipped: what make test has just skipped

.PHONY: study manual test test-all packages setup clean
study: .venv/ready
	$(BIN)/drumlin study double_shoe

manual: .venv/ready
	$(BIN)/drumlin study manual

# loadscope: a module, and what its tests share, stays in one process
test: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/pytest -n 2 --dist loadscope

test-all: packages
	$(BIN)/pytest $(TESTS)

packages: .venv/ready
	$(AS_ROOT) apt-get update
	$(AS_ROOT) apt-get install --yes --no-install-recommends $(PACKAGES)
	$(BIN)/python -m pip install --quiet --editable '.[dev,meshing]'

setup: .venv/ready

.venv/ready: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "drumlin needs Python 3.11 or newer")'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	touch $@

clean:
	rm -rf .venv
