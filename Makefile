# Every target sets up what it needs; setting up again takes a second. `make help` lists the targets.
.DEFAULT_GOAL := help
.PHONY: help setup demo test lint bench ui docs lock clean

PYTHON_IN_VENV := .venv/bin/python

help:  ## show this list
	@sed -n 's/^\([a-z]*\):.*##  *\(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 14

setup:  ## make the virtual environment, install locked packages and system libraries
	@scripts/setup.sh

demo: setup  ## train, plan and execute grasps, and write a page that shows it (10 minutes)
	$(PYTHON_IN_VENV) src/train.py experiment=demo
	$(PYTHON_IN_VENV) sim/evaluate.py experiment=demo_planning
	$(PYTHON_IN_VENV) analysis/report.py report=demo

test: lint  ## check style and types, and run all tests (10 minutes)
	OMP_NUM_THREADS=1 $(PYTHON_IN_VENV) -m pytest --numprocesses 2 --dist loadfile --no-loadscope-reorder --durations=20

lint: setup  ## check style and types only
	.venv/bin/ruff check
	.venv/bin/ruff format --check
	$(PYTHON_IN_VENV) -m mypy

bench: setup  ## measure against other software, side by side
	$(PYTHON_IN_VENV) benchmarks/run.py

ui: setup  ## look at trainings in MLflow, at http://127.0.0.1:5000, for this machine alone
	.venv/bin/mlflow ui --backend-store-uri sqlite:///mlflow.db --host 127.0.0.1

docs: setup  ## build the documentation site, outputs/docs/index.html; a broken link is an error
	NO_MKDOCS_2_WARNING=1 $(PYTHON_IN_VENV) -m mkdocs build --strict

lock: setup  ## write requirements.lock from the virtual environment
	scripts/lock.sh

clean:  ## remove caches and derived files; results, outputs and the environment stay
	rm -rf .cache .mypy_cache .ruff_cache .pytest_cache .hypothesis build
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +
