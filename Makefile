# make demo   set up, then drive a robot across the built-in warehouse
# make test   set up, then run the tests: of those marked slow, today's part
# make test-slow  set up, then run all tests marked slow
# make quick  set up, then run the tests of tests/quick/files.txt: about a minute
# make test-wheels  build wheels, install each into an empty environment of every Python here, and run the demo
# make test-ray  install Ray, then run the tests of evaluations on a cluster, where there is no network but loopback
# make test-learning  install PyTorch and libraries that learn beside the environment, and test trundle.gym with them
# make test-physx  install NVIDIA's PhysX beside the environment, where it has wheels, and run its tests with it
# make test-ros2  build real ROS 2 environments in ~/.cache/trundle, once, and run the tests against them, the long ones too
# make test-isaac  put NVIDIA's packages into a Python 3.12 in ~/.cache/trundle, once, and run Isaac Sim's classes there
# make check  lint, types, layers
# make fuzz   random examples for every property test and every kernel, FUZZ_SECONDS each (10, about twelve minutes in all)
# make docs   build the site of guides and API reference into site/; BUILDER=zensical builds it with MkDocs' successor
# make web    build the page's script and style from web/ into src/trundle/page/assets, which is committed; needs Node
# make size   print how many files, lines and functions there are, and what one step of a run goes through
# make build  rebuild the C++ kernels (an editable install does not do so on import)
PYTHON ?= python3
FUZZ_SECONDS ?= 10
VENV ?= .venv
BUILDER ?= mkdocs
BIN := $(VENV)/bin
UV := $(shell command -v uv 2>/dev/null)
STEP := $(PYTHON) scripts/progress.py

ifeq ($(UV),)
  # An environment that uv made has no pip; venv adds it.
  CREATE := $(BIN)/python -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv $(VENV)
  INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt
else
  CREATE := test -x $(BIN)/python || $(UV) venv --quiet --allow-existing --python "$$($(PYTHON) -c 'import sys; print(sys.executable)')" $(VENV)
  INSTALL := env VIRTUAL_ENV=$(VENV) $(UV) pip install --quiet --compile-bytecode --python $(BIN)/python -c constraints.txt
endif

# Built with what is installed in $(VENV), so that a rebuild compiles only what changed. FLAGS: see scripts/sanitize.sh.
BUILD = --no-build-isolation $(FLAGS)

# Written once here, so that no start has to compile Python first, whatever PYTHONDONTWRITEBYTECODE says.
COMPILE := $(BIN)/python -m compileall -q src/trundle

# A test that hangs fails after so many seconds, and says where; none takes a fifth of it.
HANGS := --timeout 600

# Tests with a target of their own.
ELSEWHERE := not wheel and not ray and not ros2 and not isaac

# Of the slow tests, one in so many, another one each day: tests/conftest.py.
PARTS := 6

KERNELS := $(wildcard src/trundle/_core/*.cpp src/trundle/_core/*/*.cpp)
SOURCES := $(KERNELS) $(wildcard src/trundle/_core/*/*.hpp) CMakeLists.txt

.PHONY: demo quick test test-slow test-wheels test-ray test-learning test-physx test-ros2 ros2-env test-isaac fuzz check size docs web build setup dev clean

demo: setup
	$(BIN)/trundle demo

# scripts/seeded_faults.py measures what they find.
quick: dev
	$(BIN)/python -m pytest $(HANGS) -n 2 --dist loadfile @tests/quick/files.txt

test: dev
	$(BIN)/python -m pytest $(HANGS) -n 2 --dist loadfile -m "$(ELSEWHERE)" --slow today/$(PARTS)

test-slow: dev
	$(BIN)/python -m pytest $(HANGS) -n 2 --dist worksteal -m "slow and $(ELSEWHERE)"

# Builds wheels without the compiled files of this folder: minutes.
test-wheels: dev
	$(BIN)/python -m pytest -m wheel

# Ray opens ports: its tests run in a network namespace with lo alone, and are skipped where there is none.
test-ray: dev $(VENV)/.trundle-ray
	$(BIN)/python scripts/only_lo.py $(BIN)/python -m pytest $(HANGS) -m ray tests/evaluation/cluster

# Beside the environment, as PyTorch is large.
test-learning: dev
	@test -e $(VENV)/.trundle-learning || { $(INSTALL) --target $(VENV)/learning $$($(BIN)/python scripts/requirements.py learning) \
	  && touch $(VENV)/.trundle-learning; }
	PYTHONPATH=$(abspath $(VENV)/learning) $(BIN)/python -m pytest $(HANGS) tests/gym tests/sim/batch

# Beside the environment: ovphysx asks for an older packaging than pytest, so nothing of it may be installed there.
test-physx: dev
	@test -e $(VENV)/.trundle-physx || { $(INSTALL) --no-deps --target $(VENV)/physx $$($(BIN)/python scripts/requirements.py physx) \
	  && touch $(VENV)/.trundle-physx; } || echo "PhysX cannot be installed here: its tests are skipped"
	PYTHONPATH=$(VENV)/physx $(BIN)/python -m pytest $(HANGS) tests/sim/physx

# The other tests of this folder run in `make test` too, where the environments are there.
test-ros2: dev ros2-env
	$(BIN)/python -m pytest $(HANGS) -n 2 --dist loadfile tests/ros2

# Wheels of ROS, and messages compiled with them: minutes. Where it cannot be built, it says why, and so do the tests skipped.
ros2-env: dev
	@$(BIN)/python scripts/ros2_env.py || true

# NVIDIA's packages (600 MB), and the kernels for them: minutes. Where it cannot be built, it says why, and so do the tests skipped.
test-isaac: dev
	@$(BIN)/python -m trundle.testing.isaac --build || true
	$(BIN)/python -m pytest $(HANGS) -n 2 --dist worksteal tests/isaac

fuzz: dev
	$(BIN)/python -m pytest -n 2 --explore --explore-seconds $(FUZZ_SECONDS)
	PYTHONPATH=tests $(BIN)/python -W ignore::RuntimeWarning -m fuzz --seconds $(FUZZ_SECONDS) --seed $$(date +%s)

check: dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright
	$(BIN)/lint-imports

size: dev
	@$(BIN)/python scripts/size.py

setup: $(VENV)/.trundle
dev: $(VENV)/.trundle-dev

$(VENV)/.tools: scripts/check_tools.py
	@$(PYTHON) scripts/check_tools.py
	@mkdir -p $(VENV) && touch $@

$(VENV)/.trundle: Makefile scripts/requirements.py pyproject.toml constraints.txt $(SOURCES) | $(VENV)/.tools
	@echo "1/4 Creating $(VENV)"
	@$(CREATE)
	@$(STEP) "2/4 Installing NumPy, MuJoCo, PyAV and what builds the kernels" -- $(INSTALL) $$($(BIN)/python scripts/requirements.py build demo)
	@$(STEP) "3/4 Compiling the C++ kernels" --objects build --of $(words $(KERNELS)) -- $(INSTALL) $(BUILD) --no-deps -e .
	@$(STEP) "4/4 Compiling Python" -- $(COMPILE)
	@touch $@

$(VENV)/.trundle-dev: $(VENV)/.trundle
	@$(INSTALL) $$($(BIN)/python scripts/requirements.py dev)
	@touch $@

$(VENV)/.trundle-ray: $(VENV)/.trundle-dev
	@$(INSTALL) $$($(BIN)/python scripts/requirements.py ray)
	@touch $@

# NO_MKDOCS_2_WARNING: Material's advice to move to Zensical, which builds this site already.
docs: $(VENV)/.trundle-docs
	$(BIN)/python scripts/docs_site.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/$(BUILDER) build --strict
	@echo "The site is site/index.html; its search needs a server: $(BIN)/python -m http.server -d site"

# Without the kernels: the reference is read from the sources.
$(VENV)/.trundle-docs: Makefile scripts/requirements.py pyproject.toml | $(VENV)/.tools
	@$(CREATE)
	@$(INSTALL) $$($(BIN)/python scripts/requirements.py docs)
	@touch $@

web: web/node_modules/.package-lock.json
	node web/build.mjs

# Without the scripts that packages would run on install: none is needed.
web/node_modules/.package-lock.json: web/package.json web/package-lock.json
	npm ci --prefix web --ignore-scripts --no-audit --no-fund
	@touch $@

build: setup
	@$(INSTALL) $(BUILD) --no-deps -e .

clean:
	rm -rf $(VENV) build dist site
