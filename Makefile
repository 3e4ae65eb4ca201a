# `make test` is everything that must hold, and what CI runs. Rust is built in release mode throughout,
# so that the tests use what the first run has compiled.

SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.PHONY: setup test rust results lint docs figures bench validation

export PYTHON ?= python3
venv := .venv

# Everything that must hold.
test: setup rust results lint docs

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

$(venv)/ready: runner/tests/requirements.txt
	$(environment)

# The tests of all crates, those of the documents among them.
rust:
	cargo test --release --workspace --locked

# Results as users open them: every shipped scenario is run and read back with xarray.
results: $(venv)/ready
	folder=$$(mktemp -d); trap 'rm -rf "$$folder"' EXIT; \
	for scenario in scenarios/*.toml; do \
	  cargo run --release --locked --quiet -- run "$$scenario" --quiet -o "$$folder/$$(basename "$$scenario" .toml)"; \
	done; \
	$(venv)/bin/python runner/tests/open_with_xarray.py "$$folder"/*

# How the code is laid out, and what clippy has to say.
lint:
	cargo fmt --all --check
	cargo clippy --release --workspace --all-targets --locked -- -D warnings

# The documentation of the crates.
docs:
	RUSTDOCFLAGS="-D warnings" cargo doc --release --workspace --no-deps --locked

# The pictures of the README. A test compares them with what the program draws.
figures:
	folder=$$(mktemp -d); trap 'rm -rf "$$folder"' EXIT; \
	cargo run --release --locked --quiet -- run scenarios/fig2.toml --quiet -o "$$folder/fig2"; \
	for name in force evolution; do cp "$$folder/fig2/$$name.svg" "docs/figures/fig2-$$name.svg"; done

# How fast it is, beside what one would write in Python.
bench: $(venv)-peers/ready
	cargo bench --locked --package asperity --bench ensemble --bench master --bench scaling
	PEERS_PYTHON=$(CURDIR)/$(venv)-peers/bin/python cargo bench --locked --package asperity --bench peers

$(venv)-peers/ready: core/benches/peers/requirements.txt
	$(environment)

# The page docs/validation, anew. A test recomputes of it what is quick.
validation:
	cargo run --release --locked --package asperity-cli --example validation
