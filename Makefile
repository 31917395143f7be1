# make study: set up and write the main report.   make manual: set up and build the manual, reports/manual/index.html.
# make test: set up, lint, type-check and test.
# make test-all: install what make test may have to skip for (Debian, Ubuntu), and run every test; a skip is a failure.
PYTHON ?= python3
BIN = .venv/bin

# CalculiX, GetFEM, the libraries that Gmsh loads, and a browser
PACKAGES = calculix-ccx chromium chromium-driver python3-getfem++ libgl1 libglu1-mesa libgomp1 libxcursor1 libxft2 libxinerama1
AS_ROOT = $(shell [ "$$(id -u)" = 0 ] || echo sudo)
TESTS = -n 2 --dist loadscope --no-skips  # or --skipped for --no-skips: what make test has just skipped

# of the oldest and newest versions: what a change of a library breaks first; its deprecations are for others to read
SHORT = tests/test_brake.py tests/test_files.py tests/test_fem.py tests/test_laws_examples.py tests/test_page.py \
  tests/test_cli.py tests/test_faults.py
# what the libraries are for, at length: the main study with its field picture, a Dask scheduler, the manual
WHOLE = tests/test_study_double_shoe.py tests/test_sweep_stopped.py::test_a_dask_worker_is_killed \
  tests/test_manual.py::test_the_manual_is_built_whole_and_stands_alone
# Whether pyproject.toml names this Python among those that are tested.
TESTED = import pathlib, sys, tomllib; project = tomllib.loads(pathlib.Path("pyproject.toml").read_text())["project"]; \
  sys.exit("Programming Language :: Python :: %d.%d" % sys.version_info[:2] not in project["classifiers"])

.PHONY: study manual test types types-of-tests passes test-all oldest newest truths calibrate levels degrees mesh_cost sharpness noticed benchmarks notebooks packages release_number constraints setup clean
study: .venv/ready
	$(BIN)/drumlin study double_shoe

manual: .venv/ready
	$(BIN)/drumlin study manual

test: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/codespell
	$(BIN)/lint-imports
	$(MAKE) --jobs=2 types passes

types:
	$(BIN)/mypy

# Types in tests take half a minute, and are left to make test-all.
types-of-tests: .venv/ready
	$(BIN)/mypy --config-file tests/mypy.ini tests

# loadscope: a module, and what its tests share, stays in one process
passes:
	$(BIN)/pytest -n 2 --dist loadscope

test-all: packages types-of-tests
	$(BIN)/pytest $(TESTS)
	$(MAKE) oldest newest

# The lower bounds of pyproject.toml have no wheels for the newest Pythons: they are tried with the oldest alone.
oldest: .venv/ready
	if $(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))'; then \
	  $(PYTHON) -m venv .venv/oldest && \
	  $(BIN)/python tests/oldest.py > .venv/oldest.txt && \
	  .venv/oldest/bin/python -m pip install --quiet --requirement .venv/oldest.txt && \
	  .venv/oldest/bin/python -m pip install --quiet --no-deps --editable . && \
	  .venv/oldest/bin/pytest -o filterwarnings=default $(SHORT) && \
	  .venv/oldest/bin/pytest -o filterwarnings=default --no-skips $(WHOLE); \
	else echo "oldest versions: tried with Python 3.11 alone"; fi

newest:
	$(PYTHON) -m venv .venv/newest
	.venv/newest/bin/python -m pip install --quiet --upgrade --editable '.[dev]'
	.venv/newest/bin/pytest -o filterwarnings=default $(SHORT)
	.venv/newest/bin/pytest -o filterwarnings=default --no-skips $(WHOLE)

# Far finer solutions of some forty brakes, by which the tests judge stated errors: ten minutes.
truths: .venv/ready
	$(BIN)/python -m drumlin_studies.stored_truth tests/truths

# The factors of the error estimates, fitted anew on random brakes: some forty minutes on two cores.
calibrate: .venv/ready
	$(BIN)/drumlin study calibration
	cp reports/calibration/factors.json src/drumlin/fem/error_control/factors.json
	cp reports/calibration/width_factors.json src/drumlin/fem/width/factors.json
	mkdir -p reports/reference/calibration
	cp reports/calibration/width_rows.csv reports/reference/calibration/width_rows.csv

# What the eight numbers of the levels' rule do to errors and times: fifteen minutes. make levels ARGS="fall=6".
levels: .venv/ready
	$(BIN)/python -m drumlin_studies.level_rules $(ARGS)

# Stated and true errors of meshes by Gmsh: five minutes. make degrees ARGS="8 100" judges 8 meshes from seed 100 on.
degrees: .venv/ready
	$(BIN)/python -m pip install --quiet --editable '.[dev,meshing]'
	$(BIN)/python -m drumlin_studies.mesh_degrees $(ARGS)

# Time and true errors on one mesh file by Gmsh, beside GetFEM and CalculiX: a minute. make mesh_cost ARGS=4.4 has elements of 4.4 mm.
# ARGS="2.25 2 equal" refines the meshes of the peers until they have drumlin's error: 25 minutes.
mesh_cost: .venv/ready
	$(BIN)/python -m pip install --quiet --editable '.[dev,meshing]'
	$(BIN)/python -m drumlin_studies.mesh_cost $(ARGS)

# By how much stated errors are larger than true ones now; the tests notice where this changes.
sharpness: .venv/ready
	$(BIN)/python -m drumlin_studies.sharpness tests/truths

# Which tests notice where a number that was found by trying is changed: half an hour. make noticed ARGS="fem/model.py".
noticed: .venv/ready
	$(BIN)/python tests/mutations.py $(ARGS)

# Figures of speed and size of this commit, appended as a line to reports/reference/benchmarks/history.jsonl: two minutes.
benchmarks: .venv/ready
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m drumlin_studies.benchmarks

# The example notebooks with their outputs, which the manual shows: a minute.
notebooks: .venv/ready
	$(BIN)/python -m drumlin_studies.notebooks

# The number of a release in all files, and today's date in CHANGELOG.md: make release_number VERSION=0.2.0
release_number: .venv/ready
	$(BIN)/python -m drumlin_studies.release_number $(VERSION)

# needs uv; writes every version that is the newest now, with the hashes of all its files
constraints:
	(sed '/^#/!d' constraints.txt; echo 'setuptools>=77' | uv pip compile pyproject.toml - --extra dev --universal \
	  --python-version 3.11 --generate-hashes --no-annotate --no-header --no-emit-index-url --quiet) > constraints.new
	mv constraints.new constraints.txt

packages: .venv/ready
	$(AS_ROOT) apt-get update
	$(AS_ROOT) apt-get install --yes --no-install-recommends $(PACKAGES)
	$(BIN)/python -m pip install --quiet --editable '.[dev,meshing]'

setup: .venv/ready

.venv/ready: pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "drumlin needs Python 3.11 or newer")'
	$(PYTHON) -m venv .venv
	if $(BIN)/python -c '$(TESTED)'; then \
	  $(BIN)/python -m pip install --quiet --require-hashes --requirement constraints.txt && \
	  $(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .; \
	else \
	  echo "no versions are tested with this Python: the newest are installed" && \
	  $(BIN)/python -m pip install --quiet --editable '.[dev]'; \
	fi
	touch $@

clean:
	rm -rf .venv
