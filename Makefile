# The front door. 'make help' lists what there is.
BUILD := build
JOBS ?= $(shell nproc)
# INSTALL=no leaves the system's packages alone.
INSTALL ?= yes
DATA ?=
OUT ?= out/demo
BASE ?=

install = @if [ "$(INSTALL)" != no ]; then scripts/install_dependencies.sh $(1); fi

.PHONY: help build demo test bench format lint clean

help:
	@echo "MLO: multi-object lidar odometry"
	@echo
	@echo "  make build             build the program: $(BUILD)/bin/mlo"
	@echo "  make demo DATA=FOLDER  run it on a folder of scans (KITTI layouts, .bin, .pcd, .ply); results in $(OUT)"
	@echo "  make test              build and run all tests"
	@echo "  make bench             build and run the benchmarks; DATA=FOLDER (docs/results.md) adds KITTI's sequences"
	@echo "  make format            format the C++ sources"
	@echo "  make lint              check format and code; BASE=main only what differs from main"
	@echo "  make clean             remove what was built"
	@echo
	@echo "Missing Debian packages are installed first (INSTALL=no: not). JOBS=N limits parallel compiling."

build:
	$(call install,build)
	@cmake --preset release
	@cmake --build $(BUILD) --target mlo -j $(JOBS)

demo: build
	@if [ -z "$(DATA)" ]; then echo "Give a folder of scans: make demo DATA=FOLDER" >&2; exit 2; fi
	$(BUILD)/bin/mlo run "$(DATA)" --out "$(OUT)"

test:
	$(call install,build)
	@cmake --preset release
	@cmake --build $(BUILD) -j $(JOBS)
	@ctest --test-dir $(BUILD) --output-on-failure

bench:
	$(call install,build bench)
	@cmake --preset release -DMLO_BUILD_BENCHMARKS=ON
	@cmake --build $(BUILD) --target benchmarks -j $(JOBS)
	@for program in $(BUILD)/bin/bench_*; do $$program || exit 1; done
	@if [ -n "$(DATA)" ]; then \
	  cmake --build $(BUILD) --target mlo -j $(JOBS) && \
	  scripts/evaluate_sequences.py --data "$(DATA)" --program $(BUILD)/bin/mlo --out out/bench --variant default:; \
	fi

format:
	$(call install,develop)
	@git ls-files -- '*.cpp' '*.hpp' | xargs clang-format -i

lint:
	$(call install,build bench develop)
	@cmake --preset release -DMLO_BUILD_BENCHMARKS=ON
	@scripts/lint.sh $(BUILD) $(BASE)

clean:
	rm -rf build build-*
