# What a person types: make demo, make gallery, make test, make check, make agreement.

.PHONY: demo gallery agreement test check rust driver

BUILD := $(or $(CARGO_TARGET_DIR),target)
RUST := $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
ICDS := /usr/share/vulkan/icd.d/*.json /usr/local/share/vulkan/icd.d/*.json /etc/vulkan/icd.d/*.json
DRIVER := mesa-vulkan-drivers libvulkan1

# Build, write an example scene, render it; like test, installs a software Vulkan driver first where there is none.
demo: rust driver
	@cargo build --release --locked
	@$(BUILD)/release/anamorph example demo --out out >/dev/null
	@$(BUILD)/release/anamorph render out/demo.toml --samples 4 -o out/demo.png
	@echo "the picture is out/demo.png, its scene out/demo.toml"

# Render every scene that is after a figure of a paper, and one contact sheet of all.
gallery: rust driver
	@cargo run --release --locked --quiet --example gallery out
	@echo "the contact sheet is out/gallery.png, the pictures and their scenes are in out/gallery"

# Hold every camera against the reference on a city of 35,000 triangles and on the models in the folder MODELS: hours on a CPU.
agreement: rust driver
	@cargo run --release --locked --quiet --example agreement -- out/agreement $(MODELS)

# All tests; installs a software Vulkan driver first where there is none and apt-get may.
test: rust driver
	cargo test --locked

# What a change must pass.
