# `make test` is everything that must hold, and what CI runs. Rust is built in release mode throughout,
# so that the tests use what the first run has compiled.

SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.PHONY: setup test built compiled rust results python notebook lint dependencies notices docs figures stubs wheel bench peers fits validation fuzz grid agreement calibration fingerprint base accuracy outputs wasm wasm-toolchain explorer keys variables
.PHONY: workflows metadata release-check packages packages-compile publish semver release release-notes binary compiles minimal-versions mutants fuzz-bytes cost

export PYTHON ?= python3
venv := .venv
target := $(or $(CARGO_TARGET_DIR),target)
site := $(target)/docs
engine := $(target)/wasm32-unknown-unknown/explorer/asperity_wasm.wasm
page := target/explorer/asperity-explorer.html
rustup_library := $(wildcard $(shell rustc --print sysroot)/lib/rustlib/wasm32-unknown-unknown/lib/libstd-*.rlib)
# Without it the compiler of `make wasm-toolchain`, if it is there: it compiles the standard library, too.
debian := $(CURDIR)/target/debian
wasm_library := $(or $(rustup_library),$(wildcard $(debian)/ready))
ifeq ($(rustup_library),)
wasm_compiler := RUSTC=$(debian)/rustc RUSTC_BOOTSTRAP=1 CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=$(debian)/wasm-ld
wasm_standard := -Zbuild-std=std,panic_abort
endif

# Everything that must hold. Tests in Rust and Python keep two cores busy; what follows them does not, and runs two at a time.
test: setup built rust python
	$(MAKE) --jobs 2 --output-sync=target results explorer notebook lint dependencies docs release-check

# All that the parts of `make test` compile and install, two at a time: linking and installing keep one core busy only.
built:
	$(MAKE) --jobs 2 --output-sync=target compiled $(deny) $(if $(wasm_library),$(page)) $(stubs) $(venv)-release/ready \
	  $(addsuffix /installed,$(venv) $(venv)-oldest $(venv)-docs $(venv)-notebook)

tested := --release --locked --package asperity --package asperity-runner --package asperity-engine --package asperity-cli

compiled:
	cargo test $(tested) --no-run

# Checks that the tools are there, and makes the Python environment that reads results.
setup:
	.ci/tools
	$(MAKE) $(venv)/ready

define environment
	rm -rf $(@D)
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/pip install --quiet --disable-pip-version-check --requirement $<
	touch $@
endef

$(venv)/ready: python/requirements.txt
	$(environment)

$(venv)-oldest/ready: python/requirements-oldest.txt
	$(environment)

# Measured traces, for comparisons that are left out where there are none.
export ASPERITY_LAB_DATA ?= $(abspath $(wildcard ../shared/data))

# The tests of all crates, those of the documents among them; the crate of the package is tested from Python.
rust:
	@[ -n "$$ASPERITY_LAB_DATA" ] || echo "ASPERITY_LAB_DATA names no folder: comparisons with laboratory data are skipped"
	$(PYTHON) .ci/rust_tests.py $(tested)

# Every shipped scenario, with its pictures, in $$folder. A quarter of a million cells are made fewer here; `make fingerprint` runs
# them all.
define shipped
	cargo build --release --locked --quiet
	folder=$$(mktemp -d); trap 'rm -rf "$$folder"' EXIT; \
	for scenario in scenarios/*.toml; do \
	  command=$$(grep -q '^\[sweep' "$$scenario" && echo sweep || echo run); \
	  smaller=$$([[ "$$scenario" != */half-space-512.toml ]] || echo --set interface.cells=[128,128]); \
	  $(target)/release/asperity $$command "$$scenario" --quiet $$smaller -o "$$folder/$$(basename "$$scenario" .toml)"; \
	done
endef

# Results as users open them: every shipped scenario is read back with xarray, and the pictures of the pages are those that it draws.
results: $(venv)/ready
	$(shipped); \
	$(venv)/bin/python runner/tests/open_with_xarray.py "$$folder"/*/; \
	$(PYTHON) .ci/figures.py check "$$folder"

package := target/package
stubs := $(package)/stubs/asperity/_core.pyi

# The Python package as users get it, where NumPy is the newest and where it is the oldest.
python: $(venv)/installed $(venv)-oldest/installed $(stubs)
	$(venv)/bin/python -P -m pytest --numprocesses 2
	$(venv)-oldest/bin/python -P -m pytest --numprocesses 2 -k "not command"
	$(venv)/bin/python -P python/tests/stubs.py --check $(stubs)
	$(venv)/bin/mypy python
	$(venv)/bin/python -P -m mypy.stubtest asperity
	$(venv)/bin/ruff format --check python docs .ci
	$(venv)/bin/ruff check python docs .ci

# The source distribution, and a wheel of the crates that the tests have compiled. Both are made of the same files: `make release-check`
# looks at those of the source distribution, and `make packages-compile` compiles it.
sources := $(shell git ls-files 'core/src' 'runner/src' 'engine/src' 'engine/build.rs' 'explorer' 'cli/src' 'cli/build.rs' 'scenarios' 'python/src' 'python/asperity' '*Cargo.toml' Cargo.lock pyproject.toml THIRD-PARTY.txt)

$(package)/wheel: $(venv)/ready $(sources)
	rm -rf $(package)/*.tar.gz target/wheels
	$(venv)/bin/maturin sdist --out $(package)
	$(venv)/bin/maturin build --release --locked --quiet --out target/wheels
	touch $@

$(addsuffix /installed,$(venv) $(venv)-oldest $(venv)-docs $(venv)-notebook $(venv)-peers): %/installed: %/ready $(package)/wheel
	$*/bin/pip install --quiet --disable-pip-version-check --force-reinstall --no-deps target/wheels/*.whl
	touch $@

# The stubs and the lists of names of the package, from the declarations in `python/src`. `make python` compares them.
stubs: $(venv)/installed $(stubs)
	$(venv)/bin/python -P python/tests/stubs.py $(stubs)

# What the extension says of itself where it is compiled with the feature `stubs`; it is not run, and so not optimised.
$(stubs): $(package)/wheel
	$(venv)/bin/maturin generate-stubs --profile release --config 'profile.release.package.asperity-python.opt-level=0' \
	  --features stubs --out $(package)/stubs

# A wheel for any Linux since 2014.
wheel: $(venv)-wheel/ready
	PATH="$(CURDIR)/$(venv)-wheel/bin:$$PATH" maturin build --release --locked --zig --compatibility manylinux2014 --out target/manylinux

$(venv)-wheel/ready: python/requirements-wheel.txt
	$(environment)

# How the code is laid out, what clippy has to say, and the licences and sources of what it is made of.
lint:
	cargo fmt --all --check
	cargo clippy --release --workspace --all-targets --locked -- -D warnings
	$(PYTHON) .ci/third_party.py check
	$(PYTHON) .ci/metadata.py check
	$(PYTHON) .ci/tolerances.py
	$(MAKE) workflows

# The workflows of hosted CI: their syntax, the inputs of actions, their permissions, and the shell in them.
workflows: $(venv)-release/ready
	@if [ -x $(venv)-release/bin/actionlint ]; then $(venv)-release/bin/actionlint; else \
	  echo "actionlint: not run, it has no wheel for this system"; fi
	$(venv)-release/bin/zizmor --offline --no-progress --quiet .github

$(venv)-release/ready: python/requirements-release.txt
	$(environment)

deny_version := 0.20.2
deny := $(target)/tools/bin/cargo-deny

# In debug mode: it runs for a second.
$(deny): Makefile
	cargo install cargo-deny --version $(deny_version) --locked --debug --quiet --root $(target)/tools --target-dir $(target)/tools/build
	touch $@

# The crates that asperity is made of, by cargo-deny and deny.toml: licences, bans and sources, and security advisories where
# their database can be reached.
dependencies: $(deny)
	$(deny) --locked check licenses bans sources
	@if $(deny) fetch db > /dev/null 2>&1; then $(deny) --locked check advisories; else \
	  echo "advisories: not checked, their database cannot be reached"; fi

# The notices of what it is made of, anew. `make lint` compares them.
notices:
	$(PYTHON) .ci/third_party.py write

# The site into target/docs, the explorer and the documentation of the crates included; then what its pages show in Python is run.
docs: $(venv)-docs/installed $(if $(wasm_library),$(page))
	rm -rf $(site)/explorer
	mkdir -p $(site)/explorer
	$(if $(wasm_library),cp $(page) $(site)/explorer/index.html,rmdir $(site)/explorer)
	RUSTDOCFLAGS="-D warnings" cargo doc --release --workspace --no-deps --locked
	$(venv)-docs/bin/sphinx-build -E -W --keep-going -n -q docs $(site)
	rm -rf $(site)/rust
	cp -r $(target)/doc $(site)/rust
	$(venv)-docs/bin/python -P -m pytest -q -p no:cacheprovider docs

$(venv)-docs/ready: docs/requirements.txt
	$(environment)

# The pictures of the README and of the pages. `make results` compares them with what is drawn.
figures: $(venv)/installed
	$(shipped); \
	$(PYTHON) .ci/figures.py write "$$folder"; \
	package=$(CURDIR)/$(venv)/bin/python; documents=$(CURDIR)/python/tests/documents.py; \
	(cd "$$folder" && SOURCE_DATE_EPOCH=0 $$package -P "$$documents")

# How fast it is, what a call from Python costs, and what the same jobs cost that one would write in Python.
bench: $(venv)/installed $(venv)-peers/installed
	cargo bench --locked --package asperity --bench ensemble --bench block --bench coupling --bench elastic --bench fit --bench lattice --bench master --bench population --bench scaling --bench velocity --bench transport --bench diffusion
	$(venv)/bin/python -P python/benches/overhead.py
	$(venv)/bin/python -P python/benches/fit.py
	cargo build --release --locked --quiet
	cargo run --release --locked --package asperity-cli --example sweep_cost
	$(venv)/bin/python -P python/benches/sweep.py
	$(venv)/bin/python -P python/benches/pictures.py target/release/asperity
	$(paired)

paired = PEERS_PYTHON=$(CURDIR)/$(venv)-peers/bin/python cargo bench --locked --package asperity --bench peers

# The page of how fast it is next to what one would write in Python, anew.
peers: $(venv)-peers/installed
	$(paired) > target/peers.md
	mv target/peers.md docs/validation/peers.md

$(venv)-peers/ready: core/benches/peers/requirements.txt
	$(environment)

# The page of what fits cost, beside curve_fit of SciPy, anew.
fits: $(venv)/installed
	$(venv)/bin/python -P python/benches/fit.py > target/fits.md
	mv target/fits.md docs/validation/fits.md

# The page docs/validation, anew. A test recomputes of it what is quick.
validation:
	cargo run --release --locked --package asperity-cli --example validation

# Whether the core and the runner compile where addresses have 32 bits and there are no threads and no clock.
wasm:
	cargo check --locked --target wasm32-unknown-unknown --package asperity --package asperity-runner

# The explorer, one page with its engine as WebAssembly; then the engine is compared with the command, and the page is tested in
# Chromium.
ifneq ($(wasm_library),)
explorer: $(page)
	cargo build --release --locked --quiet
	explorer/node_modules/.bin/tsc --project explorer
	node explorer/test.mjs $(engine) $(page) $(target)/release/asperity
else
explorer:
	@echo "explorer: not checked: $$(rustc --version) has no standard library for wasm32-unknown-unknown"
	@echo "  with rustup: rustup target add wasm32-unknown-unknown"
	@echo "  with apt only: make wasm-toolchain, which unpacks a compiler of Debian's packages (1.1 GB) into target/debian"
endif

# A compiler for WebAssembly of Debian's packages, without rights and outside of the system.
wasm-toolchain:
	.ci/wasm_toolchain $(debian)

$(engine): $(shell git ls-files 'core/src' 'runner/src' 'engine/src' 'engine/build.rs' 'explorer' 'wasm' '*Cargo.toml' Cargo.lock)
	.ci/tools
	$(wasm_compiler) cargo rustc --profile explorer --locked $(wasm_standard) --target wasm32-unknown-unknown --package asperity-wasm -- -C link-arg=--compress-relocations
	touch $@

$(page): $(engine) explorer/node_modules/ready $(shell git ls-files 'explorer')
	node explorer/build.mjs $(engine) $(page)

# The explorer in a notebook: JupyterLab in Chromium.
notebook: $(venv)-notebook/installed explorer/node_modules/ready
	node explorer/notebook.mjs $(venv)-notebook/bin/python

$(venv)-notebook/ready: python/requirements-notebook.txt
	$(environment)

explorer/node_modules/ready: explorer/package-lock.json
	cd explorer && npm ci --silent
	touch $@

# What the commands on the pages print, anew.
outputs:
	ASPERITY_UPDATE=1 cargo test --release --locked --package asperity-cli --test documents blocks_do_what_they_show

# The tables of keys of docs/scenarios and the page docs/variables, anew, from the declarations in the code.
keys variables:
	cargo run --release --locked --package asperity-cli --example $@

# The page docs/validation/accuracy, anew. It fails where a distribution or a rule has no entry.
accuracy:
	cargo run --release --locked --package asperity-cli --example accuracy

# The renewal equation and contacts followed through time, for every rule with every family of thresholds: half an hour.
# `make rust` compares those that are quick.
agreement:
	cargo test --release --locked --package asperity --test master -- solvers_agree --ignored --nocapture

# Whether draws from posteriors are calibrated: the ranks of 200 truths among 99 draws, in some minutes. `make rust` does 25.
calibration:
	cargo test --release --locked --package asperity-runner --test posterior -- --ignored --nocapture

# What all shipped scenarios and the notebooks compute, compared bit by bit with what they do in the commit BASE: for changes of
# the code that must not change a number, and before a release.
fingerprint: tree := target/fingerprint/tree
fingerprint: base $(venv)/installed
	rm -rf $(tree); git worktree prune; git worktree add --detach $(tree) $(BASE)
	env -u CARGO_TARGET_DIR $(MAKE) --directory $(tree) $(venv)/installed
	env -u CARGO_TARGET_DIR $(tree)/$(venv)/bin/python -P .ci/fingerprint.py record $(tree) target/fingerprint/before.npz
	$(venv)/bin/python -P .ci/fingerprint.py record . target/fingerprint/after.npz
	git worktree remove --force $(tree)
	$(venv)/bin/python -P .ci/fingerprint.py compare target/fingerprint/before.npz target/fingerprint/after.npz

base:
	@[ -n "$(BASE)" ] || { echo "fingerprint: BASE=COMMIT is what to compare with" >&2; exit 2; }

# Scenarios drawn from the schema, one after the other, for an hour; those that fail are left in target/fuzz, each with the
# reason, and the command that repeats it is printed. CASE=1234 checks and runs that one, SECONDS=600 takes ten minutes,
# FROM=20000000 other numbers.
fuzz:
	$(if $(CASE),ASPERITY_CASE=$(CASE)) $(if $(SECONDS),ASPERITY_FUZZ_SECONDS=$(SECONDS)) $(if $(FROM),ASPERITY_FUZZ_FROM=$(FROM)) \
	  cargo test --release --locked --package asperity-cli --test generated -- --ignored --nocapture --exact $(if $(CASE),one_case,campaign)

# Bytes from strangers: scenarios, tables, results, checkpoints and parameters of distributions, changed at random, for ten minutes
# each; what fails is left in target/fuzz, and belongs into fuzz/corpus. `make rust` tries a fixed number of them. `cargo +nightly
# fuzz run scenario` searches by coverage.
fuzz-bytes:
	ASPERITY_FUZZ_SECONDS=$(or $(SECONDS),600) cargo test --release --locked --package asperity-runner --test fuzz -- --nocapture --test-threads 1

# What steps and cells the shipped scenarios cost, anew, after a change that is meant to change it. `make rust` compares.
cost:
	ASPERITY_UPDATE=1 cargo test --release --locked --package asperity-runner --test cost

# All combinations of a distribution, a task, a temperature and a rule of ageing, one after the other; those that fail are left in
# target/fuzz. CASE=1234 runs that one, PART=3/20 the one of twenty parts that has number 3, from 0 on.
grid:
	$(if $(CASE),ASPERITY_CASE=$(CASE)) $(if $(PART),ASPERITY_PART=$(PART)) \
	  cargo test --release --locked --package asperity-cli --test generated -- --ignored --nocapture --exact all_combinations

# What is published, without compiling it again: the crates with all that they include, the wheel and the source distribution.
release-check: packages $(package)/wheel $(venv)-release/ready
	$(PYTHON) .ci/packages.py $(target)/package
	$(venv)-release/bin/twine check --strict target/wheels/*.whl $(package)/*.tar.gz

published := --workspace --exclude asperity-python --exclude asperity-wasm

packages:
	cargo package $(published) --no-verify --locked --quiet --allow-dirty

# Changes of public items of the core that the version in Cargo.toml does not allow after the release BASE, the last tag if not
# given. The crates for the command and for Python promise none (docs/compatibility.md).
semver:
	@base="$(or $(BASE),$$(git describe --tags --abbrev=0 2> /dev/null || true))"; \
	if [ -z "$$base" ]; then \
	  echo "semver: not checked, there is no release to compare with: BASE=COMMIT names one"; \
	elif ! cargo semver-checks --version > /dev/null 2>&1; then \
	  echo "semver: not checked, cargo-semver-checks is not installed"; exit $(if $(CI),1,0); \
	else \
	  cargo semver-checks --package asperity --baseline-rev "$$base"; \
	fi

# The same, each crate compiled from its package as the registry would have it, and a wheel from the source distribution.
packages-compile: $(package)/wheel
	cargo publish $(published) --dry-run --locked
	CARGO_TARGET_DIR=$(CURDIR)/$(package)/build $(venv)/bin/pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir $(package) $(package)/*.tar.gz

publish:
	cargo publish $(published) --locked

# Version, date and address of the project into all files that have them, from Cargo.toml and CHANGELOG.md.
metadata:
	$(PYTHON) .ci/metadata.py write

# A release of the version in Cargo.toml: DATE=2026-12-24 goes into the changelog and all other files. docs/releasing.md has the rest.
release:
	$(PYTHON) .ci/metadata.py release $(DATE)

# The section of the changelog for a tag, TAG=v0.1.0.
release-notes:
	mkdir -p target
	$(PYTHON) .ci/metadata.py notes $(TAG) > target/release-notes.md

# The command for TARGET=x86_64-unknown-linux-musl, with licences and manual pages, as an archive in target/binaries.
binary:
	cargo build --release --locked --package asperity-cli --target $(TARGET)
	$(PYTHON) .ci/binary.py $(target)/$(TARGET)/release $(TARGET) target/binaries

# Whether all compiles, tests and examples too; with the oldest compiler in a workflow.
compiles:
	cargo check --locked --workspace --all-targets

# Whether the oldest dependencies that Cargo.toml allows suffice, on a copy of what is published and of the package.
minimal-versions:
	rm -rf target/minimal; mkdir -p target/minimal
	git archive HEAD | tar --extract --directory target/minimal
	sed --in-place 's/, "wasm"//' target/minimal/Cargo.toml
	cd target/minimal && cargo +nightly update --quiet -Z direct-minimal-versions
	cd target/minimal && env -u CARGO_TARGET_DIR cargo check --locked --workspace

# Changes of the code that no test notices, by cargo-mutants; FILE=core/src/elastic/stepper.rs those of a file, PART=0/512 some of all.
mutants:
	cargo mutants --profile release --output target/mutants $(if $(FILE),--file $(FILE)) $(if $(PART),--shard $(PART))
