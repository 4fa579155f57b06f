# make demo   performs the built-in greeting in the virtual robot, as `kinesic demo` does
# make test   runs the tests
# Both set up .venv first; nothing but python3 (with venv) and make is needed, and no root.

PYTHON ?= python3
BIN := .venv/bin
RELEASE := build/release
INSTALL = $(BIN)/python -m pip install --quiet --disable-pip-version-check
# Installs the tested files of a list, each by its hash, and writes to a log why it cannot.
TESTED = $(INSTALL) --require-hashes --requirement $(1) >$(2) 2>&1
# Ends everything where a file is there but differs from the tested one: somebody may have exchanged it.
UNCHANGED = { ! grep -q "DO NOT MATCH THE HASHES" $(1) || { cat $(1) >&2; exit 1; }; }
# Installs the compiler from PyPI if the machine has none.
COMPILER = { ! $(BIN)/python -c 'import sys, build_backend; sys.exit(not build_backend.needs_zig())' || \
	$(call TESTED,requirements-compiler.lock,.venv/compiler.log) || { $(call UNCHANGED,.venv/compiler.log); false; }; }
SOURCES := pyproject.toml build_backend.py $(wildcard requirements*.lock setup.py kinesic/_kernel/*.cpp kinesic/*/kernel/*.cpp kinesic/*/kernel/*.h)
EXTRAS := speech face voice
KEPT ?=
OPENGL := libegl1 libgl1-mesa-dri libopengl0 libgl1
SCREENS := xvfb chromium chromium-headless-shell

.DELETE_ON_ERROR:
.PHONY: demo setup test test-rounding check soak campaign notebooks mutants mutants-studio bench docs tutorials reference wheels wheels-smoke first-report system-deps test-deps lock studio clean

# Sets up .venv for tests, and does nothing else.
setup: .venv/.stamp-test

demo: .venv/.stamp-demo
	@$(BIN)/kinesic demo --no-open

# Tests start many processes: compiled modules are kept for them, whatever the caller's environment says. Files in an
# order of their own, the longest first (tests/scheduling.py): sorted by their number of tests, they would come last.
# A test that fails is tried once more, and shown at the end with its error: hundreds depend on processes and on a clock.
TEST := PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder --reruns 1 -rR \
	--rerun-show-tracebacks
test: .venv/.stamp-test
	@$(TEST)

# The rooms that calculate as another processor would: old kernels of linear algebra, and inputs some last bits away.
test-rounding: .venv/.stamp-test
	@OPENBLAS_CORETYPE=Prescott KINESIC_NUDGE=1 $(TEST) $(addprefix tests/,body bml expressivity ik sim)

check: .venv/.stamp-test
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@printf '%s\n' linux win32 darwin | xargs -P 3 -I @ $(BIN)/mypy --platform @ --cache-dir .mypy_cache/@
	@$(BIN)/lint-imports
	@$(BIN)/python -m tests.language

# Longer runs: a thousand random blocks in extreme styles, the whole corpus, the studio played for a minute, theorems on
# examples that nobody has seen, and every reader of bytes and text fuzzed for five minutes.
soak: .venv/.stamp-test
	@$(BIN)/python -m pytest -m soak
	@$(BIN)/python -m pytest tests/theorems -n auto --hypothesis-profile soak
	@$(BIN)/python -m tests.fuzz --seconds 300

# Random blocks and merges, judged by independent code: GROUPS groups of 20 planned and 80 merged blocks, in JOBS processes.
# NEAR=adult plans all gestures in all styles and 100 documents instead, and compares them with plans without a policy.
# The journal out/campaign.jsonl lets an interrupted campaign go on.
campaign: .venv/.stamp-test
	@$(BIN)/python -m tests.campaign --groups $(or $(GROUPS),1000) --seed $(or $(SEED),1) --jobs $(or $(JOBS),1) \
		$(if $(NEAR),--near $(NEAR))

# The notebooks in examples/notebooks, executed from the first cell to the last.
notebooks: .venv/.stamp-test
	@$(BIN)/python -m pytest -m soak tests/test_notebooks.py

# Wrong programs: ten small changes of each part that must not fail, and a list of those that no test notices.
# `python tests/mutants -h` has options.
mutants: .venv/.stamp-test
	@$(BIN)/python tests/mutants

# The same for the part of the studio's page that arms, performs and stops: all of its about 600 mutants.
mutants-studio:
	@cd kinesic/studio/client && npm ci --no-audit --no-fund && npm run --silent mutants

# The page of the studio, from its sources. What is built is kept in the repository: nobody but who changes it needs node.
studio:
	@cd kinesic/studio/client && npm ci --no-audit --no-fund && npm run check && npm run build

# The pages of docs/reference that are written from the code: after a change of options, keys, messages or public names.
reference: .venv/.stamp-test
	@$(BIN)/python docs/make/reference

# The documentation site in build/site; a broken link or anchor ends it. SITES=FOLDER also adds this version to a folder
# of all published versions, for a web server.
docs: .venv/.stamp-docs
	@$(BIN)/python docs/make/site.py $(if $(SITES),--publish $(SITES))

# The tutorials of the site, block by block as their readers would; `make test` only reads them.
tutorials: .venv/.stamp-test
	@$(BIN)/python -m pytest -m tutorial tests/tutorials -n 2 --dist loadfile --reruns 1 -rR

# The source archive and the wheels for Linux in dist, checked: CPython 3.11, and the stable ABI of 3.12 and later.
wheels: $(RELEASE)/.stamp
	@$(RELEASE)/bin/python release/wheels.py

# The wheel for aarch64 under emulation, against this processor: ten minutes at most (Debian 12 or later).
wheels-smoke: .venv/.stamp-demo
	@$(BIN)/python release/emulated.py dist/kinesic-*-cp311-cp311-manylinux*_aarch64.whl

# The time and the sizes from nothing to the first report, with a wheel of dist: downloads 130 MB, changes nothing here.
first-report:
	@$(PYTHON) release/first_report.py

bench: .venv/.stamp-test
	@$(BIN)/kinesic bench all

# The core must install, in the files that were tested or, where these are not to be had, in newer ones; an extra that
# the machine does not allow is a warning. Tools that build the kernels are in the list, so that they are checked, too.
.venv/.stamp-demo: $(SOURCES)
	@echo "setting up .venv ..."
	@test -x $(BIN)/pip || $(PYTHON) -m venv --clear .venv
	@{ $(call TESTED,requirements.lock,.venv/tested.log) && $(COMPILER) && \
		$(INSTALL) --no-deps --no-build-isolation --editable . 2>>.venv/tested.log; } || { $(call UNCHANGED,.venv/tested.log); \
		echo "warn: not with the tested versions (why: .venv/tested.log); others are taken"; $(INSTALL) --editable .; }
	@for extra in $(EXTRAS); do \
		$(call TESTED,requirements-$$extra.lock,.venv/$$extra.log) || { $(call UNCHANGED,.venv/$$extra.log); \
		echo "warn: extra $$extra is not installed, kinesic runs without it (why: .venv/$$extra.log)"; }; \
	done
	@touch $@

.venv/.stamp-test: .venv/.stamp-demo
	@$(call TESTED,requirements-dev.lock,.venv/dev.log) || { $(call UNCHANGED,.venv/dev.log); \
		echo "warn: not with the tested versions (why: .venv/dev.log); others are taken"; $(INSTALL) "kinesic[dev]"; }
	@touch $@

# What builds the documentation site, and nothing else needs.
.venv/.stamp-docs: .venv/.stamp-demo requirements-docs.lock
	@$(call TESTED,requirements-docs.lock,.venv/docs.log) || { $(call UNCHANGED,.venv/docs.log); \
		echo "the tools of the documentation site are not installed (why: .venv/docs.log)"; exit 1; }
	@touch $@

# What builds and checks wheels, in an environment of its own, so that .venv keeps exactly the tested packages.
$(RELEASE)/.stamp: BIN := $(RELEASE)/bin
$(RELEASE)/.stamp: requirements-release.lock
	@$(PYTHON) -m venv --clear $(RELEASE)
	@$(call TESTED,requirements-release.lock,$(RELEASE)/install.log) || { $(call UNCHANGED,$(RELEASE)/install.log); \
		echo "the tools that build wheels are not installed (why: $(RELEASE)/install.log)"; exit 1; }
	@touch $@

# The newest versions that the oldest Python takes, so that all take them; `make test` then says whether they are good.
# One list for the core and what builds it, and one for each extra that make installs, in the same versions.
RESOLVE := .venv/lock/bin/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate \
	--no-header --no-emit-index-url
BUILD_TOOLS := import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")
TOOLS := import sys, tomllib; \
	print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"][sys.argv[1]], sep="\n")
lock:
	@$(PYTHON) -m venv --clear .venv/lock
	@.venv/lock/bin/python -m pip install --quiet uv==0.13.9
	@.venv/lock/bin/python -c '$(BUILD_TOOLS)' >.venv/lock/build.in
	@$(RESOLVE) $(KEPT) pyproject.toml $(foreach extra,$(EXTRAS) dev,--extra $(extra)) .venv/lock/build.in >.venv/lock/all
	@$(RESOLVE) --constraint .venv/lock/all pyproject.toml .venv/lock/build.in >.venv/lock/requirements.lock
	@for extra in $(EXTRAS) dev; do \
		$(RESOLVE) --constraint .venv/lock/all pyproject.toml --extra $$extra >.venv/lock/requirements-$$extra.lock || exit 1; \
	done
	@for extra in docs release compiler; do \
		.venv/lock/bin/python -c '$(TOOLS)' $$extra >.venv/lock/$$extra.in; \
		$(RESOLVE) --constraint .venv/lock/all .venv/lock/$$extra.in >.venv/lock/requirements-$$extra.lock || exit 1; \
	done
	@mv .venv/lock/requirements*.lock .
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
	rm -rf .venv .cache build dist out *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	rm -f kinesic/_kernel/*.so
	find kinesic tests examples -type d -name __pycache__ -prune -exec rm -rf {} +
