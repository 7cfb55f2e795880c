# What a person types: make demo, make gallery, make camera-pages, make pages, make docs, make wheel, make package, make test, make test-all, make test-long, make test-python,
# make check, make test-adapters, make agreement, make reproduce-quick.

.PHONY: docs package demo gallery camera-pages pages agreement reproduce-quick wheel test test-all test-long test-python test-adapters check rust driver venv

BUILD := $(or $(CARGO_TARGET_DIR),target)
RUST := $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
ICDS := /usr/share/vulkan/icd.d/*.json /usr/local/share/vulkan/icd.d/*.json /etc/vulkan/icd.d/*.json
DRIVER := mesa-vulkan-drivers libvulkan1
COMPILER := g++
PYTHON := python3-venv
# What the pages are made into a book with.
MDBOOK := 0.5.4
# Libraries that the Python package is compared with; its tests skip what is not there.
PEERS := pycolmap trimesh rtree
# A virtual environment, and the Python package that is tested in it.
VENV := $(BUILD)/venv
TESTED := $(BUILD)/tested-python
# Tests always select all packages, so that each is built once, with the same features.
PACKAGES := -p anamorph -p anamorph-lab -p anamorph-python -p naga-soft-f64
CARGO_TEST := cargo test --locked $(PACKAGES)
# An extension module does not link Python.
export PYO3_BUILD_EXTENSION_MODULE := 1
LONG_TESTS := frames kernels
ALL_TESTS := $(basename $(notdir $(wildcard tests/*.rs lab/tests/*.rs))) $(patsubst tests/%/main.rs,%,$(wildcard tests/*/main.rs))
OTHER_TESTS := $(filter-out $(LONG_TESTS),$(ALL_TESTS))
# Runs the test programs, the two longest at the same time as the others. The argument is passed to the programs.
beside = $(CARGO_TEST) $(addprefix --test ,$(LONG_TESTS)) $(1) >$(BUILD)/long-tests.txt 2>&1 & long=$$!; \
	$(CARGO_TEST) --lib --bins $(addprefix --test ,$(OTHER_TESTS)) $(1); others=$$?; \
	wait $$long; long=$$?; cat $(BUILD)/long-tests.txt; [ $$others = 0 ] && [ $$long = 0 ]
# Installs packages, by sudo where that asks for no password.
install = as=; [ "$$(id -u)" = 0 ] || as="sudo -n"; command -v apt-get >/dev/null && $$as true 2>/dev/null && \
	$$as apt-get update -qq && $$as env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq $(1) >/dev/null

# Build, write an example scene, render it; like test, installs a software Vulkan driver first where there is none.
demo: rust driver
	@cargo build --release --locked
	@$(BUILD)/release/anamorph example demo --out out >/dev/null
	@$(BUILD)/release/anamorph render out/demo.toml --samples 4 -o out/demo.png
	@echo "the picture is out/demo.png, its scene out/demo.toml"

# Render every scene that is after a figure of a paper, and one contact sheet of all.
gallery: rust driver
	@cargo run --release --locked --quiet -p anamorph-lab --example gallery out
	@echo "the contact sheet is out/gallery.jpg, the pictures and their scenes are in out/gallery"

# The pages of docs/cameras: one scene through every kind of camera, its rays, its keys.
camera-pages: rust driver
	@cargo run --release --locked --quiet -p anamorph-lab --example camera_pages docs/cameras

# The pages as a book of HTML, into target/book; the first time mdbook is built too.
docs: rust
	@[ -x $(BUILD)/mdbook/bin/mdbook ] || cargo install mdbook --version $(MDBOOK) --locked --quiet --root $(BUILD)/mdbook
	@rm -rf $(BUILD)/book-src && mkdir -p $(BUILD)/book-src && cp -r docs bench_results README.md $(BUILD)/book-src
	@mkdir $(BUILD)/book-src/python && cp -r python/README.md python/examples $(BUILD)/book-src/python
	@mv $(BUILD)/book-src/docs/book.toml $(BUILD)/book-src
	@sed -e 's,](,](docs/,' -e 's,](docs/../,](,' docs/SUMMARY.md >$(BUILD)/book-src/SUMMARY.md && rm $(BUILD)/book-src/docs/SUMMARY.md
	@$(BUILD)/mdbook/bin/mdbook build $(BUILD)/book-src --dest-dir $(abspath $(BUILD))/book
	@for tables in bench_results/*/summary.md; do cp $$tables $(BUILD)/book/$$tables; done
	@echo "the book is $(BUILD)/book/index.html"

# The tables, plots and pages of the runs in bench_results, from the results.json of each.
pages: rust
	@cargo build --release --locked -p anamorph-lab
	@$(BUILD)/release/anamorph-lab bench page

# Compare every camera with the reference on a city of 35,000 triangles and on the models in the folder MODELS: hours on a CPU.
agreement: rust driver
	@cargo run --release --locked --quiet -p anamorph-lab --example agreement -- out/agreement $(MODELS)

# Ten cases of the committed runs again: does each row agree? Ten minutes on a CPU.
reproduce-quick: rust driver
	@cargo build --release --locked -p anamorph-lab
	@status=0; while read -r row; do $(BUILD)/release/anamorph-lab bench reproduce --runs 6 "$$row" || status=1; done <lab/reproduce-quick.txt; \
	exit $$status

# The Python package as a wheel, into target/wheels.
wheel: rust venv
	@$(VENV)/bin/maturin build --release --locked --manifest-path python/Cargo.toml --out $(BUILD)/wheels

# The crate and the wheel as they would be published, into target; what they hold, their size and the licences of all that they build on. The
# first time cargo-deny is built too. python/tests/test_package.py checks most of it in `make test`.
package: rust venv wheel
	@cargo package --locked --quiet -p naga-soft-f64 -p anamorph
	@[ -x $(BUILD)/deny/bin/cargo-deny ] || cargo install cargo-deny --locked --quiet --root $(BUILD)/deny
	@$(BUILD)/deny/bin/cargo-deny --locked --all-features check licenses bans sources
	@ls -l $(BUILD)/package/*.crate $(BUILD)/wheels/*.whl

# The tests of every change; installs a software Vulkan driver first where there is none and apt-get may. The longest programs run beside the
# others, since tests of one program wait for one another's engine; what they print comes last. Examples are compiled by clippy in .ci/run.
test: rust driver venv
	$(CARGO_TEST) --lib --bins --tests --no-run
	@$(call beside,) && $(CARGO_TEST) --doc && $(MAKE) test-python

# The slow tests, which `make test` leaves out: those that are marked #[ignore = "slow: make test-all"].
test-all: rust driver
	$(CARGO_TEST) --lib --bins --tests --no-run
	@$(call beside,-- --ignored)

# The tests on random input, with 3 to 10 times as much of it, outside of .ci/run.
test-long: rust driver
	SEEDS=36 $(CARGO_TEST) --test kernels -- --include-ignored
	ANAMORPH_POLYNOMIALS=600000 $(CARGO_TEST) --lib --test cameras root
	ANAMORPH_FUZZ=5000 $(CARGO_TEST) --test fuzz --test mutated -- --include-ignored
	ANAMORPH_VIEW_EVENTS=3000 $(CARGO_TEST) --test view random_input

# Tests of the Python package, with the native module that the other tests are built with.
test-python: rust driver venv
	@cargo build --locked $(PACKAGES) --lib --bins --tests
	@rm -rf $(TESTED) && mkdir -p $(TESTED) && cp -r python/anamorph $(TESTED)
	@cp $(BUILD)/debug/lib_native.so $(TESTED)/anamorph/_native.abi3.so 2>/dev/null || \
		cp $(BUILD)/debug/lib_native.dylib $(TESTED)/anamorph/_native.abi3.so
	PYTHONPATH=$(abspath $(TESTED)) $(VENV)/bin/pytest --quiet -c python/pyproject.toml python/tests

# Every example on every software adapter of the machine, also on SwiftShader where chromium is installed: an hour.
test-adapters: rust driver
	@cargo build --release --locked
	@cargo run --release --locked --quiet -p anamorph-lab --example adapters -- $(BUILD)/release/anamorph out/adapters $(EXAMPLES)

# What a change must pass.
check: rust
	@.ci/run

# Rust that is new enough, and the C++ compiler that one library is built with; this is installed where apt-get may.
rust:
	@command -v cargo >/dev/null && command -v rustc >/dev/null || \
		{ echo "no Rust found; install rustc $(RUST) or newer from https://rustup.rs"; exit 1; }
	@have=$$(rustc --version | cut -d' ' -f2 | cut -d- -f1); \
	oldest=$$(printf '%s\n' "$$have" $(RUST) | sort -V | head -n1); \
	[ "$$oldest" = $(RUST) ] || [ "$$have" = $(RUST).0 ] || \
		{ echo "rustc $$have is too old; install $(RUST) or newer: rustup update"; exit 1; }
	@command -v c++ >/dev/null || { $(call install,$(COMPILER)); } || \
		{ echo "no C++ compiler found; install one (Debian, Ubuntu: apt-get install $(COMPILER))"; exit 1; }

# What the Python package is built and tested with.
venv:
	@python3 -c "import ensurepip, venv" 2>/dev/null || { $(call install,$(PYTHON)); } || \
		{ echo "no Python with venv found; install it (Debian, Ubuntu: apt-get install $(PYTHON))"; exit 1; }
	@[ -x $(VENV)/bin/pip ] || python3 -m venv $(VENV)
	@$(VENV)/bin/pip install --quiet --disable-pip-version-check "maturin>=1.16,<2" "numpy>=1.23" mypy pytest $(PEERS)

# A Vulkan driver; where there is none and apt-get may, Mesa's software one is installed.
driver:
	@[ -n "$$VK_DRIVER_FILES$$VK_ICD_FILENAMES" ] || ls $(ICDS) 2>/dev/null | grep -q . || { $(call install,$(DRIVER)); } || \
		echo "no Vulkan driver: pictures come from the CPU engine and tests that need a driver are skipped; install one (Debian, Ubuntu: apt-get install $(DRIVER))"
