# make study: set up and write the main report.   make test: set up, lint, type-check and test.
PYTHON ?= python3
BIN = .venv/bin

.PHONY: study test setup clean
study: .venv/ready
	$(BIN)/drumlin study double_shoe

# loadscope: a module, and what its tests share, stays in one process
test: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/pytest -n 2 --dist loadscope

setup: .venv/ready

.venv/ready: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "drumlin needs Python 3.11 or newer")'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	touch $@

clean:
	rm -rf .venv
