# make demo   performs a block of BML in the virtual robot; its film is smaller than others, to be there soon
# make test   runs the tests
# Both set up .venv first; nothing but python3 (with venv) and make is needed, and no root.

PYTHON ?= python3
BIN := .venv/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check
TESTED := --constraint requirements.lock
SOURCES := pyproject.toml requirements.lock $(wildcard setup.py kinesic/*/kernel/*.cpp kinesic/*/kernel/*.h)
EXTRAS := speech face
SMALL := --film-size 854x480 --film-rate 15
OPENGL := libegl1 libgl1-mesa-dri libopengl0 libgl1
SCREENS := xvfb chromium

.DELETE_ON_ERROR:
.PHONY: demo test test-rounding check soak mutants bench system-deps test-deps lock studio clean

demo: .venv/.stamp-demo
	@$(BIN)/kinesic perform kinesic/configs/bml/welcome.bml --robot upper36 --out out/demo --force $(SMALL)

# Tests start many processes: compiled modules are kept for them, whatever the caller's environment says. Files in an
# order of their own, the longest first (tests/scheduling.py): sorted by their number of tests, they would come last.
# What had to be tried twice is named at the end.
TEST := PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder -rR
test: .venv/.stamp-test
	@$(TEST)

# The rooms that calculate as another processor would: old kernels of linear algebra, and inputs some last bits away.
test-rounding: .venv/.stamp-test
	@OPENBLAS_CORETYPE=Prescott KINESIC_NUDGE=1 $(TEST) $(addprefix tests/,body bml expressivity ik sim)

check: .venv/.stamp-test
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/mypy
	@$(BIN)/lint-imports

# Longer runs: a thousand random blocks in extreme styles, the whole corpus, the studio played for a minute, and theorems on
# examples that nobody has seen.
soak: .venv/.stamp-test
	@$(BIN)/python -m pytest -m soak
	@$(BIN)/python -m pytest tests/theorems -n auto --hypothesis-profile soak

# Wrong programs: 200 small changes of the parts that must not fail, and which of them no test notices. Ten minutes on two
# cores that are free, three quarters of an hour under a load of twelve; `python tests/mutants -h` has options.
mutants: .venv/.stamp-test
	@$(BIN)/python tests/mutants

# The page of the studio, from its sources. What is built is kept in the repository: nobody but who changes it needs node.
studio:
	@cd kinesic/studio/client && npm ci --no-audit --no-fund && npm run check && npm run build

bench: .venv/.stamp-demo
	@$(BIN)/kinesic bench all

# The core must install, in the versions that were tested or, where these are not to be had, in newer ones; an extra that
# the machine does not allow is a warning. The second install finds the project in place and adds only what the extra needs.
.venv/.stamp-demo: $(SOURCES)
	@echo "setting up .venv ..."
	@test -x $(BIN)/pip || $(PYTHON) -m venv --clear .venv
	@$(INSTALL) $(TESTED) --editable . 2>.venv/tested.log || { \
		echo "warn: not with the tested versions (why: .venv/tested.log); others are taken"; $(INSTALL) --editable .; }
	@for extra in $(EXTRAS); do \
		$(INSTALL) $(TESTED) "kinesic[$$extra]" >.venv/$$extra.log 2>&1 || \
		echo "warn: extra $$extra is not installed, kinesic runs without it (why: .venv/$$extra.log)"; \
	done
	@touch $@

.venv/.stamp-test: .venv/.stamp-demo
	@$(INSTALL) $(TESTED) "kinesic[dev]" 2>.venv/dev.log || $(INSTALL) "kinesic[dev]"
	@touch $@

# The newest versions that the oldest Python takes, so that all take them; `make test` then says whether they are good.
# Without hashes: pip would ask for those of the project itself, which is installed in place.
lock:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11) and "make lock PYTHON=python3.11: the oldest")'
	@$(PYTHON) -m venv --clear .venv/lock
	@.venv/lock/bin/python -m pip install --quiet --editable ".[dev,all]"
	@grep '^#' requirements.lock >.venv/lock/pins
	@.venv/lock/bin/python -m pip freeze --exclude-editable >>.venv/lock/pins
	@mv .venv/lock/pins requirements.lock
	@rm -rf .venv/lock

# OpenGL for films and for the face; everything else works without it.
system-deps: INSTALLED := $(OPENGL)
# A display for tests of the face's window, and a browser for tests of pages; without them these tests are skipped.
test-deps: INSTALLED := $(SCREENS)
system-deps test-deps:
	@if [ "$$(id -u)" = 0 ]; then apt-get install -y -qq --no-install-recommends $(INSTALLED); \
	elif command -v sudo >/dev/null; then sudo apt-get install -y -qq --no-install-recommends $(INSTALLED); \
	else echo "as root: apt-get install -y $(INSTALLED)"; fi

clean:
	rm -rf .venv build dist out *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	rm -f kinesic/*/*.so
	find kinesic tests examples -type d -name __pycache__ -prune -exec rm -rf {} +
